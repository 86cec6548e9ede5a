// Makes a chunk's mesh row by row. Tables of the first vertex, triangle and cut voxel of each row say where a
// row's part lay and where it will lie, so that rows that stay are copied and only the others are made.

#include "tafoni/surface/impl/grid_chunk_maker.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "tafoni/mesh/inner/size32.h"
#include "tafoni/surface/impl/cases.h"
#include "tafoni/surface/impl/convex.h"

namespace tafoni::surface::impl {
namespace {

using volume::SampleBox;
using volume::ScalarGrid;

/// What the layer of air around a solid's frame holds: so low that walls lie where vertices end.
constexpr float air = -1e15f;

constexpr std::uint64_t bits(int from, int to) {
  return ((std::uint64_t{1} << to) - 1) & ~((std::uint64_t{1} << from) - 1);
}

/// Copies the table of rows [first, end) that stay, now from `at` on; returns what follows.
std::uint32_t move_table(const std::vector<std::uint32_t>& old, std::size_t first, std::size_t end,
                         std::uint32_t at, std::vector<std::uint32_t>& now) {
  if (first >= end) return at;
  const std::uint32_t moved = at - old[first];
  for (std::size_t row = first; row < end; ++row) now[row] = old[row] + moved;
  return old[end] + moved;
}

}  // namespace

RowEdges GridChunkState::edges(const GridLayout::Block& block, int j, int k) const {
  const Vec3i lo = block.lo, hi = block.hi;
  if (j < lo.y || j > hi.y || k < lo.z || k > hi.z) return {};
  const std::uint64_t* row = solid.data() + k * block.samples.y + j;
  const std::uint64_t columns = bits(lo.x, hi.x + 1);
  return {(row[0] ^ (row[0] >> 1)) & bits(lo.x, hi.x), j < hi.y ? (row[0] ^ row[1]) & columns : 0,
          k < hi.z ? (row[0] ^ row[block.samples.y]) & columns : 0};
}

GridChunkMaker::GridChunkMaker(const GridLayout& layout, bool polygons)
    : layout_(layout), polygons_(polygons) {
  constexpr std::size_t most = ScalarGrid::chunk_samples + 5, slack = most * most + most + 1;
  memory_.assign(most * most * most + 2 * slack, 0.0f);
  samples_ = memory_.data() + slack;
}

bool GridChunkMaker::make(const ScalarGrid& grid, Vec3i chunk, const SampleBox& changed,
                          std::uint64_t version, GridChunkState& state) {
  state_ = &state;
  block_ = layout_.block(chunk);
  choose_parts(changed);
  const Vec3i n = block_.samples;
  read(grid, {{std::max(fresh_.rows.first - 1, 0), std::min(fresh_.rows.last + 2, n.y - 1)},
              {std::max(fresh_.planes.first - 1, 0), std::min(fresh_.planes.last + 2, n.z - 1)}});
  update_bits();
  count_vertices();
  make_triangles();
  if (triangle_at_.back() == 0) {
    const bool had = state.mesh != nullptr;
    state = {};
    return had;
  }
  auto made = std::make_shared<GridChunkMesh>();
  made->version = version;
  place_all(*made);
  gather_triangles(*made);
  const auto same = [](const auto& a, const auto& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  const GridChunkMesh* old = state.mesh.get();
  const bool differs = !old || !same(old->triangles, made->triangles) ||
                       !same(old->positions, made->positions) || !same(old->normals, made->normals);
  if (differs && polygons_) gather_polygons(*made);
  if (differs) state.mesh = std::move(made);
  state.vertex_at.swap(vertex_at_);
  state.triangle_at.swap(triangle_at_);
  return differs;
}

/// Which rows to look at again.
void GridChunkMaker::choose_parts(const SampleBox& changed) {
  const Vec3i n = block_.samples;
  GridChunkState& s = *state_;
  if (s.solid.empty()) {
    s.solid.assign(n.y * n.z + 1, 0);  // one more for row_words()
    s.vertex_at.clear();
    s.triangle_at.clear();
    changed_ = fresh_ = {{0, n.y - 1}, {0, n.z - 1}};
    recut_ = {{0, n.y - 2}, {0, n.z - 2}};
    return;
  }
  const auto rows = [](int lo, int hi, int end) { return Rows{std::max(lo, 0), std::min(hi, end - 1)}; };
  const Vec3i lo = changed.lo - block_.origin, hi = changed.hi - block_.origin;
  changed_ = {rows(lo.y, hi.y, n.y), rows(lo.z, hi.z, n.z)};
  // An edge has its ends in two rows, and their gradients need one row more on each side.
  fresh_ = {rows(lo.y - 2, hi.y + 1, n.y), rows(lo.z - 2, hi.z + 1, n.z)};
  // A voxel has edges that start in two rows.
  recut_ = {rows(lo.y - 2, hi.y, n.y - 1), rows(lo.z - 2, hi.z, n.z - 1)};
}

void GridChunkMaker::read(const ScalarGrid& grid, const Part& part) {
  const Vec3i n = block_.samples;
  for (int k = part.planes.first; k <= part.planes.last; ++k) {
    const Vec3i lo = block_.origin + Vec3i{0, part.rows.first, k};
    grid.read({lo, {lo.x + n.x - 1, block_.origin.y + part.rows.last, lo.z}}, samples(part.rows.first, k));
  }
  if (layout_.boundary == Boundary::solid) add_air(part);
}

/// Where the block reaches beyond the frame.
void GridChunkMaker::add_air(const Part& part) {
  const Vec3i n = block_.samples, size = layout_.frame.size;
  const auto beyond = [](int sample, int samples) { return sample < 0 || sample >= samples; };
  for (int k = part.planes.first; k <= part.planes.last; ++k)
    for (int j = part.rows.first; j <= part.rows.last; ++j) {
      float* row = samples(j, k);
      if (beyond(block_.origin.y + j, size.y) || beyond(block_.origin.z + k, size.z)) {
        std::fill_n(row, n.x, air);
        continue;
      }
      if (beyond(block_.origin.x, size.x)) row[0] = air;
      if (beyond(block_.origin.x + n.x - 1, size.x)) row[n.x - 1] = air;
    }
}

void GridChunkMaker::update_bits() {
  const Vec3i n = block_.samples;
  const int rows = changed_.rows.last - changed_.rows.first + 1;
  for (int k = changed_.planes.first; k <= changed_.planes.last; ++k) {
    const int first = changed_.rows.first;
    signs(samples(first, k), n.x, rows, state_->solid.data() + sample_row(first, k));
  }
}

/// Where each row's vertices will be.
void GridChunkMaker::count_vertices() {
  const Vec3i n = block_.samples, lo = block_.lo, hi = block_.hi;
  const Rows rows = fresh_.rows, within{std::max(rows.first, lo.y), std::min(rows.last, hi.y)};
  const int end = n.y * n.z;
  vertex_at_.resize(end + 1);
  words_.resize((rows.last - rows.first + 1) * (fresh_.planes.last - fresh_.planes.first + 1));
  std::uint32_t at = 0;
  std::size_t row = 0;
  for (int k = fresh_.planes.first; k <= fresh_.planes.last; ++k) {
    at = move_table(state_->vertex_at, row, sample_row(rows.first, k), at, vertex_at_);
    row = sample_row(rows.last + 1, k);
    RowWord empty;
    empty.x_base = empty.y_base = empty.z_base = at;
    std::fill_n(&word(rows.first, k), rows.last - rows.first + 1, empty);
    if (k >= lo.z && k <= hi.z && within.first <= within.last) {
      const std::uint64_t* solid = state_->solid.data() + sample_row(within.first, k);
      at = row_words(solid, k < hi.z ? solid + n.y : nullptr, within.last - within.first + 1, columns(),
                     bits(lo.x, hi.x + 1), at, &word(within.first, k));
      if (within.last == hi.y) {  // no row after it
        RowWord& last = word(within.last, k);
        at -= last.z_base - last.y_base;
        last.z_base = last.y_base;
        last.y = 0;
      }
      for (int j = within.last + 1; j <= rows.last; ++j) word(j, k).x_base = at;
    }
    for (int j = rows.first; j <= rows.last; ++j) vertex_at_[sample_row(j, k)] = word(j, k).x_base;
  }
  vertex_at_[end] = move_table(state_->vertex_at, row, end, at, vertex_at_);
}

std::uint64_t GridChunkMaker::columns() const {
  return bits(block_.lo.x, block_.hi.x);
}

/// The triangles of recut rows, and where each row's will be.
void GridChunkMaker::make_triangles() {
  const Vec3i n = block_.samples, lo = block_.lo, hi = block_.hi;
  const int end = (n.y - 1) * (n.z - 1);
  triangle_at_.resize(end + 1);
  corners_.clear();
  const std::uint64_t cells = columns();
  std::uint64_t cut = 0;
  std::uint32_t at = 0;
  std::size_t row = 0;
  for (int k = recut_.planes.first; k <= recut_.planes.last; ++k) {
    at = move_table(state_->triangle_at, row, voxel_row(recut_.rows.first, k), at, triangle_at_);
    row = voxel_row(recut_.rows.last + 1, k);
    for (int j = recut_.rows.first; j <= recut_.rows.last; ++j) {
      triangle_at_[voxel_row(j, k)] = at;
      if (j < lo.y || j >= hi.y || k < lo.z || k >= hi.z) continue;
      corners_.reserve_extra(15 * 64 + kernel_slack);
      const auto made = static_cast<std::uint32_t>(
          triangles(&word(j, k), &word(j, k + 1), &cells, 1, 1, corners_.end(), cut));
      corners_.commit(made);
      at += made / 3;
    }
  }
  triangle_at_[end] = move_table(state_->triangle_at, row, end, at, triangle_at_);
}

/// Appends the vertices that rows [first_row, end_row) had.
void GridChunkMaker::keep_vertices(std::size_t first_row, std::size_t end_row, GridChunkMesh& out) const {
  const auto& at = state_->vertex_at;
  if (first_row >= end_row || at[first_row] == at[end_row]) return;
  const GridChunkMesh& old = *state_->mesh;
  const auto append = [&](std::vector<Vec3f>& to, const std::vector<Vec3f>& from) {
    to.insert(to.end(), from.begin() + at[first_row], from.begin() + at[end_row]);
  };
  append(out.positions, old.positions);
  append(out.normals, old.normals);
}

void GridChunkMaker::place_all(GridChunkMesh& out) {
  const Vec3i n = block_.samples, end = layout_.frame.size - block_.origin;
  plane_ = {};
  plane_.row_step = n.x;
  plane_.plane_step = n.x * n.y;
  plane_.x0 = std::max(-block_.origin.x, 0), plane_.nx = std::min(n.x, end.x);
  plane_.y0 = std::max(-block_.origin.y, 0), plane_.ny = std::min(n.y, end.y);
  plane_.z0 = std::max(-block_.origin.z, 0), plane_.nz = std::min(n.z, end.z);
  plane_.i0 = block_.origin.x, plane_.j0 = block_.origin.y;
  plane_.voxel = layout_.frame.spacing;
  plane_.origin = layout_.frame.origin;
  plane_.margin = layout_.margin;
  out.positions.reserve(vertex_at_.back());
  out.normals.reserve(vertex_at_.back());
  std::size_t row = 0;
  for (int k = fresh_.planes.first; k <= fresh_.planes.last; ++k) {
    keep_vertices(row, sample_row(fresh_.rows.first, k), out);
    place_row_span(k, out);
    row = sample_row(fresh_.rows.last + 1, k);
  }
  keep_vertices(row, vertex_at_.size() - 1, out);
}

/// Appends the vertices of the fresh rows of a plane.
void GridChunkMaker::place_row_span(int k, GridChunkMesh& out) {
  const int first = fresh_.rows.first, last = fresh_.rows.last;
  const std::size_t n = vertex_at_[sample_row(last + 1, k)] - vertex_at_[sample_row(first, k)];
  if (n == 0) return;
  keys_.clear();
  keys_.reserve_extra(n + kernel_slack);
  for (int j = first; j <= last; ++j) {
    const RowWord& e = word(j, k);
    EdgeKey* to = keys_.end();
    const auto list = [&](std::uint64_t set, int axis) {
      for (; set; set &= set - 1) *to++ = edge_key(std::countr_zero(set), j, axis);
    };
    list(e.x, 0), list(e.y, 1), list(e.z, 2);
    keys_.commit(to - keys_.end());
  }
  std::fill_n(keys_.end(), kernel_slack, EdgeKey{0});
  positions_.clear();
  normals_.clear();
  positions_.reserve_extra(3 * (n + kernel_slack));
  normals_.reserve_extra(3 * (n + kernel_slack));
  plane_.f = samples(0, k);
  plane_.k = k;
  plane_.level = block_.origin.z + k;
  place(plane_, keys_.data(), n, positions_.data(), nullptr, normals_.data());
  if (layout_.boundary == Boundary::solid) point_walls_outward(k, n);
  const auto append = [&](std::vector<Vec3f>& to, const Buffer<float>& from) {
    const auto* vectors = reinterpret_cast<const Vec3f*>(from.data());
    to.insert(to.end(), vectors, vectors + n);
  };
  append(out.positions, positions_);
  append(out.normals, normals_);
}

/// Normals of the vertices between the frame and the air around it.
void GridChunkMaker::point_walls_outward(int k, std::size_t n) {
  const Vec3i size = layout_.frame.size;
  const EdgeKey* keys = keys_.data();
  float* normals = normals_.data();
  for (std::size_t v = 0; v < n; ++v, normals += 3) {
    const Vec3i start = block_.origin + Vec3i{key_i(keys[v]), key_j(keys[v]), k};
    const int axis = key_axis(keys[v]);
    const int at = axis == 0 ? start.x : axis == 1 ? start.y : start.z;
    const int samples = axis == 0 ? size.x : axis == 1 ? size.y : size.z;
    if (at >= 0 && at < samples - 1) continue;
    std::fill_n(normals, 3, 0.0f);
    normals[axis] = at < 0 ? -1.0f : 1.0f;
  }
}

/// keep(k, first, end) for runs of voxel rows of a layer that stay, fresh(k) for the recut rows, in order.
template <class Keep, class Fresh>
void GridChunkMaker::for_voxel_rows(const Keep& keep, const Fresh& fresh) const {
  const int rows = block_.samples.y - 1;
  for (int k = 0; k < block_.samples.z - 1; ++k) {
    if (!recut_.planes.has(k)) {
      keep(k, 0, rows);
      continue;
    }
    keep(k, 0, recut_.rows.first);
    fresh(k);
    keep(k, recut_.rows.last + 1, rows);
  }
}

/// Appends corners that rows of voxels [first, end) had, as numbers of vertices now. All rows of samples of
/// such a run have moved by the same number in each of the two planes.
template <class T>
void GridChunkMaker::keep_corners(int k, int first, std::size_t from, std::size_t to,
                                  const std::vector<T>& old, std::vector<T>& out) const {
  const int row = sample_row(first, k), above = sample_row(first, k + 1);
  const auto& was = state_->vertex_at;
  const std::uint32_t low = vertex_at_[row] - was[row], high = vertex_at_[above] - was[above];
  const std::uint32_t limit = was[sample_row(0, k + 1)];
  const std::size_t begin = out.size();
  out.insert(out.end(), old.begin() + from, old.begin() + to);
  if (low == 0 && high == 0) return;
  auto* corner = reinterpret_cast<std::uint32_t*>(out.data() + begin);
  const std::size_t n = (to - from) * sizeof(T) / sizeof(std::uint32_t);
  for (std::size_t i = 0; i < n; ++i) corner[i] += corner[i] < limit ? low : high;
}

void GridChunkMaker::gather_triangles(GridChunkMesh& out) const {
  out.triangles.reserve(triangle_at_.back());
  const auto* fresh = reinterpret_cast<const std::array<std::uint32_t, 3>*>(corners_.data());
  for_voxel_rows(
      [&](int k, int first, int end) {
        if (first >= end) return;
        const auto& at = state_->triangle_at;
        const std::size_t from = at[voxel_row(first, k)], to = at[voxel_row(end, k)];
        if (from < to) keep_corners(k, first, from, to, state_->mesh->triangles, out.triangles);
      },
      [&](int k) {
        const std::size_t n =
            triangle_at_[voxel_row(recut_.rows.last + 1, k)] - triangle_at_[voxel_row(recut_.rows.first, k)];
        out.triangles.insert(out.triangles.end(), fresh, fresh + n);
        fresh += n;
      });
}

std::uint64_t GridChunkMaker::cut_voxels(int j, int k) const {
  if (j < block_.lo.y || j >= block_.hi.y || k < block_.lo.z || k >= block_.hi.z) return 0;
  const int n = block_.samples.y;
  const std::uint64_t* row = state_->solid.data() + sample_row(j, k);
  const std::uint64_t any = row[0] | row[1] | row[n] | row[n + 1],
                      all = row[0] & row[1] & row[n] & row[n + 1];
  return (any | (any >> 1)) & ~(all & (all >> 1)) & columns();
}

void GridChunkMaker::gather_polygons(GridChunkMesh& out) {
  VoxelPolygons& p = out.polygons;
  if (state_->mesh) {
    const VoxelPolygons& old = state_->mesh->polygons;
    p.voxels.reserve(old.voxels.size() + old.voxels.size() / 8);
    p.first.reserve(old.first.size() + old.first.size() / 8);
    p.begin.reserve(old.begin.size() + old.begin.size() / 8);
    p.corners.reserve(old.corners.size() + old.corners.size() / 8);
  }
  const auto& old = state_->voxel_at;
  voxel_at_.resize(triangle_at_.size());
  std::uint32_t at = 0;
  std::size_t row = 0;
  for (int k = 0; k < block_.samples.z - 1; ++k)
    for (int j = 0; j < block_.samples.y - 1; ++j, ++row) {
      voxel_at_[row] = at;
      const bool fresh = recut_.planes.has(k) && recut_.rows.has(j);
      at += fresh ? std::popcount(cut_voxels(j, k)) : old[row + 1] - old[row];
    }
  voxel_at_[row] = at;
  const std::uint32_t* corners = corners_.data();
  for_voxel_rows([&](int k, int first, int end) { keep_polygons(k, first, end, p); },
                 [&](int k) { corners = join_polygons(k, corners, out); });
  p.first.push_back(mesh::inner::size32(p.begin));
  p.begin.push_back(mesh::inner::size32(p.corners));
  state_->voxel_at.swap(voxel_at_);
}

/// Appends the polygons that rows of voxels [first, end) had.
void GridChunkMaker::keep_polygons(int k, int first, int end, VoxelPolygons& out) const {
  if (first >= end) return;
  const auto& at = state_->voxel_at;
  const std::size_t from = at[voxel_row(first, k)], to = at[voxel_row(end, k)];
  if (from == to) return;
  const VoxelPolygons& old = state_->mesh->polygons;
  const auto append = [](auto& list, const auto& was, std::size_t a, std::size_t b, std::uint32_t begins) {
    const std::uint32_t moved = begins - was[a];
    const std::size_t n = list.size();
    list.insert(list.end(), was.begin() + a, was.begin() + b);
    if (moved)
      for (std::size_t i = n; i < list.size(); ++i) list[i] += moved;
  };
  const std::size_t polygon = old.first[from], polygon_end = old.first[to];
  out.voxels.insert(out.voxels.end(), old.voxels.begin() + from, old.voxels.begin() + to);
  append(out.first, old.first, from, to, mesh::inner::size32(out.begin));
  append(out.begin, old.begin, polygon, polygon_end, mesh::inner::size32(out.corners));
  keep_corners(k, first, old.begin[polygon], old.begin[polygon_end], old.corners, out.corners);
}

/// Joins the triangles of the recut rows of a layer to polygons; `corners` are theirs, and those that follow
/// are returned.
const std::uint32_t* GridChunkMaker::join_polygons(int k, const std::uint32_t* corners,
                                                   GridChunkMesh& out) const {
  VoxelPolygons& p = out.polygons;
  const int n = block_.samples.y;
  const double tolerance = layout_.frame.spacing / 256;
  for (int j = recut_.rows.first; j <= recut_.rows.last; ++j) {
    const std::uint64_t* row = state_->solid.data() + sample_row(j, k);
    for (std::uint64_t cut = cut_voxels(j, k); cut; cut &= cut - 1) {
      const int i = std::countr_zero(cut);
      const auto pair = [&](int at) { return static_cast<int>(row[at] >> i & 3); };
      const int solid = pair(0) | pair(1) << 2 | pair(n) << 4 | pair(n + 1) << 6;
      const ConvexPieces& pieces =
          convex_pieces(solid, best_merge(solid, corners, out.positions.data(), tolerance));
      p.voxels.push_back(block_.origin + Vec3i{i, j, k});
      p.first.push_back(mesh::inner::size32(p.begin));
      for (int piece = 0; piece < pieces.count; ++piece) {
        p.begin.push_back(mesh::inner::size32(p.corners));
        for (int c = pieces.begin[piece]; c < pieces.begin[piece + 1]; ++c)
          p.corners.push_back(corners[pieces.corners[c]]);
      }
      corners += 3 * case_table()[solid].triangles;
    }
  }
  return corners;
}

}  // namespace tafoni::surface::impl
