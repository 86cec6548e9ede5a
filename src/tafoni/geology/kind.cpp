// Making geologies by name. Kinds work on world positions; a Shifted about each node they make lets trees ask
// at local ones.

#include "tafoni/geology/kind.h"

#include <string>

#include "tafoni/core/error.h"
#include "tafoni/geology/impl/rock.h"

namespace tafoni::geology {
namespace {

/// A geology seen from a frame whose zero lies at `shift` in the geology's own.
class Shifted final : public impl::BatchGeology {
 public:
  Shifted(GeologyPtr geology, Vec3d shift) : geology_(std::move(geology)), shift_(shift) {}
  const GeologyPtr& geology() const { return geology_; }
  Vec3d shift() const { return shift_; }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<Vec3d, impl::noise_block> moved;
      for (std::size_t i = 0; i < n; ++i) moved[i] = points[begin + i] + shift_;
      geology_->raws(std::span(moved).first(n), out.subspan(begin, n));
    });
  }

 private:
  GeologyPtr geology_;
  Vec3d shift_;
};

/// The geology as it is seen from a frame whose zero lies at `shift`; two opposite shifts undo each other.
GeologyPtr shift_by(GeologyPtr geology, Vec3d shift) {
  if (shift == Vec3d{}) return geology;
  if (const auto* back = dynamic_cast<const Shifted*>(geology.get()); back && back->shift() == -shift)
    return back->geology();
  return std::make_shared<Shifted>(std::move(geology), shift);
}

}  // namespace

std::string children_text(const GeologyType& type) {
  if (type.max_children == 0) return "no children";
  const std::string most =
      fmt::format("{} {}", type.max_children, type.max_children == 1 ? "child" : "children");
  return type.min_children == type.max_children
             ? most
             : fmt::format("{} {} {}", type.min_children,
                           type.max_children - type.min_children == 1 ? "or" : "to", most);
}

const GeologyType& find_geology(std::string_view name) {
  return find(all_geologies(), name, "geology");
}

GeologyPtr make_geology(std::string_view name, const Values& values, std::vector<GeologyPtr> children,
                        Vec3d origin, std::uint64_t seed) {
  const GeologyType& type = find_geology(name);
  if (children.size() < type.min_children || children.size() > type.max_children)
    fail(ErrorKind::usage, "{}: takes {}, but has {}", name, children_text(type),
         children.empty() ? "none" : fmt::format("{}", children.size()));
  Values valid;
  for (const auto& [key, value] : values)
    valid[key] = check_value(find_param(type.about.params, key, name), value, name);
  for (GeologyPtr& child : children) child = shift_by(std::move(child), -origin);
  return shift_by(type.make(valid, std::move(children), seed), origin);
}

GeologyPtr default_geology(Vec3d origin, std::uint64_t seed) {
  return make_geology("strata", {}, {}, origin, seed);
}

}  // namespace tafoni::geology
