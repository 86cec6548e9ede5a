// Chunks of the result are made apart. For each, the cells around it that the surface cuts get their
// triangles, and a sample looks at such cells row by row about it, the nearest rows first, until none of the
// next can be nearer. Which samples lie near the surface, and which cells of a row are cut, is read off bits.

#include "tafoni/surface/distances.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <optional>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/math/whole.h"
#include "tafoni/surface/impl/cases.h"

namespace tafoni::surface {
namespace {

using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;

/// Least distance of a vertex from the ends of its edge, in edges, as the meshers have it.
constexpr float least_end = 1.0f / 128;

constexpr int distance_chunk = ScalarGrid::chunk_samples;
static_assert(distance_chunk + 2 * most_distance + 1 <= 64, "a row of samples is a word");

/// Lengths are cells.
struct DistanceTriangle {
  Vec3f a, ab, ac;

  /// The square of the distance, by the region of the triangle that is nearest [Ericson05 §5.1.5].
  float squared_distance(Vec3f p) const {
    const Vec3f ap = p - a;
    const float d1 = dot(ab, ap), d2 = dot(ac, ap);
    if (d1 <= 0 && d2 <= 0) return dot(ap, ap);
    const Vec3f bp = ap - ab, cp = ap - ac;
    const float d3 = dot(ab, bp), d4 = dot(ac, bp), d5 = dot(ab, cp), d6 = dot(ac, cp);
    if (d3 >= 0 && d4 <= d3) return dot(bp, bp);
    if (d6 >= 0 && d5 <= d6) return dot(cp, cp);
    const float vc = d1 * d4 - d3 * d2;
    if (vc <= 0 && d1 >= 0 && d3 <= 0) return square(ap - ab * (d1 / (d1 - d3)));
    const float vb = d5 * d2 - d1 * d6;
    if (vb <= 0 && d2 >= 0 && d6 <= 0) return square(ap - ac * (d2 / (d2 - d6)));
    const float va = d3 * d6 - d5 * d4;
    if (va <= 0 && d4 >= d3 && d5 >= d6)
      return square(bp - (ac - ab) * ((d4 - d3) / ((d4 - d3) + (d5 - d6))));
    const float scale = 1 / (va + vb + vc);
    return square(ap - ab * (vb * scale) - ac * (vc * scale));
  }

 private:
  static float square(Vec3f v) { return dot(v, v); }
};

/// Makes chunks of distances; one a thread.
class ChunkDistances {
 public:
  ChunkDistances(const ScalarGrid& grid, double reach)
      : grid_(grid),
        cell_(static_cast<float>(grid.frame().spacing)),
        metres_(static_cast<float>(reach)),
        reach_(static_cast<float>(reach / grid.frame().spacing)),
        rim_(ceil_to(reach / grid.frame().spacing)) {
    sort_rows();
  }

  /// What ScalarGrid::generate() asks for.
  std::optional<float> make(const SampleBox& box, float* out) {
    if (const std::optional<bool> side = side_around(box)) return *side ? metres_ : -metres_;
    load(box);
    if (!find_cuts()) return solid(rim_, rim_, rim_) ? metres_ : -metres_;
    find_triangles();
    find_near();
    const Vec3i n = box.size();
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y)
        for (int x = 0; x < n.x; ++x) {
          const int u = x + rim_, v = y + rim_, w = z + rim_;
          const float d = near_[row(v, w)] >> u & 1 ? distance({u, v, w}) : metres_;
          out[(z * distance_chunk + y) * distance_chunk + x] = solid(u, v, w) ? d : -d;
        }
    return {};
  }

 private:
  /// On which side of the surface the chunk and those around it are, if they are known to be on one.
  std::optional<bool> side_around(const SampleBox& box) const {
    static_assert(most_distance < distance_chunk);
    const Vec3i at{box.lo.x / distance_chunk, box.lo.y / distance_chunk, box.lo.z / distance_chunk};
    const Vec3i n = grid_.chunks();
    std::optional<bool> side;
    for (int z = std::max(at.z - 1, 0); z <= std::min(at.z + 1, n.z - 1); ++z)
      for (int y = std::max(at.y - 1, 0); y <= std::min(at.y + 1, n.y - 1); ++y)
        for (int x = std::max(at.x - 1, 0); x <= std::min(at.x + 1, n.x - 1); ++x) {
          float value = 0;
          if (!grid_.uniform({x, y, z}, &value) || (side && *side != (value > 0))) return {};
          side = value > 0;
        }
    return side;
  }

