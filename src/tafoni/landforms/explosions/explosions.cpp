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

enum class Stream : std::uint64_t { sizes = 0xb1a5, places = 2 };

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
    sampling.spacing = std::max(2 * p_.radius, std::max(extent.x, extent.y) / 80);
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, Stream::places);
    sampling.accept = [&](const SurfaceSample& s) { return ground_.usable(s.position, 2.2 * p_.radius); };
    std::int64_t left = p_.count;
    const auto places = sample_surface(field_, sampling, progress);
    if (places.empty())
      progress.warn(fmt::format(
          "explosions finds no place for a crater of {:g} m: each must lie {:g} m off the terrain's border; "
          "give a smaller radius",
          p_.radius, 2.2 * p_.radius));
    for (const SurfaceSample& s : places) {
      if (left-- == 0) break;
      const double r = radius();
      add(out, s.position - to_double(s.normal) * (p_.depth * r), r);
    }
    return out;
  }

  /// What was there is gone within the radius; values change as far as 1.6 radii.
  std::vector<field::NodePtr> nodes(const std::vector<Blast>& blasts) {
    std::vector<field::NodePtr> out;
    for (std::size_t i = 0; i < blasts.size(); ++i) {
      const Blast& b = blasts[i];
      const double r = b.radius, t = ground_.site().amplitude;
      field::CloudSettings settings;
      settings.noise = {p_.roughness * r, 0.9 * r, 3, hash_combine(ground_.site().seed, i)};
      field::CloudBuilder hole(settings);
      // The falloff at r over 1.6 r takes what rock has at the crater's bottom.
      field::add_point(hole, b.at, reach * r, -std::min(r, t) / std::pow(1 - 1 / (reach * reach), 3));
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
  static constexpr double reach = 1.6;

  double radius() { return p_.radius * (1 + p_.variation * random_.uniform(-1, 1)); }

  bool add(std::vector<Blast>& out, Vec3d at, double r) const {
    if (!ground_.usable(at)) return false;
    const float f = field_.value(at);
    out.push_back(
        {at, r, std::abs(static_cast<double>(f)) < std::min(0.7 * r, 0.95 * ground_.site().amplitude)});
    return true;
  }

  /// Heaps on the ground around the crater, higher to some sides.
  void throw_out(field::CloudBuilder& cloud, const Blast& b) {
    const double r = b.radius;
    constexpr int heaps = 26;
    for (int i = 0; i < heaps; ++i) {
      const double a = 6.283185307 * (i + random_.uniform(-0.4, 0.4)) / heaps,
                   far = r * random_.uniform(1.0, 1.45);
      const double height =
          p_.rim * r * random_.uniform(0.25, 1) * (0.75 + 0.25 * std::sin(a + 9 * b.radius));
      Vec3d p = b.at + Vec3d{far * std::cos(a), far * std::sin(a), 1.2 * r};
      // Down to the ground, if it is near.
      int steps = 0;
      while (field_.value(p) < 0 && steps < 40) p.z -= 0.08 * r, ++steps;
      if (steps == 0 || steps == 40 || !ground_.usable(p)) continue;
      field::add_point(cloud, p, r * random_.uniform(0.25, 0.5), height);
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
  std::uint64_t primitives = 0;
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
      .places("positions", places)
      .lengths("radii", radii)
      .count("primitives", static_cast<std::int64_t>(primitives));
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
