// Joins pieces to one mesh: each vertex on a border belongs to the first piece that has it, every piece
// counts its own, sums of counts give the numbers, and vertices and triangles are copied in their order.

#include <algorithm>
#include <limits>
#include <memory>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/surface/impl/connect.h"

namespace tafoni::surface::impl {
namespace {

constexpr std::uint32_t gone = std::numeric_limits<std::uint32_t>::max();

/// A vertex of a piece that an earlier piece has already.
struct Repeat {
  std::uint32_t vertex, owner, owner_vertex;
  std::size_t rim, owner_rim;  ///< its place in both rims
};

using PieceIndex = std::unordered_map<Vec3i, std::uint32_t, ChunkHash>;

/// Repeats on the low faces; the lists of both sides ascend by place.
void find_face_repeats(const std::vector<Piece>& pieces, const PieceIndex& index, const Piece& piece,
                       std::vector<Repeat>& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto& low = piece.faces[2 * axis];
    Vec3i chunk = piece.chunk;
    (axis == 0 ? chunk.x : axis == 1 ? chunk.y : chunk.z) -= 1;
    const auto found = index.find(chunk);
    if (low.empty() || found == index.end()) continue;
    const Piece& owner = pieces[found->second];
    const auto& high = owner.faces[2 * axis + 1];
    const std::size_t rim = rim_begin(piece, 2 * axis), owner_rim = rim_begin(owner, 2 * axis + 1);
    std::size_t at = 0;
    for (std::size_t own = 0; own < low.size(); ++own) {
      const BorderVertex& v = low[own];
      while (at < high.size() && high[at].place < v.place) ++at;
      if (at < high.size() && high[at].place == v.place)
        out.push_back({v.vertex, found->second, high[at].vertex, rim + own, owner_rim + at});
    }
  }
}

/// Repeats along chunk edges: the first piece in order owns the vertex.
void find_corner_repeats(const std::vector<Piece>& pieces, std::vector<std::vector<Repeat>>& repeats) {
  struct Owner {
    std::uint32_t piece, vertex;
    std::size_t rim;
  };
  std::unordered_map<LatticeEdge, Owner, LatticeEdgeHash> owners;
  for (std::uint32_t p = 0; p < pieces.size(); ++p) {
    std::size_t rim = rim_begin(pieces[p], 6);
    for (const CornerVertex& v : pieces[p].corners) {
      const auto [at, fresh] = owners.emplace(v.edge, Owner{p, v.vertex, rim});
      const Owner& owner = at->second;
      if (!fresh) repeats[p].push_back({v.vertex, owner.piece, owner.vertex, rim, owner.rim});
      ++rim;
    }
  }
}

/// The new index of every vertex of every piece.
class Numbering {
 public:
  /// Vertices [begin, end) of a piece.
  struct Run {
    std::uint32_t begin, end;
  };

  explicit Numbering(const std::vector<Piece>& pieces) {
    for (const Piece& piece : pieces) {
      start_.push_back(total_);
      total_ += piece.positions.size();
    }
    numbers_.reset(new std::uint32_t[total_]);
    advise_large_pages(numbers_.get(), total_ * sizeof(std::uint32_t));
    first_.resize(pieces.size() + 1, 0);
    runs_.resize(pieces.size());
  }
  std::uint32_t* of(std::size_t piece) { return numbers_.get() + start_[piece]; }

  /// Counts the vertices that the piece itself contributes; `gone` marks the others.
  void count_own(std::size_t p, const Piece& piece, const std::vector<Repeat>& repeats,
                 const Connectivity* connectivity) {
    std::uint32_t* const number = of(p);
    const std::size_t n = piece.positions.size();
    std::fill_n(number, n, 0);
    for (const Repeat& r : repeats) number[r.vertex] = gone;
    if (connectivity && connectivity->any_removed()) {
      std::vector<bool> removed(piece.parts.size());
      for (std::uint32_t part = 0; part < piece.parts.size(); ++part)
        removed[part] = connectivity->removed(piece.chunk, part);
      for (std::uint32_t v = 0; v < n; ++v)
        if (removed[piece.part_of(v)]) number[v] = gone;
    }
    std::uint32_t count = 0;
    for (std::uint32_t v = 0; v < n;) {
      if (number[v] == gone) {
        ++v;
        continue;
      }
      const std::uint32_t begin = v;
      while (v < n && number[v] != gone) number[v++] = count++;
      runs_[p].push_back({begin, v});
    }
    first_[p + 1] = count;
  }
  /// Turns the counts into the index of each piece's first vertex.
  void sum() {
    for (std::size_t p = 0; p + 1 < first_.size(); ++p) first_[p + 1] += first_[p];
    if (first_.back() >= gone)
      fail(ErrorKind::usage,
           "the mesh has {} vertices, more than 32-bit indices can name: write it in tiles or use a larger "
           "voxel",
           first_.back());
  }
  void globalise(std::size_t p, const Piece& piece) {
    std::uint32_t* const number = of(p);
    for (std::size_t v = 0; v < piece.positions.size(); ++v)
      if (number[v] != gone) number[v] += static_cast<std::uint32_t>(first_[p]);
  }
  /// The piece's own vertices.
  std::span<const Run> own(std::size_t p) const { return runs_[p]; }
  std::uint64_t total() const { return first_.back(); }

