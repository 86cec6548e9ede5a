#include "tafoni/mesh/impl/grid_chunk_maker.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "tafoni/mesh/impl/cases.h"
#include "tafoni/mesh/impl/convex.h"
#include "tafoni/mesh/impl/lattice.h"

namespace tafoni::mesh::impl {
namespace {

using volume::SampleBox;
using volume::ScalarGrid;

constexpr int side = ScalarGrid::chunk_samples;
static_assert(side == 1 << 5);

/// What the layer of air around a solid's frame holds: so low that walls lie where vertices end.
constexpr float air = -1e15f;

struct Axis {
  int first, samples, lo, hi;
};

/// Along one axis: chunk `at` of `chunks` with n samples in the frame.
Axis axis_of(int at, int chunks, int n, bool solid) {
  const int frame_lo = solid ? -1 : 0, frame_hi = solid ? n : n - 1;
  const int lo = at == 0 ? frame_lo : side * at, hi = at == chunks - 1 ? frame_hi : side * (at + 1);
  const int first = std::max(lo - 1, frame_lo), last = std::min(hi + 1, frame_hi);
  return {first, last - first + 1, lo - first, hi - first};
}

float margin_of(const volume::GridFrame& frame) {
  const Box3d box = frame.box();
  double reach = 0;
  for (Vec3d p : {box.lo, box.hi}) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return margin_for(static_cast<std::int64_t>(std::min(reach / frame.spacing, 1e15)) + 2);
}

}  // namespace

GridLayout::GridLayout(const volume::GridFrame& f, Boundary b) : frame(f), boundary(b), margin(margin_of(f)) {
  const auto count = [](int samples) { return (samples - 2) / side + 1; };
  chunks_ = {count(f.size.x), count(f.size.y), count(f.size.z)};
}

GridLayout::Block GridLayout::block(Vec3i chunk) const {
  const bool solid = boundary == Boundary::solid;
  const Axis x = axis_of(chunk.x, chunks_.x, frame.size.x, solid);
  const Axis y = axis_of(chunk.y, chunks_.y, frame.size.y, solid);
  const Axis z = axis_of(chunk.z, chunks_.z, frame.size.z, solid);
  return {
      {x.first, y.first, z.first}, {x.samples, y.samples, z.samples}, {x.lo, y.lo, z.lo}, {x.hi, y.hi, z.hi}};
}

std::pair<Vec3i, Vec3i> GridLayout::touched(const SampleBox& s) const {
  const Vec3i n = frame.size;
  const SampleBox in{{std::max(s.lo.x, 0), std::max(s.lo.y, 0), std::max(s.lo.z, 0)},
                     {std::min(s.hi.x, n.x - 1), std::min(s.hi.y, n.y - 1), std::min(s.hi.z, n.z - 1)}};
  if (in.empty()) return {{0, 0, 0}, {-1, -1, -1}};
  // Chunk a reads the samples from 32 a - 1 to 32 a + 33.
  const auto first = [](int lo) { return std::max(lo - 2, 0) >> 5; };
  const auto last = [](int hi, int chunks) { return std::min((hi + 1) >> 5, chunks - 1); };
  return {{first(in.lo.x), first(in.lo.y), first(in.lo.z)},
          {last(in.hi.x, chunks_.x), last(in.hi.y, chunks_.y), last(in.hi.z, chunks_.z)}};
}

Vec3i GridLayout::owner(Vec3i s) const {
  return {std::clamp(s.x >> 5, 0, chunks_.x - 1), std::clamp(s.y >> 5, 0, chunks_.y - 1),
          std::clamp(s.z >> 5, 0, chunks_.z - 1)};
}

GridChunkMaker::GridChunkMaker(const GridLayout& layout, bool polygons)
    : layout_(layout), polygons_(polygons) {
  constexpr std::size_t most = side + 5, slack = most * most + most + 1;
  memory_.assign(most * most * most + 2 * slack, 0.0f);
  samples_ = memory_.data() + slack;
}

bool GridChunkMaker::make(const ScalarGrid& grid, Vec3i chunk, const SampleBox& changed,
                          std::uint64_t version, GridChunkState& state) {
  state_ = &state;
  block_ = layout_.block(chunk);
  const Vec3i n = block_.samples;
  const auto rows = [](int lo, int hi, int count) { return Rows{std::max(lo, 0), std::min(hi, count - 1)}; };
  if (state.solid.empty()) {
    state.solid.assign(static_cast<std::size_t>(n.y) * static_cast<std::size_t>(n.z), 0);
    state.cut.assign(static_cast<std::size_t>(n.y - 1) * static_cast<std::size_t>(n.z - 1), 0);
    state.any_cut.assign(static_cast<std::size_t>(n.z - 1), 0);
    state.edges.clear();
    state.merges.clear();
    changed_rows_ = fresh_rows_ = {0, n.y - 1};
    changed_planes_ = fresh_planes_ = {0, n.z - 1};
  } else {
    const Vec3i lo = changed.lo - block_.origin, hi = changed.hi - block_.origin;
    changed_rows_ = rows(lo.y, hi.y, n.y);
    changed_planes_ = rows(lo.z, hi.z, n.z);
    // An edge has its ends in two rows, and their gradients need one row more on each side.
    fresh_rows_ = rows(lo.y - 2, hi.y + 1, n.y);
    fresh_planes_ = rows(lo.z - 2, hi.z + 1, n.z);
  }
  read(grid, {{0, std::max(fresh_rows_.first - 1, 0), std::max(fresh_planes_.first - 1, 0)},
              {n.x - 1, std::min(fresh_rows_.last + 2, n.y - 1), std::min(fresh_planes_.last + 2, n.z - 1)}});
  update_bits();

  const Vec3i first{std::max(-block_.origin.x, 0), std::max(-block_.origin.y, 0),
                    std::max(-block_.origin.z, 0)};
  const Vec3i end = layout_.frame.size - block_.origin;
  plane_ = {};
  plane_.row_step = n.x;
  plane_.plane_step = n.x * n.y;
  plane_.x0 = first.x, plane_.y0 = first.y, plane_.z0 = first.z;
  plane_.nx = std::min(n.x, end.x), plane_.ny = std::min(n.y, end.y), plane_.nz = std::min(n.z, end.z);
  plane_.i0 = block_.origin.x, plane_.j0 = block_.origin.y;
  plane_.voxel = layout_.frame.spacing;
  plane_.origin = layout_.frame.origin;
  plane_.margin = layout_.margin;
  positions_.clear();
  normals_.clear();
  edges_.clear();
  indices_.clear();
  walker_.walk(samples_, n.x, n.y, n.z, n.x, static_cast<std::ptrdiff_t>(n.x) * n.y, *this, *this,
               state.solid.data());
  return finish(version);
}

void GridChunkMaker::read(const ScalarGrid& grid, const SampleBox& part) {
  const Vec3i n = block_.samples;
  for (int k = part.lo.z; k <= part.hi.z; ++k) {
    const Vec3i lo = block_.origin + Vec3i{0, part.lo.y, k};
    grid.read({lo, {lo.x + n.x - 1, block_.origin.y + part.hi.y, lo.z}},
              samples_ + (static_cast<std::ptrdiff_t>(k) * n.y + part.lo.y) * n.x);
  }
  if (layout_.boundary == Boundary::solid) add_air(part);
}

/// Where the block reaches beyond the frame.
void GridChunkMaker::add_air(const SampleBox& part) {
  const Vec3i n = block_.samples, size = layout_.frame.size;
  const auto beyond = [](int sample, int count) { return sample < 0 || sample >= count; };
  for (int k = part.lo.z; k <= part.hi.z; ++k)
    for (int j = part.lo.y; j <= part.hi.y; ++j) {
      float* row = samples_ + (static_cast<std::ptrdiff_t>(k) * n.y + j) * n.x;
      if (beyond(block_.origin.y + j, size.y) || beyond(block_.origin.z + k, size.z)) {
        std::fill_n(row, n.x, air);
        continue;
      }
      if (beyond(block_.origin.x, size.x)) row[0] = air;
      if (beyond(block_.origin.x + n.x - 1, size.x)) row[n.x - 1] = air;
    }
}

/// Signs of the changed rows, and which voxels around them are cut.
void GridChunkMaker::update_bits() {
  GridChunkState& s = *state_;
  const Vec3i n = block_.samples;
  for (int k = changed_planes_.first; k <= changed_planes_.last; ++k)
    for (int j = changed_rows_.first; j <= changed_rows_.last; ++j) {
      const std::ptrdiff_t row = static_cast<std::ptrdiff_t>(k) * n.y + j;
      signs(samples_ + row * n.x, n.x, s.solid.data() + row);
    }
  const std::uint64_t columns =
      ((std::uint64_t{1} << block_.hi.x) - 1) & ~((std::uint64_t{1} << block_.lo.x) - 1);
  for (int k = std::max(changed_planes_.first - 1, block_.lo.z);
       k <= std::min(changed_planes_.last, block_.hi.z - 1); ++k) {
    const std::uint64_t* solid = s.solid.data() + static_cast<std::ptrdiff_t>(k) * n.y;
    std::uint64_t* cut = s.cut.data() + static_cast<std::ptrdiff_t>(k) * (n.y - 1);
    for (int j = std::max(changed_rows_.first - 1, block_.lo.y);
         j <= std::min(changed_rows_.last, block_.hi.y - 1); ++j) {
      const std::uint64_t a = solid[j], b = solid[j + 1], c = solid[j + n.y], d = solid[j + n.y + 1];
      const std::uint64_t any = a | b | c | d, all = a & b & c & d;
      cut[j] = (any | (any >> 1)) & ~(all & (all >> 1)) & columns;
    }
    s.any_cut[static_cast<std::size_t>(k)] =
        std::any_of(cut, cut + n.y - 1, [](std::uint64_t row) { return row != 0; });
  }
}

/// Takes over vertices [from, to) of the mesh so far.
void GridChunkMaker::keep(std::uint32_t from, std::uint32_t to) {
  const std::size_t count = to - from;
  if (count == 0) return;
  const GridChunkMesh& old = *state_->mesh;
  const auto append = [&](Buffer<float>& out, const std::vector<Vec3f>& in) {
    out.reserve_extra(3 * (count + kernel_slack));
    std::memcpy(out.end(), in.data() + from, count * sizeof(Vec3f));
    out.commit(3 * count);
  };
  append(positions_, old.positions);
  append(normals_, old.normals);
  edges_.reserve_extra(count);
  std::memcpy(edges_.end(), state_->edges.data() + from, count * sizeof(std::uint32_t));
  edges_.commit(count);
}

void GridChunkMaker::place_fresh(int k, const EdgeKey* keys, std::size_t n) {
  if (n == 0) return;
  plane_.f = samples_ + static_cast<std::ptrdiff_t>(k) * plane_.plane_step;
  plane_.k = k;
  plane_.level = block_.origin.z + k;
  positions_.reserve_extra(3 * (n + kernel_slack));
  normals_.reserve_extra(3 * (n + kernel_slack));
  edges_.reserve_extra(n);
  place(plane_, keys, n, positions_.end(), nullptr, normals_.end());
  if (layout_.boundary == Boundary::solid) point_walls_outward(k, keys, n, normals_.end());
  for (std::size_t v = 0; v < n; ++v)
    edges_.data()[edges_.size() + v] = edge_place(key_i(keys[v]), key_j(keys[v]), k, key_axis(keys[v]));
  positions_.commit(3 * n);
  normals_.commit(3 * n);
  edges_.commit(n);
}

/// Normals of the vertices between the frame and the air around it.
void GridChunkMaker::point_walls_outward(int k, const EdgeKey* keys, std::size_t n, float* normals) const {
  const Vec3i size = layout_.frame.size;
  for (std::size_t v = 0; v < n; ++v, normals += 3) {
    const Vec3i start = block_.origin + Vec3i{key_i(keys[v]), key_j(keys[v]), k};
    const int axis = key_axis(keys[v]);
    const int at = axis == 0 ? start.x : axis == 1 ? start.y : start.z;
    const int count = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
    if (at >= 0 && at < count - 1) continue;
    std::fill_n(normals, 3, 0.0f);
    normals[axis] = at < 0 ? -1.0f : 1.0f;
  }
}

void GridChunkMaker::vertices(int k, const PlaneOutput& out) {
  const EdgeKey* keys = out.keys.data();
  const EdgeKey* end = keys + out.keys.size();
  const auto old = [&](int plane, int row) {
    const auto& edges = state_->edges;
    return static_cast<std::uint32_t>(
        std::lower_bound(edges.begin(), edges.end(), edge_place(0, row, plane, 0)) - edges.begin());
  };
  if (!fresh_planes_.has(k)) {
    keep(old(k, 0), old(k + 1, 0));
    return;
  }
  const EdgeKey* first =
      std::partition_point(keys, end, [&](EdgeKey key) { return key_j(key) < fresh_rows_.first; });
  const EdgeKey* last =
      std::partition_point(first, end, [&](EdgeKey key) { return key_j(key) <= fresh_rows_.last; });
  keep(old(k, 0), old(k, fresh_rows_.first));
  place_fresh(k, first, static_cast<std::size_t>(last - first));
  keep(old(k, fresh_rows_.last + 1), old(k + 1, 0));
}

void GridChunkMaker::triangles(const PlaneOutput& out) {
  const std::size_t n = out.indices.size();
  indices_.reserve_extra(n);
  if (n) std::memcpy(indices_.end(), out.indices.data(), n * sizeof(std::uint32_t));
  indices_.commit(n);
}

/// Joins triangles to polygons; voxels away from the changed rows are joined as they were.
void GridChunkMaker::join_polygons(VoxelPolygons& out) {
  GridChunkState& s = *state_;
  const Vec3i n = block_.samples;
  const double tolerance = layout_.frame.spacing / 256;
  const Vec3f* positions = reinterpret_cast<const Vec3f*>(positions_.data());
  const std::uint32_t* triangles = indices_.data();
  std::vector<std::uint8_t> merges;
  for (int k = block_.lo.z; k < block_.hi.z; ++k)
    for (int j = block_.lo.y; j < block_.hi.y; ++j) {
      const std::uint64_t* row = s.solid.data() + static_cast<std::ptrdiff_t>(k) * n.y + j;
      const bool fresh = k >= changed_planes_.first - 1 && k <= changed_planes_.last &&
                         j >= changed_rows_.first - 1 && j <= changed_rows_.last;
      std::size_t old = 0;
      std::uint64_t cut = s.cut[static_cast<std::size_t>(k * (n.y - 1) + j)];
      if (cut && !fresh) old = old_voxel(block_.origin + Vec3i{0, j, k});
      for (; cut; cut &= cut - 1) {
        const int i = std::countr_zero(cut);
        const auto pair = [&](int at) { return static_cast<int>(row[at] >> i & 3); };
        const int solid = pair(0) | pair(1) << 2 | pair(n.y) << 4 | pair(n.y + 1) << 6;
        const int merge = fresh ? best_merge(solid, triangles, positions, tolerance) : s.merges[old++];
        const ConvexPieces& pieces = convex_pieces(solid, merge);
        out.voxels.push_back(block_.origin + Vec3i{i, j, k});
        out.first.push_back(static_cast<std::uint32_t>(out.begin.size()));
        for (int p = 0; p < pieces.count; ++p) {
          out.begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
          for (int c = pieces.begin[p]; c < pieces.begin[p + 1]; ++c)
            out.corners.push_back(triangles[pieces.corners[c]]);
        }
        merges.push_back(static_cast<std::uint8_t>(merge));
        triangles += 3 * case_table()[static_cast<std::size_t>(solid)].triangles;
      }
    }
  out.first.push_back(static_cast<std::uint32_t>(out.begin.size()));
  out.begin.push_back(static_cast<std::uint32_t>(out.corners.size()));
  s.merges = std::move(merges);
}

/// The place of the first voxel of a row, or of the next row that has any, in the mesh so far.
std::size_t GridChunkMaker::old_voxel(Vec3i voxel) const {
  const auto& voxels = state_->mesh->polygons.voxels;
  return static_cast<std::size_t>(std::lower_bound(voxels.begin(), voxels.end(), voxel, voxel_before) -
                                  voxels.begin());
}

bool GridChunkMaker::finish(std::uint64_t version) {
  GridChunkState& s = *state_;
  if (indices_.size() == 0) {
    const bool had = s.mesh != nullptr;
    s = {};
    return had;
  }
  const auto* positions = reinterpret_cast<const Vec3f*>(positions_.data());
  const auto* normals = reinterpret_cast<const Vec3f*>(normals_.data());
  const auto* triangles = reinterpret_cast<const std::array<std::uint32_t, 3>*>(indices_.data());
  const std::size_t vertex_count = edges_.size(), triangle_count = indices_.size() / 3;
  const auto same = [](const auto& held, const auto* made, std::size_t n) {
    return held.size() == n && std::memcmp(held.data(), made, n * sizeof(*made)) == 0;
  };
  if (s.mesh && same(s.mesh->positions, positions, vertex_count) &&
      same(s.mesh->normals, normals, vertex_count) && same(s.mesh->triangles, triangles, triangle_count)) {
    s.edges.assign(edges_.data(), edges_.end());
    return false;
  }
  auto made = std::make_shared<GridChunkMesh>();
  made->positions.assign(positions, positions + vertex_count);
  made->normals.assign(normals, normals + vertex_count);
  made->triangles.assign(triangles, triangles + triangle_count);
  made->version = version;
  if (polygons_) join_polygons(made->polygons);
  s.edges.assign(edges_.data(), edges_.end());
  s.mesh = std::move(made);
  return true;
}

}  // namespace tafoni::mesh::impl
