// A tree over boxes, eight children a node, built bottom up over boxes that are already in order along a
// curve. One vector comparison tests all eight children of a node.

#include "tafoni/field/impl/box_tree.h"

#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

unsigned overlaps(const WideBox& w, const Box3f& box) {
  const float lo[3] = {box.lo.x, box.lo.y, box.lo.z}, hi[3] = {box.hi.x, box.hi.y, box.hi.z};
  unsigned mask = 0;
  for (std::size_t l = 0; l < WideBox::fan; l += lane_count()) {
    Mask hit = hn::And(Lanes::load(w.lo[0] + l) <= Lanes(hi[0]), Lanes::load(w.hi[0] + l) >= Lanes(lo[0]));
    for (int a = 1; a < 3; ++a)
      hit = hn::And(
          hit, hn::And(Lanes::load(w.lo[a] + l) <= Lanes(hi[a]), Lanes::load(w.hi[a] + l) >= Lanes(lo[a])));
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(float_tag, hit, bits);
    mask |= static_cast<unsigned>(bits[0]) << l;
  }
  return mask;
}

Overlaps choose_overlaps() {
  return &overlaps;
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field::impl {

HWY_EXPORT(choose_overlaps);

Overlaps overlaps_kernel() {
  static const Overlaps kernel = HWY_DYNAMIC_DISPATCH(choose_overlaps)();
  return kernel;
}

BoxTree::BoxTree(std::vector<Box3f> boxes) {
  constexpr std::size_t fan = WideBox::fan;
  while (!boxes.empty()) {
    const std::size_t nodes = (boxes.size() + fan - 1) / fan;
    std::vector<WideBox> level(nodes);
    std::vector<Box3f> parents(nodes);
    for (std::size_t i = 0; i < nodes * fan; ++i) {
      const Box3f box = i < boxes.size() ? boxes[i] : Box3f{};
      WideBox& w = level[i / fan];
      const auto c = i % fan;
      w.lo[0][c] = box.lo.x, w.lo[1][c] = box.lo.y, w.lo[2][c] = box.lo.z;
      w.hi[0][c] = box.hi.x, w.hi[1][c] = box.hi.y, w.hi[2][c] = box.hi.z;
      parents[i / fan].expand(box);
    }
    levels_.push_back(std::move(level));
    if (nodes == 1) break;
    boxes = std::move(parents);
  }
}

std::uint64_t BoxTree::bytes() const {
  std::uint64_t total = 0;
  for (const auto& level : levels_) total += level.size() * sizeof(WideBox);
  return total;
}

}  // namespace tafoni::field::impl
#endif
