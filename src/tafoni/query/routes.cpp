#include "tafoni/query/routes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"

namespace tafoni::query {
namespace {

/// How near to a column, in spacings, a place must lie.
constexpr double near_column = 0.1;

double level_distance(Vec3d a, Vec3d b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

std::uint64_t column_key(std::int64_t i, std::int64_t j) {
  return hash_combine(static_cast<std::uint64_t>(i), static_cast<std::uint64_t>(j));
}

}  // namespace

Routes::Routes(const Collider& ground, const WalkerSettings& settings, Vec3d start,
               const RouteSettings& route) {
  if (!(route.spacing > 0)) fail(ErrorKind::usage, "places need a spacing above 0 m");
  const double d = route.spacing;
  const Walker walker(settings);
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> columns;
  struct Column {
    std::int64_t i, j;
  };
  std::vector<Column> at;
  const auto center = [&](Column c, double z) {
    return Vec3d{static_cast<double>(c.i) * d, static_cast<double>(c.j) * d, z};
  };
  const auto add = [&](Column c, Vec3d feet) {
    auto& here = columns[column_key(c.i, c.j)];
    for (std::uint32_t p : here)
      if (std::abs(places_[p].z - feet.z) < settings.step / 2) return p;
    here.push_back(static_cast<std::uint32_t>(places_.size()));
    places_.push_back(feet);
    strides_.emplace_back();
    at.push_back(c);
    return here.back();
  };
  const Column first{std::llround(start.x / d), std::llround(start.y / d)};
  if (ground.overlaps(walker.capsule_at(start))) return;
  const auto put = walker.stride(ground, start, center(first, start.z));
  if (!put.found) return;
  add(first, put.feet);
  for (std::size_t p = 0; p < places_.size() && places_.size() < route.places; ++p)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (di == 0 && dj == 0) continue;
        const Column c{at[p].i + di, at[p].j + dj};
        const Vec3d to = center(c, places_[p].z);
        const auto reached = walker.stride(ground, places_[p], to);
        if (!reached.found || level_distance(reached.feet, to) > near_column * d) continue;
        const std::uint32_t next = add(c, reached.feet);
        strides_[p].push_back(next);
      }
}

std::vector<Vec3d> Routes::way(std::size_t from, std::size_t to) const {
  if (from >= places_.size() || to >= places_.size()) return {};
  constexpr std::uint32_t none = 0xffffffff;
  std::vector<std::uint32_t> before(places_.size(), none), queue{static_cast<std::uint32_t>(from)};
  before[from] = static_cast<std::uint32_t>(from);
  for (std::size_t q = 0; q < queue.size() && before[to] == none; ++q)
    for (std::uint32_t next : strides_[queue[q]])
      if (before[next] == none) before[next] = queue[q], queue.push_back(next);
  if (before[to] == none) return {};
  std::vector<Vec3d> result{places_[to]};
  for (auto p = static_cast<std::uint32_t>(to); p != from; result.push_back(places_[p])) p = before[p];
  std::reverse(result.begin(), result.end());
  return result;
}

std::vector<Vec3d> standing_places(const Collider& ground, const WalkerSettings& settings, double x, double y,
                                   double above, double below, bool roofed) {
  std::vector<Vec3d> places;
  const Walker walker(settings);
  double z = above;
  bool under_rock = ground.solid({x, y, above});
  while (z > below) {
    const auto hit = ground.ray({x, y, z}, {0, 0, -1}, z - below);
    if (!hit) break;
    z = hit->point.z - 1e-6 * (1 + std::abs(hit->point.z));
    if (hit->from_rock) {
      under_rock = true;
      continue;
    }
    if (roofed && !under_rock) continue;
    // High enough that the capsule clears a slope under it, and down from there.
    const double rise = settings.radius + settings.step;
    const Vec3d raised = hit->point + Vec3d{0, 0, rise};
    if (ground.overlaps(walker.capsule_at(raised))) continue;
    const auto footing = walker.footing(ground, raised, rise + settings.step);
    if (footing.found) places.push_back(footing.feet);
  }
  return places;
}

Walked follow(const Collider& ground, Walker& walker, const std::vector<Vec3d>& way, double speed,
              double step, const std::function<void(const Walker&)>& each) {
  if (!(speed > 0) || !(step > 0)) fail(ErrorKind::usage, "a walk needs a speed and a time step above 0");
  Walked walked;
  for (std::size_t w = 1; w < way.size(); ++w) {
    const double size = level_distance(way[w - 1], way[w]);
    const double close = near_column * std::max(size, 0.1);
    const int most = 16 + static_cast<int>(8 * size / (speed * step));
    int moves = 0;
    for (; moves < most && level_distance(walker.feet(), way[w]) > close; ++moves) {
      const Vec3d left = way[w] - walker.feet();
      const double far = std::hypot(left.x, left.y);
      walker.move(ground, left * (std::min(speed, far / step) / far), step);
      walked.seconds += step;
      if (each) each(walker);
    }
    walked.moves += moves;
    walked.metres += size;
    if (moves == most) return walked;
  }
  walked.arrived = true;
  return walked;
}

}  // namespace tafoni::query
