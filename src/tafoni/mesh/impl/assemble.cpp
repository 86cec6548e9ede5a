#include <algorithm>
#include <chrono>
#include <limits>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/impl/connect.h"

namespace tafoni::mesh::impl {
namespace {

constexpr std::uint32_t gone = std::numeric_limits<std::uint32_t>::max();

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// A vertex of a piece that an earlier piece has already.
struct Repeat {
  std::uint32_t vertex, owner, owner_vertex;
};

using PieceIndex = std::unordered_map<Vec3i, std::uint32_t, ChunkHash>;

/// Repeats on the low faces; the lists of both sides ascend by place.
void find_face_repeats(const std::vector<Piece>& pieces, const PieceIndex& index, const Piece& piece,
                       std::vector<Repeat>& out) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto& low = piece.faces[static_cast<std::size_t>(2 * axis)];
    Vec3i chunk = piece.chunk;
    (axis == 0 ? chunk.x : axis == 1 ? chunk.y : chunk.z) -= 1;
    const auto found = index.find(chunk);
    if (low.empty() || found == index.end()) continue;
    const auto& high = pieces[found->second].faces[static_cast<std::size_t>(2 * axis + 1)];
    std::size_t at = 0;
    for (const BorderVertex& v : low) {
      while (at < high.size() && high[at].place < v.place) ++at;
      if (at < high.size() && high[at].place == v.place)
        out.push_back({v.vertex, found->second, high[at].vertex});
    }
  }
}

/// Repeats along chunk edges: the first piece in order owns the vertex.
void find_corner_repeats(const std::vector<Piece>& pieces, std::vector<std::vector<Repeat>>& repeats) {
  struct Owner {
    std::uint32_t piece, vertex;
  };
  std::unordered_map<LatticeEdge, Owner, LatticeEdgeHash> owners;
  for (std::uint32_t p = 0; p < pieces.size(); ++p)
    for (const CornerVertex& v : pieces[p].corners) {
      const auto [at, fresh] = owners.emplace(v.edge, Owner{p, v.vertex});
      if (!fresh) repeats[p].push_back({v.vertex, at->second.piece, at->second.vertex});
    }
}

/// New index of each vertex that the piece itself contributes, counted from its own first; `gone` for others.
std::uint32_t number_own(const Piece& piece, const std::vector<Repeat>& repeats,
                         const Connectivity* connectivity, std::vector<std::uint32_t>& index) {
  index.assign(piece.positions.size(), 0);
  for (const Repeat& r : repeats) index[r.vertex] = gone;
  if (connectivity && connectivity->any_removed()) {
    std::vector<bool> removed(piece.parts.size());
    for (std::uint32_t p = 0; p < piece.parts.size(); ++p) removed[p] = connectivity->removed(piece.chunk, p);
    for (std::uint32_t v = 0; v < index.size(); ++v)
      if (removed[piece.part_of(v)]) index[v] = gone;
  }
  std::uint32_t count = 0;
  for (std::uint32_t& i : index)
    if (i != gone) i = count++;
  return count;
}

void compact(std::vector<Vec3f>& values, const std::vector<std::uint32_t>& index) {
  if (values.empty()) return;
  std::size_t count = 0;
  for (std::size_t v = 0; v < index.size(); ++v)
    if (index[v] != gone) values[count++] = values[v];
  values.resize(count);
}

/// Moves the pieces' arrays into one, freeing each as it goes.
template <class T, class Member>
void gather(std::vector<Piece>& pieces, Member member, std::vector<T>& out) {
  std::size_t total = 0;
  for (const Piece& piece : pieces) total += (piece.*member).size();
  if (pieces.size() == 1) {
    out = std::move(pieces[0].*member);
    return;
  }
  out.reserve(total);
  for (Piece& piece : pieces) {
    out.insert(out.end(), (piece.*member).begin(), (piece.*member).end());
    std::vector<T>().swap(piece.*member);
  }
}

}  // namespace

Mesh assemble(std::vector<Piece>& pieces, const Connectivity* connectivity, double* stitch_seconds,
              double* gather_seconds) {
  const double start = now();
  const auto count = static_cast<std::int64_t>(pieces.size());
  PieceIndex index;
  for (std::uint32_t p = 0; p < pieces.size(); ++p) index.emplace(pieces[p].chunk, p);
  std::vector<std::vector<Repeat>> repeats(pieces.size());
  find_corner_repeats(pieces, repeats);
  std::vector<std::vector<std::uint32_t>> numbers(pieces.size());
  std::vector<std::uint64_t> first(pieces.size() + 1, 0);
  parallel_for(count, [&](std::int64_t at) {
    const auto p = static_cast<std::size_t>(at);
    find_face_repeats(pieces, index, pieces[p], repeats[p]);
    first[p + 1] = number_own(pieces[p], repeats[p], connectivity, numbers[p]);
  });
  for (std::size_t p = 0; p < pieces.size(); ++p) first[p + 1] += first[p];
  if (first.back() >= gone)
    fail(ErrorKind::usage,
         "the mesh has {} vertices, more than 32-bit indices can name: write it in tiles or use "
         "a larger voxel",
         first.back());
  parallel_for(count, [&](std::int64_t at) {
    const auto p = static_cast<std::size_t>(at);
    Piece& piece = pieces[p];
    std::vector<std::uint32_t> global(piece.positions.size(), gone);
    for (std::size_t v = 0; v < global.size(); ++v)
      if (numbers[p][v] != gone) global[v] = static_cast<std::uint32_t>(first[p]) + numbers[p][v];
    for (const Repeat& r : repeats[p])
      if (numbers[r.owner][r.owner_vertex] != gone)
        global[r.vertex] = static_cast<std::uint32_t>(first[r.owner]) + numbers[r.owner][r.owner_vertex];
    std::size_t kept = 0;
    for (const auto& t : piece.triangles)
      if (global[t[0]] != gone) piece.triangles[kept++] = {global[t[0]], global[t[1]], global[t[2]]};
    piece.triangles.resize(kept);
    compact(piece.positions, numbers[p]);
    compact(piece.normals, numbers[p]);
  });
  const double middle = now();
  Mesh mesh;
  parallel_for(3, [&](std::int64_t array) {
    if (array == 0) gather(pieces, &Piece::triangles, mesh.triangles);
    if (array == 1) gather(pieces, &Piece::positions, mesh.positions);
    if (array == 2) gather(pieces, &Piece::normals, mesh.normals);
  });
  *stitch_seconds += middle - start;
  *gather_seconds += now() - middle;
  return mesh;
}

}  // namespace tafoni::mesh::impl
