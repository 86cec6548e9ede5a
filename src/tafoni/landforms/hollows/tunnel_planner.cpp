// Tunnels planned under a terrain: a raster of the lowest roofs, mouths at samples of the surface that have
// air before and rock behind them, and ways between ends as fractal legs, levelled until they can be walked;
// a few random windings are tried until one stays under the roofs and crosses no other.

#include "tafoni/landforms/hollows/tunnel_planner.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/surface.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

constexpr double nowhere = -1e30;

enum class TunnelPlannerStream : std::uint64_t { mouths = 1, side = 7 };

/// Chosen by eye; lengths are in radii of the tunnels where nothing else is said.
namespace tunnel_planner_look {
// From point to point of a tunnel's axis.
constexpr double step = 0.7;
// Passes that take off an axis's smallest bends.
constexpr int smoothing = 4;
// The raster of roofs: its pixels, at most so many across the area; from sample to sample upwards, metres at
// least.
constexpr double roof_pixel = 0.8, roofs_across = 300, roof_rise = 0.4, least_rise = 0.5;
// Mouths are sought so far apart, at most so many across the area, on slopes whose normal's z is between
// these (neither ceilings nor flats), so far off the terrain's border.
constexpr double mouth_spacing = 2, mouths_across = 60, border = 4;
constexpr float steepest = 0.15f, flattest = 0.94f;
// Hillsides that slope by so many radians, more or less, come before gentle slopes and cliffs.
constexpr double hillside = 0.75, hillside_range = 0.25;
// Before a mouth there must be air from and up to so far, in a wedge that opens upwards; behind it rock.
constexpr double air_from = 0.6, air_to = 3, air_step = 0.4, air_rise = 0.3;
constexpr double rock_from = 5, rock_to = 8;
// A tunnel begins so far before the ground, and goes straight in from there.
constexpr double porch = 0.7, straight = 5;
// Within so many straights of an open end a tunnel need have no roof.
constexpr double roofless = 1.2;
// A tunnel's reach, with what it swells: its roof is looked for so far around and above.
constexpr double reach = 1.3;
// Tunnels whose axes differ in height by less meet on a level, which is welcome; those that cross in plan
// must be metres more than both radii apart.
constexpr double level = 0.1, apart = 0.5, rock_between = 1;
// A way meets itself only where so much of it lies between.
constexpr double own_way = 4;
// The shortest way, and how much longer than needed for the slope it is planned, in shares.
constexpr double least_way = 3, longer = 1.15;
// Bends go aside in steps of metres until the way is long enough, at most so many metres beyond its length.
constexpr double bend_step = 2, bend_most = 60;
// Attempts at a way; from the fourth on they bend metres farther aside each, from the sixth on all bend.
constexpr std::uint64_t attempts = 10, as_needed = 3, all_bend = 4;
constexpr double bend_more = 3;
}  // namespace tunnel_planner_look

Vec3d aside(Vec3d ahead) {
  return {-ahead.y, ahead.x, 0};
}

/// Takes off the smallest bends: where a slope turns within its own width, its floor falls in steps.
void smooth(std::vector<volume::AxisPoint>& axis) {
  for (int pass = 0; pass < tunnel_planner_look::smoothing; ++pass) {
    volume::AxisPoint before = axis.front();
    for (std::size_t i = 1; i + 1 < axis.size(); ++i) {
      const volume::AxisPoint own = axis[i];
      axis[i].position = 0.25 * before.position + 0.5 * own.position + 0.25 * axis[i + 1].position;
      axis[i].radius = 0.25 * before.radius + 0.5 * own.radius + 0.25 * axis[i + 1].radius;
      before = own;
    }
  }
}

}  // namespace

volume::TunnelSettings tunnel_settings(const TunnelParams& params) {
  volume::TunnelSettings s;
  s.radius = params.radius, s.swelling = params.swelling, s.wander = params.wander, s.floor = params.floor;
  s.step = tunnel_planner_look::step * params.radius;
  return s;
}

TunnelPlanner::TunnelPlanner(const Ground& ground, const TunnelPlannerSettings& settings, Progress& progress)
    : ground_(ground), s_(settings), field_(field::compile(ground.site().terrain)) {
  look_for_roofs();
  progress.check();
  look_for_mouths(progress);
}

/// Goes up from the depth, column by column, to the first air.
void TunnelPlanner::look_for_roofs() {
  const Vec3d extent = s_.area.size();
  const double step = std::max(tunnel_planner_look::roof_pixel * s_.radius,
                               std::max(extent.x, extent.y) / tunnel_planner_look::roofs_across);
  const int nx = floor_to(extent.x / step) + 2, ny = floor_to(extent.y / step) + 2;
  roofs_.placement = {s_.area.lo.x - 0.5 * step, s_.area.hi.y + 0.5 * step, step, step};
  roofs_.values = raster::Grid<float>(nx, ny, static_cast<float>(nowhere));
  const double low = std::max(s_.lowest, s_.area.lo.z),
               rise = std::max(tunnel_planner_look::least_rise, tunnel_planner_look::roof_rise * s_.radius);
  const int most = floor_to((s_.area.hi.z - low) / rise) + 2;
  parallel_for(ny, [&](int row) {
    std::vector<Vec3d> line;
    std::vector<float> values;
    for (int col = 0; col < nx; ++col) {
      const Vec2d at = roofs_.placement.center(col, row);
      if (!ground_.usable({at.x, at.y, s_.area.center().z}, s_.radius)) continue;
      line.clear();
      for (int k = 0; k < most; ++k) line.push_back({at.x, at.y, low + rise * k});
      values.resize(line.size());
      field_.values(line, values);
      const auto air = std::find_if(values.begin(), values.end(), [](float v) { return v <= 0; });
      const auto solid = static_cast<double>(air - values.begin()) - 1;
      if (solid > 0) roofs_.values.at(col, row) = static_cast<float>(low + rise * solid);
    }
  });
}

