#include "tafoni/landforms/surface.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/spatial_hash.h"

namespace tafoni::landforms {
namespace {

struct Candidate {
  SurfacePoint point;
  std::uint64_t priority;
};

constexpr int tries = 2;  ///< candidates a cell
constexpr int newton_steps = 4;

/// All candidates of one column of chunks.
class ColumnSampler {
 public:
  ColumnSampler(const field::CompiledField& field, const SurfaceSampling& settings, double voxel)
      : field_(field), settings_(settings), voxel_(voxel), evaluator_(field, voxel) {}

  std::vector<Candidate> sample(int a, int b, Progress& progress) {
    const double chunk = voxel_ * field::chunk_cells;
    Box3d column{{a * chunk, b * chunk, settings_.box.lo.z},
                 {(a + 1) * chunk, (b + 1) * chunk, settings_.box.hi.z}};
    if (refused(column)) return {};
    const auto range = evaluator_.column(a, b);
    const int first = std::max(range.first, static_cast<int>(std::floor(settings_.box.lo.z / chunk)));
    const int last = std::min(range.last, static_cast<int>(std::floor(settings_.box.hi.z / chunk)));
    for (int c = first; c <= last; ++c) {
      progress.check();
      column.lo.z = c * chunk;
      column.hi.z = (c + 1) * chunk;
      if (!refused(column) && evaluator_.evaluate(c, samples_)) {
        scatter();
        project();
      }
    }
    return std::move(result_);
  }

 private:
  bool refused(const Box3d& cells) const {
    // A sample may come to lie a cell beyond its own.
    return settings_.maybe && !settings_.maybe(cells.center(), 0.5 * length(cells.size()) + 2 * voxel_);
  }

  Vec3d corner(int i, int j, int k) const {
    return Vec3d{static_cast<double>(std::int64_t{samples_.chunk.x} * field::chunk_cells + i),
                 static_cast<double>(std::int64_t{samples_.chunk.y} * field::chunk_cells + j),
                 static_cast<double>(std::int64_t{samples_.chunk.z} * field::chunk_cells + k)} *
           voxel_;
  }

  /// Jittered points in the cells that the surface cuts.
  void scatter() {
    points_.clear();
    keys_.clear();
    for (int bz = 0; bz < field::chunk_bricks; ++bz)
      for (int by = 0; by < field::chunk_bricks; ++by)
        for (int bx = 0; bx < field::chunk_bricks; ++bx)
          if (samples_.brick(bx, by, bz)) scatter_brick(bx, by, bz);
  }

  void scatter_brick(int bx, int by, int bz) {
    constexpr int n = field::brick_cells;
    const Box3d brick{corner(bx * n, by * n, bz * n), corner((bx + 1) * n, (by + 1) * n, (bz + 1) * n)};
    if (!settings_.box.overlaps(brick.grown(voxel_)) || refused(brick)) return;
    for (int k = bz * n; k < (bz + 1) * n; ++k)
      for (int j = by * n; j < (by + 1) * n; ++j)
        for (int i = bx * n; i < (bx + 1) * n; ++i)
          if (is_cut(i, j, k)) scatter_cell(i, j, k);
  }

  bool is_cut(int i, int j, int k) const {
    int solid = 0;
    for (int corner = 0; corner < 8; ++corner)
      solid += samples_.at(i + (corner & 1), j + (corner >> 1 & 1), k + (corner >> 2)) > 0;
    return solid != 0 && solid != 8;
  }

  void scatter_cell(int i, int j, int k) {
    const Vec3<std::int64_t> cell{std::int64_t{samples_.chunk.x} * field::chunk_cells + i,
                                  std::int64_t{samples_.chunk.y} * field::chunk_cells + j,
                                  std::int64_t{samples_.chunk.z} * field::chunk_cells + k};
    const Vec3d lo = corner(i, j, k);
    const Box3d grown{lo - Vec3d{voxel_, voxel_, voxel_}, lo + Vec3d{2 * voxel_, 2 * voxel_, 2 * voxel_}};
    if (!settings_.box.overlaps(grown)) return;
    if (settings_.maybe && !settings_.maybe(grown.center(), 3 * voxel_)) return;
    const std::uint64_t key =
        hash_combine(hash_combine(hash_combine(settings_.seed, static_cast<std::uint64_t>(cell.x)),
                                  static_cast<std::uint64_t>(cell.y)),
                     static_cast<std::uint64_t>(cell.z));
    Random random(key);
    for (int t = 0; t < tries; ++t) {
      const Vec3d jitter{random.uniform(), random.uniform(), random.uniform()};
      points_.push_back(lo + jitter * voxel_);
      keys_.push_back(random.next());
    }
  }

