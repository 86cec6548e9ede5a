// The primitives of passages, rooms and dolines: points side by side along each passage, layers of points for
// a room, a bowl around each place where water sinks in. What would leave a closed pocket in the rock is
// taken out again.

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/karst/passages.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

/// The streams of passages, dolines and rooms are counted on from these.
enum class CarvingStream : std::uint64_t {
  unevenness = 11,
  breadth = 12,
  slots = 13,
  rooms_outline = 14,
  passages = 0x1000,
  dolines = 0x20000000,
  rooms = 0x40000000
};

Random random_of(std::uint64_t seed, CarvingStream first, std::size_t i) {
  return Random(seed, static_cast<std::uint64_t>(first) + i);
}

// Chosen by eye. Radii are those of the passage at the place, unless said otherwise.
constexpr double reach_in_radii = 1.7;  // of a point's influence over the half-height that it opens
constexpr double closing = 1.2;         // place steps; a narrower tube would close between its places
constexpr double level_slope = 0.7;     // share of a step in plan, above which a stream cuts a slot
constexpr double round_breadth = 0.35;  // below, one point a place makes the vault
constexpr double broad_for_3 = 0.6, broad_for_4 = 1.1;  // above these, three and four do
// Neighbours a radius apart share what one of them would do alone.
constexpr double share_of_two = 0.75, share_of_more = 0.68;
constexpr double slot_width = 0.45, slot_step = 0.55, slot_energy = 0.75;  // radii, radii, share
constexpr double least_contrast = 0.12;  // of resistance: below, a wall shows no bed
constexpr double scallop_chance = 0.5;   // at a place of a wall without beds
constexpr std::size_t bare_ends = 3;     // places: there a passage is narrower than its sections say
constexpr double narrow = 8;             // where a way is less open than this many times the breadth asked

struct Point {
  Vec3d center;
  double reach, energy;  ///< metres; energy > 0 carves
  Vec3d from;            ///< the place that it widens, to which a way must be open
};

/// The cross-section at one place of a passage.
struct Section {
  Vec3d at, side;       ///< side: unit, horizontal, to the left
  double radius, step;  ///< open half-height; distance to the next place
  double broad;         ///< half-width beyond the half-height, in radii
  double slot;          ///< depth of the slot in the floor, in radii
};

constexpr int grooves = 5;  ///< heights at which each wall is tested for a soft bed

class Carver {
 public:
  Carver(const Ground& ground, const CaveSize& size, const PassageSettings& s, std::uint64_t seed,
         std::size_t passage)
      : ground_(ground),
        radius_(size.radius),
        s_(s),
        seed_(seed),
        random_(random_of(seed, CarvingStream::passages, passage)),
        amplitude_(ground.site().amplitude) {}

  void carve(const Passage& passage) {
    measure(passage);
    for (const Section& section : sections_) body(section);
    if (s_.roughness > 0) follow_beds();
  }
  std::vector<Point> body_points;
  std::vector<Point> wall_points;

 private:
  void measure(const Passage& passage) {
    const std::size_t n = passage.line.size();
    std::array<std::vector<float>, 3> noise;
    std::vector<Vec3d> places(n);
    struct Unevenness {
      CarvingStream stream;
      double waves;  ///< a radius
      int octaves;
    };
    constexpr std::array<Unevenness, 3> kinds = {{{CarvingStream::unevenness, 0.35, 3},
                                                  {CarvingStream::breadth, 0.16, 2},
                                                  {CarvingStream::slots, 0.12, 2}}};
    for (std::size_t k = 0; k < kinds.size(); ++k) {
      noise[k].resize(n);
      for (std::size_t i = 0; i < n; ++i)
        places[i] = (passage.line[i] + ground_.site().origin) * (kinds[k].waves / radius_);
      fbm(places, kinds[k].octaves, hash_combine(seed_, kinds[k].stream), noise[k]);
    }
    for (std::size_t i = 0; i < n; ++i) {
      const Vec3d before = passage.line[i > 0 ? i - 1 : i], after = passage.line[std::min(i + 1, n - 1)];
      const Vec3d ahead = after - before;
      const double level = std::hypot(ahead.x, ahead.y) / std::max(length(ahead), 1e-9);
      const double uneven = 2 * double{noise[0][i]} - 1;
      const double r = passage.radius[i] * std::clamp(1 + 1.3 * s_.roughness * uneven, 0.6, 1.6);
      // Shafts are round; what runs level is broad along the bedding or has a slot cut by its stream.
      const double broad = std::clamp(5.5 * (noise[1][i] - 0.36), 0.1, 1.9);
      const double slot = std::clamp(9.0 * (noise[2][i] - 0.52), 0.0, 2.0);
      sections_.push_back({passage.line[i], normalized(Vec3d{-ahead.y, ahead.x, 0}), r,
                           std::max(0.5 * length(ahead) * (i > 0 && i + 1 < n ? 1 : 2), 0.1 * radius_),
                           broad * level, level > level_slope ? slot : 0});
    }
  }

