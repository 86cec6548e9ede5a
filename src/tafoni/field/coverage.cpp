// The share of an area that lies above or below primitives: discs as wide as their supports are marked on
// cells.

#include <algorithm>
#include <cmath>
#include <functional>
#include <unordered_set>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/pose.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/whole.h"

namespace tafoni::field {
namespace {

/// Cells of the plane, marked where a disc covers their centre.
class Cells {
 public:
  Cells(const Box3d& area, double cell)
      : area_(area),
        cell_(cell),
        width_(ceil_to(area.size().x / cell)),
        height_(ceil_to(area.size().y / cell)),
        marked_(std::ptrdiff_t{width_} * height_) {}

  void mark(double x, double y, double radius) {
    const auto first = [](double v, int n) { return ceil_to(std::clamp<double>(v, 0, n)); };
    const double cx = (x - area_.lo.x) / cell_ - 0.5, cy = (y - area_.lo.y) / cell_ - 0.5, r = radius / cell_;
    for (int j = first(cy - r, height_); j <= cy + r && j < height_; ++j) {
      const double dy = j - cy, half = std::sqrt(std::max(r * r - dy * dy, 0.0));
      for (int i = first(cx - half, width_); i <= cx + half && i < width_; ++i)
        marked_[std::ptrdiff_t{j} * width_ + i] = true;
    }
  }
  double share() const { return ratio(std::count(marked_.begin(), marked_.end(), true), marked_.size()); }

 private:
  Box3d area_;
  double cell_;
  int width_, height_;
  std::vector<bool> marked_;
};

/// Marks the primitives below `root`, seen by `at` from where the tree stands and larger by `scale`.
void mark(Cells& cells, const Node* root, const std::function<Vec3d(Vec3d)>& at, double scale) {
  std::unordered_set<const Node*> seen;
  std::vector<const Node*> pending{root};
  while (!pending.empty()) {
    const Node* node = pending.back();
    pending.pop_back();
    if (!node || !seen.insert(node).second) continue;
    if (const auto* op = node->operation())
      for (const auto& child : op->children) pending.push_back(child.get());
    if (const auto* nested = node->nested(); nested && nested->child())
      nested->each_pose([&](const impl::Pose* pose) {
        const NodePtr child = nested->child();
        if (!pose) return mark(cells, child.get(), at, scale);
        mark(
            cells, child.get(), [&](Vec3d p) { return at(pose->to_world(p)); }, scale * pose->scale);
      });
    const auto* cloud = node->cloud();
    if (!cloud) continue;
    impl::Primitives found;
    cloud->collect(cloud->bounds(), found);
    for (std::size_t i = 0; i < found.size(); ++i) {
      const Vec3d p =
          at({impl::to_metres(found.x[i]), impl::to_metres(found.y[i]), impl::to_metres(found.z[i])});
      cells.mark(p.x, p.y, found.reach[i] * scale);
    }
  }
}

}  // namespace

double coverage(const NodePtr& root, const Box3d& area, double cell) {
  if (!(cell > 0) || !(area.size().x > 0) || !(area.size().y > 0))
    fail(ErrorKind::usage, "coverage wants an area and a cell above 0 m");
  Cells cells(area, cell);
  mark(
      cells, root.get(), [](Vec3d p) { return p; }, 1);
  return cells.share();
}

}  // namespace tafoni::field
