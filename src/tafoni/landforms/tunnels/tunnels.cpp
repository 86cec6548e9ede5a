// Fractal tunnels [Ju01 §3]: between ends that the user gives, or through hills from mouth to mouth; all are
// carved into one volume.

#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/hollows/hollow.h"
#include "tafoni/landforms/hollows/tunnel_planner.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/table_rows.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::landform_tunnels {
namespace {

using impl::Ground;

/// Chosen by eye; lengths are in radii of the tunnels.
namespace look {
// Two mouths make a tunnel where they are so far apart and look away from each other, out of a hill that they
// have on both sides, by at least this cosine.
constexpr double least_length = 12, through_hill = 0.5;
// So many pairs of mouths are tried in all.
constexpr int tries = 4000;
// Mouths so near to one that is in use stay shut; farther off where a tunnel has no other end.
constexpr double apart = 6, apart_blind = 12;
// How far a tunnel goes into a slope that it does not come out of.
constexpr double blind = 20;
// Longest tunnel whose ends are given: its axis is one of points.
constexpr double longest = 1e6;
}  // namespace look

struct Params : impl::HollowParams, impl::TunnelParams {
  std::int64_t count = 3;
  double slope = 27;
  Rows tunnel;
  Params() { wander = 0.2; }
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "Most tunnels at random places, from hillside to hillside; none where tunnels are given")
        .real("radius", &Params::radius, "m", 0.1, 200, "Radius of a tunnel, on average")
        .real("swelling", &Params::swelling, "", 0, 0.9,
              "Most that the radius differs from its average, as a share of it; 0 for a tube of even width")
        .real("wander", &Params::wander, "", 0, 0.5,
              "Most that the middle of a stretch lies off its straight line, as a share of its length; 0 for "
              "straight tunnels")
        .real("floor", &Params::floor, "", 0.1, 1,
              "Depth of the level floor below the axis, as a share of the radius; 1 for a round tube")
        .real("slope", &Params::slope, "deg", 1, 80, "Slope of the steepest stretch, where the ends allow it")
        .real("cover", &Params::cover, "m", 0, 1000, "Least rock over the roof of tunnels at random places");
    impl::add_hollow_params(t);
    t.rows("tunnel", &Params::tunnel,
           {numbers_column("from", "", "m", 3, -1e9, 1e9, "World x, y and z of one end"),
            numbers_column("to", "", "m", 3, -1e9, 1e9, "World x, y and z of the other end"),
            numbers_column("radius", "", "m", 1, 0.1, 200, "Radius; empty for the layer's"),
            numbers_column("wander", "", "", 1, 0, 0.5, "Wander; empty for the layer's")},
           "Tunnels whose ends are given");
    return t;
  }();
  return params;
}

/// Digs tunnels between ends that the user chose.
void dig_given(const Ground& ground, const Params& p, impl::Hollow& hollow, Progress& progress) {
  const Site& site = ground.site();
  std::uint64_t index = 0;
  for (const Row& row : p.tunnel) {
    const std::string where = fmt::format("tunnels: tunnel, row {}", index + 1);
    impl::TunnelParams own = p;
    own.radius = impl::number_in(row, "radius").value_or(p.radius);
    own.wander = impl::number_in(row, "wander").value_or(p.wander);
    volume::TunnelSettings s = impl::tunnel_settings(own);
    s.slope = std::tan(p.slope * degree);
    s.seed = hash_combine(site.seed, index++);
    const Vec3d from = impl::point_in(row, "from", where) - site.origin,
                to = impl::point_in(row, "to", where) - site.origin;
    if (length(to - from) > look::longest * s.radius)
      fail(ErrorKind::usage, "{}: {:.3g} m are too long for a tunnel of {:g} m radius", where,
           length(to - from), s.radius);
    volume::Tunnel tunnel = volume::fractal_tunnel(from, to, s);
    if (ground.box().overlaps(volume::bounds(tunnel, 0)))
      hollow.add(std::move(tunnel));
    else
      progress.warn(
          fmt::format("{} is not dug: it lies outside the terrain or where the layer may not act", where));
  }
}

/// Digs tunnels from hillside to hillside, off the ends of the others.
void dig_random(const Ground& ground, const Params& p, impl::Hollow& hollow, Progress& progress) {
  impl::TunnelPlannerSettings s{p, ground.box()};
  s.slope = std::tan(p.slope * degree);
  s.lowest = ground.box().lo.z + p.radius;
  s.seed = ground.site().seed;
  impl::TunnelPlanner planner(ground, s, progress);
  const auto& mouths = planner.mouths();
  std::vector<bool> taken(mouths.size());
  if (mouths.empty() && p.count > 0)
    progress.warn(fmt::format(
        "tunnels digs nothing: no hillside rises high enough for tunnels of {:g} m radius; give a smaller "
        "radius or their ends",
        p.radius));
  std::int64_t left = p.count;
  int tries = 0;
  for (std::size_t i = 0; i < mouths.size() && left > 0; ++i)
    for (std::size_t j = i + 1; j < mouths.size() && left > 0 && !taken[i] && tries < look::tries; ++j) {
      const Vec3d d = mouths[j].ground - mouths[i].ground;
      // On two sides of a hill both look away from each other.
      if (taken[j] || length(d) < look::least_length * p.radius ||
          dot(d, mouths[i].inward) < look::through_hill * length(d) ||
          dot(d, mouths[j].inward) > -look::through_hill * length(d))
        continue;
      progress.check();
      ++tries;
      auto way = planner.way(planner.end_of(mouths[i]), planner.end_of(mouths[j]),
                             hash_combine(s.seed, i * mouths.size() + j));
      if (!way) continue;
      planner.keep_off(*way);
      hollow.add(std::move(*way));
      taken[i] = taken[j] = true;
      for (std::size_t k = 0; k < mouths.size(); ++k)
        for (const std::size_t used : {i, j})
          if (length(mouths[k].ground - mouths[used].ground) < look::apart * p.radius) taken[k] = true;
      --left;
    }
  // Where there is no hill left to go through, tunnels end in the slopes.
  for (std::size_t i = 0; i < mouths.size() && left > 0; ++i) {
    if (taken[i]) continue;
    const impl::WayEnd from = planner.end_of(mouths[i]);
    const impl::WayEnd to{from.floor + mouths[i].inward * (look::blind * p.radius), -mouths[i].inward,
                          p.radius, false};
    if (auto way = planner.way(from, to, hash_combine(s.seed, i))) {
      planner.keep_off(*way);
      hollow.add(std::move(*way));
      --left;
      for (std::size_t k = 0; k < mouths.size(); ++k)
        if (length(mouths[k].ground - mouths[i].ground) < look::apart_blind * p.radius) taken[k] = true;
    }
  }
}

Result generate(const Site& site, const Values& values, Progress& progress) {
  Params p;
  assign(table().infos(), &p, values, "tunnels");
  progress.check();
  const Ground ground(site);
  impl::Hollow hollow(ground, p, p.radius);
  if (!ground.box().empty()) {
    dig_given(ground, p, hollow, progress);
    if (p.tunnel.empty()) dig_random(ground, p, hollow, progress);
  }
  Result result = hollow.finish(progress);
  result.facts.count("primitives", 0);
  return result;
}

}  // namespace

const LandformType& declaration() {
  static const LandformType type{
      .about = {.name = "tunnels",
                .doc = "Fractal tunnels that wind and swell, through hills or between given ends",
                .source = "[Ju01 §3]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms::landform_tunnels
