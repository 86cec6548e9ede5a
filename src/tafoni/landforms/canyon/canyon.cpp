// Canyons: rivers found by their stream power attack the walls that floods reach; rows of negative points
// follow the stress into the rock, deepest where it is soft and where the river runs against it
// [Paris19 §6.1]. The strongest rivers may run in slot canyons.

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/canyon/slot.h"
#include "tafoni/landforms/canyon/streams.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::landform_canyon {
namespace {

using impl::Ground;
using impl::Streams;

enum class Stream : std::uint64_t { walls = 0xa0, unevenness = 0xa1, cuts = 0xa2, slots = 0xa3 };

/// Chosen by eye.
namespace look {
// Defaults. A river drains this share of the terrain, and this many strips one pixel wide as long as its
// diagonal, for a plain slope sheds one.
constexpr double catchment = 0.004, plain_slopes = 4;
// The radius, metres or pixels of the terrain, whichever is more, and all else in radii.
constexpr double radius = 2.5, radius_pixels = 1.2;
constexpr double spacing = 0.6, flood = 0.8, banks = 4, height = 12, retreat = 5, slot_width = 2;

// How a flood's stress falls off upwards, beside by the square: the share that is gone at the height's end.
constexpr double upward = 0.5;
// The normal's z below which ground turns from the bed to a wall, and over how much of it.
constexpr double bed_level = 0.92, wall_rise = 0.35;
// Share of the stress that a level ceiling is spared.
constexpr double ceiling = 0.7;
// Weak rivers count for more than their share of the greatest stream power: the root of it, and so much more.
constexpr double boost = 1.15;
// A flow that comes towards a wall with the sine 1 / `turning` counts as full against it.
constexpr double turning = 2.5;

// Unevenness: waves a radius, and its strength at roughness 1.
constexpr double uneven_scale = 0.2, unevenness = 2.4;
// Where rock is felt beside a place: so many radii along the wall and into it.
constexpr double feel_aside = 1.6, feel_in = 0.8;

// Rows of points: their step in radii, how they turn from level against the wall's normal, how much of the
// depth the first point takes by itself, over how many radii the last ones weaken, and how sizes vary.
constexpr double row_step = 0.5, row_normal = 0.35, row_first = 0.2, row_end = 0.7;
constexpr double row_small = 0.9, row_large = 1.1;
// What a point takes beyond the rock's value at it, in radii, so that rows open it for sure.
constexpr double surplus = 0.4;
}  // namespace look

struct Params : impl::StreamSettings, impl::SlotSettings {
  double height = 0;
  double retreat = 0;
  double radius = 0;
  double spacing = 0;
  double undercut = 0.85;
  double bed = 0.08;
  double cutoff = 0.12;
  double roughness = 0.5;
  std::int64_t slots = 1;
  Params() { threshold = 0.05, flood = 0, banks = 0; }
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    const std::string where_slots = "where slot_depth is above 0";
    const Values with_slots = {{"slot_depth", 10.0}};
    ParamTable<Params> t;
    t.real("threshold", &Params::threshold, "", 0, 1,
           "Share of the terrain's greatest stream power from which water is a river: less adds side streams")
        .real(
            "catchment", &Params::catchment, "m2", 0, 1e12,
            "Area that a river drains at least; 0 for 0.4 % of the terrain and more than a plain slope sheds")
        .real("flood", &Params::flood, "m", 0, 500,
              "How high floods rise above the bed and cover flats beside it; 0 for 0.8 times the radius")
        .real("banks", &Params::banks, "m", 0, 5000,
              "How far from the ground that they cover floods act; 0 for four times the radius")
        .real("height", &Params::height, "m", 0, 5000,
              "How far above the bed floods act; 0 for twelve times the radius")
        .real("retreat", &Params::retreat, "m", 0, 500,
              "How deep the softest rock is cut under full stress; 0 for five times the radius")
        .real("radius", &Params::radius, "m", 0, 500,
              "Reach of one carving primitive; 0 for 2.5 m or 1.2 pixels of the terrain, whichever is more")
        .real("spacing", &Params::spacing, "m", 0, 500,
              "Least distance between places that are carved; 0 for 0.6 times the radius")
        .real("undercut", &Params::undercut, "", 0, 1,
              "How much more those walls give way that the river runs against; 0 cuts both sides alike")
        .real("bed", &Params::bed, "", 0, 1, "How much the bed itself is cut, as a share of what walls are")
        .real("beta", &Params::beta, "", 0, 1,
              "Effect of full stress on the most resistant rock; more makes walls even, less lets hard beds "
              "stand out")
        .real("cutoff", &Params::cutoff, "", 0, 1, "Erosion effect below which nothing is carved")
        .real("roughness", &Params::roughness, "", 0, 1, "Unevenness of what is carved; 0 for smooth notches")
        .real("slot_depth", &Params::slot_depth, "m", 0, 1000,
              "Depth of the slot canyons that are cut into the beds of the strongest rivers, 0 for none; the "
              "terrain needs as much rock below")
        .real("slot_width", &Params::slot_width, "m", 0, 200,
              "Width of a slot canyon; 0 for twice the radius")
        .only(where_slots, with_slots)
        .integer("slots", &Params::slots, "", 1, 100,
                 "How many rivers run in slot canyons, the strongest first")
        .only(where_slots, with_slots)
        .real("winding", &Params::winding, "", 0, 1,
              "How far the walls of slot canyons lean over; 0 for upright ones")
        .only(where_slots, with_slots);
    return t;
  }();
  return params;
}

