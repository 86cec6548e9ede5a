#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology {
namespace {

struct Params {
  std::vector<double> position = {0, 0, 0};
  double dip = 0;
  double azimuth = 90;
  double thickness = 8;
  double spacing = 20;
  double strength = 0.6;
  double base = 0.15;
  double turbulence = 0.25;
  double wavelength = 10;
  std::int64_t octaves = 3;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("position", &Params::position, "m", 3, -1e8, 1e8, "a world position on the first plane")
        .real("dip", &Params::dip, "deg", 0, 90, "steepest descent of the planes")
        .real("azimuth", &Params::azimuth, "deg", -360, 360,
              "direction in which they descend, clockwise from north")
        .real("thickness", &Params::thickness, "m", 0.01, 10000,
              "distance from a plane beyond which it has no effect")
        .real("spacing", &Params::spacing, "m", 0, 100000,
              "distance between parallel planes, 0 for one alone")
        .real("strength", &Params::strength, "", -1, 1,
              "resistance added on a plane, negative for a soft band")
        .real("base", &Params::base, "", -1, 1, "resistance everywhere")
        .real("turbulence", &Params::turbulence, "", 0, 1,
              "greatest resistance added by small irregularities")
        .real("wavelength", &Params::wavelength, "m", 0.1, 10000, "size of the coarsest irregularities")
        .integer("octaves", &Params::octaves, "", 1, 12, "levels of detail of the irregularities");
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, std::uint64_t seed) : p_(p), normal_(impl::plane_normal(p.dip, p.azimuth)) {
    const double f = 1 / p.wavelength;
    noise_ = {{f, f, f}, static_cast<int>(p.octaves), hash_combine(seed, 0x706c)};
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    const Vec3d first{p_.position[0], p_.position[1], p_.position[2]};
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      const auto world = points.subspan(begin, n);
      std::array<float, impl::noise_block> t;
      noise_.sample(world, std::span(t).first(n));
      for (std::size_t i = 0; i < n; ++i)
        out[begin + i] = p_.base + p_.strength * falloff(dot(world[i] - first, normal_)) +
                         p_.turbulence * static_cast<double>(t[i]);
    });
  }

 private:
  /// g of the distance to the nearest plane.
  double falloff(double d) const {
    // Adding and taking away this number rounds to whole ones; std::round() is a call.
    constexpr double whole = 0x1.8p52;
    if (p_.spacing > 0) d -= p_.spacing * ((d / p_.spacing + whole) - whole);
    return impl::falloff(std::abs(d) / p_.thickness);
  }

  Params p_;
  Vec3d normal_;
  impl::Turbulence noise_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr>, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "planes");
  return std::make_shared<Node>(p, seed);
}

}  // namespace

const GeologyType& geology_planes() {
  static const GeologyType type{
      .about = {.name = "planes",
                .doc = "Parallel bands about planes of any dip, harder or softer than the rest",
                .source = "[Paris19 §4.2]",
                .params = table().infos()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology
