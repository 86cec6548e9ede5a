#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/karst/passages.h"
#include "tafoni/landforms/karst/percolation.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/angle.h"
#include "tafoni/terrain/analysis.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;

struct Params {
  double radius = 0;
  double spacing = 0;
  std::int64_t sinks = 8;
  std::int64_t faces = 6;
  double sink_depth = 0.3;
  double face_slope = 30;
  double passage = 500;
  double depth = 80;
  double base_level = -12000;
  double resistance = 0.75;
  double epsilon = 0.1;
  std::int64_t directions = 6;
  double steepness = 0.35;
  double cover = 1.2;
  double beta = 0.2;
  double threshold = 0.12;
  double roughness = 0.5;
  double winding = 0.5;
  double chambers = 0.5;
  std::vector<double> springs;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.real("radius", &Params::radius, "m", 0, 200,
           "half the width of a middling passage, 0 for half a pixel of the terrain but 2.5 m at least")
        .real("spacing", &Params::spacing, "m", 0, 2000,
              "radius of the Poisson spheres that keep passages apart, 0 for five times the radius")
        .integer(
            "sinks", &Params::sinks, "", 0, 10000,
            "most entrances in closed depressions or, where there are too few, in the softest gentle ground")
        .integer("faces", &Params::faces, "", 0, 10000, "most entrances in cliff faces")
        .real("sink_depth", &Params::sink_depth, "m", 0, 1000,
              "depressions shallower than this swallow no water")
        .real("face_slope", &Params::face_slope, "deg", 5, 89,
              "slope from which ground counts as a cliff face")
        .real("passage", &Params::passage, "m", 10, 1e6, "about the length of passage that one seed may grow")
        .real("depth", &Params::depth, "m", 1, 5000, "how far caves go down below their seed")
        .real("base_level", &Params::base_level, "m", -12000, 10000,
              "elevation below which there are no caves")
        .real("resistance", &Params::resistance, "", 0, 1,
              "rho_0: rock as hard as this or harder is not carved")
        .real("epsilon", &Params::epsilon, "", 0, 1, "range of chance in what rock gives way next")
        .integer("directions", &Params::directions, "", 1, 64, "ways on that are tried around a carved point")
        .real("steepness", &Params::steepness, "", 0, 1,
              "how steeply water seeks its way, 1 for all directions of the lower hemisphere alike")
        .real("cover", &Params::cover, "", 0, 20, "rock left over passages, as a multiple of their radius")
        .real("beta", &Params::beta, "", 0, 1, "effect of full stress on the most resistant rock")
        .real("threshold", &Params::threshold, "", 0, 1,
              "dead ends with a smaller erosion effect are left out")
        .real("roughness", &Params::roughness, "", 0, 1, "unevenness of the walls")
        .real("winding", &Params::winding, "", 0, 1, "how far passages wind off the straight line")
        .real("chambers", &Params::chambers, "", 0, 1,
              "how often rooms break out where ways meet or the rock is weak, 0 for none")
        .numbers("springs", &Params::springs, "m", 0, -1e8, 1e8,
                 "x, y, z of each place where the water shall come to light again");
    return t;
  }();
  return params;
}

class Karst {
 public:
  Karst(const Site& site, const Params& p, Progress& progress)
      : p_(p), ground_(site), field_(field::compile(site.terrain)), progress_(progress) {
    radius_ = p.radius > 0 ? p.radius : std::max(2.5, 0.5 * ground_.pixel());
    spacing_ = p.spacing > 0 ? p.spacing : 5 * radius_;
    const auto& heights = site.heights->values.values();
    lowest_ = *std::min_element(heights.begin(), heights.end());
  }

  Result run() {
    if (ground_.box().empty()) return report({}, {}, {});
    const std::vector<Vec3d> start = seeds();
    impl::PercolationSettings water;
    water.spacing = spacing_;
    water.epsilon = p_.epsilon;
    water.threshold = p_.resistance;
    water.directions = static_cast<int>(p_.directions);
    water.steepness = p_.steepness;
    // The tube reaches its radius above the axis, its unevenness and winding somewhat more.
    water.cover = (p_.cover + 1.6) * radius_;
    water.depth = p_.depth;
    water.base_z = std::max(p_.base_level - ground_.site().origin.z, lowest_ + 1.2 * radius_);
    water.face_z = std::cos(0.8 * p_.face_slope * degree);
    water.points_per_seed = static_cast<std::size_t>(std::max(2.0, p_.passage / (1.2 * spacing_)));
    water.seed = ground_.site().seed;
    const auto percolation = impl::percolate(field_, ground_, start, springs(), water, progress_);
    return carve(percolation);
  }