  /// Samples of the chunk with `rim_` more on each side, as far as the grid has them, and their signs.
  void load(const SampleBox& box) {
    const Vec3i rim{rim_, rim_, rim_}, last = grid_.frame().size - Vec3i{1, 1, 1};
    block_ = {box.lo - rim, box.hi + rim};
    size_ = block_.size();
    values_.resize(block_.count());
    grid_.read(block_, values_.data());
    solid_.assign(std::size_t(size_.y) * size_.z, 0);
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y) {
        const float* v = values_.data() + (std::ptrdiff_t{z} * size_.y + y) * size_.x;
        std::uint64_t bits = 0;
        for (int x = 0; x < size_.x; ++x) bits |= std::uint64_t{v[x] > 0} << x;
        solid_[row(y, z)] = bits;
      }
    // Beyond the grid its border repeats itself and would be cut where it is not.
    const Vec3i first{std::max(-block_.lo.x, 0), std::max(-block_.lo.y, 0), std::max(-block_.lo.z, 0)};
    cells_ = {
        first,
        {std::min(size_.x - 1, last.x - block_.lo.x) - 1, std::min(size_.y - 1, last.y - block_.lo.y) - 1,
         std::min(size_.z - 1, last.z - block_.lo.z) - 1}};
  }

  /// Cells by their lowest sample. False where the surface cuts none.
  bool find_cuts() {
    cut_.assign(solid_.size(), 0);
    std::uint64_t all = 0;
    if (cells_.empty()) return false;
    const std::uint64_t within =
        (~std::uint64_t{0} >> (63 - cells_.hi.x)) & (~std::uint64_t{0} << cells_.lo.x);
    for (int z = cells_.lo.z; z <= cells_.hi.z; ++z)
      for (int y = cells_.lo.y; y <= cells_.hi.y; ++y) {
        const std::uint64_t r[] = {solid_[row(y, z)], solid_[row(y + 1, z)], solid_[row(y, z + 1)],
                                   solid_[row(y + 1, z + 1)]};
        const std::uint64_t any = r[0] | r[1] | r[2] | r[3], every = r[0] & r[1] & r[2] & r[3];
        all |= cut_[row(y, z)] = ((any | any >> 1) & ~(every & every >> 1)) & within;
      }
    return all != 0;
  }

  void find_triangles() {
    triangles_.clear();
    nearest_ = 0;
    of_cell_.resize(values_.size());
    for (int z = cells_.lo.z; z <= cells_.hi.z; ++z)
      for (int y = cells_.lo.y; y <= cells_.hi.y; ++y)
        for (std::uint64_t bits = cut_[row(y, z)]; bits != 0; bits &= bits - 1)
          add_triangles({std::countr_zero(bits), y, z});
  }

  void add_triangles(Vec3i cell) {
    float corner[8];
    int solids = 0;
    for (int c = 0; c < 8; ++c) {
      corner[c] = values_[index(cell + Vec3i{c & 1, (c >> 1) & 1, c >> 2})];
      solids |= (corner[c] > 0) << c;
    }
    const impl::CellCase& own = impl::case_table()[solids];
    of_cell_[index(cell)] = {static_cast<std::uint32_t>(triangles_.size()), own.triangles};
    for (int t = 0; t < own.triangles; ++t) {
      Vec3f v[3];
      for (int k = 0; k < 3; ++k) v[k] = vertex(own.edges[3 * t + k], corner, cell);
      triangles_.push_back({v[0], v[1] - v[0], v[2] - v[0]});
    }
  }

  static Vec3f vertex(int edge, const float corner[8], Vec3i cell) {
    const int axis = edge / 4, a = edge & 1, b = (edge >> 1) & 1;
    const int low = axis == 0 ? 2 * a + 4 * b : axis == 1 ? a + 4 * b : a + 2 * b;
    const float from = corner[low], to = corner[low + (1 << axis)];
    const float t = std::clamp(from / (from - to), least_end, 1 - least_end);
    Vec3f p{static_cast<float>(cell.x + (low & 1)), static_cast<float>(cell.y + ((low >> 1) & 1)),
            static_cast<float>(cell.z + (low >> 2))};
    (axis == 0 ? p.x : axis == 1 ? p.y : p.z) += t;
    return p;
  }

