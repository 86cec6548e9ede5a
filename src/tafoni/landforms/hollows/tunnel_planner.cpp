// Tunnels planned under a terrain: a raster of the lowest roofs, mouths at samples of the surface that have
// air before and rock behind them, and ways between ends as fractal legs, levelled until they can be walked;
// a few random windings are tried until one stays under the roofs and crosses no other.

#include "tafoni/landforms/hollows/tunnel_planner.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/surface.h"

namespace tafoni::landforms::impl {
namespace {

constexpr double nowhere = -1e30;

Vec3d aside(Vec3d ahead) {
  return {-ahead.y, ahead.x, 0};
}

/// Takes off the smallest bends: where a slope turns within its own width, its floor falls in steps.
void smooth(std::vector<volume::AxisPoint>& axis) {
  for (int pass = 0; pass < 4; ++pass) {
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

TunnelPlanner::TunnelPlanner(const Ground& ground, const TunnelPlannerSettings& settings, Progress& progress)
    : ground_(ground), s_(settings), field_(field::compile(ground.site().terrain)) {
  look_for_roofs();
  progress.check();
  look_for_mouths(progress);
}

/// Up from the depth, column by column, to the first air.
void TunnelPlanner::look_for_roofs() {
  const Vec3d extent = s_.area.size();
  const double step = std::max(0.8 * s_.radius, std::max(extent.x, extent.y) / 300);
  const int nx = static_cast<int>(extent.x / step) + 2, ny = static_cast<int>(extent.y / step) + 2;
  roofs_.placement = {s_.area.lo.x - 0.5 * step, s_.area.hi.y + 0.5 * step, step, step};
  roofs_.values = raster::Grid<float>(nx, ny, static_cast<float>(nowhere));
  const double low = std::max(s_.lowest, s_.area.lo.z), rise = std::max(0.5, 0.4 * s_.radius);
  const int most = static_cast<int>((s_.area.hi.z - low) / rise) + 2;
  parallel_for(ny, [&](std::int64_t row) {
    std::vector<Vec3d> line;
    std::vector<float> values;
    for (int col = 0; col < nx; ++col) {
      const Vec2d at = roofs_.placement.center(col, static_cast<int>(row));
      if (!ground_.usable({at.x, at.y, s_.area.center().z}, s_.radius)) continue;
      line.clear();
      for (int k = 0; k < most; ++k) line.push_back({at.x, at.y, low + rise * k});
      values.resize(line.size());
      field_.values(line, values);
      const auto air = std::find_if(values.begin(), values.end(), [](float v) { return v <= 0; });
      const auto solid = static_cast<double>(air - values.begin()) - 1;
      if (solid > 0) roofs_.values.at(col, static_cast<int>(row)) = static_cast<float>(low + rise * solid);
    }
  });
}

double TunnelPlanner::roof(double x, double y, double around) const {
  const raster::Placement& at = roofs_.placement;
  const Vec2d lo = at.pixel(x - around, y + around), hi = at.pixel(x + around, y - around);
  const int c0 = static_cast<int>(std::floor(lo.x)), c1 = static_cast<int>(std::ceil(hi.x));
  const int r0 = static_cast<int>(std::floor(lo.y)), r1 = static_cast<int>(std::ceil(hi.y));
  if (c0 < 0 || r0 < 0 || c1 >= roofs_.width() || r1 >= roofs_.height()) return nowhere;
  float least = 1e30f;
  for (int r = r0; r <= r1; ++r)
    for (int c = c0; c <= c1; ++c) least = std::min(least, roofs_.values.at(c, r));
  return static_cast<double>(least);
}

void TunnelPlanner::look_for_mouths(Progress& progress) {
  SurfaceSampling sampling;
  const Vec3d extent = s_.area.size();
  sampling.spacing = std::max(2 * s_.radius, std::max(extent.x, extent.y) / 60);
  sampling.box = s_.area;
  sampling.box.lo.z = std::max(sampling.box.lo.z, s_.lowest);
  sampling.seed = hash_combine(s_.seed, 1);
  sampling.accept = [&](const SurfaceSample& at) {
    return at.normal.z > 0.15f && at.normal.z < 0.94f && ground_.usable(at.position, 4 * s_.radius);
  };
  std::vector<Mouth> found;
  for (const SurfaceSample& at : sample_surface(field_, sampling, progress)) {
    const Vec3d out =
        normalized(Vec3d{static_cast<double>(at.normal.x), static_cast<double>(at.normal.y), 0});
    const Mouth mouth{at.position, -out, std::acos(static_cast<double>(at.normal.z))};
    if (good(mouth)) found.push_back(mouth);
  }
  // Hillsides before gentle slopes and cliffs; sampling has shuffled them.
  std::stable_sort(found.begin(), found.end(), [](const Mouth& a, const Mouth& b) {
    const auto merit = [](const Mouth& m) { return std::abs(m.slope - 0.75) < 0.25; };
    return merit(a) > merit(b);
  });
  mouths_ = std::move(found);
}

/// Free in front, where one comes from; a roof not far inside.
bool TunnelPlanner::good(const Mouth& m) const {
  const double r = s_.radius;
  const Vec3d axis = m.ground + Vec3d{0, 0, s_.floor * r};
  std::vector<Vec3d> air, rock;
  for (double t = 0.6; t <= 3; t += 0.4)
    for (double up : {0.0, 0.5}) air.push_back(axis - m.inward * (t * r) + Vec3d{0, 0, (up + 0.3 * t) * r});
  for (double t = 5; t <= 8; t += 1)
    for (double side : {-1.0, 0.0, 1.0})
      for (double up : {-1.0, 0.0, 1.4})
        rock.push_back(axis + m.inward * (t * r) + aside(m.inward) * (side * r) + Vec3d{0, 0, up * r});
  std::vector<float> free(air.size()), solid(rock.size());
  field_.values(air, free);
  field_.values(rock, solid);
  return std::all_of(free.begin(), free.end(), [](float v) { return v < 0; }) &&
         std::all_of(solid.begin(), solid.end(), [](float v) { return v > 0; }) &&
         ground_.usable(m.ground + m.inward * (8 * r)) && m.ground.z > s_.lowest + r;
}

WayEnd TunnelPlanner::end_of(const Mouth& m) const {
  return {m.ground - m.inward * (0.7 * s_.radius), m.inward, 5 * s_.radius, true};
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
    // Two bends to either side.
    const Vec3d d = b1 - a1;
    const Vec3d side =
        aside(normalized(Vec3d{d.x, d.y, 0})) * (Random(seed, 7).at(0) & 1 ? lengthen : -lengthen);
    stops.push_back(a1 + d * (1.0 / 3) + side);
    stops.push_back(a1 + d * (2.0 / 3) - side);
  }
  stops.push_back(b1);
  volume::TunnelSettings t;
  t.radius = r, t.swelling = s_.swelling, t.wander = s_.wander, t.floor = s_.floor;
  t.step = 0.7 * r;
  volume::Tunnel made;
  made.floor = s_.floor * r;
  const auto straight = [&](Vec3d p, Vec3d q) {
    const int n = std::max(1, static_cast<int>(length(q - p) / t.step));
    for (int i = 0; i < n; ++i) made.axis.push_back({p + (q - p) * (static_cast<double>(i) / n), r});
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
    return end.open && std::hypot(p.x - end.floor.x, p.y - end.floor.y) < 1.2 * end.straight;
  };
  const auto highest = [&](Vec3d p) {
    if (near_end(p, from) || near_end(p, to)) return 1e9;
    return roof(p.x, p.y, 1.3 * r) - s_.cover - 1.3 * r;
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
    return std::hypot(d.x, d.y) < both + 0.5 && up > 0.1 * s_.radius && up < both + 1;
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
    // Nor over itself.
    for (std::size_t j = 0; j < i && along - place[j] > 4 * s_.radius; ++j)
      if (over(a, way.axis[j])) return true;
  }
  return false;
}

std::optional<volume::Tunnel> TunnelPlanner::way(const WayEnd& from, const WayEnd& to, std::uint64_t seed,
                                                 const std::function<bool(Vec3d)>& avoid) const {
  const Vec3d d = to.floor + to.ahead * to.straight - from.floor - from.ahead * from.straight;
  const double flat = std::hypot(d.x, d.y);
  if (flat < 3 * s_.radius) return {};
  // How far aside the bends must be for the way to be long enough, and then some.
  double needed = 0;
  const auto length_of = [&](double w) { return 2 * std::hypot(flat / 3, w) + std::hypot(flat / 3, 2 * w); };
  while (length_of(needed) * s_.slope < 1.15 * std::abs(d.z) && needed < flat + 60) needed += 2;
  for (std::uint64_t i = 0; i < 10; ++i) {
    const double more = needed + (i < 3 ? 0 : 3.0 * static_cast<double>(i));
    if (auto made = attempt(from, to, hash_combine(seed, i), needed > 0 || i > 4 ? more : 0, avoid))
      return made;
  }
  return {};
}

}  // namespace tafoni::landforms::impl