 private:
  std::size_t total_ = 0;
  std::vector<std::size_t> start_;
  std::unique_ptr<std::uint32_t[]> numbers_;
  std::vector<std::uint64_t> first_;
  std::vector<std::vector<Run>> runs_;
};

/// The pieces' own vertices, one after the other.
void gather_vertices(const std::vector<Piece>& pieces, const Numbering& numbering,
                     std::span<Vec3f> Piece::*member, std::vector<Vec3f>& out) {
  if (pieces.empty() || (pieces[0].*member).empty()) return;
  reserve_large(out, numbering.total());
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::span<Vec3f> values = pieces[p].*member;
    for (const auto& [begin, end] : numbering.own(p))
      out.insert(out.end(), values.begin() + begin, values.begin() + end);
  }
}

/// The pieces' triangles by their new indices, without those of removed parts.
void gather_triangles(const std::vector<Piece>& pieces, Numbering& numbering,
                      std::vector<std::array<std::uint32_t, 3>>& out) {
  std::size_t total = 0;
  for (const Piece& piece : pieces) total += piece.triangles.size();
  reserve_large(out, total);
  // Through the cache: push_back() would ask for room at each triangle, resize() would touch all memory
  // before.
  std::array<std::array<std::uint32_t, 3>, 1024> some;
  for (std::size_t p = 0; p < pieces.size(); ++p) {
    const std::uint32_t* const number = numbering.of(p);
    const PieceTriangles& triangles = pieces[p].triangles;
    for (std::size_t begin = 0; begin < triangles.size(); begin += some.size()) {
      std::size_t count = 0;
      triangles.for_each(begin, std::min(begin + some.size(), triangles.size()), [&](const auto& t) {
        some[count] = {number[t[0]], number[t[1]], number[t[2]]};
        count += number[t[0]] != gone;
      });
      out.insert(out.end(), some.begin(), some.begin() + count);
    }
  }
}

}  // namespace

mesh::Mesh assemble(std::vector<Piece>& pieces, double voxel, const Connectivity* connectivity,
                    const SeamSums& seams, double* stitch_seconds, double* gather_seconds) {
  const double start = now();
  const std::int64_t count = pieces.size();
  const auto each = [&](const auto& body) { parallel_for(count, [&](std::int64_t p) { body(p); }); };
  PieceIndex index;
  for (std::uint32_t p = 0; p < pieces.size(); ++p) index.emplace(pieces[p].chunk, p);
  std::vector<std::vector<Repeat>> repeats(pieces.size());
  find_corner_repeats(pieces, repeats);
  Numbering numbering(pieces);
  const bool normals = !pieces.empty() && !pieces[0].normals.empty();
  each([&](std::size_t p) {
    find_face_repeats(pieces, index, pieces[p], repeats[p]);
    numbering.count_own(p, pieces[p], repeats[p], connectivity);
  });
  numbering.sum();
  if (normals)
    for (std::size_t p = 0; p < pieces.size(); ++p)
      for (const Repeat& r : repeats[p]) pieces[r.owner].rim[r.owner_rim] += pieces[p].rim[r.rim];
  each([&](std::size_t p) {
    numbering.globalise(p, pieces[p]);
    if (!normals) return;
    seams.complete(pieces[p]);
    settle_rim(pieces[p], voxel);
  });
  // An owner's vertex is never a repeat itself, so nothing read here is written here.
  each([&](std::size_t p) {
    for (const Repeat& r : repeats[p]) numbering.of(p)[r.vertex] = numbering.of(r.owner)[r.owner_vertex];
  });
  const double middle = now();
  mesh::Mesh mesh;
  parallel_for(3, [&](std::int64_t array) {
    if (array == 0) gather_triangles(pieces, numbering, mesh.triangles);
    if (array == 1) gather_vertices(pieces, numbering, &Piece::positions, mesh.positions);
    if (array == 2) gather_vertices(pieces, numbering, &Piece::normals, mesh.normals);
  });
  *stitch_seconds += middle - start;
  *gather_seconds += now() - middle;
  return mesh;
}

}  // namespace tafoni::surface::impl
