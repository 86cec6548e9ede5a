// Bands of rock about planes: resistance falls off from the nearest plane, and noise is added everywhere.

#include <cmath>

#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_planes {
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
    t.numbers("position", &Params::position, "m", 3, -1e8, 1e8, "World position on the first plane")
        .real("dip", &Params::dip, "deg", 0, 90,
              "Steepest descent of the planes: 0 for level ones, 90 for upright ones")
        .real("azimuth", &Params::azimuth, "deg", -360, 360,
              "Direction in which the planes descend, clockwise from north")
        .only("where dip is above 0", {{"dip", 30.0}})
        .real("thickness", &Params::thickness, "m", 0.01, 10000,
              "Distance from a plane beyond which it has no effect")
        .real("spacing", &Params::spacing, "m", 0, 100000,
              "Distance between parallel planes; 0 for one alone")
        .real("strength", &Params::strength, "", -1, 1,
              "Resistance added on a plane; negative for a soft band")
        .real("base", &Params::base, "", -1, 1, "Resistance that is everywhere")
        .real("turbulence", &Params::turbulence, "", 0, 1,
              "Most resistance that small irregularities add; 0 for none")
        .real("wavelength", &Params::wavelength, "m", 0.1, 10000, "Size of the coarsest irregularities")
        .only("where turbulence is above 0")
        .integer("octaves", &Params::octaves, "", 1, 12,
                 "Levels of detail of the irregularities, each half as large as the one before")
        .only("where turbulence is above 0");
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, std::uint64_t seed) : p_(p), normal_(impl::plane_normal(p.dip, p.azimuth)) {
    const double f = 1 / p.wavelength;
    noise_ = {{f, f, f}, p.octaves, seed, impl::Stream::planes};
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    const Vec3d first{p_.position[0], p_.position[1], p_.position[2]};
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      const auto world = points.subspan(begin, n);
      std::array<float, impl::noise_block> t;
      noise_.sample(world, std::span(t).first(n));
      for (std::size_t i = 0; i < n; ++i)
        out[begin + i] =
            p_.base + p_.strength * effect(dot(world[i] - first, normal_)) + p_.turbulence * t[i];
    });
  }

 private:
  /// g of the distance to the nearest plane, of d from the first.
  double effect(double d) const {
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

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "planes",
                .doc = "Parallel bands about planes of any dip, harder or softer than the rest",
                .source = "[Paris19 §4.2]",
                .params = table()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_planes
