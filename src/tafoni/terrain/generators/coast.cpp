// A cliffed limestone coast seen as a heightfield: sea to the south; bays, headlands, narrow inlets along
// joints, stacks; bedded cliffs with ledges above a shore platform; a terraced plateau with dolines and a dry
// valley.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/contour.h"
#include "tafoni/terrain/impl/face.h"
#include "tafoni/terrain/impl/plane_noise.h"

namespace tafoni::terrain {
namespace {

using impl::PlaneNoise;
using impl::smooth;
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
    t.real("sea", &Coast::sea, "", 0, 1, "about which share of the map is sea")
        .real("cliff", &Coast::cliff, "m", 1, 1000, "mean height of the cliffs")
        .real("bays", &Coast::bays, "m", 0, 5000, "how far bays reach in and headlands out")
        .real("bay_size", &Coast::bay_size, "m", 20, 50000, "distance from bay to bay")
        .real("inlets", &Coast::inlets, "1/km", 0, 100, "narrow inlets along joints, per km of coast")
        .real("stacks", &Coast::stacks, "1/km", 0, 200, "sea stacks and skerries, per km of coast")
        .real("tilt", &Coast::tilt, "", 0, 1, "rise of the plateau inland, metres per metre")
        .real("hills", &Coast::hills, "m", 10, 1e5, "distance from hill to hill on the plateau")
        .real("terrace", &Coast::terrace, "m", 0, 100, "height of the plateau's steps, 0 for none")
        .real("dolines", &Coast::dolines, "1/ha", 0, 50, "sinkholes per hectare of plateau")
        .real("roughness", &Coast::roughness, "", 0, 4, "strength of small relief");
    return t;
  }();
  return params;
}

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
    return std::hypot(off.x, off.y) - half_width * (1 - 0.8 * along / length);
  }
};

struct Doline {
  Vec2d center;
  double radius, depth;
  bool collapsed;
};

/// A line on the map: the zero of a function that is positive on its landward side.
struct Line {
  raster::Raster inside;
  impl::Contour contour;

  /// From p in cell i, positive inside, and the nearest point of the line.
  std::pair<double, Vec2d> distance(std::size_t i, Vec2d p) const {
    const bool in = inside.values.data()[i] > 0;
    const std::int32_t nearest = contour.nearest.data()[i];
    if (nearest < 0) return {in ? 1e4 : -1e4, p};
    const Vec2d s = contour.points[static_cast<std::size_t>(nearest)];
    const double d = std::hypot(p.x - s.x, p.y - s.y);
    return {in ? d : -d, s};
  }
};

class Builder {
 public:
  Builder(const Coast& p, std::uint64_t seed)
      : p_(p),
        seed_(seed),
        width_(static_cast<int>(p.width)),
        height_(static_cast<int>(p.height)),
        extent_{p.pixel * static_cast<double>(p.width), p.pixel * static_cast<double>(p.height)},
        face_(6 * p.cliff, {}, seed) {
    for (Line* line : {&shore_, &foot_}) {
      line->inside.values = raster::Grid<float>(width_, height_);
      line->inside.placement = {0, extent_.y, p.pixel, p.pixel};
    }
  }

  raster::Raster run(Progress& progress) {
    progress.begin("coast", 3 * static_cast<std::uint64_t>(height_), "rows");
    base_ = baseline();
    place_inlets();
    place_stacks();
    rows(progress, [this](int row, const Points& points) { draw_lines(row, points); });
    drop_lagoons();
    shore_.contour = impl::trace_contour(shore_.inside);
    foot_.contour = impl::trace_contour(foot_.inside);
    progress.advance(static_cast<std::uint64_t>(height_));
    place_dolines();
    raster::Raster out{raster::Grid<float>(width_, height_), shore_.inside.placement, {}};
    rows(progress, [&](int row, const Points& points) { relief(row, points, out.values.row(row)); });
    progress.end();
    return out;
  }

 private:
  using Points = std::vector<Vec2d>;

