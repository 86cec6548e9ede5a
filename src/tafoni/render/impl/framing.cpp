// Where to stand: cameras from outside are fitted around the whole mesh and the one whose coarse picture
// shows most is taken; inside, roomy roofed places are sought at random and the one with the longest view
// is taken.

#include "tafoni/render/impl/framing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/render/impl/film.h"

namespace tafoni::render::impl {
namespace {

constexpr double pi = std::numbers::pi;
constexpr double margin = 0.97;  // of the half picture is filled, so that nothing touches its edge

// What a pixel is worth when cameras from outside are compared, chosen by eye: undercuts are what a picture
// of 3D terrain is for; plain ground and water fill it without showing anything.
constexpr double water_worth = 0.05, ground_worth = 0.15, steep_worth = 1.5, undercut_worth = 4;
constexpr double border_worth = -0.6;  // the walls that close the mesh, and backs of triangles
constexpr double elevations_tried[] = {0.27, 0.36, 0.50};  // radians down: three-quarter views
constexpr double high_from = 0.4, high_worth = 0.85;  // from high up more ground is seen, but undercuts less

// Views inside of caves.
constexpr double inside_fov = 1.2;    // radians: wide, since walls are near
constexpr double look_down = -0.12;   // a little down, at the floor ahead
constexpr double roofed_least = 0.9;  // share of the sky that a place in a cave may not see
constexpr float eye_share = 0.45f;    // of the height under the roof, but …
constexpr float eye_height = 1.7f;  // … metres above the floor at most, and four spacings, for coarse meshes
constexpr float longest_view = 12;  // of the room: what is further counts no more
constexpr double near_quantile = 0.1, median_worth = 0.5, ahead_worth = 2.0;  // an outlook's score

/// What a coarse picture from `camera` shows: cliffs and undercuts count, walls of the data's edge do not.
double interest(const World& world, const Camera& camera, double aspect, std::optional<float> sea) {
  constexpr int width = 96, height = 54;
  View view;
  view.eye = to_float(camera.eye);
  view.forward = to_float(normalized(camera.target - camera.eye));
  const Vec3f right = normalized(cross(view.forward, Vec3f{0, 0, 1}));
  const auto half = static_cast<float>(std::tan(camera.fov / 2));
  view.right = right * (half * static_cast<float>(aspect));
  view.up = cross(right, view.forward) * half;
  view.width = width;
  view.height = height;
  std::array<double, height> rows{};
  parallel_for(height, [&](int row) {
    double score = 0;
    for (int x = 0; x < width; ++x) {
      const Vec3f d = view.through(x, row);
      const Hit hit = world.tracer().closest(view.eye, d);
      if (!hit) continue;
      const Vec3f p = view.eye + d * hit.t;
      const bool wall = world.is_border(p, hit.face);
      if (sea && p.z < *sea) {
        score += wall ? 0 : water_worth;
        continue;
      }
      if (wall || dot(hit.face, d) > 0)
        score += border_worth;
      else if (hit.face.z < -0.1f)
        score += undercut_worth;
      else
        score += ground_worth + steep_worth * (1 - std::abs(hit.face.z));
    }
    rows[row] = score;
  });
  double sum = 0;
  for (const double row : rows) sum += row;
  return sum;
}

struct Openness {
  double roofed = 0;  ///< share of the upper directions that are blocked
  float near = 0;     ///< free distance below which few directions lie, metres
  float room = 0;     ///< the lower quartile of the free distances, metres
};

Openness look_around(const World& world, Vec3f eye) {
  constexpr int count = 96;
  Openness open;
  std::array<float, count> distances{};
  int upper = 0, blocked = 0;
  for (int i = 0; i < count; ++i) {
    // A spherical Fibonacci lattice.
    const double z = 1 - (2 * i + 1.0) / count, phi = i * 2.399963229728653, r = std::sqrt(1 - z * z);
    const Hit hit = world.tracer().closest(eye, to_float({r * std::cos(phi), r * std::sin(phi), z}));
    distances[i] = std::min(hit.t, length(world.box().size()));
    if (z > 0.2) {
      ++upper;
      blocked += hit ? 1 : 0;
    }
  }
  std::sort(distances.begin(), distances.end());
  open.near = distances[count / 16];
  open.room = distances[count / 4];
  open.roofed = 1.0 * blocked / upper;
  return open;
}

struct Outlook {
  Vec3f direction;
  double score = 0;
};

/// The level direction with the longest view ahead and no wall close before the eye.
Outlook best_direction(const World& world, Vec3f eye, float room) {
  constexpr int headings = 32;
  std::array<double, headings> scores{};
  const auto direction = [&](int heading) {
    const double a = heading * 2 * pi / headings;
    return to_float(normalized(Vec3d{std::sin(a), std::cos(a), look_down}));
  };
  parallel_for(headings, [&](int i) {
    View view;
    view.eye = eye;
    view.forward = direction(i);
    const Vec3f right = normalized(cross(view.forward, Vec3f{0, 0, 1}));
    const auto half = static_cast<float>(std::tan(inside_fov / 2));
    view.right = right * (half * 16 / 9);
    view.up = cross(right, view.forward) * half;
    view.width = 32;
    view.height = 18;
    std::vector<float> depths;
    float ahead = 0;
    for (int y = 0; y < view.height; ++y)
      for (int x = 0; x < view.width; ++x) {
        const Hit hit = world.tracer().closest(eye, view.through(x, y));
        // Daylight at the end is worth no more than a wall at that distance.
        depths.push_back(hit ? std::min(hit.t, longest_view * room) : room);
        if (x >= 14 && x < 18 && y >= 7 && y < 11) ahead += depths.back();
      }
    std::sort(depths.begin(), depths.end());
    const auto at = [&](double share) {
      return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size()))];
    };
    scores[i] = at(near_quantile) + median_worth * at(0.5) + ahead_worth * ahead / 16;
  });
  const auto best = std::max_element(scores.begin(), scores.end());
  return {direction(static_cast<int>(best - scores.begin())), *best};
}

