// Blue noise on an implicit surface: in each lattice cell that the surface cuts, a jittered candidate goes to
// the cell's interpolated zero; by rising random priority, candidates are projected by Newton steps and kept
// where no kept sample is near. Columns of chunks are worked on in parallel by the colours of a checkerboard.

#include "tafoni/landforms/site/surface.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <span>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/field/chunks.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms {
namespace {

/// A jittered place near the surface, as the lattice's samples show it, that may become a sample.
struct Candidate {
  Vec3d position;
  std::uint64_t priority;
};
struct Sample {
  SurfaceSample point;
  std::uint64_t priority;
};

constexpr int newton_steps = 4;                   ///< a candidate that has not arrived by then is given up
constexpr double arrived_at = 0.01;               ///< spacings from the surface that count as on it
constexpr std::size_t most_samples = 10'000'000;  ///< a gigabyte
constexpr double stray = 3;  ///< a sample lies at most this many cells from the cell it was drawn in

/// Finds all candidates of one column of chunks.
class ColumnSampler {
 public:
  ColumnSampler(const field::CompiledField& field, const SurfaceSampling& settings, double voxel)
      : settings_(settings), voxel_(voxel), evaluator_(field, voxel) {}

  std::vector<Candidate> sample(int a, int b, Progress& progress) {
    const double chunk = voxel_ * field::chunk_cells;
    Box3d column{{a * chunk, b * chunk, settings_.box.lo.z},
                 {(a + 1) * chunk, (b + 1) * chunk, settings_.box.hi.z}};
    if (refused(column)) return {};
    const auto range = evaluator_.column(a, b);
    const int first = std::max(range.first, floor_to(settings_.box.lo.z / chunk));
    const int last = std::min(range.last, floor_to(settings_.box.hi.z / chunk));
    for (int c = first; c <= last; ++c) {
      progress.check();
      column.lo.z = c * chunk;
      column.hi.z = (c + 1) * chunk;
      if (!refused(column) && evaluator_.evaluate(c, samples_)) scatter();
    }
    return std::move(result_);
  }

 private:
  bool refused(const Box3d& cells) const {
    return settings_.maybe && !settings_.maybe(cells.center(), 0.5 * length(cells.size()) + stray * voxel_);
  }

  Vec3<std::int64_t> cell(int i, int j, int k) const {
    return {std::int64_t{samples_.chunk.x} * field::chunk_cells + i,
            std::int64_t{samples_.chunk.y} * field::chunk_cells + j,
            std::int64_t{samples_.chunk.z} * field::chunk_cells + k};
  }
  Vec3d corner(int i, int j, int k) const {
    const auto c = cell(i, j, k);
    return Vec3d{static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)} * voxel_;
  }

  void scatter() {
    for (int bz = 0; bz < field::chunk_bricks; ++bz)
      for (int by = 0; by < field::chunk_bricks; ++by)
        for (int bx = 0; bx < field::chunk_bricks; ++bx)
          if (samples_.brick(bx, by, bz)) scatter_brick(bx, by, bz);
  }

