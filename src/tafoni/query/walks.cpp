// Draws starts, looks for routes around each, draws two places of these, and lets a walker go from one to the
// other while its overlap with the ground is measured at points of its axis.

#include "tafoni/query/walks.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"

namespace tafoni::query {
namespace {

/// Ways are planned for a walker with a little less of everything, so that the one that walks them has
/// something in hand when it does not come to every place by the same way: shares of what it has.
struct Margins {
  double radius = 1.1;  ///< a wider walker keeps off walls
  double taller = 0.1;  ///< of its radius: keeps off roofs
  double step = 0.8;
  double slope = 0.9;
};

WalkerSettings with_margins(WalkerSettings walker) {
  constexpr Margins margins;
  walker.radius *= margins.radius;
  walker.height += margins.taller * walker.radius;
  walker.step *= margins.step;
  walker.slope *= margins.slope;
  return walker;
}

/// Starts that are drawn before the box is given up.
constexpr int most_starts = 20000;
/// Places that a start must lead to, so that routes from it have a choice.
constexpr std::size_t enough_places = 60;
/// Pairs of places that are drawn for a route that is long enough; then the last pair has to do.
constexpr int most_pairs = 200;
/// Points of the capsule's axis at which its overlap is measured.
constexpr int axis_points = 7;

/// How far the surface comes within the capsule, by the points of its axis.
double overlap_of(const Collider& ground, const Capsule& shape) {
  double worst = 0;
  for (int i = 0; i < axis_points; ++i) {
    const Vec3d p = shape.a + (shape.b - shape.a) * (i / double{axis_points - 1});
    if (const auto near = ground.closest(p, shape.radius))
      worst = std::max(worst, shape.radius - near->distance);
  }
  return ground.solid(shape.a) ? std::max(worst, shape.radius) : worst;
}

/// Places from which many others can be reached.
Routes find_start(const Collider& ground, const Box3d& box, const WalkSettings& settings, Random& random,
                  Progress& progress) {
  const WalkerSettings planned = with_margins(settings.walker), walkers[] = {planned, settings.walker};
  const std::size_t enough = std::min(enough_places, settings.routes.places);
  for (int i = 0; i < most_starts; ++i) {
    progress.check();
    const double x = random.uniform(box.lo.x, box.hi.x), y = random.uniform(box.lo.y, box.hi.y);
    const std::vector<Vec3d> places =
        standing_places(ground, planned, x, y, box.hi.z, box.lo.z, settings.roofed);
    if (places.empty()) continue;
    Routes routes(ground, walkers, places[random.below(places.size())], settings.routes);
    if (routes.places().size() >= enough) return routes;
  }
  fail(ErrorKind::input,
       "no place {}was found from which a walker can reach others: {}give it another part of the terrain, or "
       "a "
       "smaller walker (--walker)",
       settings.roofed ? "under rock " : "",
       settings.roofed ? "let it start in the open, too (--anywhere), " : "");
}

double length_of(const std::vector<Vec3d>& way) {
  double sum = 0;
  for (std::size_t i = 1; i < way.size(); ++i) sum += length(way[i] - way[i - 1]);
  return sum;
}

}  // namespace

std::vector<Vec3d> surface_points(const Capsule& shape, double inset) {
  const double r = shape.radius - inset;
  std::vector<Vec3d> points;
  constexpr int rings = 5, spokes = 6;
  for (int k = 0; k < rings; ++k)
    for (int i = 0; i < spokes; ++i) {
      const double turn = 2 * std::numbers::pi * (i + 0.5 * (k & 1)) / spokes;
      const Vec3d level{r * std::cos(turn), r * std::sin(turn), 0};
      points.push_back(shape.a + (shape.b - shape.a) * (k / double{rings - 1}) + level);
      if (k == 0) points.push_back(shape.a + (level - Vec3d{0, 0, r}) * std::sqrt(0.5));
      if (k == rings - 1) points.push_back(shape.b + (level + Vec3d{0, 0, r}) * std::sqrt(0.5));
    }
  points.push_back(shape.a - Vec3d{0, 0, r});
  points.push_back(shape.b + Vec3d{0, 0, r});
  return points;
}

std::vector<Walk> random_walks(const Collider& ground, const Box3d& box, const WalkSettings& settings,
                               const std::function<double(const Capsule&)>& check, Progress& progress) {
  if (settings.count < 1 || settings.around < 1) fail(ErrorKind::usage, "give a number of routes above 0");
  (void)Walker(settings.walker, {});  // says what is wrong with it before margins change it
  std::vector<Walk> walks(settings.count);
  const int groups = (settings.count + settings.around - 1) / settings.around;
  progress.begin("walks", groups, "starts");
  parallel_for(
      groups,
      [&](std::int64_t group) {
        Random random(settings.seed, group);
        const std::size_t first = group * settings.around;
        const std::size_t last = std::min(walks.size(), first + settings.around);
        const Routes routes = find_start(ground, box, settings, random, progress);
        for (std::size_t w = first; w < last; ++w) {
          std::size_t from = 0, to = 0;
          // A way that comes back to where it began would be done before it is walked.
          const auto wanting = [&] {
            return length(routes.places()[to] - routes.places()[from]) < 2 * settings.walker.radius ||
                   length_of(routes.way(routes.path(from, to))) < settings.least;
          };
          for (int tries = 0; tries < most_pairs && wanting(); ++tries) {
            from = random.below(routes.places().size());
            to = random.below(routes.places().size());
          }
          Walk& walk = walks[w];
          walk.from = routes.places()[from], walk.to = routes.places()[to];
          Walker walker(settings.walker, walk.from);
          walk.walked = find_way(ground, walker, routes, from, to, settings.seconds, [&](const Walker& now) {
            progress.check();
            walk.overlap = std::max(walk.overlap, overlap_of(ground, now.capsule()));
            if (check) walk.depth = std::max(walk.depth, check(now.capsule()));
          });
        }
      },
      progress);
  progress.end();
  return walks;
}

}  // namespace tafoni::query
