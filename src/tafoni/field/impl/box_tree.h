#pragma once
// A wide bounding-volume tree over boxes that are given in an order worth keeping.

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

/// Bounds of up to eight children, structure of arrays; absent children are empty boxes.
struct WideBox {
  static constexpr int fan = 8;
  alignas(32) float lo[3][fan], hi[3][fan];
};

/// Bit c: child c touches `box`. For the instruction set this machine has.
using Overlaps = unsigned (*)(const WideBox&, const Box3f& box);
Overlaps overlaps_kernel();

class BoxTree {
 public:
  BoxTree() = default;
  explicit BoxTree(std::vector<Box3f> boxes);

  /// Calls visit(i) for each box i that touches `box`, in ascending order.
  template <class Visit>
  void visit(const Box3f& box, const Visit& visit) const {
    if (levels_.empty()) return;
    const Overlaps overlaps = overlaps_kernel();
    // Depth first, children in order. Sixteen levels of eight hold any number of boxes.
    struct Frame {
      std::size_t node;
      unsigned mask;
    };
    std::array<Frame, 16> stack;
    std::size_t depth = 0;
    const std::size_t top = levels_.size() - 1;
    stack[0] = {0, overlaps(levels_[top][0], box)};
    for (;;) {
      Frame& frame = stack[depth];
      if (frame.mask == 0) {
        if (depth == 0) return;
        --depth;
        continue;
      }
      const std::size_t child = frame.node * WideBox::fan + std::countr_zero(frame.mask);
      frame.mask &= frame.mask - 1;
      if (depth < top) {
        ++depth;
        stack[depth] = {child, overlaps(levels_[top - depth][child], box)};
      } else {
        visit(child);
      }
    }
  }
  std::uint64_t bytes() const;

 private:
  std::vector<std::vector<WideBox>> levels_;  ///< [0] bounds the boxes, the last has one node
};

}  // namespace tafoni::field::impl
