// Craters [Ruths01]: each blast is a negative point whose falloff takes the rock within its radius; blasts at
// the surface throw out a rim of small heaps.

#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/landforms/site/table_rows.h"
#include "tafoni/math/noise.h"

namespace tafoni::landforms::landform_explosions {
namespace {

using impl::Ground;

/// Craters' own noise has the numbers from 0 on.
enum class Stream : std::uint64_t { sizes = 0xb1a5, places = 2 };

/// Chosen by eye; lengths are in radii of a crater where nothing else is said.
namespace look {
// Values change as far as this: a point whose falloff is steep at the crater's wall, and gentle beyond.
constexpr double reach = 1.6;
// Random places are so far apart, at most so many across the terrain, and so far off its border, for a rim.
constexpr double apart = 2, places_across = 80, border = 2.2;
// The size of the wall's unevenness, and its octaves.
constexpr double uneven_size = 0.9;
constexpr int uneven_octaves = 3;
// A blast is at the surface, and throws out a rim, where the field is less than this, or than this share of
// what the field is clamped to.
constexpr double surface = 0.7, surface_clamped = 0.95;
// The rim's heaps: how many, how far they stray from even angles (in shares of one), how far out they lie,
// their heights as shares of the rim's, and their radii.
constexpr int heaps = 26;
constexpr double heap_stray = 0.4, heap_near = 1.0, heap_far = 1.45, heap_low = 0.25, heap_high = 1;
constexpr double heap_small = 0.25, heap_large = 0.5;
// Heights change round the crater about this mean, by this share, from a direction that depends on the
// radius.
constexpr double side_mean = 0.75, side = 0.25, side_turn = 9;
// The ground under a heap is looked for from so high above the blast, in so many steps downwards.
constexpr double above = 1.2, down = 0.08;
constexpr int down_steps = 40;
}  // namespace look

struct Params {
  std::int64_t count = 4;
  double radius = 5;
  double variation = 0.4;
  double depth = 0.15;
  double rim = 0.35;
  double roughness = 0.25;
  Rows blast;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 10000,
              "How many explosions go off at random places on the surface, besides those that are given and "
              "the layer's points")
        .real("radius", &Params::radius, "m", 0.1, 500, "Radius of a crater, on average")
        .real("variation", &Params::variation, "", 0, 0.9,
              "Share by which radii vary at random; 0 for craters of one size")
        .real("depth", &Params::depth, "", 0, 2,
              "How deep under the surface a blast lies, as a share of the radius: more leaves caves with a "
              "small mouth")
        .real("rim", &Params::rim, "", 0, 1,
              "Height of what is thrown out around the crater, as a share of the radius; 0 for no rim")
        .real("roughness", &Params::roughness, "", 0, 0.6,
              "Unevenness of the crater, as a share of the radius; 0 for a smooth bowl")
        .rows("blast", &Params::blast,
              {numbers_column("at", "", "m", 3, -1e9, 1e9, "World x, y and z of the blast"),
               numbers_column("radius", "", "m", 1, 0.1, 500, "Radius of the crater; empty for the layer's")},
              "Explosions whose place is given, in the air, at the surface or in the rock");
    return t;
  }();
  return params;
}

struct Blast {
  Vec3d at;
  double radius;
  bool thrown;  ///< whether it lies at the surface, so that there is a rim
};

/// [Ruths01] adds a symmetric falloff to the values around the place; that is what a blended point is.
class Craters {
 public:
  Craters(const Ground& ground, const Params& p)
      : ground_(ground),
        p_(p),
        random_(ground.site().seed, Stream::sizes),
        field_(field::compile(ground.site().terrain)) {}