/// The parameters with zeros replaced by what suits the terrain's pixels.
Params with_defaults(Params p, const Ground& ground) {
  const auto& heights = *ground.site().heights;
  const auto pick = [](double& value, double otherwise) { value = value > 0 ? value : otherwise; };
  const double width = heights.placement.dx * heights.width(),
               height = heights.placement.dy * heights.height();
  pick(p.catchment, std::max(look::catchment * width * height,
                             look::plain_slopes * std::hypot(width, height) * ground.pixel()));
  pick(p.radius, std::max(look::radius, look::radius_pixels * ground.pixel()));
  pick(p.spacing, look::spacing * p.radius);
  pick(p.flood, look::flood * p.radius);
  pick(p.banks, look::banks * p.radius);
  pick(p.height, look::height * p.radius);
  pick(p.retreat, look::retreat * p.radius);
  pick(p.slot_width, look::slot_width * p.radius);
  return p;
}

class CanyonWalls {
 public:
  CanyonWalls(const Site& site, const Params& p, Progress& progress)
      : ground_(site), p_(with_defaults(p, ground_)), progress_(progress) {}

  Result run() {
    Result result;
    if (ground_.box().empty()) return report(std::move(result), 0);
    const Streams streams(ground_, p_, progress_);
    streams_ = &streams;
    if (streams.cells() > 0) {
      if (p_.slot_depth > 0) add(slots(), result);
      add(walls(), result);
    }
    return report(std::move(result), streams.cells());
  }

 private:
  void add(field::NodePtr node, Result& result) {
    if (node) result.nodes.push_back(std::move(node));
  }

  static Vec3d horizontal(Vec3f normal) {
    return normalized(Vec3d{to_double(normal).x, to_double(normal).y, 0});
  }

