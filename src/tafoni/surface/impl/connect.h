#pragma once
// Joins pieces: which parts belong to one component of the surface, and which vertices are the same.

#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "tafoni/surface/chunk.h"
#include "tafoni/surface/impl/piece.h"
#include "tafoni/surface/impl/rim.h"

namespace tafoni::surface::impl {

/// The components of a surface, piece by piece. Keeps a record of every part and what the pieces not yet
/// added will need, not the meshes.
class Connectivity {
 public:
  /// Pieces come with their low neighbours in x, y and z before them.
  void add(const Piece& piece);

  struct Result {
    std::uint64_t components = 0, fragments = 0, bubbles = 0;
  };
  /// Decides what to remove: closed components that enclose less than `least` cubic metres.
  Result decide(double least);
  /// Whether the part is to be removed.
  bool removed(Vec3i chunk, std::uint32_t part) const;
  bool any_removed() const { return !removed_.empty(); }

 private:
  struct Face {
    std::vector<std::uint32_t> places, parts;
  };
  std::uint32_t root(std::uint32_t part);
  void join(std::uint32_t a, std::uint32_t b);

  std::vector<std::uint32_t> parents_;
  std::vector<Part> parts_;
  std::unordered_map<Vec3i, std::uint32_t, ChunkHash> first_part_;
  std::unordered_map<Vec3i, Face, ChunkHash> high_faces_[3];
  std::unordered_map<LatticeEdge, std::uint32_t, LatticeEdgeHash> corners_;
  std::unordered_set<std::uint32_t> removed_;
};

/// One mesh of pieces in ascending order of (chunk.y, chunk.x, chunk.z), vertices on shared faces merged.
/// Consumes the pieces, which are settled inside (settle_inside() in rim.h) if they have normals. Parts that
/// `connectivity` removes are left out; it may be null. Normals are made to agree with the triangles, whose
/// share beyond the pieces' outer border `seams` knows.
mesh::Mesh assemble(std::vector<Piece>& pieces, double voxel, const Connectivity* connectivity,
                    const SeamSums& seams, double* stitch_seconds, double* gather_seconds);

}  // namespace tafoni::surface::impl