  /// Narrower tubes would close between the places.
  double least() const { return closing * place_step * radius_; }
  double height(const Section& c) const { return std::max(c.radius / (1 + 0.3 * c.broad), least()); }

  /// A low broad vault: points side by side, so that the roof is flatter than round; the slot below it.
  void body(const Section& c) {
    const double low = height(c), reach = reach_in_radii * low,
                 energy = tube_energy(amplitude_, low, reach, c.step);
    if (c.broad < round_breadth) {
      const double round = std::max(c.radius, least());
      add(c.at, c.at, reach_in_radii * round, tube_energy(amplitude_, round, reach_in_radii * round, c.step));
    } else {
      const int n = c.broad > broad_for_4 ? 4 : c.broad > broad_for_3 ? 3 : 2;
      for (int i = 0; i < n; ++i) {
        const double u = 2.0 * i / (n - 1) - 1;
        add(c.at + c.side * (u * c.broad * low), c.at, reach,
            energy * (n == 2 ? share_of_two : share_of_more));
      }
    }
    const double thin = std::max(slot_width * c.radius, least());
    for (double depth = 0.35; depth < c.slot; depth += slot_step)
      add(c.at - Vec3d{0, 0, low * 0.6 + depth * c.radius}, c.at, reach_in_radii * thin,
          slot_energy * tube_energy(amplitude_, thin, reach_in_radii * thin, c.step));
  }

  /// Walls recede into the softest bed that they cut, which leaves ledges of the harder ones.
  void follow_beds() {
    probes_.clear();
    for (const Section& c : sections_)
      for (double hand : {-1.0, 1.0})
        for (int k = 0; k < grooves; ++k) probes_.push_back(wall(c, hand, k));
    rho_.resize(probes_.size());
    ground_.resistances(probes_, rho_);
    // What is scooped at an end would be closed.
    for (std::size_t i = bare_ends; i + bare_ends < sections_.size(); ++i)
      for (std::size_t hand = 0; hand < 2; ++hand) {
        const auto first = rho_.begin() + (2 * i + hand) * grooves;
        const auto soft = std::min_element(first, first + grooves);
        const auto hard = std::max_element(first, first + grooves);
        const double contrast = *hard - *soft;
        if (contrast < least_contrast) {
          scallop(sections_[i], hand == 0 ? -1 : 1);
          continue;
        }
        const double r = sections_[i].radius;
        const double reach = r * (0.45 + 0.25 * std::min(1.0, 2 * contrast)) * random_.uniform(0.85, 1.15);
        scoop(probes_[soft - rho_.begin()], sections_[i].at, reach,
              s_.roughness * std::min(2.2, 6 * contrast) *
                  tube_energy(amplitude_, 0.55 * reach, reach, std::min(sections_[i].step, 0.5 * reach)));
      }
  }

  /// A place on the wall, at one of the tested heights.
  Vec3d wall(const Section& c, double hand, int k) const {
    const double low = height(c);
    const double h = 0.75 * (2.0 * k / (grooves - 1) - 1);
    return c.at + c.side * (hand * low * (c.broad + 0.85 * std::sqrt(1 - h * h))) + Vec3d{0, 0, h * low};
  }

  /// In rock without beds the wall is scooped at random.
  void scallop(const Section& c, double hand) {
    if (random_.uniform() > scallop_chance) return;
    const Vec3d at = wall(c, hand, draw_index(random_, grooves));
    scoop(at, c.at, c.radius * random_.uniform(0.35, 0.6), 1.5 * s_.roughness * amplitude_);
  }