  void scatter_brick(int bx, int by, int bz) {
    constexpr int n = field::brick_cells;
    const Box3d brick{corner(bx * n, by * n, bz * n), corner((bx + 1) * n, (by + 1) * n, (bz + 1) * n)};
    if (!settings_.box.overlaps(brick.grown(voxel_)) || refused(brick)) return;
    // Bit i of solid[k][j] tells whether the sample is rock. A cell is cut where its eight corners differ.
    unsigned solid[n + 1][n + 1];
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j) {
        solid[k][j] = 0;
        for (int i = 0; i <= n; ++i)
          solid[k][j] |= unsigned{samples_.at(bx * n + i, by * n + j, bz * n + k) > 0} << i;
      }
    for (int k = 0; k < n; ++k)
      for (int j = 0; j < n; ++j) {
        const unsigned any = solid[k][j] | solid[k][j + 1] | solid[k + 1][j] | solid[k + 1][j + 1];
        const unsigned all = solid[k][j] & solid[k][j + 1] & solid[k + 1][j] & solid[k + 1][j + 1];
        unsigned cut = (any | any >> 1) & ~(all & all >> 1) & 0xffu;
        for (; cut != 0; cut &= cut - 1) scatter_cell(bx * n + std::countr_zero(cut), by * n + j, bz * n + k);
      }
  }

  void scatter_cell(int i, int j, int k) {
    const Vec3d lo = corner(i, j, k);
    const Box3d box{lo, lo + Vec3d{voxel_, voxel_, voxel_}};
    if (!settings_.box.overlaps(box.grown(voxel_)) || refused(box)) return;
    const auto at = cell(i, j, k);
    Random random(settings_.seed, key_of_cell(at.x, at.y, at.z));
    float f[8];
    for (int corner = 0; corner < 8; ++corner)
      f[corner] = samples_.at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2));
    Vec3d u{random.uniform(), random.uniform(), random.uniform()};
    const Vec3d slope = approach(f, u);
    const SurfaceSample shown{lo + u * voxel_, to_float(normalized(slope) * -1.0)};
    if (settings_.accept && !settings_.accept(shown)) return;
    result_.push_back({shown.position, random.next()});
  }

  /// Takes two Newton steps towards the zero of the cell's trilinear interpolant with its mean gradient,
  /// which it returns, per cell; `u` is in cells from the cell's low corner.
  static Vec3d approach(const float (&f)[8], Vec3d& u) {
    const auto d = [&](int a, int b) { return double{f[a] - f[b]}; };
    const Vec3d g = Vec3d{d(1, 0) + d(3, 2) + d(5, 4) + d(7, 6), d(2, 0) + d(3, 1) + d(6, 4) + d(7, 5),
                          d(4, 0) + d(5, 1) + d(6, 2) + d(7, 3)} *
                    0.25;
    const double slope2 = dot(g, g);
    if (slope2 < 1e-12) return {0, 0, -1};
    const auto mix = [](double a, double b, double t) { return a + (b - a) * t; };
    const auto along_x = [&](int a) { return mix(f[a], f[a + 1], u.x); };
    for (int step = 0; step < 2; ++step) {
      const double value = mix(mix(along_x(0), along_x(2), u.y), mix(along_x(4), along_x(6), u.y), u.z);
      u += g * (-value / slope2);
      u = {std::clamp(u.x, 0.0, 1.0), std::clamp(u.y, 0.0, 1.0), std::clamp(u.z, 0.0, 1.0)};
    }
    return g;
  }

  const SurfaceSampling& settings_;
  double voxel_;
  field::ChunkEvaluator evaluator_;
  field::ChunkSamples samples_;
  std::vector<Candidate> result_;
};

/// Moves candidates to the surface by Newton steps along the gradient; returns those that arrive near where
/// they began and are accepted, in order.
std::vector<Sample> project(const field::CompiledField& field, const SurfaceSampling& settings, double voxel,
                            std::span<const Candidate> candidates) {
  std::vector<Vec3d> points;
  std::vector<std::uint32_t> which;
  for (std::uint32_t i = 0; i < candidates.size(); ++i) {
    points.push_back(candidates[i].position);
    which.push_back(i);
  }
  std::vector<float> values;
  std::vector<Vec3f> gradients;
  std::vector<std::pair<std::uint32_t, SurfaceSample>> arrived;
  for (int step = 0; !points.empty(); ++step) {
    values.resize(points.size());
    gradients.resize(points.size());
    field.gradients(points, values, gradients);
    std::size_t left = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3d g = to_double(gradients[i]);
      const double f = values[i], slope = length(g);
      if (std::abs(f) < arrived_at * settings.spacing * slope) {
        const Vec3d moved = points[i] - candidates[which[i]].position;
        if (dot(moved, moved) <= (stray - 1) * (stray - 1) * voxel * voxel)
          arrived.emplace_back(which[i], SurfaceSample{points[i], to_float(g * (-1 / slope))});
        continue;
      }
      if (step == newton_steps || slope < 1e-6) continue;
      Vec3d move = g * (-f / (slope * slope));
      if (length(move) > voxel) move = normalized(move) * voxel;
      points[left] = points[i] + move;
      which[left++] = which[i];
    }
    points.resize(left);
  }
  std::sort(arrived.begin(), arrived.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Sample> samples;
  for (const auto& [i, point] : arrived)
    if (settings.box.contains(point.position) && (!settings.accept || settings.accept(point)))
      samples.push_back({point, candidates[i].priority});
  return samples;
}

/// Dart throwing over the columns of chunks. Columns of one colour of a 2 x 2 checkerboard lie a whole column
/// apart, so that they cannot disturb one another: they are worked on in parallel, after what earlier colours
/// have accepted. Candidates live only as long as their column's turn.
class DartBoard {
 public:
  struct Pair {
    int x, y;
  };
  DartBoard(const field::CompiledField& field, const SurfaceSampling& settings, double voxel, Pair first,
            Pair size)
      : field_(field),
        settings_(settings),
        voxel_(voxel),
        first_(first),
        size_(size),
        kept_(std::size_t{1} * size.x * size.y) {}

  std::vector<SurfaceSample> run(Progress& progress) {
    progress.begin("sampling the surface", kept_.size(), "tiles");
    for (int colour = 0; colour < 4; ++colour) {
      const int x0 = colour & 1, y0 = colour >> 1;
      const int across = (size_.x - x0 + 1) / 2, along = (size_.y - y0 + 1) / 2;
      parallel_for(
          std::int64_t{across} * along,
          [&](std::int64_t i) {
            const Vec3i at = sample_at({across, along, 1}, i);
            column(x0 + 2 * at.x, y0 + 2 * at.y, progress);
          },
          progress);
    }
    progress.end();
    return gather();
  }

