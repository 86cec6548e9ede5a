// Rock from fractal noise that changes faster upwards than sideways, so that beds and lenses appear.

#include <algorithm>

#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_turbulence {
namespace {

struct Params {
  double wavelength = 20;
  double lateral = 150;
  std::int64_t octaves = 4;
  double contrast = 2.5;
  double base = 0;
  double strength = 1;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("wavelength", &Params::wavelength, "m", 0.1, 10000,
           "Vertical size of the coarsest variation: the thickness of the thickest beds")
        .real("lateral", &Params::lateral, "m", 0, 100000,
              "Horizontal size of the coarsest variation; 0 for beds that never change sideways")
        .integer("octaves", &Params::octaves, "", 1, 12,
                 "Levels of detail, each half as large as the one before")
        .real(
            "contrast", &Params::contrast, "", 0.1, 20,
            "Gain about the middle, since plain noise keeps to middle values: more for beds that differ more")
        .real("base", &Params::base, "", -1, 1, "Resistance where the noise is 0")
        .real("strength", &Params::strength, "", -1, 1,
              "Resistance added where the noise is 1; negative turns hard beds into soft ones");
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, std::uint64_t seed) : p_(p) {
    const double lateral = p.lateral > 0 ? 1 / p.lateral : 0;
    noise_ = {{lateral, lateral, 1 / p.wavelength}, p.octaves, seed, impl::Stream::turbulence};
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      const auto world = points.subspan(begin, n);
      std::array<float, impl::noise_block> t;
      noise_.sample(world, std::span(t).first(n));
      for (std::size_t i = 0; i < n; ++i) {
        const double gained = std::clamp(0.5 + (t[i] - 0.5) * p_.contrast, 0.0, 1.0);
        out[begin + i] = p_.base + p_.strength * gained;
      }
    });
  }

 private:
  Params p_;
  impl::Turbulence noise_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr>, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "turbulence");
  return std::make_shared<Node>(p, seed);
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "turbulence",
                .doc = "Beds and lenses from fractal noise of the elevation",
                .source = "[Paris19 §4.1]",
                .params = table()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_turbulence
