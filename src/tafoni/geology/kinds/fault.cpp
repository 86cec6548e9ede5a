// The rock of one child, moved inside a domain: a position in there asks where its rock came from.

#include "tafoni/geology/impl/domain.h"
#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_fault {
namespace {

struct Params : impl::DomainParams {
  std::vector<double> slip = {0, 0, -12};
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("throw", &Params::slip, "m", 3, -1e5, 1e5,
              "How far the rock inside the domain has moved: east, north and up");
    impl::declare_domain(t);
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(GeologyPtr rock, std::unique_ptr<const impl::Domain> domain, Vec3d slip)
      : rock_(std::move(rock)), domain_(std::move(domain)), slip_(slip) {}

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<Vec3d, impl::noise_block> from;
      std::array<unsigned char, impl::noise_block> inside;
      domain_->contains(points.subspan(begin, n), std::span(inside).first(n));
      for (std::size_t i = 0; i < n; ++i) from[i] = inside[i] ? points[begin + i] - slip_ : points[begin + i];
      rock_->raws(std::span(from).first(n), out.subspan(begin, n));
    });
  }

 private:
  GeologyPtr rock_;
  std::unique_ptr<const impl::Domain> domain_;
  Vec3d slip_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr> children, std::uint64_t) {
  Params p;
  assign(table().infos(), &p, values, "fault");
  auto domain = impl::make_domain(p, children, 1, "fault");
  return std::make_shared<Node>(std::move(children[0]), std::move(domain),
                                Vec3d{p.slip[0], p.slip[1], p.slip[2]});
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "fault",
                .doc = "Moves the rock of its child inside a domain; it is torn along the border",
                .source = "[Paris19 §4.4]",
                .params = table()},
      .min_children = 1,
      .max_children = 2,
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_fault
