#pragma once
// Triangles in blocks of eight under a tree of eight-wide boxes, for any number of triangles: a brick's or a
// whole mesh's. Boxes only sort out what is far; what is near is worked out in double (triangle.h).

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/query/impl/triangle.h"

namespace tafoni::query::impl {

class TriangleTree {
 public:
  static constexpr int width = 8;

  TriangleTree() = default;
  /// Positions are kept as given, bit for bit.
  TriangleTree(std::span<const Vec3f> positions, std::span<const std::array<std::uint32_t, 3>> triangles);

  bool empty() const { return blocks_.empty(); }
  const Box3f& bounds() const { return bounds_; }
  std::size_t bytes() const;

  /// All within `radius` of the segment from from - half to from + half, moved along from + s * along for s
  /// in [begin, end].
  struct Path {
    Vec3d from, along, half;
    double radius = 0, begin = 0, end = 1;
  };
  /// Calls found(context, triangle, end) for the triangles that the shape may meet, roughly in the order of
  /// meeting; it gives the end of the path that is still of interest, below `begin` to stop.
  void along(const Path& path, double (*found)(void*, const Triangle&, double end), void* context) const;
  /// Calls found(context, triangle, distance) for triangles that may lie within `distance` of p, nearer ones
  /// first, roughly; it gives the distance still of interest.
  void around(Vec3d p, double distance, double (*found)(void*, const Triangle&, double distance),
              void* context) const;

  struct alignas(32) Block {
    float v[3][3][width];  ///< by corner, axis; unused lanes are points far off
  };
  struct alignas(32) Node {
    float lo[3][width], hi[3][width];  ///< of eight blocks or nodes; a point far off where there is none
  };
  /// Blocks are level 0; node i of level l has children 8 i .. 8 i + 7 of level l - 1.
  struct Layout {
    const Block* blocks;
    const Node* nodes;
    const std::uint32_t* first;  ///< node of each level, from level 1
    int levels;                  ///< of nodes
  };

 private:
  Layout layout() const {
    return {blocks_.data(), nodes_.data(), first_.data(), static_cast<int>(first_.size())};
  }

  Box3f bounds_;
  std::vector<Block> blocks_;
  std::vector<Node> nodes_;
  std::vector<std::uint32_t> first_;
};

}  // namespace tafoni::query::impl