/// A place at eye height above a floor under the widest roof.
std::optional<Vec3f> find_cave(const World& world, std::optional<float> sea) {
  const std::size_t triangles = world.mesh().triangles.size();
  constexpr std::int64_t tries = 20000;
  constexpr std::uint64_t place_seed = 17;
  std::vector<double> scores(tries, 0);
  std::vector<Vec3f> eyes(tries);
  const float reach = length(world.box().size());
  parallel_for(tries, [&](std::int64_t i) {
    Random random(place_seed, i);
    const auto triangle = static_cast<std::uint32_t>(random.below(triangles));
    const Vec3f n = world.face_normal(triangle), p = world.center(triangle);
    if (n.z < 0.5f || (sea && p.z < *sea)) return;
    const Vec3f from = p + n * world.offset();
    const Hit roof = world.tracer().closest(from, {0, 0, 1}, reach);
    // A roof seen from behind is the mesh's own underside: the floor is outside of what is solid.
    if (!roof || roof.face.z > 0) return;
    const Vec3f eye = from + Vec3f{0, 0, 1} * std::min(eye_share * roof.t, 4 * world.spacing() + eye_height);
    const Openness open = look_around(world, eye);
    if (open.roofed < roofed_least) return;
    eyes[i] = eye;
    scores[i] = open.room * std::min(1.0f, 3 * open.near / open.room);
  });
  // Of the roomiest places the one with the best outlook.
  std::vector<std::size_t> order(tries);
  std::iota(order.begin(), order.end(), std::size_t{0});
  constexpr std::ptrdiff_t finalists = 32;
  std::partial_sort(order.begin(), order.begin() + finalists, order.end(), [&](std::size_t a, std::size_t b) {
    return scores[a] != scores[b] ? scores[a] > scores[b] : a < b;
  });
  std::optional<Vec3f> best;
  double best_score = 0;
  for (std::ptrdiff_t i = 0; i < finalists; ++i) {
    const std::size_t place = order[i];
    if (scores[place] <= 0) break;
    const double score = best_direction(world, eyes[place], look_around(world, eyes[place]).room).score;
    if (score <= best_score) continue;
    best_score = score;
    best = eyes[place];
  }
  return best;
}

}  // namespace

namespace {

/// The greatest of four numbers over all vertices not below `sea`; measure(p) gives them for one.
template <class Measure>
std::array<double, 4> greatest(const World& world, std::optional<float> sea, Measure&& measure) {
  const std::vector<Vec3f>& positions = world.mesh().positions;
  constexpr std::int64_t grain = 1 << 16;
  const auto count = std::ssize(positions);
  constexpr std::array<double, 4> least{-1e300, -1e300, -1e300, -1e300};
  std::vector<std::array<double, 4>> blocks((count + grain - 1) / grain, least);
  parallel_blocks(count, grain, [&](std::int64_t begin, std::int64_t end) {
    std::array<double, 4>& block = blocks[begin / grain];
    for (std::int64_t i = begin; i < end; ++i) {
      if (sea && positions[i].z < *sea) continue;
      const std::array<double, 4> m = measure(to_double(positions[i]));
      for (std::size_t k = 0; k < 4; ++k) block[k] = std::max(block[k], m[k]);
    }
  });
  std::array<double, 4> all = least;
  for (const auto& block : blocks)
    for (std::size_t k = 0; k < 4; ++k) all[k] = std::max(all[k], block[k]);
  return all;
}

}  // namespace

