// The five domains: four are a test of one position, the fifth asks another geology.

#include "tafoni/geology/impl/domain.h"

#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/geology/impl/rock.h"

namespace tafoni::geology::impl {
namespace {

/// A domain given by a test of one position.
template <class Test>
class Tested final : public Domain {
 public:
  explicit Tested(Test test) : test_(std::move(test)) {}
  void contains(std::span<const Vec3d> world, std::span<unsigned char> inside) const override {
    for (std::size_t i = 0; i < world.size(); ++i) inside[i] = test_(world[i]) ? 1 : 0;
  }

 private:
  Test test_;
};

template <class Test>
std::unique_ptr<const Domain> by_test(Test test) {
  return std::make_unique<Tested<Test>>(std::move(test));
}

/// Where a geology is above a half.
class Field final : public Domain {
 public:
  explicit Field(GeologyPtr field) : field_(std::move(field)) {}
  void contains(std::span<const Vec3d> world, std::span<unsigned char> inside) const override {
    for_blocks(world.size(), [&](std::size_t begin, std::size_t n) {
      std::array<double, noise_block> value;
      field_->raws(world.subspan(begin, n), std::span(value).first(n));
      for (std::size_t i = 0; i < n; ++i) inside[begin + i] = value[i] > 0.5 ? 1 : 0;
    });
  }

 private:
  GeologyPtr field_;
};

std::unique_ptr<const Domain> box(Vec3d middle, const std::vector<double>& size, double azimuth) {
  return by_test([=, a = sine_cosine(azimuth), x = size[0] / 2, y = size[1] / 2, z = size[2] / 2](Vec3d p) {
    const Vec3d q = p - middle;
    return std::abs(q.x * a.y - q.y * a.x) < x && std::abs(q.y * a.y + q.x * a.x) < y && std::abs(q.z) < z;
  });
}

/// Whether an upright prism over a ring holds a position, by the even-odd rule.
std::unique_ptr<const Domain> prism(const DomainParams& params, std::string_view where) {
  const std::vector<double>& xy = params.polygon;
  if (xy.size() < 6 || xy.size() % 2 != 0)
    fail(ErrorKind::usage, "{}: polygon has {} numbers, but needs x, y of three corners or more", where,
         xy.size());
  if (params.bottom >= params.top)
    fail(ErrorKind::usage, "{}: bottom = {} is not below top = {}", where, params.bottom, params.top);
  return by_test([xy, bottom = params.bottom, top = params.top](Vec3d p) {
    if (!(p.z > bottom && p.z < top)) return false;
    bool in = false;
    for (std::size_t i = 0, j = xy.size() - 2; i < xy.size(); j = i, i += 2) {
      // The even-odd rule counts a level edge on one side only; on the border is outside.
      if (xy[i + 1] == p.y && xy[j + 1] == p.y && (p.x >= xy[i]) != (p.x > xy[j])) return false;
      if ((xy[i + 1] > p.y) == (xy[j + 1] > p.y)) continue;
      const double x = xy[i] + (xy[j] - xy[i]) * (p.y - xy[i + 1]) / (xy[j + 1] - xy[i + 1]);
      if (p.x == x) return false;
      in ^= p.x < x;
    }
    return in;
  });
}

}  // namespace

std::unique_ptr<const Domain> make_domain(const DomainParams& params, std::vector<GeologyPtr>& children,
                                          std::size_t keep, std::string_view where) {
  const bool field = params.domain == "field";
  const std::size_t wanted = keep + (field ? 1 : 0);
  if (children.size() != wanted)
    fail(ErrorKind::usage, "{}: with domain = \"{}\" it takes {} {}, but has {}", where, params.domain,
         wanted, wanted == 1 ? "child" : "children", children.size());
  const Vec3d at{params.position[0], params.position[1], params.position[2]};
  if (field) {
    auto domain = std::make_unique<Field>(std::move(children.back()));
    children.pop_back();
    return domain;
  }
  if (params.domain == "box") return box(at, params.size, params.azimuth);
  if (params.domain == "polygon") return prism(params, where);
  if (params.domain == "sphere")
    return by_test([=, r = params.radius](Vec3d p) { return dot(p - at, p - at) < r * r; });
  return by_test(
      [=, normal = plane_normal(params.dip, params.azimuth)](Vec3d p) { return dot(p - at, normal) > 0; });
}

}  // namespace tafoni::geology::impl
