#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/landforms/hollows/burrows.h"
#include "tafoni/landforms/hollows/hollow.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/cells.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms {
namespace {

using impl::Ground;

struct Params : impl::HollowParams {
  std::int64_t count = 3;
  double radius = 2.5;
  double swelling = 0.25;
  double wander = 0.2;
  double floor = 0.55;
  double slope = 27;
  double cover = 3;
  Rows tunnel;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.integer("count", &Params::count, "", 0, 1000,
              "most tunnels at random places, from hillside to hillside; none where tunnels are given")
        .real("radius", &Params::radius, "m", 0.1, 200, "of a tunnel, on average")
        .real("swelling", &Params::swelling, "", 0, 0.9, "most that the radius differs from it, as a share")
        .real("wander", &Params::wander, "", 0, 0.5,
              "most that the middle of a stretch lies off its straight line, as a share of its length")
        .real("floor", &Params::floor, "", 0.1, 1,
              "depth of the level floor below the axis, as a share of the radius; 1 for a round one")
        .real("slope", &Params::slope, "deg", 1, 80, "of the steepest stretch, where the ends allow it")
        .real("cover", &Params::cover, "m", 0, 1000, "least rock over the roof of those at random places");
    impl::add_hollow_params(t);
    t.rows("tunnel", &Params::tunnel,
           {numbers_column("from", "", "m", 3, -1e9, 1e9, "x, y and z of one end, world"),
            numbers_column("to", "", "m", 3, -1e9, 1e9, "of the other"),
            numbers_column("radius", "", "m", 1, 0.1, 200, "empty for the layer's"),
            numbers_column("wander", "", "", 1, 0, 0.5, "empty for the layer's")},
           "tunnels whose ends are given");
    return t;
  }();
  return params;
}

/// Between ends that the user chose.
void dig_given(const Ground& ground, const Params& p, impl::Hollow& hollow, Progress& progress) {
  const Site& site = ground.site();
  std::uint64_t index = 0;
  for (const Row& row : p.tunnel) {
    const std::string where = fmt::format("tunnels: tunnel, row {}", index + 1);
    volume::TunnelSettings s;
    s.radius = impl::number_in(row, "radius").value_or(p.radius);
    s.wander = impl::number_in(row, "wander").value_or(p.wander);
    s.swelling = p.swelling, s.floor = p.floor, s.slope = std::tan(p.slope * degree);
    s.step = 0.7 * s.radius;
    s.seed = hash_combine(site.seed, index++);
    const Vec3d from = impl::point_in(row, "from", where) - site.origin,
                to = impl::point_in(row, "to", where) - site.origin;
    constexpr double most = 1e6;
    if (length(to - from) > most * s.radius)
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

/// From one hillside to another, as far from the ends of the others as may be.
void dig_random(const Ground& ground, const Params& p, impl::Hollow& hollow, Progress& progress) {
  impl::BurrowSettings s;
  s.area = ground.box();
  s.radius = p.radius, s.swelling = p.swelling, s.wander = p.wander, s.floor = p.floor;
  s.slope = std::tan(p.slope * degree);
  s.cover = p.cover;
  s.lowest = ground.box().lo.z + p.radius;
  s.seed = ground.site().seed;
  impl::Burrows burrows(ground, s, progress);
  const auto& mouths = burrows.mouths();
  std::vector<bool> taken(mouths.size());
  if (mouths.empty() && p.count > 0)
    progress.warn(fmt::format(
        "tunnels digs nothing: no hillside rises high enough for tunnels of {:g} m radius; give a smaller "
        "radius or their ends",
        p.radius));
  std::int64_t left = p.count;
  int tries = 0;
  for (std::size_t i = 0; i < mouths.size() && left > 0; ++i)
    for (std::size_t j = i + 1; j < mouths.size() && left > 0 && !taken[i] && tries < 4000; ++j) {
      const Vec3d d = mouths[j].ground - mouths[i].ground;
      // The other side of a hill: both look away from each other.
      if (taken[j] || length(d) < 12 * p.radius || dot(d, mouths[i].inward) < 0.5 * length(d) ||
          dot(d, mouths[j].inward) > -0.5 * length(d))
        continue;
      progress.check();
      ++tries;
      auto way = burrows.way(burrows.end_of(mouths[i]), burrows.end_of(mouths[j]),
                             hash_combine(s.seed, i * mouths.size() + j));
      if (!way) continue;
      burrows.keep_off(*way);
      hollow.add(std::move(*way));
      taken[i] = taken[j] = true;
      for (std::size_t k = 0; k < mouths.size(); ++k)
        for (const std::size_t used : {i, j})
          if (length(mouths[k].ground - mouths[used].ground) < 6 * p.radius) taken[k] = true;
      --left;
    }
  // No hill to go through: into the slopes, then.
  for (std::size_t i = 0; i < mouths.size() && left > 0; ++i) {
    if (taken[i]) continue;
    const impl::WayEnd from = burrows.end_of(mouths[i]);
    const impl::WayEnd to{from.floor + mouths[i].inward * (20 * p.radius), -mouths[i].inward, p.radius,
                          false};
    if (auto way = burrows.way(from, to, hash_combine(s.seed, i))) {
      burrows.keep_off(*way);
      hollow.add(std::move(*way));
      --left;
      for (std::size_t k = 0; k < mouths.size(); ++k)
        if (length(mouths[k].ground - mouths[i].ground) < 12 * p.radius) taken[k] = true;
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
  result.report.emplace_back("primitives", std::int64_t{0});
  return result;
}

}  // namespace

const LandformType& landform_tunnels() {
  static const LandformType type{
      .about = {.name = "tunnels",
                .doc = "Fractal tunnels that wind and swell, through hills or between given ends",
                .source = "[Ju01 §3]",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::landforms