  /// Newton steps along the gradient; keeps what arrives near its own cell.
  void project() {
    start_ = points_;
    for (int step = 0; !points_.empty(); ++step) {
      values_.resize(points_.size());
      gradients_.resize(points_.size());
      field_.gradients(points_, values_, gradients_);
      std::size_t left = 0;
      for (std::size_t i = 0; i < points_.size(); ++i) {
        const Vec3d g = to_double(gradients_[i]);
        const double f = static_cast<double>(values_[i]), slope = length(g);
        if (std::abs(f) < 0.01 * settings_.spacing * slope) {
          arrive(points_[i], g * (-1 / slope), start_[i], keys_[i]);
          continue;
        }
        if (step == newton_steps || slope < 1e-6) continue;
        Vec3d move = g * (-f / (slope * slope));
        if (length(move) > voxel_) move = normalized(move) * voxel_;
        points_[left] = points_[i] + move;
        start_[left] = start_[i];
        keys_[left++] = keys_[i];
      }
      points_.resize(left);
    }
  }

  void arrive(Vec3d p, Vec3d normal, Vec3d start, std::uint64_t key) {
    const Vec3d moved = p - start;
    if (dot(moved, moved) > 4 * voxel_ * voxel_ || !settings_.box.contains(p)) return;
    const SurfacePoint point{p, to_float(normal)};
    if (!settings_.accept || settings_.accept(point)) result_.push_back({point, key});
  }

  const field::CompiledField& field_;
  const SurfaceSampling& settings_;
  double voxel_;
  field::ChunkEvaluator evaluator_;
  field::ChunkSamples samples_;
  std::vector<Vec3d> points_, start_;
  std::vector<std::uint64_t> keys_;
  std::vector<float> values_;
  std::vector<Vec3f> gradients_;
  std::vector<Candidate> result_;
};

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
        kept_(static_cast<std::size_t>(size.x) * static_cast<std::size_t>(size.y)) {}

  std::vector<SurfacePoint> run(Progress& progress) {
    progress.begin("sampling the surface", kept_.size(), "tiles");
    for (int colour = 0; colour < 4; ++colour) {
      const int x0 = colour & 1, y0 = colour >> 1;
      const std::int64_t across = (size_.x - x0 + 1) / 2, along = (size_.y - y0 + 1) / 2;
      parallel_for(
          across * along,
          [&](std::int64_t i) {
            column(x0 + 2 * static_cast<int>(i % across), y0 + 2 * static_cast<int>(i / across), progress);
          },
          progress);
    }
    progress.end();
    return gathered();
  }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size_.x) + static_cast<std::size_t>(x);
  }

  void column(int x, int y, Progress& progress) {
    ColumnSampler sampler(field_, settings_, voxel_);
    std::vector<Candidate> candidates = sampler.sample(first_.x + x, first_.y + y, progress);
    if (candidates.empty()) return;
    SpatialHash hash(2 * settings_.spacing, candidates.size() / 8);
    add_neighbours(x, y, hash);
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.priority < b.priority; });
    std::vector<Candidate>& kept = kept_[index(x, y)];
    for (const Candidate& candidate : candidates) {
      if (hash.any_near(candidate.point.position, settings_.spacing)) continue;
      hash.insert(candidate.point.position);
      kept.push_back(candidate);
    }
    kept.shrink_to_fit();
  }

  /// What neighbours have accepted within reach of the column's candidates, which may lie two cells outside
  /// it.
  void add_neighbours(int x, int y, SpatialHash& hash) const {
    const double side = voxel_ * field::chunk_cells, reach = settings_.spacing + 2 * voxel_;
    const double west = (first_.x + x) * side - reach, south = (first_.y + y) * side - reach;
    for (int ny = std::max(0, y - 1); ny <= std::min(size_.y - 1, y + 1); ++ny)
      for (int nx = std::max(0, x - 1); nx <= std::min(size_.x - 1, x + 1); ++nx)
        for (const Candidate& c : kept_[index(nx, ny)]) {
          const Vec3d p = c.point.position;
          if (p.x > west && p.x < west + side + 2 * reach && p.y > south && p.y < south + side + 2 * reach)
            hash.insert(p);
        }
  }

  /// By priority, so that every prefix is spread over the whole region.
  std::vector<SurfacePoint> gathered() {
    std::vector<Candidate> all;
    for (auto& part : kept_) {
      all.insert(all.end(), part.begin(), part.end());
      part = {};
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Candidate& a, const Candidate& b) { return a.priority < b.priority; });
    std::vector<SurfacePoint> points;
    points.reserve(all.size());
    for (const Candidate& c : all) points.push_back(c.point);
    return points;
  }

  const field::CompiledField& field_;
  const SurfaceSampling& settings_;
  double voxel_;
  Pair first_, size_;
  std::vector<std::vector<Candidate>> kept_;  ///< by column
};

}  // namespace

std::vector<SurfacePoint> sample_surface(const field::CompiledField& field, const SurfaceSampling& settings,
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
  const auto whole = [](double v) { return static_cast<int>(v); };
  return DartBoard(field, settings, voxel, {whole(a0), whole(b0)}, {whole(across), whole(along)})
      .run(progress);
}

}  // namespace tafoni::landforms