  /// Samples that a cut cell may be near to.
  void find_near() {
    std::vector<std::uint64_t>& to = near_;
    to.assign(cut_.size(), 0);
    std::vector<std::uint64_t> along = to;
    // A cell is as near to `rim_` samples on either side of it.
    for (std::size_t i = 0; i < cut_.size(); ++i)
      if (cut_[i] != 0)
        for (int d = 1 - rim_; d <= rim_; ++d) along[i] |= d < 0 ? cut_[i] >> -d : cut_[i] << d;
    std::vector<std::uint64_t> across = to;
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int d = 1 - rim_; d <= rim_; ++d)
          if (y + d >= 0 && y + d < size_.y) across[row(y + d, z)] |= along[row(y, z)];
    for (int z = 0; z < size_.z; ++z)
      for (int y = 0; y < size_.y; ++y)
        for (int d = 1 - rim_; d <= rim_; ++d)
          if (z + d >= 0 && z + d < size_.z) to[row(y, z + d)] |= across[row(y, z)];
  }

  /// Metres, at most the reach.
  float distance(Vec3i sample) {
    const Vec3f p{static_cast<float>(sample.x), static_cast<float>(sample.y), static_cast<float>(sample.z)};
    float best = reach_ * reach_;  // the square
    // What was nearest to the sample before is seldom far.
    if (nearest_ < triangles_.size()) best = std::min(best, triangles_[nearest_].squared_distance(p));
    for (const Row& near : rows_) {
      const float rest = best - near.squared_gap;
      if (!(rest > 0)) break;
      const int y = sample.y + near.y, z = sample.z + near.z,
                h = std::min(floor_to(std::sqrt(rest)), rim_ - 1);
      const std::uint64_t window = ((std::uint64_t{1} << (2 * h + 2)) - 1) << (sample.x - h - 1);
      for (std::uint64_t bits = cut_[row(y, z)] & window; bits != 0; bits &= bits - 1) {
        const int x = std::countr_zero(bits);
        const float along = gap(x - sample.x);
        if (near.squared_gap + along * along < best) look({x, y, z}, p, best);
      }
    }
    return best < reach_ * reach_ ? std::min(std::sqrt(best) * cell_, metres_) : metres_;
  }

  void look(Vec3i cell, Vec3f p, float& best) {
    const CellTriangles own = of_cell_[index(cell)];
    for (std::uint32_t t = own.first; t < own.first + own.count; ++t)
      if (const float d = triangles_[t].squared_distance(p); d < best) best = d, nearest_ = t;
  }

  /// How far a sample is from a cell so many further on, along one axis.
  static float gap(int cells) { return static_cast<float>(cells < 0 ? -cells - 1 : cells); }

  /// Rows of cells about a sample, the nearest first.
  void sort_rows() {
    for (int z = -rim_; z < rim_; ++z)
      for (int y = -rim_; y < rim_; ++y) rows_.push_back({y, z, gap(y) * gap(y) + gap(z) * gap(z)});
    std::stable_sort(rows_.begin(), rows_.end(),
                     [](const Row& a, const Row& b) { return a.squared_gap < b.squared_gap; });
  }

  std::size_t row(int y, int z) const { return std::size_t(z) * size_.y + y; }
  std::size_t index(Vec3i at) const { return row(at.y, at.z) * size_.x + at.x; }
  bool solid(int x, int y, int z) const { return solid_[row(y, z)] >> x & 1; }

  struct CellTriangles {
    std::uint32_t first, count;
  };
  struct Row {
    int y, z;  ///< counted from the sample
    float squared_gap;
  };

  const ScalarGrid& grid_;
  float cell_, metres_;  ///< of a cell's side, and the reach
  float reach_;          ///< in cells
  int rim_;
  SampleBox block_, cells_;  ///< cells_ counts from the block
  Vec3i size_;               ///< of the block
  std::vector<float> values_;
  std::vector<std::uint64_t> solid_, cut_, near_;  ///< by rows along x; cells go by their lowest sample
  std::vector<CellTriangles> of_cell_;             ///< valid where cut_ says so
  std::vector<DistanceTriangle> triangles_;
  std::size_t nearest_ = 0;  ///< to the sample before
  std::vector<Row> rows_;
};

}  // namespace

ScalarGrid distances(const ScalarGrid& grid, double reach, Precision precision, Progress& progress) {
  const volume::GridFrame& frame = grid.frame();
  if (!(reach > 0) || reach > most_distance * frame.spacing)
    fail(ErrorKind::usage, "distances reach above 0 and at most {} cells, here {:g} m, not {:g} m",
         most_distance, most_distance * frame.spacing, reach);
  ScalarGrid out(frame, static_cast<float>(-reach), precision);
  const Vec3i n = grid.chunks();
  progress.begin("measuring distances", std::int64_t{n.x} * n.y * n.z, "chunks");
  out.generate([&](const SampleBox& box, float* to) { return ChunkDistances(grid, reach).make(box, to); },
               progress);
  progress.end();
  return out;
}

}  // namespace tafoni::surface
