// Makes the mesh of a chunk by the core (impl/block.h), notes where its vertices lie on the chunk's faces and
// edges, and asks the source for gradients where the vertices are.

#include "tafoni/surface/impl/piece.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/mesh/inner/size32.h"
#include "tafoni/surface/impl/rim.h"

namespace tafoni::surface::impl {
namespace {

constexpr int n = field::chunk_cells;

/// Eight bricks' bits as 64 cells' bits.
std::uint64_t cells_of_bricks(std::uint64_t bricks) {
  std::uint64_t cells = 0;
  for (int b = 0; b < 8; ++b)
    if ((bricks >> b) & 1) cells |= std::uint64_t{0xff} << (8 * b);
  return cells;
}

/// A field may be flat along its own zero set; up is as good as any other direction, on both sides of a seam.
Vec3f to_normal(Vec3f gradient) {
  const float l = length(gradient);
  return l > 0 && std::isfinite(l) ? gradient * (-1.0f / l) : Vec3f{0, 0, 1};
}

void to_normals(std::span<Vec3f> g) {
  std::size_t v = 0;
  for (; v + 4 <= g.size(); v += 4) {
    const Vec3<Four> four = load_vectors(&g[v]);
    const Four l = sqrt(dot(four, four)), scale = -1.0f / l;
    const auto usual = (l > 0) & (l <= std::numeric_limits<float>::max());
    for (std::size_t k = 0; k < 4; ++k) g[v + k] = usual[k] ? g[v + k] * scale[k] : to_normal(g[v + k]);
  }
  for (; v < g.size(); ++v) g[v] = to_normal(g[v]);
}

}  // namespace

PieceTriangles::PieceTriangles(std::span<const Wide> triangles, std::size_t vertices, Arena& arena) {
  if (vertices > std::size_t{1} << 16) {
    wide_ = arena.copy(triangles.data(), triangles.size());
    return;
  }
  const auto narrow = arena.allocate<Narrow>(triangles.size());
  const std::uint32_t* from = triangles.empty() ? nullptr : triangles.front().data();
  std::uint16_t* const to = narrow.empty() ? nullptr : narrow.front().data();
  for (std::size_t i = 0; i < 3 * triangles.size(); ++i) to[i] = static_cast<std::uint16_t>(from[i]);
  narrow_ = narrow;
}

bool PieceMaker::choose_cells(const field::ChunkSamples& samples) {
  bool any = false;
  layers_.fill(false);
  for (int bz = 0; bz < field::chunk_bricks; ++bz) {
    if (!samples.active[bz]) continue;
    std::uint64_t rows[n];
    std::uint64_t all = 0;
    for (int j = 0; j < n; ++j) {
      rows[j] = cells_of_bricks((samples.active[bz] >> (j & ~7)) & 0xff);
      if (!whole_) rows[j] &= set_.row(first_.x, first_.y + j);
      all |= rows[j];
    }
    if (!all) continue;
    for (int k = 8 * bz; k < 8 * bz + 8; ++k) {
      if (!set_.layer(first_.z + k)) continue;
      layers_[k] = any = true;
      std::uint64_t* to = cells_.data() + k * layer_words;
      for (int j = 0; j < n; ++j) to[j * words] = rows[j];
    }
  }
  return any;
}

bool PieceMaker::make(const field::ChunkSamples& samples, SampleSource& source, Piece& out,
                      const Kept* kept) {
  const double start = now();
  out = Piece{};
  out.chunk = samples.chunk;
  first_ = {samples.chunk.x * n, samples.chunk.y * n, samples.chunk.z * n};
  whole_ = set_.whole_chunk(first_);
  if (!choose_cells(samples)) return false;
  samples_ = samples.f.data();
  piece_ = &out;
  plane_ = Plane{};
  plane_.row_step = field::ChunkSamples::nx;
  plane_.plane_step = field::ChunkSamples::nx * field::ChunkSamples::ny;
  plane_.i0 = first_.x, plane_.j0 = first_.y;
  plane_.voxel = voxel_;
  plane_.margin = margin_;
  positions_.clear();
  points_.clear();
  indices_.clear();
  facets_.clear();
  edges_.clear();
  fresh_.clear();
  normals_out_.clear();
  kept_ = kept;
  kept_at_ = 0;
  walker_.walk(samples_, n + 1, n + 1, n + 1, plane_.row_step, plane_.plane_step, *this, *this,
               kept ? kept->signs : nullptr);
  const std::size_t count = walker_.vertex_count();
  if (count == 0) return false;
  out.cut_cells = walker_.cut_cells();
  auto* p = reinterpret_cast<Vec3f*>(positions_.data());
  const auto* t = reinterpret_cast<const std::array<std::uint32_t, 3>*>(indices_.data());
  if (kept) {
    out.positions = {p, count};
    out.triangles = PieceTriangles({t, indices_.size() / 3});
    out.edges = edges_;
  } else {
    out.positions = arena_->copy(p, count);
    out.triangles = PieceTriangles({t, indices_.size() / 3}, count, *arena_);
  }
  if (wanted_.parts) find_parts(out, parents_);
  const double middle = now();
  triangles_seconds += middle - start;
  if (wanted_.facets) {
    out.rim = arena_->allocate<FacetSum>(rim_size(out));
    note_rim(out, voxel_, facets_.data());
  }
  if (wanted_.normals) find_normals(source, out);
  normals_seconds += now() - middle;
  return true;
}

void PieceMaker::vertices(int k, const PlaneOutput& out) {
  const std::size_t count = out.keys.size();
  plane_.f = samples_ + std::ptrdiff_t{k} * plane_.plane_step;
  plane_.k = k;
  plane_.level = first_.z + k;
  positions_.reserve_extra(3 * (count + kernel_slack));
  if (wanted_.normals) points_.reserve_extra(3 * (count + kernel_slack));
  place(plane_, out.keys.data(), count, positions_.end(), wanted_.normals ? points_.end() : nullptr, nullptr);
  positions_.commit(3 * count);
  if (wanted_.normals) points_.commit(3 * count);
  if (wanted_.facets) {
    facets_.reserve_extra(count);
    std::fill_n(facets_.end(), count, FacetFour{});
    facets_.commit(count);
  }
  if (kept_) take_over(k, out);
  const EdgeKey* keys = out.keys.data();
  for (std::uint32_t v = 0; v < count; ++v) {
    const int i = key_i(keys[v]), j = key_j(keys[v]);
    if (((i & (n - 1)) == 0) | ((j & (n - 1)) == 0) | ((k & (n - 1)) == 0) | !whole_)
      note_border(k, keys[v], out.first + v);
  }
}

/// Notes the edges of plane k's vertices, puts in place what is kept and lists what is not.
void PieceMaker::take_over(int k, const PlaneOutput& out) {
  const std::span<std::uint32_t> old = kept_->piece.edges;
  const std::size_t count = out.keys.size();
  normals_out_.resize(wanted_.normals ? out.first + count : 0);
  for (std::uint32_t v = 0; v < count; ++v) {
    const EdgeKey key = out.keys.data()[v];
    const int i = key_i(key), j = key_j(key), axis = key_axis(key);
    const std::uint32_t edge = ((k * (n + 1) + j) * 3 + axis) * (n + 1) + i;
    edges_.push_back(edge);
    if (!kept_->holds(i, j, k, axis)) {
      fresh_.push_back(out.first + v);
      continue;
    }
    while (kept_at_ < old.size() && old[kept_at_] < edge) ++kept_at_;
    if (kept_at_ == old.size() || old[kept_at_] != edge)
      fail(ErrorKind::usage, "a field changed outside of the boxes that were said to hold every change");
    std::memcpy(positions_.data() + 3 * (out.first + v), &kept_->piece.positions[kept_at_], sizeof(Vec3f));
    if (wanted_.normals) normals_out_[out.first + v] = kept_->piece.normals[kept_at_];
  }
}

void PieceMaker::triangles(const PlaneOutput& out) {
  if (out.indices.size() == 0) return;
  indices_.reserve_extra(out.indices.size());
  std::memcpy(indices_.end(), out.indices.data(), out.indices.size() * sizeof(std::uint32_t));
  indices_.commit(out.indices.size());
  if (wanted_.facets) add_facets(out);
}

/// While positions and sums of the layer's vertices are in the innermost cache.
void PieceMaker::add_facets(const PlaneOutput& out) {
  // There is slack behind them, so that a fourth float can be loaded with each; nobody asks for it.
  const float* const positions = positions_.data();
  FacetFour* const sums = facets_.data();
  const std::uint32_t* const indices = out.indices.data();
  for (std::size_t i = 0; i < out.indices.size(); i += 3) {
    const std::uint32_t a = indices[i], b = indices[i + 1], c = indices[i + 2];
    const Four at = load_four(positions + 3 * a);
    const Four u = load_four(positions + 3 * b) - at, v = load_four(positions + 3 * c) - at;
    const FacetFour facet =
        u * __builtin_shufflevector(v, v, 1, 2, 0, 3) - __builtin_shufflevector(u, u, 1, 2, 0, 3) * v;
    sums[a] += facet;
    sums[b] += facet;
    sums[c] += facet;
  }
}

void PieceMaker::settle(Piece& piece) {
  const double start = now();
  settle_inside(piece, facets_.data());
  normals_seconds += now() - start;
}

void PieceMaker::note_border(int k, EdgeKey key, std::uint32_t vertex) {
  const int axis = key_axis(key);
  const int at[3] = {key_i(key), key_j(key), k};
  const int a = (axis + 1) % 3, b = (axis + 2) % 3;
  if (!whole_) {
    // The four cells around the edge.
    bool inside = true;
    for (int c = 0; c < 4; ++c) {
      int cell[3] = {first_.x + at[0], first_.y + at[1], first_.z + at[2]};
      cell[a] -= c & 1;
      cell[b] -= c >> 1;
      inside = inside && set_.cell(cell[0], cell[1], cell[2]);
    }
    if (!inside) piece_->open.push_back(vertex);
  }
  const bool on_a = at[a] == 0 || at[a] == n, on_b = at[b] == 0 || at[b] == n;
  if (on_a && on_b) {
    piece_->corners.push_back({{{first_.x + at[0], first_.y + at[1], first_.z + at[2]}, axis}, vertex});
  } else if (on_a || on_b) {
    const int face_axis = on_a ? a : b;
    // Vertices come by k, j, axis and i; `place` ascends in that order within each face.
    const int i = at[0], j = at[1];
    const std::uint32_t place =
        face_axis == 0 ? (k * (n + 1) + j) * 3 + axis : ((face_axis == 1 ? k : j) * 3 + axis) * (n + 1) + i;
    piece_->faces[2 * face_axis + (at[face_axis] == n)].push_back({place, vertex});
  }
}

void PieceMaker::find_normals(SampleSource& source, Piece& out) {
  auto* points = reinterpret_cast<Vec3d*>(points_.data());
  std::size_t count = out.positions.size();
  if (kept_) {
    count = 0;
    for (std::uint32_t v : fresh_) points[count++] = points[v];
  }
  values_.resize(count);
  gradients_.resize(count);
  source.gradients({points, count}, values_, gradients_);
  to_normals(gradients_);
  if (kept_) {
    for (std::size_t f = 0; f < count; ++f) normals_out_[fresh_[f]] = gradients_[f];
    out.normals = normals_out_;
  } else {
    out.normals = arena_->copy(gradients_.data(), count);
  }
}

void find_parts(Piece& out, std::vector<std::uint32_t>& parents) {
  const auto count = mesh::inner::size32(out.positions);
  parents.resize(count);
  for (std::uint32_t v = 0; v < count; ++v) parents[v] = v;
  const auto root = [&](std::uint32_t v) {
    while (parents[v] != v) v = parents[v] = parents[parents[v]];
    return v;
  };
  const auto join = [&](std::uint32_t a, std::uint32_t b) {
    if (parents[a] == parents[b]) return;
    const std::uint32_t ra = root(a), rb = root(b);
    if (ra < rb)
      parents[rb] = ra;
    else
      parents[ra] = rb;
  };
  out.triangles.for_each([&](const auto& t) { join(t[0], t[1]), join(t[1], t[2]); });
  // Roots are the lowest vertex of their part, so one pass in order numbers them.
  std::vector<std::uint32_t> labels(count);
  std::uint32_t parts = 0;
  for (std::uint32_t v = 0; v < count; ++v) {
    parents[v] = root(v);
    labels[v] = parents[v] == v ? parts++ : labels[parents[v]];
  }
  out.parts.assign(parts, Part{});
  out.triangles.for_each([&](const auto& t) {
    const Vec3d a = to_double(out.positions[t[0]]), b = to_double(out.positions[t[1]]);
    Part& part = out.parts[labels[t[0]]];
    part.volume += dot(a, cross(b, to_double(out.positions[t[2]]))) / 6;
    ++part.triangles;
  });
  for (std::uint32_t v : out.open) out.parts[labels[v]].open = true;
  if (parts > 1) out.labels = std::move(labels);
}

}  // namespace tafoni::surface::impl