 private:
  /// The user's points, then sinks, then faces.
  std::vector<Vec3d> seeds() {
    std::vector<Vec3d> all;
    for (Vec3d p : ground_.site().points) {
      if (field_.value(p) < 0) p = below(p);
      if (ground_.usable(p)) all.push_back(p);
    }
    SpatialHash apart(6 * spacing_);
    for (Vec3d p : all) apart.insert(p);
    if (p_.sinks > 0 || p_.faces > 0) survey();
    if (p_.sinks > 0) add_apart(sinks(), static_cast<std::size_t>(p_.sinks), apart, all);
    if (p_.faces > 0) add_apart(faces(), static_cast<std::size_t>(p_.faces), apart, all);
    return all;
  }

  std::vector<Vec3d> springs() const {
    if (p_.springs.size() % 3 != 0)
      fail(ErrorKind::usage,
           "karst: springs needs x, y and z for each spring, so a multiple of three numbers");
    std::vector<Vec3d> all;
    for (std::size_t i = 0; i + 2 < p_.springs.size(); i += 3) {
      const Vec3d p =
          on_surface(Vec3d{p_.springs[i], p_.springs[i + 1], p_.springs[i + 2]} - ground_.site().origin);
      if (ground_.usable(p)) all.push_back(p);
    }
    return all;
  }

  /// The first rock under a place in the air; the place itself when there is none.
  Vec3d below(Vec3d p) const {
    for (Vec3d q = p; q.z > ground_.box().lo.z; q.z -= 0.5 * radius_)
      if (field_.value(q) > 0) return on_surface(q);
    return p;
  }

  void add_apart(const std::vector<Vec3d>& wanted, std::size_t most, SpatialHash& apart,
                 std::vector<Vec3d>& all) {
    std::size_t added = 0;
    for (std::size_t i = 0; i < wanted.size() && added < most; ++i) {
      if (apart.any_near(wanted[i], 3 * spacing_)) continue;
      apart.insert(wanted[i]);
      all.push_back(wanted[i]);
      ++added;
    }
  }

  /// Closed depressions, the largest first, then the softest places of gentle ground in the upper half.
  std::vector<Vec3d> sinks() {
    const raster::Raster& heights = *ground_.site().heights;
    auto found = terrain::sinks(heights, {p_.sink_depth, 4 * ground_.pixel() * ground_.pixel()}, progress_);
    std::stable_sort(found.begin(), found.end(),
                     [](const terrain::Sink& a, const terrain::Sink& b) { return a.volume > b.volume; });
    std::vector<Vec3d> points;
    for (const terrain::Sink& sink : found) {
      const Vec2d at = heights.placement.center(sink.col, sink.row);
      const Vec3d p{at.x, at.y, sink.elevation};
      if (high(p) && ground_.usable(p, spacing_)) points.push_back(on_surface(p));
    }
    const auto gentle = soft_ground();
    points.insert(points.end(), gentle.begin(), gentle.end());
    return points;
  }

  /// Room below to descend into.
  bool high(Vec3d p) const {
    return p.z > std::max(lowest_, p_.base_level - ground_.site().origin.z) + 5 * radius_;
  }

  Vec3d on_surface(Vec3d p) const {
    for (int i = 0; i < 6; ++i) {
      float value = 0;
      Vec3f gradient;
      field_.gradients({&p, 1}, {&value, 1}, {&gradient, 1});
      const double slope = std::min(-0.2, static_cast<double>(gradient.z));
      p.z -= static_cast<double>(value) / slope;
    }
    return p;
  }