  void add(Vec3d p, Vec3d from, double reach, double energy) {
    body_points.push_back({p, reach, energy, from});
  }
  void scoop(Vec3d p, Vec3d from, double reach, double energy) {
    wall_points.push_back({p, reach, energy, from});
  }

  const Ground& ground_;
  double radius_;  ///< of a middling passage
  const PassageSettings& s_;
  std::uint64_t seed_;
  Random random_;
  double amplitude_;
  std::vector<Section> sections_;
  std::vector<Vec3d> probes_;
  std::vector<float> rho_;
};

/// The height above the room's centre where the softest rock lies under the hardest: its roof.
double roof_of(const Chamber& room, const Ground& ground) {
  constexpr int n = 24;
  std::vector<Vec3d> up;
  std::vector<float> rho(n);
  for (int i = 0; i < n; ++i)
    up.push_back(room.center + Vec3d{0, 0, room.radius * (0.2 + 0.6 * i / (n - 1))});
  ground.resistances(up, rho);
  std::size_t best = n / 2;
  float contrast = 0.02f;
  for (std::size_t i = 3; i + 3 < n; ++i) {
    const float step = rho[i + 1] + rho[i + 2] + rho[i + 3] - rho[i - 1] - rho[i - 2] - rho[i - 3];
    if (step > contrast) {
      contrast = step;
      best = i;
    }
  }
  return 0.6 * static_cast<double>(best) / (n - 1) + 0.2;
}

/// Layers of points with ragged outlines that shrink towards the roof; blocks are left on the floor.
std::vector<Point> carve_room(const Chamber& room, const Ground& ground, Random random, std::uint64_t seed) {
  const double amplitude = ground.site().amplitude, roof = roof_of(room, ground) * room.radius;
  const double apart = 0.24 * room.radius, reach = reach_in_radii * apart, floor = -0.3 * room.radius;
  // The falloffs of a dense lattice sum up to 0.638 (reach / apart)^3.
  const double energy = 1.5 * amplitude / (0.638 * reach_in_radii * reach_in_radii * reach_in_radii);
  const double turn = random.uniform(0, 6.283), slim = random.uniform(0.6, 0.95);
  const Vec3d u{std::cos(turn), std::sin(turn), 0}, v{-u.y, u.x, 0};
  const int layers = std::max(2, round_to((roof - floor) / apart));
  std::vector<Point> points;
  for (int k = 0; k < layers; ++k) {
    const double t = 1.0 * k / (layers - 1);
    const double z = floor + 0.4 * apart + (roof - floor - 0.8 * apart) * t;
    // Corbelled: a step in every second layer.
    const double shrunk = 1 - 0.5 * smoothstep(0.3, 1.1, 0.5 * std::floor(2 * t * 2) / 2 + 0.5 * t);
    const int n = ceil_to(room.radius / apart);
    for (int j = -n; j <= n; ++j)
      for (int i = -n; i <= n; ++i) {
        const double x = (i + random.uniform(-0.3, 0.3)) * apart, y = (j + random.uniform(-0.3, 0.3)) * apart;
        const Vec3d p = room.center + u * x + v * (y * slim) + Vec3d{0, 0, z};
        const double bulge = 0.75 + 0.5 * fbm((p + ground.site().origin) * (1.2 / room.radius), 2, seed);
        if (std::hypot(x, y) > room.radius * shrunk * bulge) continue;
        if (k == 0 && random.uniform() < 0.35) continue;
        points.push_back({p, reach, energy, room.center});
      }
  }
  return points;
}

/// A bowl around a swallet: one broad shallow point and a few steps down to the shaft.
std::vector<Point> carve_doline(Vec3d p, double radius, Random random) {
  std::vector<Point> points = {{p, 4.2 * radius, 0.9 * radius, p}};
  for (int i = 0; i < 5; ++i) {
    const Vec3d at = p + Vec3d{random.uniform(-1.6, 1.6) * radius, random.uniform(-1.6, 1.6) * radius,
                               random.uniform(-0.5, 0) * radius};
    points.push_back({at, random.uniform(1.4, 2.2) * radius, 0.5 * radius, at});
  }
  return points;
}

