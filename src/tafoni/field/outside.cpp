#include "tafoni/field/inner/outside.h"

#include <algorithm>
#include <unordered_set>
#include <vector>

#include "tafoni/field/impl/node.h"

namespace tafoni::field {

static_assert(farthest == impl::reach_limit);

std::uint64_t primitives_outside(const NodePtr& root, const Box3d& box) {
  // A box at infinity has no float.
  constexpr double far = 1e9;
  const auto near = [&](Vec3d p) {
    return to_float(
        Vec3d{std::clamp(p.x, -far, far), std::clamp(p.y, -far, far), std::clamp(p.z, -far, far)});
  };
  std::uint64_t total = 0;
  std::unordered_set<const Node*> seen;
  std::vector<const Node*> pending{root.get()};
  while (!pending.empty()) {
    const Node* node = pending.back();
    pending.pop_back();
    if (!node || !seen.insert(node).second) continue;
    if (const auto* op = node->operation())
      for (const NodePtr& child : op->children) pending.push_back(child.get());
    const auto* cloud = node->cloud();
    if (!cloud || cloud->size() == 0) continue;
    const Box3f own = cloud->bounds();
    if (box.contains(to_double(own.lo)) && box.contains(to_double(own.hi))) continue;
    impl::Primitives touching;
    cloud->collect(Box3f{near(box.lo), near(box.hi)}, touching);
    total += cloud->size() - touching.size();
  }
  return total;
}

}  // namespace tafoni::field
