// Folded rock: a position asks the child where its rock was before it was bent, by noise along each axis and
// by regular waves along the vertical.

#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology::geology_fold {
namespace {

struct Params {
  double amplitude = 16;
  double lateral = 8;
  double wavelength = 90;
  std::int64_t octaves = 2;
  double height = 0;
  double length = 120;
  double axis = 0;
  double lean = 0;
  std::vector<double> position = {0, 0};
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("amplitude", &Params::amplitude, "m", 0, 1e4,
           "Most that random folds raise or lower the rock; 0 for none")
        .real("lateral", &Params::lateral, "m", 0, 1e4,
              "Most that random folds move the rock east or north; 0 for none")
        .real("wavelength", &Params::wavelength, "m", 0.1, 1e5, "Size of the coarsest random folds")
        .only("where amplitude or lateral is above 0")
        .integer("octaves", &Params::octaves, "", 1, 12,
                 "Levels of detail of the random folds, each half as large as the one before")
        .only("where amplitude or lateral is above 0")
        .real("height", &Params::height, "m", 0, 1e4,
              "How far the crests of regular folds rise and their troughs sink; 0 for none")
        .real("length", &Params::length, "m", 0.1, 1e5, "Distance between the crests of regular folds")
        .only("where height is above 0", {{"height", 20.0}})
        .real("axis", &Params::axis, "deg", -360, 360,
              "Direction of the crests of regular folds, clockwise from north")
        .only("where height is above 0", {{"height", 20.0}})
        .real("lean", &Params::lean, "deg", -80, 80,
              "How far regular folds lean over towards the right of their axis; 0 for upright ones")
        .only("where height is above 0", {{"height", 20.0}})
        .numbers("position", &Params::position, "m", 2, -1e8, 1e8,
                 "World x and y of a place on a crest of regular folds, at elevation 0 where these lean")
        .only("where height is above 0", {{"height", 20.0}});
    return t;
  }();
  return params;
}

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, GeologyPtr rock, std::uint64_t seed) : p_(p), rock_(std::move(rock)) {
    const double f = 1 / p.wavelength;
    constexpr impl::Stream streams[] = {impl::Stream::fold_x, impl::Stream::fold_y, impl::Stream::fold_z};
    for (std::size_t c = 0; c < 3; ++c) noise_[c] = {{f, f, f}, p.octaves, seed, streams[c]};
    const Vec2d axis = impl::sine_cosine(p.axis), lean = impl::sine_cosine(p.lean);
    across_ = Vec3d{axis.y, -axis.x, -lean.x / lean.y} * (2 * std::numbers::pi / p.length);
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<Vec3d, impl::noise_block> from;
      const auto world = points.subspan(begin, n);
      std::copy(world.begin(), world.end(), from.begin());
      if (p_.height > 0)
        for (std::size_t i = 0; i < n; ++i) from[i].z -= regular_rise(world[i]);
      add<&Vec3d::x>(noise_[0], p_.lateral, world, from);
      add<&Vec3d::y>(noise_[1], p_.lateral, world, from);
      add<&Vec3d::z>(noise_[2], p_.amplitude, world, from);
      rock_->raws(std::span(from).first(n), out.subspan(begin, n));
    });
  }

 private:
  /// How far regular folds have raised the rock that is at p now.
  double regular_rise(Vec3d p) const {
    return p_.height * std::cos(dot(p - Vec3d{p_.position[0], p_.position[1], 0}, across_));
  }

  /// Adds the displacement delta along one axis.
  template <double Vec3d::*axis>
  static void add(const impl::Turbulence& noise, double amplitude, std::span<const Vec3d> world,
                  std::span<Vec3d> from) {
    if (amplitude == 0) return;
    std::array<float, impl::noise_block> t;
    noise.sample(world, std::span(t).first(world.size()));
    for (std::size_t i = 0; i < world.size(); ++i) from[i].*axis += amplitude * (2.0 * t[i] - 1);
  }

  Params p_;
  GeologyPtr rock_;
  std::array<impl::Turbulence, 3> noise_;
  Vec3d across_;  ///< gradient of the phase of the regular folds, 1 / m
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr> children, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "fold");
  return std::make_shared<Node>(p, std::move(children[0]), seed);
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "fold",
                .doc = "Folds its child by turbulence, by regular waves or by both",
                .source = "[Paris19 §4.3]",
                .params = table()},
      .min_children = 1,
      .max_children = 1,
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_fold
