// A passage: a tube along the curve through the stroke's points, which strays from it and varies in width by
// smooth noise along the way. Rooms are discs of overlapping balls, set along it at even distances.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_cave {
namespace {

enum class Stream : std::uint64_t { sideways = 1, up = 2, width = 3, lone_room = 4, first_room = 5 };

// Chosen by eye, in radii of the passage where they are lengths.
constexpr double room_radius = 2.2;       // so that a room is clearly wider than what leads to it
constexpr double wander_wavelength = 4;   // bends that a walker sees as bends
constexpr double width_wavelength = 1.5;  // shorter than bends, so that walls are not parallel
constexpr double rise = 0.4;              // of the straying sideways goes up and down: floors stay walkable
constexpr int least_balls = 5, more_balls = 4;  // around the middle of a room
constexpr double ball_turn = 0.25;              // how far a ball strays from its place, in spaces between two
constexpr double least_ball = 0.55, most_ball = 0.95;   // radii of these, in radii of the ball in the middle
constexpr double least_reach = 0.8, most_reach = 1.15;  // how far they reach, in radii of the room

struct Params {
  double variation = 0.3, wander = 0.5, chamber_radius = 0, flatten = 0.6;
  std::int64_t chambers = 0;
};

const std::vector<ParamInfo>& params() {
  using P = Params;
  static const std::vector<ParamInfo> infos =
      ParamTable<P>()
          .real("variation", &P::variation, "", 0, 0.8,
                "How much the width varies along the passage: 0 leaves it even, 0.8 makes squeezes and halls")
          .real("wander", &P::wander, "", 0, 3,
                "How far the passage strays from the curve, in radii; 0 follows it")
          .integer("chambers", &P::chambers, "", 0, 1000,
                   "How many rooms stand along the passage, evenly apart; 0 makes none")
          .real("chamber_radius", &P::chamber_radius, "m", 0, 1e4,
                "Radius of the rooms; 0 takes 2.2 radii of the passage")
          .only("where there is a room: chambers is above 0, or the stroke has one point",
                {{"chambers", std::int64_t{2}}})
          .real("flatten", &P::flatten, "", 0.2, 1,
                "Height of the rooms in widths: 1 makes them round, less makes them low")
          .only("where there is a room: chambers is above 0, or the stroke has one point",
                {{"chambers", std::int64_t{2}}});
  return infos;
}

/// Smooth noise in [-1, 1] along a line, one value a unit.
double wave(const Random& random, double x) {
  const double whole = std::floor(x), s = smoothstep(x - whole);
  const auto at = [&](double i) {
    return static_cast<double>(random.at(floor_to<std::int64_t>(i)) >> 11) * 0x1p-52 - 1;
  };
  return at(whole) * (1 - s) + at(whole + 1) * s;
}

/// A room: overlapping balls in a flat disc, so that its plan is irregular and its floor level.
void add_room(Vec3d center, double radius, double flatten, Random random, Dab& dab) {
  constexpr double whole_turn = 2 * std::numbers::pi;
  const double ball = radius * flatten;
  dab.sphere(center, ball);
  const int around = least_balls + static_cast<int>(random.below(more_balls));
  const double turn = random.uniform(0, whole_turn);
  for (int i = 0; i < around; ++i) {
    const double angle = turn + whole_turn * (i + random.uniform(-ball_turn, ball_turn)) / around;
    const double r = ball * random.uniform(least_ball, most_ball),
                 far = std::max(radius * random.uniform(least_reach, most_reach) - r, 0.0);
    // The floors of all balls lie on about one level.
    dab.sphere(center + Vec3d{far * std::cos(angle), far * std::sin(angle), r - ball}, r);
  }
}

/// How much of the way along `path` is covered at each of its points.
std::vector<double> ways(std::span<const Vec3d> path) {
  std::vector<double> out(path.size(), 0);
  for (std::size_t i = 1; i < path.size(); ++i) out[i] = out[i - 1] + length(path[i] - path[i - 1]);
  return out;
}

/// Moves the path sideways and a little up and down by up to `wander` radii. Its ends stay where they were
/// asked for.
void stray(std::vector<Vec3d>& path, std::span<const double> covered, double radius, double wander,
           std::uint64_t seed) {
  const Random sideways(seed, Stream::sideways), up(seed, Stream::up);
  const double step = wander_wavelength * radius, whole = covered.back();
  const std::vector<Vec3d> straight = path;
  for (std::size_t i = 0; i < path.size(); ++i) {
    const Vec3d ahead = straight[std::min(i + 1, path.size() - 1)] - straight[i > 0 ? i - 1 : 0];
    const Vec3d across = normalized(Vec3d{-ahead.y, ahead.x, 0});
    const double free = std::min({covered[i] / step, (whole - covered[i]) / step, 1.0}) * wander * radius;
    path[i] += across * (free * wave(sideways, covered[i] / step)) +
               Vec3d{0, 0, rise * free * wave(up, covered[i] / step)};
  }
}

void apply(const Stroke& stroke, std::uint64_t seed, Dab& dab) {
  Params p;
  assign(params(), &p, stroke.values, "cave");
  const double room = p.chamber_radius > 0 ? p.chamber_radius : room_radius * stroke.radius;
  if (stroke.points.size() == 1)
    return add_room(stroke.points[0], room, p.flatten, Random(seed, Stream::lone_room), dab);

  auto path = sample_path(stroke.points, true, path_spacing * stroke.radius);
  const std::vector<double> covered = ways(path);
  const double whole = covered.back();
  stray(path, covered, stroke.radius, p.wander, seed);
  const Random width(seed, Stream::width);
  dab.tube(path, [&](double t) {
    return stroke.radius * (1 + p.variation * wave(width, t * whole / (width_wavelength * stroke.radius)));
  });
  const int chambers = static_cast<int>(p.chambers);
  for (int c = 0; c < chambers; ++c) {
    const double at = whole * (c + 1) / (chambers + 1);
    const auto i = std::lower_bound(covered.begin(), covered.end(), at) - covered.begin();
    const auto stream = static_cast<std::uint64_t>(Stream::first_room) + c;
    add_room(path[std::min(i, std::ssize(path) - 1)], room, p.flatten, Random(seed, stream), dab);
  }
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about = {.name = "cave",
                .doc = "A passage of irregular width along a curve, with rooms; one point alone is a room",
                .source = "[Paris19 §8.2]",
                .params = params()},
      .max_points = 10000,
      .apply = apply,
  };
  return type;
}

}  // namespace tafoni::scene::brush_cave
