#pragma once
// What all live surfaces have in common: a mesh in chunks, of which an edit makes only those anew that it
// touches. IncrementalMesher keeps one of a field, GridMesher of a scalar grid, PrismMesher of a prism-field;
// runtime::DestructibleTerrain hands on what its GridMesher makes.
//
// A chunk is named by its place among the chunks: chunk (a, b, c) has the cells from (n a, n b, n c), where
// each mesher says its n. Prism-fields have chunks of whole columns: c is 0.
//
// The contract of update(): it makes the mesh that of what it is given, says which chunks' meshes differ from
// before, sorted by ChunkOrder, and looks at no more than it was told has changed; the first update looks at
// everything. A chunk that lost its last triangle is among them. Versions count updates, from 1.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <tuple>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/math/vec.h"

namespace tafoni::surface {

/// The mesh of one chunk, complete in itself: vertices on its borders are repeated in the neighbours, their
/// positions and normals bit for bit.
struct ChunkMesh {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;  ///< one a vertex, unit length
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::uint64_t version = 0;  ///< of the update that changed it last
};

/// The same, where a mesher shows its own memory: valid until its next update.
struct ChunkView {
  std::span<const Vec3f> positions, normals;
  std::span<const std::array<std::uint32_t, 3>> triangles;
  std::uint64_t version = 0;
};

/// A chunk whose mesh is another than before.
struct ChunkChange {
  Vec3i chunk;
  std::uint64_t version = 0;  ///< of the update that changed it
  friend bool operator==(const ChunkChange&, const ChunkChange&) = default;
};

/// Sorts by y, then x, then z: the order of chunks in every list, and in meshes made of all chunks.
struct ChunkOrder {
  bool operator()(Vec3i a, Vec3i b) const { return std::tie(a.y, a.x, a.z) < std::tie(b.y, b.x, b.z); }
  bool operator()(const ChunkChange& a, const ChunkChange& b) const { return (*this)(a.chunk, b.chunk); }
};
inline constexpr ChunkOrder chunk_before{};

/// The hash of unordered containers by chunk.
struct ChunkHash {
  std::size_t operator()(Vec3i chunk) const {
    const std::uint32_t x = chunk.x, y = chunk.y, z = chunk.z;
    return hash_combine(x | std::uint64_t{y} << 32, std::uint64_t{z});
  }
};

}  // namespace tafoni::surface
