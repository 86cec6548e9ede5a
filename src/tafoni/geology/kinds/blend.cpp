#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_blend {
namespace {

class Node final : public impl::BatchGeology {
 public:
  explicit Node(std::vector<GeologyPtr> children) : children_(std::move(children)) {}

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    children_.front()->raws(points, out);
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<double, impl::noise_block> term;
      for (std::size_t c = 1; c < children_.size(); ++c) {
        children_[c]->raws(points.subspan(begin, n), std::span(term).first(n));
        for (std::size_t i = 0; i < n; ++i) out[begin + i] += term[i];
      }
    });
  }

 private:
  std::vector<GeologyPtr> children_;
};

GeologyPtr make(const Values&, std::vector<GeologyPtr> children, std::uint64_t) {
  return std::make_shared<Node>(std::move(children));
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "blend", .doc = "The sum of its children's resistances", .source = "[Paris19 §4.2]"},
      .min_children = 1,
      .max_children = 1000,
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_blend
