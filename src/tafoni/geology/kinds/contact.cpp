// Two rocks along a border. A block of positions is parted by the domain, and each rock is asked for its own
// part at once.

#include "tafoni/geology/impl/domain.h"
#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_contact {
namespace {

const ParamTable<impl::DomainParams>& table() {
  static const ParamTable<impl::DomainParams> params = [] {
    ParamTable<impl::DomainParams> t;
    impl::declare_domain(t);
    return t;
  }();
  return params;
}

/// Points of a block that belong to one side, and what they get.
struct Side {
  std::array<Vec3d, impl::noise_block> points;
  std::array<std::size_t, impl::noise_block> index;
  std::size_t size = 0;

  void fill(const Geology& rock, std::span<double> out) const {
    std::array<double, impl::noise_block> value;
    rock.raws(std::span(points).first(size), std::span(value).first(size));
    for (std::size_t i = 0; i < size; ++i) out[index[i]] = value[i];
  }
};

class Node final : public impl::BatchGeology {
 public:
  Node(GeologyPtr outside, GeologyPtr inside, std::unique_ptr<const impl::Domain> domain)
      : rock_{std::move(outside), std::move(inside)}, domain_(std::move(domain)) {}

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<unsigned char, impl::noise_block> inside;
      std::array<Side, 2> sides;
      domain_->contains(points.subspan(begin, n), std::span(inside).first(n));
      for (std::size_t i = 0; i < n; ++i) {
        Side& side = sides[inside[i]];
        side.points[side.size] = points[begin + i];
        side.index[side.size++] = begin + i;
      }
      for (std::size_t s = 0; s < 2; ++s)
        if (sides[s].size > 0) sides[s].fill(*rock_[s], out);
    });
  }

 private:
  std::array<GeologyPtr, 2> rock_;  ///< outside and inside the domain
  std::unique_ptr<const impl::Domain> domain_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr> children, std::uint64_t) {
  impl::DomainParams p;
  assign(table().infos(), &p, values, "contact");
  auto domain = impl::make_domain(p, children, 2, "contact");
  return std::make_shared<Node>(std::move(children[0]), std::move(children[1]), std::move(domain));
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "contact",
                .doc = "Two rocks side by side: the second child inside a domain, the first outside",
                .source = "[Paris19 §4, fig. 3]",
                .params = table()},
      .min_children = 2,
      .max_children = 3,
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_contact