  template <class Body>
  void rows(Progress& progress, const Body& body) {
    parallel_for(
        height_,
        [&](std::int64_t row) {
          Points points(static_cast<std::size_t>(width_));
          for (int col = 0; col < width_; ++col)
            points[static_cast<std::size_t>(col)] =
                shore_.inside.placement.center(col, static_cast<double>(row));
          body(static_cast<int>(row), points);
        },
        progress);
  }

  PlaneNoise noise(double wavelength, int octaves, std::uint64_t stream) const {
    return {wavelength, octaves, hash_combine(seed_, stream)};
  }

  /// Positive on land, before inlets and stacks; metres, roughly the distance northward from the shore.
  std::vector<double> open_coast(const Points& points) const {
    const auto wx = noise(0.4 * p_.bay_size, 3, 1).at(points), wy = noise(0.4 * p_.bay_size, 3, 2).at(points);
    Points warped(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      warped[i] = points[i] + Vec2d{wx[i], wy[i]} * (0.12 * p_.bay_size);
    const auto bays = noise(p_.bay_size, 2, 3).at(warped), crags = noise(0.16 * p_.bay_size, 4, 4).at(warped);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i)
      out[i] = points[i].y - base_ + p_.bays * (bays[i] + 0.3 * crags[i]);
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
    const auto share = static_cast<std::ptrdiff_t>(p_.sea * static_cast<double>(land.size() - 1));
    std::nth_element(land.begin(), land.begin() + share, land.end());
    return land[static_cast<std::size_t>(share)];
  }

  /// North of the sea's edge at x.
  double shore(double x) const {
    Points column;
    for (double y = 0; y < extent_.y; y += 2 * p_.pixel) column.push_back({x, y});
    const auto land = open_coast(column);
    for (std::size_t i = 0; i < land.size(); ++i)
      if (land[i] > 0) return column[i].y;
    return extent_.y;
  }

  std::size_t per_length(double count) const {
    return static_cast<std::size_t>(std::min(1e5, std::round(count * extent_.x / 1000)));
  }

  void place_inlets() {
    Random random(seed_, 12);
    // Joints come in a set: most inlets lean the same way.
    const double lean = random.uniform(-0.5, 0.5);
    for (std::size_t i = 0; i < per_length(p_.inlets); ++i) {
      const double x = random.uniform(0, extent_.x);
      const double angle = lean + random.uniform(-0.3, 0.3);
      const double length = random.uniform(25, 70), half_width = random.uniform(3, 6.5);
      const Vec2d direction{std::sin(angle), std::cos(angle)};
      inlets_.push_back({Vec2d{x, shore(x)} - direction * 12, direction, length + 12, half_width});
    }
  }

