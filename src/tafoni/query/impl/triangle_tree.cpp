// Sorts triangles along a space-filling curve and packs them by eights; nodes are eight boxes each, built
// level by level from below.

#include "tafoni/query/impl/triangle_tree.h"

#include <algorithm>
#include <limits>

#include "tafoni/mesh/inner/size32.h"

namespace tafoni::query::impl {
namespace {

/// Where lanes that hold no triangle are: beyond any box, and finite.
constexpr float nowhere = 1e30f;

std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

/// Triangles along a space-filling curve through their middles.
std::vector<std::uint32_t> curve_order(std::span<const Vec3f> positions,
                                       std::span<const std::array<std::uint32_t, 3>> triangles,
                                       const Box3f& bounds) {
  const Vec3f size = bounds.size();
  const float side = std::max({size.x, size.y, size.z, 1e-6f});
  const double scale = 2097151.0 / (3.0 * side);
  std::vector<std::pair<std::uint64_t, std::uint32_t>> keys(triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t) {
    const auto [a, b, c] = triangles[t];
    const Vec3d sum = to_double(positions[a] - bounds.lo) + to_double(positions[b] - bounds.lo) +
                      to_double(positions[c] - bounds.lo);
    const auto key = [&](double d) { return spread(static_cast<std::uint64_t>(std::max(d * scale, 0.0))); };
    keys[t] = {key(sum.x) | key(sum.y) << 1 | key(sum.z) << 2, t};
  }
  std::sort(keys.begin(), keys.end());
  std::vector<std::uint32_t> order(triangles.size());
  for (std::size_t t = 0; t < order.size(); ++t) order[t] = keys[t].second;
  return order;
}

void set_box(TriangleTree::Node& node, int lane, const Box3f& box) {
  const float lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
  for (int axis = 0; axis < 3; ++axis) node.lo[axis][lane] = lo[axis], node.hi[axis][lane] = hi[axis];
}

}  // namespace

TriangleTree::TriangleTree(std::span<const Vec3f> positions,
                           std::span<const std::array<std::uint32_t, 3>> triangles) {
  if (triangles.empty()) return;
  for (const auto& t : triangles)
    for (std::uint32_t v : t) bounds_.expand(positions[v]);
  const std::vector<std::uint32_t> order = curve_order(positions, triangles, bounds_);
  const std::size_t count = (order.size() + width - 1) / width;
  blocks_.resize(count);
  std::vector<Box3f> boxes(count);
  for (std::size_t i = 0; i < count * width; ++i) {
    Block& block = blocks_[i / width];
    const std::size_t lane = i % width;
    for (std::size_t corner = 0; corner < 3; ++corner) {
      Vec3f p{nowhere, nowhere, nowhere};
      if (i < order.size()) {
        p = positions[triangles[order[i]][corner]];
        boxes[i / width].expand(p);
      }
      block.v[corner][0][lane] = p.x, block.v[corner][1][lane] = p.y, block.v[corner][2][lane] = p.z;
    }
  }
  do {
    first_.push_back(mesh::inner::size32(nodes_));
    std::vector<Box3f> above((boxes.size() + width - 1) / width);
    for (std::size_t n = 0; n < above.size(); ++n) {
      Node node;
      for (int lane = 0; lane < width; ++lane) {
        const std::size_t child = n * width + lane;
        const Box3f none{{nowhere, nowhere, nowhere}, {nowhere, nowhere, nowhere}};
        set_box(node, lane, child < boxes.size() ? boxes[child] : none);
        if (child < boxes.size()) above[n].expand(boxes[child]);
      }
      nodes_.push_back(node);
    }
    boxes = std::move(above);
  } while (boxes.size() > 1);
}

std::size_t TriangleTree::bytes() const {
  return blocks_.capacity() * sizeof(Block) + nodes_.capacity() * sizeof(Node) + sizeof *this;
}

}  // namespace tafoni::query::impl