double TunnelPlanner::roof(double x, double y, double around) const {
  const raster::Placement& at = roofs_.placement;
  const Vec2d lo = at.pixel(x - around, y + around), hi = at.pixel(x + around, y - around);
  const int c0 = floor_to(lo.x), c1 = ceil_to(hi.x);
  const int r0 = floor_to(lo.y), r1 = ceil_to(hi.y);
  if (c0 < 0 || r0 < 0 || c1 >= roofs_.width() || r1 >= roofs_.height()) return nowhere;
  float least = 1e30f;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c) least = std::min(least, roofs_.values.at(c, r));
  return least;
}

void TunnelPlanner::look_for_mouths(Progress& progress) {
  SurfaceSampling sampling;
  const Vec3d extent = s_.area.size();
  sampling.spacing = std::max(tunnel_planner_look::mouth_spacing * s_.radius,
                              std::max(extent.x, extent.y) / tunnel_planner_look::mouths_across);
  sampling.box = s_.area;
  sampling.box.lo.z = std::max(sampling.box.lo.z, s_.lowest);
  sampling.seed = hash_combine(s_.seed, TunnelPlannerStream::mouths);
  sampling.accept = [&](const SurfaceSample& at) {
    return at.normal.z > tunnel_planner_look::steepest && at.normal.z < tunnel_planner_look::flattest &&
           ground_.usable(at.position, tunnel_planner_look::border * s_.radius);
  };
  std::vector<Mouth> found;
  for (const SurfaceSample& at : sample_surface(field_, sampling, progress)) {
    const Vec3d out = normalized(Vec3d{at.normal.x, at.normal.y, 0});
    const Mouth mouth{at.position, -out, std::acos(double{at.normal.z})};
    if (good(mouth)) found.push_back(mouth);
  }
  // Hillsides before gentle slopes and cliffs; sampling has shuffled them.
  std::stable_sort(found.begin(), found.end(), [](const Mouth& a, const Mouth& b) {
    const auto merit = [](const Mouth& m) {
      return std::abs(m.slope - tunnel_planner_look::hillside) < tunnel_planner_look::hillside_range;
    };
    return merit(a) > merit(b);
  });
  mouths_ = std::move(found);
}

/// Whether it is free in front, where one comes from, and has a roof not far inside.
bool TunnelPlanner::good(const Mouth& m) const {
  const double r = s_.radius;
  const Vec3d axis = m.ground + Vec3d{0, 0, s_.floor * r};
  std::vector<Vec3d> air, rock;
  for (double t = tunnel_planner_look::air_from; t <= tunnel_planner_look::air_to;
       t += tunnel_planner_look::air_step)
    for (double up : {0.0, 0.5})
      air.push_back(axis - m.inward * (t * r) + Vec3d{0, 0, (up + tunnel_planner_look::air_rise * t) * r});
  for (double t = tunnel_planner_look::rock_from; t <= tunnel_planner_look::rock_to; t += 1)
    for (double side : {-1.0, 0.0, 1.0})
      for (double up : {-1.0, 0.0, 1.4})
        rock.push_back(axis + m.inward * (t * r) + aside(m.inward) * (side * r) + Vec3d{0, 0, up * r});
  std::vector<float> free(air.size()), solid(rock.size());
  field_.values(air, free);
  field_.values(rock, solid);
  return std::all_of(free.begin(), free.end(), [](float v) { return v < 0; }) &&
         std::all_of(solid.begin(), solid.end(), [](float v) { return v > 0; }) &&
         ground_.usable(m.ground + m.inward * (tunnel_planner_look::rock_to * r)) &&
         m.ground.z > s_.lowest + r;
}

WayEnd TunnelPlanner::end_of(const Mouth& m) const {
  return {m.ground - m.inward * (tunnel_planner_look::porch * s_.radius), m.inward,
          tunnel_planner_look::straight * s_.radius, true};
}

