// A cliffed limestone coast seen as a heightfield: sea to the south; bays, headlands, narrow inlets along
// joints, stacks; bedded cliffs with ledges above a shore platform; a terraced plateau with dolines and a dry
// valley.

#include <algorithm>
#include <cmath>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/face.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"
#include "tafoni/terrain/impl/shore.h"

namespace tafoni::terrain::generator_coast {
namespace {

using impl::PlaneNoise;
using impl::soft_min;

struct Coast : GridSettings {
  double sea = 0.34;
  double cliff = 46;
  double bays = 75;
  double bay_size = 300;
  double inlets = 9;
  double stacks = 20;
  double tilt = 0.05;
  double hills = 240;
  double terrace = 5;
  double dolines = 5;
  double roughness = 1;
};

const ParamTable<Coast>& table() {
  static const ParamTable<Coast> params = [] {
    ParamTable<Coast> t;
    add_grid_params(t);
    t.real("sea", &Coast::sea, "", 0, 1, "About which share of the map is sea")
        .real("cliff", &Coast::cliff, "m", 1, 1000,
              "Mean height of the cliffs, and of the plateau behind them")
        .real("bays", &Coast::bays, "m", 0, 5000,
              "How far bays reach in and headlands out; 0 for a straight coast")
        .real("bay_size", &Coast::bay_size, "m", 20, 50000, "Distance from bay to bay")
        .only("where bays is above 0")
        .real("inlets", &Coast::inlets, "1/km", 0, 100,
              "Narrow inlets along joints, per km of coast; 0 for none")
        .real("stacks", &Coast::stacks, "1/km", 0, 200,
              "Sea stacks and skerries per km of coast, as far as headlands give room; 0 for none")
        .real("tilt", &Coast::tilt, "", 0, 1, "Rise of the plateau inland, metres per metre")
        .real("hills", &Coast::hills, "m", 10, 1e5, "Distance from hill to hill on the plateau")
        .real("terrace", &Coast::terrace, "m", 0, 100, "Height of the plateau's steps; 0 for none")
        .real("dolines", &Coast::dolines, "1/ha", 0, 50, "Sinkholes per hectare of plateau; 0 for none")
        .real("roughness", &Coast::roughness, "", 0, 4,
              "Strength of small relief: 0 for smooth ground, 4 for broken rock");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t {
  warp_x = 1,
  warp_y = 2,
  bays = 3,
  crags = 4,
  jag_x = 5,
  jag_y = 6,
  clusters = 7,
  shelf = 8,
  shelf_crags = 9,
  inlets = 12,
  stacks = 13,
  dolines = 14,
  hills = 20,
  knolls = 21,
  valleys = 22,
  grain = 23,
  wobble = 24,
  ledges = 25,
  gullies = 31,
  steepness = 33,
  rocks = 34,
  reefs = 35
};

/// Chosen by eye after photographs of limestone coasts; metres where nothing else is said.
namespace look {
// The shoreline.
constexpr double warp_size = 0.4, warp = 0.12;        // of a bay: bays lean to one side
constexpr double crag_size = 0.16, crag_depth = 0.3;  // of a bay; of how far bays reach
constexpr double jag_size = 26, jags = 6.0;           // small jags of everything at the water's edge
constexpr double lean = 0.5, lean_spread = 0.3;       // radians: of the set of joints; of one inlet in it
constexpr double inlet_least = 25, inlet_most = 70;   // lengths
constexpr double inlet_narrow = 3, inlet_wide = 6.5;  // half widths at the mouth
constexpr double inlet_taper = 0.8;                   // share of its width that an inlet loses to its head
constexpr double inlet_start = 12;                    // an inlet begins this far out, so that it opens
// Stacks.
constexpr double stack_near = 8, stack_far = 65;  // off the shore
constexpr double skerries = 0.45;                 // share of stacks that are low
constexpr double skerry_least = 2.5, skerry_most = 5, stack_least = 6, stack_most = 13;  // radii
constexpr double skerry_low = 1.5, skerry_high = 6, stack_low = 0.3, stack_high = 0.75;  // tops; of the cliff
constexpr double stack_room = 5;                        // water between two stacks
constexpr double stack_chance = 0.6, stack_loss = 0.8;  // off a headland, and how it falls into a bay
constexpr double stack_tries = 40;                      // times the number wanted
// The shelf between the shore and the foot of the cliffs.
constexpr double shelf_narrow = 3, shelf_wide = 11;  // on headlands, and how much more in bays
constexpr double shelf_size = 70, shelf_crag_size = 20, shelf_crags = 5;
constexpr double shelf_least = 0.7, stack_shelf = 1.2;  // in inlets; about stacks
constexpr double shelf_top = 1.8, shelf_relief = 0.4;   // its elevation
// The cliffs.
constexpr double gully_size = 16, steep_size = 120;  // gullies run straight up; faces lean by stretches
constexpr double rock_size = 9, rock_depth = 0.7, gully_depth = 0.8;
constexpr double stack_lean = 1.8, lean_mean = 1.2,
                 lean_range = 0.4;         // how much nearer the top is than of a face
constexpr double brow = 5, brow_run = 14;  // the rim is worn this much, over this way
constexpr double rim = 2.0;                // rounding of the rim
constexpr double lowest_land = 0.05;       // so that land is land
// The plateau.
constexpr double hill_relief = 0.28;  // of the cliff's height
constexpr double knoll_size = 60, knolls = 2.2, grain_size = 7, grain = 0.35;
constexpr double valley_size = 1.75, valley_width = 0.09;  // of hills; of the noise, squared
constexpr double valley_share = 0.12, valley_depth = 4;    // of the height, and metres
constexpr double ledge_size = 130, ledge_share = 0.6;      // terraces come and go
constexpr double step_from = 0.2, step_run = 0.6;          // of a terrace: its tread, its riser
// Dolines.
constexpr double cluster_size = 150, cluster_share = 0.9;
constexpr double doline_radius = 6, doline_range = 4.5;  // the least, and the greatest as a multiple of it
constexpr double collapsed = 0.3, wall_run = 0.45;       // share with upright walls, and where these end
constexpr double doline_room = 20;                       // kept from the cliffs
constexpr double wobble_size = 18, wobble = 0.3;         // they are not round
// The sea floor.
constexpr double reef_size = 40, reef_height = 5, reef_rocks = 1.2, reef_level = 3.5;
constexpr double bare_run = 45, bare_far = 0.12;  // rock shows beside the shore, and little far out
constexpr double first_depth = 0.4, near_depth = 3.5, near_run = 25, sea_slope = 0.045;
constexpr double reef_run = 12;  // off the shore: where reefs have their full height
}  // namespace look

struct Stack {
  Vec2d center;
  double radius, top;
};

/// A wedge of sea along a joint.
struct Inlet {
  Vec2d mouth, direction;
  double length, half_width;

  double outside(Vec2d p) const {
    const Vec2d d = p - mouth;
    const double along = std::clamp(d.x * direction.x + d.y * direction.y, 0.0, length);
    const Vec2d off = d - direction * along;
    return std::hypot(off.x, off.y) - half_width * (1 - look::inlet_taper * along / length);
  }
};

struct Doline {
  Vec2d center;
  double radius, depth;
  bool collapsed;
};

class Builder {
 public:
  Builder(const Coast& p, std::uint64_t seed)
      : p_(p),
        seed_(seed),
        width_(p.columns()),
        height_(p.rows()),
        extent_(p.extent()),
        face_(6 * p.cliff, {}, seed) {
    for (impl::Shore* line : {&shore_, &foot_}) {
      line->inside.values = raster::Grid<float>(width_, height_);
      line->inside.placement = impl::placement_of(p);
    }
  }

  raster::Raster run(Progress& progress) {
    progress.begin("coast", 3 * height_, "rows");
    base_ = baseline();
    place_inlets();
    place_stacks();
    impl::for_rows(p_, progress, [this](int row, const Points& points) { draw_lines(row, points); });
    impl::drop_lagoons(shore_.inside.values);
    shore_.contour = impl::trace_contour(shore_.inside);
    foot_.contour = impl::trace_contour(foot_.inside);
    progress.advance(height_);
    place_dolines();
    raster::Raster out = impl::fill_rows(
        p_, progress,
        [this](int row, const Points& points, std::span<double> heights) { relief(row, points, heights); });
    progress.end();
    return out;
  }

 private:
  using Points = std::vector<Vec2d>;

  PlaneNoise noise(double wavelength, int octaves, Stream stream) const {
    return {wavelength, octaves, seed_, stream};
  }

  /// Positive on land, before inlets and stacks; metres, roughly the distance northward from the shore.
  std::vector<double> open_coast(const Points& points) const {
    const auto wx = noise(look::warp_size * p_.bay_size, 3, Stream::warp_x).at(points),
               wy = noise(look::warp_size * p_.bay_size, 3, Stream::warp_y).at(points);
    Points warped(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      warped[i] = points[i] + Vec2d{wx[i], wy[i]} * (look::warp * p_.bay_size);
    const auto bays = noise(p_.bay_size, 2, Stream::bays).at(warped),
               crags = noise(look::crag_size * p_.bay_size, 4, Stream::crags).at(warped);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = points[i].y - base_ + p_.bays * (bays[i] + look::crag_depth * crags[i]);
    return out;
  }

  /// The y about which the shore swings so that the sea has its share, from a sample of the map.
  double baseline() const {
    constexpr int samples = 96;
    std::vector<double> land;
    for (int row = 0; row < samples; ++row) {
      Points points;
      for (int col = 0; col < samples; ++col)
        points.push_back({(col + 0.5) / samples * extent_.x, (row + 0.5) / samples * extent_.y});
      const auto values = open_coast(points);
      land.insert(land.end(), values.begin(), values.end());
    }
    const auto share = floor_to(p_.sea * (samples * samples - 1));
    std::nth_element(land.begin(), land.begin() + share, land.end());
    return land[share];
  }

  /// The least y that is land at x.
  double shore(double x) const {
    Points column;
    for (double y = 0; y < extent_.y; y += 2 * p_.pixel) column.push_back({x, y});
    const auto land = open_coast(column);
    for (std::size_t i = 0; i < land.size(); ++i)
      if (land[i] > 0) return column[i].y;
    return extent_.y;
  }

  int per_length(double count) const { return round_to(std::min(1e5, count * extent_.x / 1000)); }

  void place_inlets() {
    Random random(seed_, Stream::inlets);
    // Joints come in a set: most inlets lean the same way.
    const double lean = random.uniform(-look::lean, look::lean);
    for (int i = 0; i < per_length(p_.inlets); ++i) {
      const double x = random.uniform(0, extent_.x);
      const double angle = lean + random.uniform(-look::lean_spread, look::lean_spread);
      const double length = random.uniform(look::inlet_least, look::inlet_most),
                   half_width = random.uniform(look::inlet_narrow, look::inlet_wide);
      const Vec2d direction{std::sin(angle), std::cos(angle)};
      inlets_.push_back({Vec2d{x, shore(x)} - direction * look::inlet_start, direction,
                         length + look::inlet_start, half_width});
    }
  }

  void place_stacks() {
    Random random(seed_, Stream::stacks);
    const int wanted = per_length(p_.stacks);
    for (int tries = 0; std::ssize(stacks_) < wanted && tries < look::stack_tries * wanted; ++tries) {
      const double x = random.uniform(0, extent_.x), out = random.uniform(look::stack_near, look::stack_far);
      const bool skerry = random.uniform() < look::skerries;
      const double radius = skerry ? random.uniform(look::skerry_least, look::skerry_most)
                                   : random.uniform(look::stack_least, look::stack_most);
      const double top = skerry ? random.uniform(look::skerry_low, look::skerry_high)
                                : random.uniform(look::stack_low, look::stack_high) * p_.cliff;
      const Vec2d center{x, shore(x) - out};
      // Stacks are what is left of headlands: the farther into a bay, the fewer.
      const double into_bay = (center.y + out - base_) / std::max(p_.bays, 1.0);
      const bool keep = random.uniform() < look::stack_chance - look::stack_loss * into_bay;
      const bool clear = std::none_of(stacks_.begin(), stacks_.end(), [&](const Stack& s) {
        return std::hypot(s.center.x - center.x, s.center.y - center.y) <
               s.radius + radius + look::stack_room;
      });
      if (keep && clear && center.y > 0) stacks_.push_back({center, radius, top});
    }
  }

  /// Beyond its outline by this much a feature changes no sign.
  double margin() const { return 14 + 2 * p_.pixel; }

  struct Reach {
    Vec2d center;
    double radius;
  };
  /// Those of `all` that matter on the row at y.
  template <class T, class ReachOf>
  std::vector<T> near(const std::vector<T>& all, double y, const ReachOf& reach_of) const {
    std::vector<T> out;
    for (const T& one : all) {
      const Reach reach = reach_of(one);
      if (std::abs(y - reach.center.y) < reach.radius + margin()) out.push_back(one);
    }
    return out;
  }

  /// The shoreline and, behind a shelf that is wide in bays and missing in inlets, the foot of the cliffs.
  void draw_lines(int row, const Points& points) {
    const auto land = open_coast(points);
    const auto jx = noise(look::jag_size, 4, Stream::jag_x).at(points),
               jy = noise(look::jag_size, 4, Stream::jag_y).at(points);
    const auto shelf = noise(look::shelf_size, 3, Stream::shelf).at(points),
               crags = noise(look::shelf_crag_size, 4, Stream::shelf_crags).at(points);
    const double y = points.front().y;
    const auto inlets = near(inlets_, y, [](const Inlet& o) {
      return Reach{o.mouth, o.length + o.half_width};
    });
    const auto stacks = near(stacks_, y, [](const Stack& o) { return Reach{o.center, o.radius}; });
    for (int i = 0; i < width_; ++i) {
      const Vec2d p = points[i] + Vec2d{jx[i], jy[i]} * look::jags;
      const double into_bay = (points[i].y - base_) / std::max(p_.bays, 1.0);
      const double width =
          (look::shelf_narrow + look::shelf_wide * smoothstep(0.0, 1.0, 0.4 + into_bay)) * (0.8 + shelf[i]) +
          look::shelf_crags * p_.roughness * crags[i];
      double sea = land[i], rock = land[i] - std::max(width, look::shelf_least);
      for (const Inlet& inlet : inlets) {
        if (std::abs(p.x - inlet.mouth.x) > inlet.length + inlet.half_width + margin()) continue;
        sea = std::min(sea, inlet.outside(p));
        rock = std::min(rock, inlet.outside(p) - look::shelf_least);
      }
      for (const Stack& stack : stacks) {
        if (std::abs(p.x - stack.center.x) > stack.radius + margin()) continue;
        const double island = stack.radius - std::hypot(p.x - stack.center.x, p.y - stack.center.y);
        sea = std::max(sea, island);
        rock = std::max(rock, island - look::stack_shelf);
      }
      shore_.inside.values.at(i, row) = static_cast<float>(sea);
      foot_.inside.values.at(i, row) = static_cast<float>(rock);
    }
  }

  void place_dolines() {
    Random random(seed_, Stream::dolines);
    const double hectares = extent_.x * extent_.y / 1e4;
    const int tries = round_to(std::min(1e6, p_.dolines * hectares));
    const PlaneNoise clusters = noise(look::cluster_size, 2, Stream::clusters);
    for (int k = 0; k < tries; ++k) {
      const Vec2d c{random.uniform(0, extent_.x), random.uniform(0, extent_.y)};
      const double radius =
          look::doline_radius * std::pow(look::doline_range, random.uniform() * random.uniform());
      const double depth = radius * random.uniform(0.35, 0.65);
      const bool collapsed = random.uniform() < look::collapsed;
      const bool wanted = random.uniform() < 0.5 + look::cluster_share * clusters.at(c);
      const Vec2d pixel = foot_.inside.placement.pixel(c.x, c.y);
      const int col = std::clamp(round_to(pixel.x), 0, width_ - 1);
      const int row = std::clamp(round_to(pixel.y), 0, height_ - 1);
      const double inland = foot_.distance(foot_.inside.values.index(col, row), c).first;
      if (wanted && inland > radius + look::doline_room) dolines_.push_back({c, radius, depth, collapsed});
    }
  }

  double doline_depth(const Doline& d, Vec2d p, double wobble) const {
    const double r = std::hypot(p.x - d.center.x, p.y - d.center.y) / d.radius * (1 + look::wobble * wobble);
    if (r >= 1) return 0;
    return d.depth * (d.collapsed ? smoothstep(0.0, look::wall_run, 1 - r)
                                  : std::pow(1 - r, 1.2) * smoothstep(0.0, 0.25, 1 - r));
  }

  /// Elevation of the plateau, had the sea never come, along a row.
  std::vector<double> plateau(const Points& points, const std::vector<double>& inland) const {
    const auto hills = noise(p_.hills, 3, Stream::hills).at(points),
               knolls = noise(look::knoll_size, 4, Stream::knolls).at(points);
    const auto valleys = noise(look::valley_size * p_.hills, 2, Stream::valleys).at(points),
               grain = noise(look::grain_size, 4, Stream::grain).at(points);
    const auto wobble = noise(look::wobble_size, 2, Stream::wobble).at(points),
               ledges = noise(look::ledge_size, 2, Stream::ledges).at(points);
    const auto dolines = near(dolines_, points.front().y, [](const Doline& o) {
      return Reach{o.center, 1.5 * o.radius};
    });
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double back = std::max(inland[i], 0.0);
      double h = p_.cliff * (1 + look::hill_relief * hills[i]) + p_.tilt * back +
                 look::knolls * p_.roughness * knolls[i];
      const double valley = std::max(0.0, 1 - valleys[i] * valleys[i] / look::valley_width);
      h -= valley * valley * (look::valley_share * h + look::valley_depth);
      if (p_.terrace > 0) {
        const double steps = h / p_.terrace, whole = std::floor(steps);
        const double stepped =
            (whole + smoothstep(0.0, look::step_run, steps - whole - look::step_from)) * p_.terrace;
        h += look::ledge_share * smoothstep(0.0, 1.0, 0.5 + 1.2 * ledges[i]) * (stepped - h);
      }
      h += look::grain * p_.roughness * grain[i];
      double hole = 0;
      for (const Doline& d : dolines)
        if (std::abs(points[i].x - d.center.x) < 1.5 * d.radius)
          hole = std::max(hole, doline_depth(d, points[i], wobble[i]));
      out[i] = h - hole;
    }
    return out;
  }

  void relief(int row, const Points& points, std::span<double> out) const {
    std::vector<double> inland(points.size()), behind(points.size());
    Points foot(points.size());
    const std::size_t row_begin = shore_.inside.values.index(0, row);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t cell = row_begin + i;
      inland[i] = shore_.distance(cell, points[i]).first;
      std::tie(behind[i], foot[i]) = foot_.distance(cell, points[i]);
    }
    const auto top = plateau(points, behind);
    const auto stacks = near(stacks_, points.front().y, [](const Stack& o) {
      return Reach{o.center, o.radius};
    });
    // What depends on the nearest point of the foot runs straight up the face.
    const auto gully = noise(look::gully_size, 2, Stream::gullies).at(foot),
               steep = noise(look::steep_size, 2, Stream::steepness).at(points);
    const auto rocks = noise(look::rock_size, 4, Stream::rocks).at(points),
               reef = noise(look::reef_size, 4, Stream::reefs).at(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = inland[i];
      if (d <= 0) {
        out[i] = sea_floor(d, rocks[i], reef[i]);
        continue;
      }
      const double up_shelf = behind[i] > 0 ? 1 : d / (d - behind[i]);
      const double shelf = (look::shelf_top + look::shelf_relief * p_.roughness * (rocks[i] + 1)) *
                           smoothstep(0.0, 1.0, up_shelf);
      const Stack* stack = stack_at(stacks, points[i]);
      const double flute = (stack ? 0.5 : 1.0) * p_.roughness *
                           (look::rock_depth * rocks[i] + look::gully_depth * (0.6 - std::abs(gully[i])));
      const double reach =
          (behind[i] - flute) * (stack ? look::stack_lean : look::lean_mean + look::lean_range * steep[i]);
      const double summit = stack ? std::min(top[i], stack->top + 1.5 * rocks[i])
                                  : top[i] - look::brow * std::exp(-std::max(reach, 0.0) / look::brow_run);
      const double wall = shelf + face_.height(reach);
      out[i] = std::max(soft_min(wall, std::max(summit, shelf), look::rim), look::lowest_land);
    }
  }

  /// Elevation of the sea floor at d < 0 metres from the shore: bare rock lies beside it, sediment farther
  /// out.
  double sea_floor(double d, double rocks, double reef) const {
    const double bare = std::exp(d / look::bare_run) + look::bare_far;
    const double reefs =
        p_.roughness * bare *
        (look::reef_rocks * rocks + look::reef_height * (1 - std::abs(reef)) - look::reef_level);
    const double floor =
        -look::first_depth - look::near_depth * smoothstep(0.0, look::near_run, -d) + look::sea_slope * d;
    return std::min(floor + reefs * smoothstep(0.0, look::reef_run, -d), -0.05 + 0.04 * d);
  }

  static const Stack* stack_at(const std::vector<Stack>& stacks, Vec2d p) {
    for (const Stack& s : stacks)
      if (std::hypot(p.x - s.center.x, p.y - s.center.y) < s.radius + 4) return &s;
    return nullptr;
  }

  Coast p_;
  std::uint64_t seed_;
  int width_, height_;
  Vec2d extent_;
  impl::Face face_;
  std::vector<Inlet> inlets_;
  std::vector<Stack> stacks_;
  std::vector<Doline> dolines_;
  impl::Shore shore_, foot_;
  double base_ = 0;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Coast p;
  assign(table().infos(), &p, values, "coast");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "coast",
                .doc = "A rugged coast: cliffs, bays, stacks and a plateau with dolines",
                .source = "a composition of fractal noise and distances to the shoreline",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_coast