  /// The stress sigma of the flood: it falls off upwards and is more where the river runs against the wall.
  double stress(const SurfaceSample& at) const {
    const Streams::Bank bank = streams_->at(at.position);
    if (!(bank.stress > 0)) return 0;
    const double above = (at.position.z - bank.bed) / p_.height;
    if (above >= 1) return 0;
    const double low = above > 0 ? (1 - above * above) * (1 - look::upward * above) : 1;
    const double nz = at.normal.z;
    const double wall =
        smoothstep(0.0, look::wall_rise, look::bed_level - nz) * (nz < 0 ? 1 + look::ceiling * nz : 1);
    const double flood = std::min(1.0, look::boost * std::sqrt(bank.stress)) * low;
    // The effect is never above the stress, so that what cannot reach the cutoff need not be looked at
    // closer.
    if (flood * (p_.bed + (1 - p_.bed) * wall) < p_.cutoff) return 0;
    return flood * (p_.bed + (1 - p_.bed) * wall * against(at, bank)) * ground_.weight(at.position);
  }

  /// 1 where the water comes towards the wall, 1 - undercut where it leaves it. What counts is the flow a
  /// little upstream: beside the wall it has already turned.
  double against(const SurfaceSample& at, const Streams::Bank& bank) const {
    const Vec3d back{-bank.flow.x, -bank.flow.y, 0};
    const Streams::Bank before = streams_->at(at.position + back * p_.banks);
    const Vec2d flow = before.stress > 0 ? before.flow : bank.flow;
    const Vec3d wall = horizontal(at.normal);
    const double into = -(flow.x * wall.x + flow.y * wall.y);
    return 1 - p_.undercut * (0.5 - 0.5 * std::clamp(look::turning * into, -1.0, 1.0));
  }

  /// A factor for each place. It is smooth over several primitives, or neighbours would bore holes of their
  /// own instead of one notch.
  std::vector<float> unevenness(const std::vector<SurfaceSample>& places) const {
    std::vector<Vec3d> scaled(places.size());
    for (std::size_t i = 0; i < places.size(); ++i)
      scaled[i] = (places[i].position + ground_.site().origin) * (look::uneven_scale / p_.radius);
    std::vector<float> out(places.size());
    fbm(scaled, 2, hash_combine(ground_.site().seed, Stream::unevenness), out);
    const auto strength = static_cast<float>(look::unevenness * p_.roughness);
    for (float& t : out) t = std::max(0.0f, 1 + strength * (t - 0.5f));
    return out;
  }