std::optional<volume::Tunnel> TunnelPlanner::attempt(const WayEnd& from, const WayEnd& to, std::uint64_t seed,
                                                     double lengthen,
                                                     const std::function<bool(Vec3d)>& avoid) const {
  const double r = s_.radius;
  const Vec3d up{0, 0, s_.floor * r};
  const Vec3d a = from.floor + up, b = to.floor + up;
  const Vec3d a1 = a + from.ahead * from.straight, b1 = b + to.ahead * to.straight;
  std::vector<Vec3d> stops = {a1};
  if (lengthen > 0) {
    // It bends to one side and then to the other.
    const Vec3d d = b1 - a1;
    const Vec3d side = aside(normalized(Vec3d{d.x, d.y, 0})) *
                       (Random(seed, TunnelPlannerStream::side).at(0) & 1 ? lengthen : -lengthen);
    stops.push_back(a1 + d * (1.0 / 3) + side);
    stops.push_back(a1 + d * (2.0 / 3) - side);
  }
  stops.push_back(b1);
  volume::TunnelSettings t = tunnel_settings(s_);
  volume::Tunnel made;
  made.floor = s_.floor * r;
  const auto straight = [&](Vec3d p, Vec3d q) {
    const int n = std::max(1, floor_to(length(q - p) / t.step));
    for (int i = 0; i < n; ++i) made.axis.push_back({p + (q - p) * (1.0 * i / n), r});
  };
  straight(a, a1);
  for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
    t.seed = hash_combine(seed, i);
    const volume::Tunnel leg = volume::fractal_tunnel(stops[i], stops[i + 1], t);
    made.axis.insert(made.axis.end(), leg.axis.begin(), leg.axis.end() - 1);
  }
  straight(b1, b);
  made.axis.push_back({b, r});
  smooth(made.axis);
  const auto near_end = [&](Vec3d p, const WayEnd& end) {
    return end.open &&
           std::hypot(p.x - end.floor.x, p.y - end.floor.y) < tunnel_planner_look::roofless * end.straight;
  };
  const auto highest = [&](Vec3d p) {
    if (near_end(p, from) || near_end(p, to)) return 1e9;
    return roof(p.x, p.y, tunnel_planner_look::reach * r) - s_.cover - tunnel_planner_look::reach * r;
  };
  if (!volume::level_axis(made.axis, s_.slope, highest)) return {};
  for (const volume::AxisPoint& p : made.axis) {
    if (p.position.z - r < s_.lowest || !ground_.usable(p.position)) return {};
    if (avoid && avoid(p.position)) return {};
  }
  if (crosses(made, from, to)) return {};
  return made;
}

void TunnelPlanner::keep_off(const volume::Tunnel& dug) {
  dug_.insert(dug_.end(), dug.axis.begin(), dug.axis.end());
}

bool TunnelPlanner::crosses(const volume::Tunnel& way, const WayEnd& from, const WayEnd& to) const {
  const auto at_end = [&](Vec3d p) {
    for (const WayEnd* end : {&from, &to})
      if (std::hypot(p.x - end->floor.x, p.y - end->floor.y) < end->straight) return true;
    return false;
  };
  // Level crossings are welcome.
  const auto over = [&](const volume::AxisPoint& a, const volume::AxisPoint& b) {
    const Vec3d d = a.position - b.position;
    const double both = a.radius + b.radius, up = std::abs(d.z);
    return std::hypot(d.x, d.y) < both + tunnel_planner_look::apart &&
           up > tunnel_planner_look::level * s_.radius && up < both + tunnel_planner_look::rock_between;
  };
  double along = 0;
  std::vector<double> place;
  for (std::size_t i = 0; i < way.axis.size(); ++i) {
    const volume::AxisPoint& a = way.axis[i];
    if (i > 0) along += length(a.position - way.axis[i - 1].position);
    place.push_back(along);
    if (!at_end(a.position) &&
        std::any_of(dug_.begin(), dug_.end(), [&](const auto& b) { return over(a, b); }))
      return true;
    // Nor does a way cross itself.
    for (std::size_t j = 0; j < i && along - place[j] > tunnel_planner_look::own_way * s_.radius; ++j)
      if (over(a, way.axis[j])) return true;
  }
  return false;
}

std::optional<volume::Tunnel> TunnelPlanner::way(const WayEnd& from, const WayEnd& to, std::uint64_t seed,
                                                 const std::function<bool(Vec3d)>& avoid) const {
  const Vec3d d = to.floor + to.ahead * to.straight - from.floor - from.ahead * from.straight;
  const double flat = std::hypot(d.x, d.y);
  if (flat < tunnel_planner_look::least_way * s_.radius) return {};
  // How far aside the bends must be for the way to be long enough, and then some.
  double needed = 0;
  const auto length_of = [&](double w) { return 2 * std::hypot(flat / 3, w) + std::hypot(flat / 3, 2 * w); };
  while (length_of(needed) * s_.slope < tunnel_planner_look::longer * std::abs(d.z) &&
         needed < flat + tunnel_planner_look::bend_most)
    needed += tunnel_planner_look::bend_step;
  for (std::uint64_t i = 0; i < tunnel_planner_look::attempts; ++i) {
    const double more =
        needed +
        (i < tunnel_planner_look::as_needed ? 0 : tunnel_planner_look::bend_more * static_cast<double>(i));
    if (auto made = attempt(from, to, hash_combine(seed, i),
                            needed > 0 || i > tunnel_planner_look::all_bend ? more : 0, avoid))
      return made;
  }
  return {};
}

}  // namespace tafoni::landforms::impl
