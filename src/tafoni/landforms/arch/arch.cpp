// Arches [Paris19 §6.1]: takes the best of the places that a search has found, thin walls, rims with room for
// a shaft behind them and faces that stand opposite each other, where an opening leaves a sound roof; windows
// are cut out of the tree and bridges united with it.

#include <algorithm>
#include <cmath>

#include "tafoni/landforms/arch/places.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/spatial_hash.h"

namespace tafoni::landforms::landform_arch {
namespace {

using impl::Ground;

using impl::Found;

using Params = impl::ArchParams;

/// Chosen by eye.
namespace look {
// Two openings or bridges are so many sizes apart at least.
constexpr double apart = 2;
// A window that leaves no sound roof is tried again, less wide and less high by these factors.
constexpr int attempts = 3;
constexpr double narrower = 0.8, lower = 0.85;
// The rock that must remain about a window: from pier to pier, in half widths from its middle, where the span
// ends and the piers begin, and above it in shares of the roof (of the half height, for the piers).
constexpr double piers = 1.35, pier_step = 0.15, span = 1.2, roof_low = 0.3, roof_high = 0.95,
                 roof_step = 0.2;
// A window's corners are tested at this share of its half height: it is vaulted.
constexpr double corners = 0.9;
// The crown of a window with a shaft lies so far before its middle, in half lengths.
constexpr double crown = 0.25;
// The skin about a shaft is tested so many radii from its axis, from so many roofs above the window up to so
// many sizes below the shaft's top.
constexpr double skin = 1.2, skin_low = 0.5, skin_high = 0.15;
}  // namespace look

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "Most openings that are sought in fins, ridges and cliffs")
        .real("size", &Params::size, "m", 0, 500,
              "Greatest height of an opening; 0 for three pixels of the terrain, but 18 m at least")
        .real(
            "thickness", &Params::thickness, "m", 0, 1000,
            "Thickest wall that an arch may pierce: more finds arches like tunnels; 0 for 1.2 times the size")
        .real("roof", &Params::roof, "m", 0, 200,
              "Least rock that is left above an opening; 0 for a fifth of the size")
        .real("slope", &Params::slope, "deg", 10, 89, "Slope from which ground counts as a face")
        .boolean("potholes", &Params::potholes,
                 "Whether cliffs are opened into a shaft behind their rim where no thin wall is left: "
                 "pothole arches")
        .integer("bridges", &Params::bridges, "", 0, 1000,
                 "Most natural bridges that are built between faces that stand opposite each other")
        .real("span", &Params::span, "m", 0, 1000, "Longest of these bridges; 0 for three times the size")
        .only("where bridges is above 0", {{"bridges", std::int64_t{4}}})
        .real("weakness", &Params::weakness, "", 0, 1,
              "How much wider openings are where the rock is soft; 0 for openings of even width")
        .real("roughness", &Params::roughness, "", 0, 1,
              "Unevenness of the rock in openings and bridges; 0 for smooth vaults");
    return t;
  }();
  return params;
}

class Arches {
 public:
  Arches(const Site& site, const Params& p, Progress& progress)
      : ground_(site),
        p_(impl::with_defaults(p, ground_)),
        field_(field::compile(site.terrain)),
        progress_(progress),
        step_(impl::arch_step(p_)),
        taken_(2 * look::apart * p_.size) {}

  Result run() {
    if (!ground_.box().empty()) {
      user_bridges();
      if (p_.count > 0 || p_.bridges > 0) take_best();
    }
    return finish();
  }

 private:
  void take_best() {
    const impl::ArchPlaces found = impl::find_arch_places(ground_, field_, p_, bridges_.size(), progress_);
    take_windows(found.fins);
    take_windows(found.cliffs);
    take_bridges(found.gaps);
  }

  void user_bridges() {
    const auto& points = ground_.site().points;
    for (std::size_t i = 0; i + 1 < points.size(); i += 2)
      if (ground_.usable(points[i]) && ground_.usable(points[i + 1]) && length(points[i + 1] - points[i]) > 1)
        build(impl::plan_bridge(ground_, p_, points[i], points[i + 1], bridges_.size()));
  }

  void build(const impl::Bridge& b) {
    const auto shape = impl::bridge_shape(b, impl::arch_texture(ground_, p_, 1));
    bridges_.push_back(field::function(shape));
    places_.push_back(0.5 * (b.from + b.to) + Vec3d{0, 0, b.rise});
    reached_.expand(impl::reach(b, shape->margin(), ground_.site().amplitude));
  }

  void take_windows(const std::vector<Found<impl::Window>>& found) {
    for (const auto& place : found) {
      impl::Window w = place.what;
      progress_.check();
      if (std::ssize(windows_) >= p_.count) return;
      if (taken_.any_near(w.center, look::apart * p_.size) || !inside(w)) continue;
      for (int attempt = 0; attempt < look::attempts;
           ++attempt, w.half_width *= look::narrower, w.half_height *= look::lower) {
        const auto shape = impl::window_shape(w, impl::arch_texture(ground_, p_, -1));
        if (!sound(w, *shape)) continue;
        taken_.insert(w.center);
        windows_.push_back(field::function(shape));
        places_.push_back(w.center);
        heights_.push_back(2 * w.half_height);
        reached_.expand(impl::reach(w, shape->margin(), ground_.site().amplitude));
        break;
      }
    }
  }