  /// Gentle ground and faces of the whole surface, wherever it is: a sparse choice is enough.
  void survey() {
    const Vec3d size = ground_.box().size();
    SurfaceSampling sampling;
    sampling.spacing =
        std::clamp(std::max(size.x, size.y) / 150, 0.5 * spacing_, std::max(1.5 * spacing_, 1e-3));
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, 0xface);
    sampling.accept = [&](const SurfacePoint& at) {
      return at.normal.z > -0.3f && high(at.position) && ground_.usable(at.position, spacing_);
    };
    surface_ = sample_surface(field_, sampling, progress_);
  }

  std::vector<Vec3d> soft_ground() const {
    std::vector<std::pair<double, Vec3d>> places;
    for (const SurfacePoint& at : surface_)
      if (at.normal.z > 0.93f && deep(at.position))
        places.emplace_back(ground_.resistance(at.position - Vec3d{0, 0, 3 * radius_}), at.position);
    return softest(std::move(places));
  }

  bool deep(Vec3d p) const {
    for (double t : {0.5, 1.0, 1.5})
      if (field_.value(p - Vec3d{0, 0, t * spacing_}) <= 0) return false;
    return true;
  }

  std::vector<Vec3d> faces() const {
    const auto steep = static_cast<float>(std::cos(p_.face_slope * degree));
    std::vector<std::pair<double, Vec3d>> places;
    for (const SurfacePoint& at : surface_)
      if (at.normal.z < steep && thick(at))
        places.emplace_back(ground_.resistance(at.position - to_double(at.normal) * (2 * radius_)),
                            at.position);
    return softest(std::move(places));
  }

  /// Rock enough behind a face for a cave, not a fin or a pillar.
  bool thick(const SurfacePoint& at) const {
    const Vec3d inward = normalized(Vec3d{-to_double(at.normal).x, -to_double(at.normal).y, -0.1});
    const Vec3d aside = Vec3d{-inward.y, inward.x, 0} * (3 * radius_);
    for (double t : {0.25, 0.6, 1.0, 1.5, 2.0}) {
      const Vec3d p = at.position + inward * (t * spacing_);
      if (field_.value(p) <= 0) return false;
      if (t >= 1 && (field_.value(p + aside) <= 0 || field_.value(p - aside) <= 0)) return false;
    }
    return true;
  }

  static std::vector<Vec3d> softest(std::vector<std::pair<double, Vec3d>> places) {
    std::stable_sort(places.begin(), places.end(),
                     [](const auto& a, const auto& b) { return a.first < b.first; });
    std::vector<Vec3d> points;
    for (const auto& place : places) points.push_back(place.second);
    return points;
  }

  Result carve(const impl::Percolation& percolation) {
    impl::PassageSettings shape;
    shape.radius = radius_;
    shape.spacing = spacing_;
    shape.beta = p_.beta;
    shape.threshold = p_.threshold;
    shape.roughness = p_.roughness;
    shape.winding = p_.winding;
    shape.chambers = p_.chambers;
    shape.seed = hash_combine(ground_.site().seed, 0x5e);
    const auto caves = impl::make_passages(field_, ground_, percolation, shape);
    const field::NodePtr node = impl::carve_passages(caves, ground_, shape);
    if (!node) return report({}, {}, {});
    const auto carved = field::compile(field::blend({ground_.site().terrain, node}));
    return report(node, caves, impl::open_networks(carved, caves));
  }

  Result report(field::NodePtr node, const impl::CaveSystem& caves, const std::vector<bool>& open) const {
    Result result;
    std::vector<double> entrances;
    double deepest = 0;
    for (Vec3d p : caves.entrances)
      for (double v :
           {p.x + ground_.site().origin.x, p.y + ground_.site().origin.y, p.z + ground_.site().origin.z})
        entrances.push_back(v);
    for (const impl::Passage& passage : caves.passages)
      for (Vec3d p : passage.line) deepest = std::max(deepest, ground_.height(p.x, p.y) - p.z);
    const auto connected = std::count(open.begin(), open.end(), true);
    result.report = {
        {"entrances", static_cast<std::int64_t>(caves.entrances.size())},
        {"entrance_positions", entrances},
        {"chambers", static_cast<std::int64_t>(caves.chambers.size())},
        {"passage_length_m", caves.length},
        {"networks", static_cast<std::int64_t>(caves.networks)},
        {"connected_networks", static_cast<std::int64_t>(connected)},
        {"primitives", node ? static_cast<std::int64_t>(field::stats(node).primitives) : std::int64_t{0}},
        {"greatest_depth_m", deepest},
    };
    if (node) result.nodes.push_back(std::move(node));
    return result;
  }

  const Params& p_;
  Ground ground_;
  field::CompiledField field_;
  Progress& progress_;
  double radius_, spacing_, lowest_;
  std::vector<SurfacePoint> surface_;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "karst");
  return Karst(site, p, progress).run();
}

}  // namespace

const LandformType& landform_karst() {
  static const LandformType type{
      .about = {.name = "karst",
                .doc = "Caves that water opens through soft rock, with sinkholes above and exits in cliffs",
                .source = "[Paris19 §6.2]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