  /// The resistance rho of each place, averaged along the bed for the same reason.
  std::vector<float> resistances(const std::vector<SurfaceSample>& places) const {
    std::vector<float> out(places.size(), 0.5f);
    if (!ground_.site().geology) return out;
    std::vector<Vec3d> points;
    points.reserve(3 * places.size());
    for (const SurfaceSample& at : places) {
      const Vec3d wall = horizontal(at.normal);
      const Vec3d aside = Vec3d{-wall.y, wall.x, 0} * (look::feel_aside * p_.radius),
                  in = wall * (-look::feel_in * p_.radius);
      points.insert(points.end(), {at.position, at.position + in + aside, at.position + in - aside});
    }
    std::vector<float> rho(points.size());
    ground_.site().geology->resistances(points, rho);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] = (rho[3 * i] + rho[3 * i + 1] + rho[3 * i + 2]) / 3;
    return out;
  }

  struct Attack {
    SurfaceSample at;
    double effect;
  };

  std::vector<Attack> attacks() {
    SurfaceSampling sampling;
    sampling.spacing = p_.spacing;
    sampling.box = ground_.box();
    sampling.seed = hash_combine(ground_.site().seed, Stream::walls);
    sampling.maybe = [this](Vec3d p, double around) { return streams_->near(p, around, p_.height); };
    // The effect is never above the stress.
    sampling.accept = [this](const SurfaceSample& at) {
      return stress(at) >= std::max(p_.cutoff, 1e-6) && ground_.usable(at.position);
    };
    const auto field = field::compile(ground_.site().terrain);
    const auto points = sample_surface(field, sampling, progress_);
    const auto rho = resistances(points), uneven = unevenness(points);
    std::vector<Attack> attacks;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double e = erosion_effect(rho[i], stress(points[i]), p_.beta);
      if (e >= p_.cutoff && uneven[i] > 0) attacks.push_back({points[i], e * uneven[i]});
    }
    return attacks;
  }

  struct Cut {
    Vec3d center, behind;
    double radius;
    double share;  ///< of what it takes to open the rock behind too
  };

  /// Each place is cut by a row of points that leads into the rock, mostly level: rivers undercut.
  std::vector<Cut> cuts() {
    std::vector<Cut> out;
    Random random(ground_.site().seed, Stream::cuts);
    const double step = look::row_step * p_.radius;
    for (const Attack& a : attacks()) {
      strongest_ = std::max(strongest_, a.effect);
      const Vec3d inward =
          normalized(horizontal(a.at.normal) * -1.0 - to_double(a.at.normal) * look::row_normal);
      const double depth = p_.retreat * a.effect;
      const int row = 1 + floor_to(std::max(0.0, depth - look::row_first * p_.radius) / step);
      for (int k = 0; k < row; ++k) {
        const Vec3d center = a.at.position + inward * (k * step);
        if (!ground_.usable(center)) break;
        out.push_back({center, center + inward * step,
                       p_.radius * random.uniform(look::row_small, look::row_large),
                       std::clamp((depth - k * step) / (look::row_end * p_.radius), 0.0, 1.0)});
      }
    }
    return out;
  }

  /// Together the points of a place take away what rock there is. Behind a wall's face that is soon all the
  /// terrain's amplitude, however near the face.
  field::NodePtr walls() {
    const auto all = cuts();
    std::vector<Vec3d> probes;
    for (const Cut& cut : all) probes.insert(probes.end(), {cut.center, cut.behind});
    std::vector<float> rock(probes.size());
    field::compile(ground_.site().terrain).values(probes, rock);
    // Points of one wall's rows add to one another.
    const double together = overlap_of_darts(p_.radius, p_.spacing);
    field::CloudBuilder cloud{field::CloudSettings{}};
    for (std::size_t i = 0; i < all.size(); ++i)
      add_point(cloud, all[i].center, all[i].radius,
                -energy(all[i], rock[2 * i], rock[2 * i + 1]) / together);
    primitives_ += cloud.size();
    return cloud.size() > 0 ? cloud.finish() : nullptr;
  }

  double energy(const Cut& cut, float here, float behind) const {
    const double most = std::max({0.0, double{here}, double{behind}});
    return cut.share * (most + look::surplus * p_.radius);
  }

  field::NodePtr slots() {
    field::CloudBuilder cloud{field::CloudSettings{}};
    impl::SlotSettings settings = p_;
    settings.seed = hash_combine(ground_.site().seed, Stream::slots);
    for (const Streams::Course& course : streams_->courses(p_.slots))
      slot_length_ += carve_slot(cloud, ground_, course, settings);
    primitives_ += cloud.size();
    return cloud.size() > 0 ? cloud.finish() : nullptr;
  }

  Result report(Result result, std::size_t cells) const {
    const double pixel = ground_.site().heights->placement.dx * ground_.site().heights->placement.dy;
    result.facts.count("primitives", primitives_)
        .area("river_bed", static_cast<double>(cells) * pixel)
        .about("Area of the pixels that the river flows over")
        .number("strongest_effect", strongest_)
        .about("Greatest erosion anywhere, from 0 for none to 1 for all that the parameters allow")
        .length("slot_length", slot_length_)
        .about("Length of the slots along the river");
    return result;
  }

  Ground ground_;
  Params p_;
  Progress& progress_;
  const Streams* streams_ = nullptr;
  std::int64_t primitives_ = 0;
  double strongest_ = 0, slot_length_ = 0;
};

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "canyon");
  return CanyonWalls(site, p, progress).run();
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "canyon",
                .doc = "Walls that rivers undercut, most at outer bends and in soft beds, and slot canyons",
                .source = "[Paris19 §6.1]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_canyon
