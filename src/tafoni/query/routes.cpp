// Finds places by letting a walker go from each known one to the eight columns around; ways are the shortest
// paths in the graph of places, walked by the same strides.

#include "tafoni/query/routes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/mesh/inner/size32.h"

namespace tafoni::query {
namespace {

/// Metres. A walker this near to a place has come to it.
constexpr double close = 0.005;

double level_distance(Vec3d a, Vec3d b) {
  return std::hypot(a.x - b.x, a.y - b.y);
}

std::uint64_t column_key(std::int64_t i, std::int64_t j) {
  return hash_combine(static_cast<std::uint64_t>(i), j);
}

int moves_for(double metres, double move) {
  return static_cast<int>(std::clamp(std::ceil(metres / move - 1e-9), 1.0, 1e9));
}

/// One of `moves` moves that are left to level (to.x, to.y).
void advance(const Collider& ground, Walker& walker, Vec3d to, int moves, double seconds) {
  walker.move(ground, (to - walker.feet()) * (1 / (seconds * std::max(1, moves))), seconds);
}

/// Walks to level (to.x, to.y); false when it strays or loses its footing.
bool walk_to(const Collider& ground, Walker& walker, Vec3d to, double move) {
  for (int m = moves_for(level_distance(walker.feet(), to), move); m > 0 && walker.grounded(); --m)
    advance(ground, walker, to, m, 1);
  return walker.grounded() && level_distance(walker.feet(), to) < close;
}

}  // namespace

Routes::Routes(const Collider& ground, std::span<const WalkerSettings> walkers, Vec3d start,
               const RouteSettings& route)
    : settings_(route) {
  if (walkers.empty()) fail(ErrorKind::internal, "routes are for one walker at least");
  const WalkerSettings& settings = walkers.front();
  step_ = settings.step;
  if (!(route.spacing > 0) || !(route.move > 0))
    fail(ErrorKind::usage, "places need a spacing and moves above 0 m");
  const double d = route.spacing;
  std::unordered_map<std::uint64_t, std::vector<std::uint32_t>> columns;
  struct Column {
    std::int64_t i, j;
  };
  std::vector<Column> at;
  const auto center = [&](Column c) {
    return Vec3d{static_cast<double>(c.i) * d, static_cast<double>(c.j) * d, 0};
  };
  const auto add = [&](Column c, Vec3d feet) {
    auto& here = columns[column_key(c.i, c.j)];
    for (std::uint32_t p : here)
      if (std::abs(places_[p].z - feet.z) < close) return p;
    here.push_back(mesh::inner::size32(places_));
    places_.push_back(feet);
    next_.emplace_back();
    at.push_back(c);
    return here.back();
  };
  const Column first{std::llround(start.x / d), std::llround(start.y / d)};
  Walker walker(settings, start);
  if (!walker.settle(ground) || !walk_to(ground, walker, center(first), route.move)) return;
  add(first, walker.feet());
  for (std::size_t p = 0; p < places_.size() && places_.size() < route.places; ++p)
    for (int dj = -1; dj <= 1; ++dj)
      for (int di = -1; di <= 1; ++di) {
        if (di == 0 && dj == 0) continue;
        const Column c{at[p].i + di, at[p].j + dj};
        walker = Walker(settings, places_[p]);
        if (!walker.settle(ground) || !walk_to(ground, walker, center(c), route.move)) continue;
        const bool all = std::all_of(walkers.begin() + 1, walkers.end(), [&](const WalkerSettings& another) {
          Walker companion(another, places_[p]);
          return companion.settle(ground) && walk_to(ground, companion, center(c), route.move) &&
                 std::abs(companion.feet().z - walker.feet().z) < settings.step;
        });
        if (!all) continue;
        const std::uint32_t reached = add(c, walker.feet());
        next_[p].push_back(reached);
      }
}

std::vector<std::uint32_t> Routes::path(std::size_t from, std::size_t to,
                                        std::span<const Stretch> closed) const {
  if (from >= places_.size() || to >= places_.size()) return {};
  constexpr std::uint32_t none = 0xffffffff;
  const auto start = static_cast<std::uint32_t>(from);
  std::vector<std::uint32_t> before(places_.size(), none), queue{start};
  before[from] = start;
  for (std::size_t q = 0; q < queue.size() && before[to] == none; ++q)
    for (std::uint32_t next : next_[queue[q]]) {
      if (before[next] != none) continue;
      if (std::find(closed.begin(), closed.end(), Stretch{queue[q], next}) != closed.end()) continue;
      before[next] = queue[q];
      queue.push_back(next);
    }
  if (before[to] == none) return {};
  std::vector<std::uint32_t> result{static_cast<std::uint32_t>(to)};
  while (result.back() != from) result.push_back(before[result.back()]);
  std::reverse(result.begin(), result.end());
  return result;
}

std::vector<Vec3d> Routes::way(std::span<const std::uint32_t> path) const {
  std::vector<Vec3d> result;
  for (std::uint32_t p : path) result.push_back(places_[p]);
  return result;
}

std::size_t Routes::nearest(Vec3d feet, std::span<const std::size_t> without) const {
  std::size_t best = places_.size();
  double least = 1.5 * settings_.spacing;
  for (std::size_t p = 0; p < places_.size(); ++p) {
    const double d = level_distance(places_[p], feet);
    if (d >= least || std::abs(places_[p].z - feet.z) > 2 * step_) continue;
    if (std::find(without.begin(), without.end(), p) == without.end()) least = d, best = p;
  }
  return best;
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

Walked follow(const Collider& ground, Walker& walker, const std::vector<Vec3d>& way, double move,
              double seconds, const std::function<void(const Walker&)>& each) {
  if (!(move > 0) || !(seconds > 0)) fail(ErrorKind::usage, "a walk needs moves above 0 m and 0 s");
  Walked walked;
  walker.settle(ground);
  for (std::size_t w = 0; w < way.size(); ++w) {
    const double size = level_distance(w == 0 ? walker.feet() : way[w - 1], way[w]);
    const int wanted = moves_for(size, move), most = 3 * wanted + 8;
    int moves = 0;
    for (; moves < most && level_distance(walker.feet(), way[w]) > close; ++moves) {
      const int left = moves_for(level_distance(walker.feet(), way[w]), move);
      advance(ground, walker, way[w], std::max(left, wanted - moves), seconds);
      walked.seconds += seconds;
      if (each) each(walker);
    }
    walked.moves += moves;
    if (moves == most) return walked;
    walked.metres += size;
    walked.reached = w;
  }
  walked.arrived = true;
  return walked;
}

Walked find_way(const Collider& ground, Walker& walker, const Routes& routes, std::size_t from,
                std::size_t to, double seconds, const std::function<void(const Walker&)>& each, int tries) {
  Walked sum;
  std::vector<Routes::Stretch> closed;
  std::vector<std::size_t> out_of_reach;  // places that it did not come to from where it is
  for (int t = 0; t < tries && !sum.arrived; ++t) {
    const std::vector<std::uint32_t> path = routes.path(from, to, closed);
    if (path.empty()) break;
    const Walked walked = follow(ground, walker, routes.way(path), routes.settings().move, seconds, each);
    sum.arrived = walked.arrived;
    sum.moves += walked.moves;
    sum.metres += walked.metres;
    sum.seconds += walked.seconds;
    if (walked.reached == 0 && level_distance(walker.feet(), routes.places()[from]) > close)
      out_of_reach.push_back(from);
    else
      out_of_reach.clear();
    if (walked.reached + 1 < path.size()) closed.push_back({path[walked.reached], path[walked.reached + 1]});
    from = routes.nearest(walker.feet(), out_of_reach);
  }
  return sum;
}

}  // namespace tafoni::query
