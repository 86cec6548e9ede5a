#pragma once
// The rings of a polygon, indexed so that asking about a place costs about the logarithm of their length.

#include <cstdint>
#include <vector>

#include "tafoni/landforms/site/region.h"

namespace tafoni::landforms::impl {

class Outline {
 public:
  explicit Outline(const std::vector<Ring>& rings);

  /// By the even-odd rule over all rings together, so that a hole is just another ring.
  bool inside(Vec2d p) const;
  /// Metres to the nearest ring; `most` when it is not nearer than that.
  double distance(Vec2d p, double most) const;
  /// The vertices' box in x and y; empty when there are none.
  Box3d bounds() const;

 private:
  struct Edge {
    Vec2d a, b;
  };
  /// Edges [begin, end) within lo..hi; the first child of an inner node follows it, the second is at
  /// `second`.
  struct Span {
    Vec2d lo, hi;
    std::uint32_t begin, end, second;
  };
  void build(std::uint32_t begin, std::uint32_t end);
  /// The squared distance from p to a span, 0 inside of it.
  static double gap2(const Span& span, Vec2d p);
  static double distance2(const Edge& edge, Vec2d p);

  std::vector<Edge> edges_;
  std::vector<Span> spans_;
};

}  // namespace tafoni::landforms::impl