  std::vector<Blast> blasts(Progress& progress) {
    std::vector<Blast> out;
    for (std::size_t n = 0; n < p_.blast.size(); ++n) {
      const Vec3d at = impl::point_in(p_.blast[n], "at", fmt::format("explosions: blast, row {}", n + 1));
      if (!add(out, at - ground_.site().origin, impl::number_in(p_.blast[n], "radius").value_or(p_.radius)))
        progress.warn(
            fmt::format("explosions: blast, row {} does nothing: it lies outside the terrain or where the "
                        "layer may not act",
                        n + 1));
    }
    for (const Vec3d& p : ground_.site().points) add(out, p, radius());
    if (p_.count == 0) return out;
    SurfaceSampling sampling;
    const Vec3d extent = ground_.box().size();
    sampling.spacing = std::max(look::apart * p_.radius, std::max(extent.x, extent.y) / look::places_across);
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, Stream::places);
    sampling.accept = [&](const SurfaceSample& s) {
      return ground_.usable(s.position, look::border * p_.radius);
    };
    std::int64_t left = p_.count;
    const auto places = sample_surface(field_, sampling, progress);
    if (places.empty())
      progress.warn(fmt::format(
          "explosions finds no place for a crater of {:g} m: each must lie {:g} m off the terrain's border; "
          "give a smaller radius",
          p_.radius, look::border * p_.radius));
    for (const SurfaceSample& s : places) {
      if (left-- == 0) break;
      const double r = radius();
      add(out, s.position - to_double(s.normal) * (p_.depth * r), r);
    }
    return out;
  }

  /// What was there is gone within the radius of each blast; values change as far as the reach.
  std::vector<field::NodePtr> nodes(const std::vector<Blast>& blasts) {
    std::vector<field::NodePtr> out;
    for (std::size_t i = 0; i < blasts.size(); ++i) {
      const Blast& b = blasts[i];
      const double r = b.radius, t = ground_.site().amplitude;
      field::CloudSettings settings;
      settings.noise = {p_.roughness * r, look::uneven_size * r, look::uneven_octaves,
                        hash_combine(ground_.site().seed, i)};
      field::CloudBuilder hole(settings);
      // The falloff at r over the reach takes what rock has at the crater's bottom.
      field::add_point(hole, b.at, look::reach * r,
                       -std::min(r, t) / std::pow(1 - 1 / (look::reach * look::reach), 3));
      if (b.thrown && p_.rim > 0) {
        field::CloudBuilder thrown(field::CloudSettings{});
        throw_out(thrown, b);
        if (thrown.size() > 0) out.push_back(thrown.finish());
      }
      out.push_back(hole.finish());
    }
    return out;
  }

 private:
  double radius() { return p_.radius * (1 + p_.variation * random_.uniform(-1, 1)); }

  bool add(std::vector<Blast>& out, Vec3d at, double r) const {
    if (!ground_.usable(at)) return false;
    const double f = field_.value(at);
    out.push_back(
        {at, r, std::abs(f) < std::min(look::surface * r, look::surface_clamped * ground_.site().amplitude)});
    return true;
  }

  /// Heaps on the ground around the crater, higher to some sides.
  void throw_out(field::CloudBuilder& cloud, const Blast& b) {
    const double r = b.radius;
    for (int i = 0; i < look::heaps; ++i) {
      const double a = 6.283185307 * (i + random_.uniform(-look::heap_stray, look::heap_stray)) / look::heaps,
                   far = r * random_.uniform(look::heap_near, look::heap_far);
      const double height = p_.rim * r * random_.uniform(look::heap_low, look::heap_high) *
                            (look::side_mean + look::side * std::sin(a + look::side_turn * b.radius));
      Vec3d p = b.at + Vec3d{far * std::cos(a), far * std::sin(a), look::above * r};
      // A heap lies on the ground, if that is near.
      int steps = 0;
      while (field_.value(p) < 0 && steps < look::down_steps) p.z -= look::down * r, ++steps;
      if (steps == 0 || steps == look::down_steps || !ground_.usable(p)) continue;
      field::add_point(cloud, p, r * random_.uniform(look::heap_small, look::heap_large), height);
    }
  }

  const Ground& ground_;
  const Params& p_;
  Random random_;
  field::CompiledField field_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "explosions");
  progress.check();
  const Ground ground(site);
  Result result;
  std::vector<Vec3d> places;
  std::vector<double> radii;
  std::int64_t primitives = 0;
  if (!ground.box().empty()) {
    Craters craters(ground, p);
    const std::vector<Blast> blasts = craters.blasts(progress);
    for (const Blast& b : blasts) {
      places.push_back(b.at);
      radii.push_back(b.radius);
    }
    result.nodes = craters.nodes(blasts);
    for (const auto& node : result.nodes) primitives += field::stats(node).primitives;
  }
  result.facts.count("explosions", std::ssize(radii))
      .about("Explosions that went off, at given places and at random ones")
      .places("positions", places)
      .about("x, y and z of each blast in turn")
      .lengths("radii", radii)
      .about("Radius of the crater of each blast")
      .count("primitives", primitives);
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "explosions",
                .doc = "Craters of explosions, at given places or at random ones, with what they threw out",
                .source = "[Ruths01]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_explosions