  void place_stacks() {
    Random random(seed_, 13);
    const std::size_t wanted = per_length(p_.stacks);
    for (std::size_t tries = 0; stacks_.size() < wanted && tries < 40 * wanted; ++tries) {
      const double x = random.uniform(0, extent_.x), out = random.uniform(8, 65);
      const bool skerry = random.uniform() < 0.45;
      const double radius = skerry ? random.uniform(2.5, 5) : random.uniform(6, 13);
      const double top = skerry ? random.uniform(1.5, 6) : random.uniform(0.3, 0.75) * p_.cliff;
      const Vec2d center{x, shore(x) - out};
      // Stacks are what is left of headlands: the farther into a bay, the fewer.
      const double into_bay = (center.y + out - base_) / std::max(p_.bays, 1.0);
      const bool keep = random.uniform() < 0.6 - 0.8 * into_bay;
      const bool clear = std::none_of(stacks_.begin(), stacks_.end(), [&](const Stack& s) {
        return std::hypot(s.center.x - center.x, s.center.y - center.y) < s.radius + radius + 5;
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
    const auto jx = noise(26, 4, 5).at(points), jy = noise(26, 4, 6).at(points);
    const auto shelf = noise(70, 3, 8).at(points), crags = noise(20, 4, 9).at(points);
    const double y = points.front().y;
    const auto inlets = near(inlets_, y, [](const Inlet& o) {
      return Reach{o.mouth, o.length + o.half_width};
    });
    const auto stacks = near(stacks_, y, [](const Stack& o) { return Reach{o.center, o.radius}; });
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec2d p = points[i] + Vec2d{jx[i], jy[i]} * 6.0;
      const double into_bay = (points[i].y - base_) / std::max(p_.bays, 1.0);
      const double width = (3 + 11 * smooth(0.4 + into_bay)) * (0.8 + shelf[i]) + 5 * p_.roughness * crags[i];
      double sea = land[i], rock = land[i] - std::max(width, 0.7);
      for (const Inlet& inlet : inlets) {
        if (std::abs(p.x - inlet.mouth.x) > inlet.length + inlet.half_width + margin()) continue;
        sea = std::min(sea, inlet.outside(p));
        rock = std::min(rock, inlet.outside(p) - 0.7);
      }
      for (const Stack& stack : stacks) {
        if (std::abs(p.x - stack.center.x) > stack.radius + margin()) continue;
        const double island = stack.radius - std::hypot(p.x - stack.center.x, p.y - stack.center.y);
        sea = std::max(sea, island);
        rock = std::max(rock, island - 1.2);
      }
      shore_.inside.values.row(row)[i] = static_cast<float>(sea);
      foot_.inside.values.row(row)[i] = static_cast<float>(rock);
    }
  }

  /// Sea that no sea reaches becomes land.
  void drop_lagoons() {
    raster::Grid<float>& land = shore_.inside.values;
    raster::Grid<std::uint8_t> open(width_, height_);
    std::vector<std::pair<int, int>> stack;
    const auto visit = [&](int col, int row) {
      if (!open.inside(col, row) || open.at(col, row) || land.at(col, row) > 0) return;
      open.at(col, row) = 1;
      stack.emplace_back(col, row);
    };
    for (int col = 0; col < width_; ++col) visit(col, height_ - 1);
    for (int row = 0; row < height_; ++row) {
      visit(0, row);
      visit(width_ - 1, row);
    }
    while (!stack.empty()) {
      const auto [col, row] = stack.back();
      stack.pop_back();
      visit(col - 1, row);
      visit(col + 1, row);
      visit(col, row - 1);
      visit(col, row + 1);
    }
    for (std::size_t i = 0; i < open.size(); ++i)
      if (!open.data()[i] && land.data()[i] <= 0) land.data()[i] = 0.5f;
  }

  void place_dolines() {
    Random random(seed_, 14);
    const double hectares = extent_.x * extent_.y / 1e4;
    const auto tries = static_cast<std::size_t>(std::min(1e6, std::round(p_.dolines * hectares)));
    const PlaneNoise clusters = noise(150, 2, 7);
    for (std::size_t k = 0; k < tries; ++k) {
      const Vec2d c{random.uniform(0, extent_.x), random.uniform(0, extent_.y)};
      const double radius = 6 * std::pow(4.5, random.uniform() * random.uniform());
      const double depth = radius * random.uniform(0.35, 0.65);
      const bool collapsed = random.uniform() < 0.3;
      const bool wanted = random.uniform() < 0.5 + 0.9 * clusters.at(c);
      const Vec2d pixel = foot_.inside.placement.pixel(c.x, c.y);
      const int col = std::clamp(static_cast<int>(std::lround(pixel.x)), 0, width_ - 1);
      const int row = std::clamp(static_cast<int>(std::lround(pixel.y)), 0, height_ - 1);
      const double inland = foot_.distance(foot_.inside.values.index(col, row), c).first;
      if (wanted && inland > radius + 20) dolines_.push_back({c, radius, depth, collapsed});
    }
  }

  double doline_depth(const Doline& d, Vec2d p, double wobble) const {
    const double r = std::hypot(p.x - d.center.x, p.y - d.center.y) / d.radius * (1 + 0.3 * wobble);
    if (r >= 1) return 0;
    return d.depth * (d.collapsed ? smooth((1 - r) / 0.45) : std::pow(1 - r, 1.2) * smooth(4 * (1 - r)));
  }

  /// Elevation of the plateau, had the sea never come, along a row.
  std::vector<double> plateau(const Points& points, const std::vector<double>& inland) const {
    const auto hills = noise(p_.hills, 3, 20).at(points), knolls = noise(60, 4, 21).at(points);
    const auto valleys = noise(1.75 * p_.hills, 2, 22).at(points), grain = noise(7, 4, 23).at(points);
    const auto wobble = noise(18, 2, 24).at(points), ledges = noise(130, 2, 25).at(points);
    const auto dolines = near(dolines_, points.front().y, [](const Doline& o) {
      return Reach{o.center, 1.5 * o.radius};
    });
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double back = std::max(inland[i], 0.0);
      double h = p_.cliff * (1 + 0.28 * hills[i]) + p_.tilt * back + 2.2 * p_.roughness * knolls[i];
      const double valley = std::max(0.0, 1 - valleys[i] * valleys[i] / 0.09);
      h -= valley * valley * (0.12 * h + 4);
      if (p_.terrace > 0) {
        const double steps = h / p_.terrace, whole = std::floor(steps);
        const double stepped = (whole + smooth((steps - whole - 0.2) / 0.6)) * p_.terrace;
        h += 0.6 * smooth(0.5 + 1.2 * ledges[i]) * (stepped - h);
      }
      h += 0.35 * p_.roughness * grain[i];
      double hole = 0;
      for (const Doline& d : dolines)
        if (std::abs(points[i].x - d.center.x) < 1.5 * d.radius)
          hole = std::max(hole, doline_depth(d, points[i], wobble[i]));
      out[i] = h - hole;
    }
    return out;
  }

  void relief(int row, const Points& points, float* out) const {
    std::vector<double> inland(points.size()), behind(points.size());
    Points foot(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const std::size_t cell = shore_.inside.values.index(static_cast<int>(i), row);
      inland[i] = shore_.distance(cell, points[i]).first;
      std::tie(behind[i], foot[i]) = foot_.distance(cell, points[i]);
    }
    const auto top = plateau(points, behind);
    const auto stacks = near(stacks_, points.front().y, [](const Stack& o) {
      return Reach{o.center, o.radius};
    });
    // What depends on the nearest point of the foot runs straight up the face.
    const auto gully = noise(16, 2, 31).at(foot), steep = noise(120, 2, 33).at(points);
    const auto rocks = noise(9, 4, 34).at(points), reef = noise(40, 4, 35).at(points);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = inland[i];
      if (d <= 0) {
        out[i] = static_cast<float>(sea_floor(d, rocks[i], reef[i]));
        continue;
      }
      const double up_shelf = behind[i] > 0 ? 1 : d / (d - behind[i]);
      const double shelf = (1.8 + 0.4 * p_.roughness * (rocks[i] + 1)) * smooth(up_shelf);
      const Stack* stack = stack_at(stacks, points[i]);
      const double flute =
          (stack ? 0.5 : 1.0) * p_.roughness * (0.7 * rocks[i] + 0.8 * (0.6 - std::abs(gully[i])));
      const double reach = (behind[i] - flute) * (stack ? 1.8 : 1.2 + 0.4 * steep[i]);
      const double summit = stack ? std::min(top[i], stack->top + 1.5 * rocks[i])
                                  : top[i] - 5 * std::exp(-std::max(reach, 0.0) / 14);
      const double wall = shelf + face_.height(reach);
      out[i] = static_cast<float>(std::max(soft_min(wall, std::max(summit, shelf), 2.0), 0.05));
    }
  }

  /// d < 0 metres from the shore: bare rock beside it, sediment farther out.
  double sea_floor(double d, double rocks, double reef) const {
    const double bare = std::exp(d / 45) + 0.12;
    const double reefs = p_.roughness * bare * (1.2 * rocks + 5 * (1 - std::abs(reef)) - 3.5);
    const double floor = -0.4 - 3.5 * smooth(-d / 25) + 0.045 * d;
    return std::min(floor + reefs * smooth(-d / 12), -0.05 + 0.04 * d);
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
  Line shore_, foot_;
  double base_ = 0;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Coast p;
  assign(table().infos(), &p, values, "coast");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& generator_coast() {
  static const GeneratorType type{
      .about = {.name = "coast",
                .doc = "A rugged coast: cliffs, bays, stacks and a plateau with dolines",
                .source = "a composition of fractal noise and distances to the shoreline",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