Camera fit(const World& world, double azimuth, double elevation, double fov, double aspect,
           std::optional<float> sea) {
  if (sea && world.box().hi.z <= *sea) sea = std::nullopt;
  const Vec3d forward{std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
                      -std::sin(elevation)};
  const Vec3d right = normalized(cross(forward, Vec3d{0, 0, 1})), up = cross(right, forward);
  const double tan_y = margin * std::tan(fov / 2), tan_x = tan_y * aspect;
  // The eye e sees p when |r(p) - r(e)| <= tan_x (f(p) - f(e)), and so for up: four planes to push back.
  const auto [right_most, left, high, low] = greatest(world, sea, [&](Vec3d p) {
    const double r = dot(p, right), u = dot(p, up), f = dot(p, forward);
    return std::array{r - tan_x * f, -r - tan_x * f, u - tan_y * f, -u - tan_y * f};
  });
  const double f = std::min(-(left + right_most) / (2 * tan_x), -(low + high) / (2 * tan_y));
  const double r = (right_most - left) / 2, u = (high - low) / 2;
  Camera camera;
  camera.eye = right * r + up * u + forward * f;
  camera.target = camera.eye + forward * std::max(dot(to_double(world.box().center()), forward) - f, 1e-3);
  camera.fov = fov;
  return camera;
}

Camera center(const World& world, Camera camera, double aspect, std::optional<float> sea) {
  if (sea && world.box().hi.z <= *sea) sea = std::nullopt;
  const Vec3d forward = normalized(camera.target - camera.eye);
  const Vec3d right = normalized(cross(forward, Vec3d{0, 0, 1})), up = cross(right, forward);
  const double tan_y = margin * std::tan(camera.fov / 2), tan_x = tan_y * aspect;
  // How far the eye may go each way before a vertex leaves the picture, then halved again and again.
  const auto slack = greatest(world, sea, [&](Vec3d p) {
    const Vec3d d = p - camera.eye;
    const double r = dot(d, right), u = dot(d, up), f = dot(d, forward);
    return std::array{r - tan_x * f, -r - tan_x * f, u - tan_y * f, -u - tan_y * f};
  });
  double r_low = slack[0], r_high = -slack[1], u_low = slack[2], u_high = -slack[3], r = 0, u = 0;
  for (int step = 0; step < 12; ++step) {
    r = (r_low + r_high) / 2;
    u = (u_low + u_high) / 2;
    const auto reach = greatest(world, sea, [&](Vec3d p) {
      const Vec3d d = p - camera.eye;
      const double depth = dot(d, forward), x = (dot(d, right) - r) / depth, y = (dot(d, up) - u) / depth;
      return std::array{x, -x, y, -y};
    });
    (reach[0] > reach[1] ? r_low : r_high) = r;
    (reach[2] > reach[3] ? u_low : u_high) = u;
  }
  const Vec3d by = right * r + up * u;
  camera.eye += by;
  camera.target += by;
  return camera;
}

Camera best_outside(const World& world, const RenderSettings& settings, std::optional<float> sea) {
  const double aspect = 1.0 * settings.width / settings.height;
  const double fov = Camera{}.fov;
  std::vector<double> azimuths, elevations;
  if (settings.azimuth)
    azimuths = {*settings.azimuth};
  else
    for (int i = 0; i < 16; ++i) azimuths.push_back((i + 0.5) * pi / 8);
  if (settings.elevation)
    elevations = {*settings.elevation};
  else
    elevations.assign(std::begin(elevations_tried), std::end(elevations_tried));
  Camera best;
  double best_score = -1e300;
  for (const double elevation : elevations)
    for (const double azimuth : azimuths) {
      const Camera camera = fit(world, azimuth, elevation, fov, aspect, sea);
      if (azimuths.size() * elevations.size() == 1) return center(world, camera, aspect, sea);
      const double score = interest(world, camera, aspect, sea) * (elevation > high_from ? high_worth : 1.0);
      if (score <= best_score) continue;
      best_score = score;
      best = camera;
    }
  return center(world, best, aspect, sea);
}

Camera best_inside(const World& world, std::optional<Vec3f> eye, std::optional<float> sea) {
  if (!eye) eye = find_cave(world, sea);
  if (!eye)
    fail(ErrorKind::input,
         "Nothing in this mesh is roofed, so there is no inside to look at; give the camera's position.");
  const float room = look_around(world, *eye).room;
  Camera camera;
  camera.eye = to_double(*eye);
  camera.target =
      camera.eye + to_double(best_direction(world, *eye, room).direction) * std::max<double>(room, 1e-3);
  camera.fov = inside_fov;
  return camera;
}

}  // namespace tafoni::render::impl