template <class T>
std::vector<T> join(const std::vector<std::vector<T>>& parts) {
  std::vector<T> all;
  for (const auto& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

/// Removes the points from which no straight way, lower than -`breadth` all along, leads to where they widen
/// a passage: where passages narrow or end they would leave closed pockets in the rock. `alone`: a point
/// joins the field by itself; others then only widen its way. Gives whether any went.
bool drop_pockets(const field::CompiledField& field, double breadth, bool alone, std::vector<Point>& points) {
  constexpr int steps = 8;
  std::vector<Vec3d> ways;
  for (const Point& p : points)
    for (int k = 0; k < steps; ++k) ways.push_back(p.center + (p.from - p.center) * (1.0 * k / steps));
  std::vector<float> values(ways.size());
  parallel_blocks(std::ssize(ways), 8192, [&](std::int64_t begin, std::int64_t end) {
    field.values(std::span(ways).subspan(begin, end - begin), std::span(values).subspan(begin, end - begin));
  });
  const auto closed = [&](const Point& p, std::size_t i) {
    const double r = length(ways[i] - p.center) / p.reach, g = alone && r < 1 ? std::pow(1 - r * r, 3) : 0;
    return values[i] - p.energy * g > -breadth;
  };
  std::vector<Point> kept;
  for (std::size_t i = 0; i < points.size(); ++i) {
    bool open = true;
    for (std::size_t k = 0; k < steps && open && points[i].from != points[i].center; ++k)
      open = !closed(points[i], steps * i + k);
    // Where the passage itself is narrow it needs all that widens it.
    const bool tight = !alone && values[steps * i + steps - 1] > -narrow * breadth;
    if (open || tight) kept.push_back(points[i]);
  }
  const bool any = kept.size() < points.size();
  points = std::move(kept);
  return any;
}

field::NodePtr cloud_of(std::span<const Point> points, const Ground& ground) {
  field::CloudBuilder cloud{field::CloudSettings{}};
  for (const Point& p : points)
    if (ground.usable(p.center)) add_point(cloud, p.center, p.reach, -p.energy);
  return cloud.size() ? cloud.finish() : nullptr;
}

}  // namespace

field::NodePtr carve_passages(const CaveSystem& caves, const Ground& ground, const CaveSize& size,
                              const PassageSettings& settings, std::uint64_t seed) {
  const std::size_t passages = caves.passages.size(), rooms = caves.chambers.size();
  std::vector<std::vector<Point>> parts(passages + rooms + caves.swallets.size());
  std::vector<std::vector<Point>> walls(passages), halls(rooms);
  parallel_for(std::ssize(parts), [&](std::int64_t job) {
    const std::size_t i = job;
    if (i < passages) {
      Carver carver(ground, size, settings, seed, i);
      carver.carve(caves.passages[i]);
      parts[i] = std::move(carver.body_points);
      walls[i] = std::move(carver.wall_points);
    } else if (i < passages + rooms) {
      halls[i - passages] =
          carve_room(caves.chambers[i - passages], ground, random_of(seed, CarvingStream::rooms, i),
                     hash_combine(seed, CarvingStream::rooms_outline));
    } else {
      parts[i] = carve_doline(caves.swallets[i - passages - rooms], size.radius,
                              random_of(seed, CarvingStream::dolines, i));
    }
  });
  std::vector<Point> body = join(parts), wall = join(walls), hall = join(halls);
  const auto with = [&](const field::NodePtr& node) {
    return field::compile(field::blend({ground.site().terrain, node}));
  };
  const auto open_all = [&] {
    std::vector<Point> all = body;
    all.insert(all.end(), hall.begin(), hall.end());
    return cloud_of(all, ground);
  };
  field::NodePtr open = open_all();
  // What a third look would still find is rare, and each costs as much as all the rest.
  bool any = true;
  for (int look = 0; look < 2 && open && any; ++look) {
    const field::CompiledField now = with(open);
    any = drop_pockets(now, size.radius, false, body);
    any = drop_pockets(now, 0, false, hall) || any;
    if (any) open = open_all();
  }
  if (!open) return nullptr;
  drop_pockets(with(open), size.radius, true, wall);
  const field::NodePtr scooped = cloud_of(wall, ground);
  return scooped ? field::blend({open, scooped}) : open;
}

}  // namespace tafoni::landforms::impl