  void take_bridges(const std::vector<Found<impl::Bridge>>& found) {
    const std::size_t most = bridges_.size() + p_.bridges;
    for (const auto& [merit, b] : found) {
      if (bridges_.size() >= most) return;
      const Vec3d middle = 0.5 * (b.from + b.to);
      if (taken_.any_near(middle, look::apart * p_.size)) continue;
      taken_.insert(middle);
      build(b);
    }
  }

  /// Whether the corners of a window lie on real data and in the region.
  bool inside(const impl::Window& w) const {
    const Vec3d u = w.along() * w.half_width, d = w.through * w.half_length;
    for (double z : {-look::corners, look::corners})
      for (const Vec3d& c : {u + d, u - d, d - u, -u - d})
        if (!ground_.usable(w.center + c + Vec3d{0, 0, z * w.half_height})) return false;
    return true;
  }

  /// Whether a window is air all the way through, has rock above it for the thickness of the roof from pier
  /// to pier, and has piers.
  bool sound(const impl::Window& w, const impl::RockShape& shape) const {
    std::vector<Vec3d> way, rock;
    const double end = w.shaft_radius > 0 ? w.shaft_at : w.half_length;
    for (double t = -w.half_length; t <= end; t += step_) way.push_back(w.center + w.through * t);
    if (w.shaft_radius > 0)
      for (double z = 0; z < w.shaft_top; z += step_)
        way.push_back(w.center + w.through * w.shaft_at + Vec3d{0, 0, z});
    std::vector<float> before(way.size()), opening(way.size());
    field_.values(way, before);
    shape.values(way, opening);
    for (std::size_t i = 0; i < way.size(); ++i)
      if (before[i] > 0 && opening[i] <= 0) return false;
    const Vec3d crown = w.center - (w.shaft_radius > 0 ? w.through * (look::crown * w.half_length) : Vec3d{});
    for (double s = -look::piers; s <= look::piers + 0.5 * look::pier_step; s += look::pier_step)
      for (double z = look::roof_low; z <= look::roof_high; z += look::roof_step) {
        const Vec3d above{0, 0, w.half_height + shape.margin() + z * p_.roof};
        if (std::abs(s) < look::span)
          rock.push_back(crown + w.along() * (s * w.half_width) + above);
        else
          rock.push_back(crown + w.along() * (s * w.half_width) + Vec3d{0, 0, z * w.half_height});
      }
    if (w.shaft_radius > 0) skin(w, shape.margin(), rock);
    std::vector<float> remains(rock.size()), gone(rock.size());
    field_.values(rock, remains);
    shape.values(rock, gone);
    for (std::size_t i = 0; i < rock.size(); ++i)
      if (remains[i] <= 0 || gone[i] >= 0) return false;
    return true;
  }

  /// Places around a shaft, from the roof of its window to the ground about it, which must stay rock.
  void skin(const impl::Window& w, double margin, std::vector<Vec3d>& rock) const {
    const Vec3d axis = w.center + w.through * w.shaft_at;
    const double top = w.shaft_top - 0.5 * p_.size - look::skin_high * p_.size;
    const double around = look::skin * w.shaft_radius + margin;
    for (double z = w.half_height + margin + look::skin_low * p_.roof; z < top; z += 2 * step_)
      for (const Vec3d& d : {-w.through, w.along(), -w.along()})
        rock.push_back(axis + d * around + Vec3d{0, 0, z});
  }

  Result finish() const {
    Result result;
    result.facts.count("arches", std::ssize(windows_))
        .about("Openings through walls of rock")
        .count("bridges", std::ssize(bridges_))
        .about("Bridges of rock from one side of a hollow to the other")
        .places("positions", places_)
        .about("x, y and z of each arch or bridge in turn")
        .lengths("opening_heights", heights_)
        .about("Height of the opening of each arch or bridge")
        .count("primitives", 0);
    if (windows_.empty() && bridges_.empty()) return result;
    result.reshaped = reached_;
    result.reshape = [windows = windows_, bridges = bridges_](field::NodePtr tree) {
      if (!bridges.empty()) {
        std::vector<field::NodePtr> all = {std::move(tree)};
        all.insert(all.end(), bridges.begin(), bridges.end());
        tree = field::unite(std::move(all));
      }
      if (windows.empty()) return tree;
      return field::subtract(tree, field::unite(windows));
    };
    return result;
  }

  Ground ground_;
  Params p_;
  field::CompiledField field_;
  Progress& progress_;
  double step_;
  SpatialHash taken_;
  std::vector<field::NodePtr> windows_, bridges_;
  std::vector<Vec3d> places_;
  std::vector<double> heights_;
  Box3d reached_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "arch");
  return Arches(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "arch",
                .doc = "Arches through fins, ridges and cliff rims, natural bridges across canyons and "
                       "between given points",
                .source = "[Paris19 §5.2, §6.1, figs. 8, 23]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_arch