 private:
  std::size_t index(int x, int y) const { return std::size_t{1} * y * size_.x + x; }

  void column(int x, int y, Progress& progress) {
    ColumnSampler sampler(field_, settings_, voxel_);
    std::vector<Candidate> candidates = sampler.sample(first_.x + x, first_.y + y, progress);
    if (candidates.empty()) return;
    SpatialHash hash(2 * settings_.spacing, candidates.size() / 8);
    add_neighbours(x, y, hash);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.priority < b.priority; });
    std::vector<Sample>& kept = kept_[index(x, y)];
    // The work goes in rounds, as most candidates of the later ones lie beside a sample already and need no
    // projecting.
    const std::span<const Candidate> all(candidates);
    std::vector<Candidate> round;
    for (std::size_t begin = 0, end = 0; begin < all.size(); begin = end) {
      end = std::min(all.size(), std::max<std::size_t>(begin + 64, begin + begin / 2));
      round.clear();
      for (const Candidate& c : all.subspan(begin, end - begin))
        if (!hash.any_near(c.position, nearly * settings_.spacing)) round.push_back(c);
      for (const Sample& sample : project(field_, settings_, voxel_, round)) {
        if (hash.any_near(sample.point.position, settings_.spacing)) continue;
        hash.insert(sample.point.position);
        kept.push_back(sample);
      }
    }
    kept.shrink_to_fit();
    // How many there are in the end does not depend on which column comes first.
    if ((all_ += kept.size()) > most_samples)
      fail(
          ErrorKind::usage,
          "a spacing of {:g} m gives more than {} million places on a region of {:.0f} by {:.0f} m; choose a "
          "larger one",
          settings_.spacing, most_samples / 1'000'000, settings_.box.size().x, settings_.box.size().y);
  }

  /// Adds what neighbours have accepted within reach of the column's candidates, which may lie two cells
  /// outside it.
  void add_neighbours(int x, int y, SpatialHash& hash) const {
    const double side = voxel_ * field::chunk_cells, reach = settings_.spacing + stray * voxel_;
    const double west = (first_.x + x) * side - reach, south = (first_.y + y) * side - reach;
    for (int ny = std::max(0, y - 1); ny <= std::min(size_.y - 1, y + 1); ++ny)
      for (int nx = std::max(0, x - 1); nx <= std::min(size_.x - 1, x + 1); ++nx)
        for (const Sample& c : kept_[index(nx, ny)]) {
          const Vec3d p = c.point.position;
          if (p.x > west && p.x < west + side + 2 * reach && p.y > south && p.y < south + side + 2 * reach)
            hash.insert(p);
        }
  }

  /// All samples by priority, so that every prefix is spread over the whole region.
  std::vector<SurfaceSample> gather() {
    std::vector<Sample> all;
    for (auto& part : kept_) {
      all.insert(all.end(), part.begin(), part.end());
      part = {};
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Sample& a, const Sample& b) { return a.priority < b.priority; });
    std::vector<SurfaceSample> points;
    points.reserve(all.size());
    for (const Sample& c : all) points.push_back(c.point);
    return points;
  }

  /// A candidate so much nearer than the spacing to a sample will not come to lie farther away by projection.
  static constexpr double nearly = 0.9;

  const field::CompiledField& field_;
  const SurfaceSampling& settings_;
  double voxel_;
  Pair first_, size_;
  std::vector<std::vector<Sample>> kept_;  ///< by column
  std::atomic<std::size_t> all_ = 0;       ///< of these
};

}  // namespace

std::vector<SurfaceSample> sample_surface(const field::CompiledField& field, const SurfaceSampling& settings,
                                          Progress& progress) {
  if (settings.box.empty()) return {};
  // With cells of half the spacing, a surface point is at most a cell's diagonal from the candidates of its
  // cell and these at most the spacing from a sample: together below twice the spacing.
  const double voxel = 0.5 * settings.spacing;
  const double chunk = voxel * field::chunk_cells;
  const auto index = [chunk](double v) { return std::floor(v / chunk); };
  const double a0 = index(settings.box.lo.x), b0 = index(settings.box.lo.y);
  const double across = index(settings.box.hi.x) - a0 + 1, along = index(settings.box.hi.y) - b0 + 1;
  if (!(across * along <= 4194304.0))
    fail(ErrorKind::usage,
         "a spacing of {} m is too small for a region of {:.0f} by {:.0f} m; choose a larger one",
         settings.spacing, settings.box.size().x, settings.box.size().y);
  return DartBoard(field, settings, voxel, {floor_to(a0), floor_to(b0)}, {floor_to(across), floor_to(along)})
      .run(progress);
}

}  // namespace tafoni::landforms
