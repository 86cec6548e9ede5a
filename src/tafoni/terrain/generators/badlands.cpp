// An amphitheatre of badlands below the rim of a plateau: fins between gullies, ledges of hard beds that run
// from fin to fin, aprons of debris, a wash that leaves to the south. A bowl is worn by stream power and by
// slides on a coarse grid; hard beds and small relief are added to every pixel of it.

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tafoni/core/random.h"
#include "tafoni/math/smoothstep.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/resample.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/rows.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain::generator_badlands {
namespace {

using impl::PlaneNoise;

struct Badlands : GridSettings {
  double relief = 60;
  double bowl = 0.62;
  double slope = 22;
  double fins = 20;
  double incision = 1;
  double bed = 5;
  double ledges = 0.6;
  double roughness = 1;
  Badlands() {
    width = height = 700;
    pixel = 0.5;
  }
};

const ParamTable<Badlands>& table() {
  static const ParamTable<Badlands> params = [] {
    ParamTable<Badlands> t;
    add_grid_params(t);
    t.real("relief", &Badlands::relief, "m", 1, 2000, "Height of the plateau above the floor of the bowl")
        .real("bowl", &Badlands::bowl, "", 0.1, 1,
              "How far the amphitheatre reaches into the map, as a share of it from the south")
        .real("slope", &Badlands::slope, "deg", 5, 70,
              "Steepness of the amphitheatre before gullies cut it: little for a long apron, much for a wall")
        .real("fins", &Badlands::fins, "m", 2, 1000, "Distance from fin to fin")
        .real("incision", &Badlands::incision, "", 0, 5,
              "How deeply water has cut; 0 for not at all, and little remains between gullies at 5")
        .real("bed", &Badlands::bed, "m", 0.5, 500, "Mean thickness of the beds")
        .real("ledges", &Badlands::ledges, "", 0, 0.9,
              "How far hard beds stand out as ledges; 0 for even slopes")
        .real("roughness", &Badlands::roughness, "", 0, 4,
              "Strength of small relief: 0 for smooth ground, 4 for rubble");
    return t;
  }();
  return params;
}

enum class Stream : std::uint64_t { bays = 1, hills = 2, grooves = 3, waves = 4, rocks = 5, beds = 21 };

/// Chosen by eye after photographs of badlands; metres where nothing else is said.
namespace look {
constexpr double bay_size = 0.45, bay_depth = 0.12;  // of the map: bays of the rim
constexpr double hill_size = 3, hill_relief = 0.03;  // in fins; as a share of the relief
constexpr double groove_depth = 0.09;                // of a fin: where gullies begin
constexpr double reach = 0.86;                       // of the bowl: where the rim is before bays
constexpr double squeeze = 1.25;                     // the bowl is narrower than it is deep
constexpr double rim_run = 0.06, rim_share = 0.15;  // the cliff at the rim: of the slope's run; of its height
constexpr double flattening = 1.5;                  // how fast the slope below flattens out
constexpr double floor_slope = 0.045, plateau_slope = 0.04;  // rises to the north that let water drain
constexpr double calm = 0.35;                                // share of small relief that the plateau has
constexpr double source = 0.12;                         // of a fin squared: area that feeds no channel yet
constexpr double cutting = 0.075;                       // of a step, for a map of the default size
constexpr double hardness = 0.5, bed_cycle = 3;         // how much beds differ; beds from hard to hard
constexpr double steepest = 2.2;                        // rise over run that rock can stand
constexpr double creep = 0.02, most_creep = 0.12;       // rain wears gentle ground; more would swing
constexpr double gentle = 0.8;                          // rise over run that is not worn so
constexpr double shed = 0.05;                           // share of what is too steep that falls in a step
constexpr double bare_from = 0.3, bare_run = 0.5;       // slopes at which beds begin to show, and do in full
constexpr double wave_size = 6, wave_height = 0.5;      // in fins; of a bed: beds are not quite level
constexpr double rock_size = 0.35, rock_height = 0.06;  // in fins: rubble
constexpr double rock_debris = 0.1, rock_bare = 0.45;   // rubble of covered ground, and more where it is bare
}  // namespace look

/// Heights before and after hard beds have been left standing: steep over a hard bed, gentle over a soft one.
class Beds {
 public:
  Beds(double thickness, double ledges, double top, std::uint64_t seed) {
    Random random(seed, Stream::beds);
    double from = -2 * thickness, to = from;
    bool hard = false;
    while (from < top + 2 * thickness) {
      knots_.push_back({from, to});
      hard = !hard;
      const double t = thickness * random.uniform(0.5, 1.5);
      // Hard beds rise in a short run of the slope; soft ones make up for it.
      const double run = t * (hard ? 1 - ledges : 1 + ledges);
      from += run;
      to += t;
    }
    const double scale = knots_.back()[0] > 0 ? (top + 2 * thickness) / knots_.back()[0] : 1;
    for (auto& knot : knots_) knot[0] *= scale;
    for (auto& knot : knots_) knot[1] *= (top + 2 * thickness) / knots_.back()[1];
  }

  double operator()(double z) const {
    auto above = std::upper_bound(knots_.begin(), knots_.end(), z,
                                  [](double value, const auto& knot) { return value < knot[0]; });
    above = std::clamp(above, knots_.begin() + 1, knots_.end() - 1);
    const auto& a = *(above - 1);
    const auto& b = *above;
    return a[1] + (b[1] - a[1]) * (z - a[0]) / (b[0] - a[0]);
  }

 private:
  std::vector<std::array<double, 2>> knots_;
};

class Builder {
 public:
  Builder(const Badlands& p, std::uint64_t seed)
      : p_(p),
        seed_(seed),
        extent_(p.extent()),
        cell_(std::max(p.pixel, std::max(p.fins / 10, std::max(extent_.x, extent_.y) / 260))) {}

  raster::Raster run(Progress& progress) {
    raster::Raster coarse = valley();
    progress.begin("erosion", steps, "steps");
    for (int i = 0; i < steps && p_.incision > 0; ++i) {
      incise(coarse);
      slide(coarse);
      progress.advance();
    }
    progress.end();
    return refine(coarse, progress);
  }

 private:
  static constexpr int steps = 24;  // of erosion; more would cost time and change little

  /// The plateau with its bowl, as it was before water cut it.
  raster::Raster valley() const {
    raster::Raster out;
    const int columns = ceil_to(extent_.x / cell_) + 1;
    const int rows = ceil_to(extent_.y / cell_) + 1;
    out.placement = {-0.5 * cell_, extent_.y + 0.5 * cell_, cell_, cell_};
    out.values = raster::Grid<float>(columns, rows);
    std::vector<Vec2d> at;
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < columns; ++col) at.push_back(out.placement.center(col, row));
    const double size = std::min(extent_.x, extent_.y);
    const auto bays = PlaneNoise(look::bay_size * size, 3, seed_, Stream::bays).at(at);
    const auto hills = PlaneNoise(look::hill_size * p_.fins, 3, seed_, Stream::hills).at(at);
    const auto grooves = PlaneNoise(p_.fins, 2, seed_, Stream::grooves).at(at);
    const double run = p_.relief / std::tan(p_.slope * std::numbers::pi / 180);
    const Vec2d middle{0.5 * extent_.x, extent_.y * (1 - p_.bowl)};
    for (std::size_t i = 0; i < at.size(); ++i) {
      // Inside: the distance from the rim, which opens to the south.
      const double dx = at[i].x - middle.x, dy = std::max(at[i].y - middle.y, 0.0);
      const double reach = extent_.y * p_.bowl * look::reach + look::bay_depth * size * bays[i];
      const double inside = reach - std::hypot(dx * extent_.y / extent_.x * look::squeeze, dy);
      const double t = inside / run;
      // A cliff at the rim, then a slope that flattens out.
      const double fall = t <= 0 ? 0
                                 : look::rim_share * smoothstep(0.0, look::rim_run, t) +
                                       (1 - look::rim_share) * (1 - std::exp(-look::flattening * t)) /
                                           (1 - std::exp(-look::flattening));
      const double floor = look::floor_slope * at[i].y;
      const double plateau = p_.relief * (1 + look::plateau_slope * at[i].y / extent_.y);
      const double z = floor + (plateau - floor) * std::max(0.0, 1 - std::min(fall, 1.0));
      const double rough = p_.roughness * (look::hill_relief * p_.relief * hills[i] +
                                           look::groove_depth * p_.fins * grooves[i]);
      out.values.data()[i] = static_cast<float>(z + rough * (look::calm + smoothstep(0.0, 0.25, t)));
    }
    return out;
  }

  /// One step of dz/dt = -K sqrt(A) S, implicit [Braun13], on the filled surface.
  void incise(raster::Raster& heights) const {
    heights.values = fill_depressions(heights);
    auto& z = heights.values;
    const auto n = static_cast<std::uint32_t>(z.size());
    std::vector<std::uint32_t> order(n), receiver(n);
    std::vector<float> area(n, static_cast<float>(cell_ * cell_)), step(n, 1);
    std::iota(order.begin(), order.end(), 0u);
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
      return z.data()[a] != z.data()[b] ? z.data()[a] < z.data()[b] : a < b;
    });
    for (int row = 0; row < z.height(); ++row)
      for (int col = 0; col < z.width(); ++col) descend(z, col, row, receiver, step);
    for (std::size_t i = n; i-- > 0;)
      if (receiver[order[i]] != order[i]) area[receiver[order[i]]] += area[order[i]];
    // Water too little to have a channel does not cut.
    const double source = look::source * p_.fins * p_.fins;
    const double strength = look::cutting * p_.incision * 24 / steps;
    for (const std::uint32_t i : order) {
      const std::uint32_t r = receiver[i];
      if (r == i) continue;
      const double here = z.data()[i], below = z.data()[r];
      const double water = std::max(area[i] - source, 0.0);
      const double f = strength * std::sqrt(water) / (step[i] * cell_) * softness(here);
      z.data()[i] = static_cast<float>((here + f * below) / (1 + f));
    }
  }

  /// The steepest lower neighbour; itself on the map's border, which keeps its height.
  static void descend(const raster::Grid<float>& z, int col, int row, std::vector<std::uint32_t>& receiver,
                      std::vector<float>& step) {
    const std::size_t here = z.index(col, row);
    receiver[here] = static_cast<std::uint32_t>(here);
    if (col == 0 || row == 0 || col == z.width() - 1 || row == z.height() - 1) return;
    float steepest = 0;
    for (int k = 0; k < 8; ++k) {
      const int c = col + impl::neighbour_col[k], r = row + impl::neighbour_row[k];
      const float length = impl::neighbour_col[k] != 0 && impl::neighbour_row[k] != 0 ? 1.41421356f : 1.f;
      const float slope = (z.data()[here] - z.at(c, r)) / length;
      if (slope <= steepest) continue;
      steepest = slope;
      receiver[here] = static_cast<std::uint32_t>(z.index(c, r));
      step[here] = length;
    }
  }

  /// How fast rock at this height gives way, about 1: soft and hard beds take turns in a wave.
  double softness(double z) const {
    return 1 + look::hardness * std::sin(2 * std::numbers::pi * z / (look::bed_cycle * p_.bed));
  }

  /// Faces steeper than rock can stand shed debris, which comes to rest below them; rain wears gentle ground
  /// down.
  void slide(raster::Raster& heights) const {
    const double steepest = look::steepest * cell_, creep = look::creep * p_.fins / cell_;
    const raster::Grid<float> z = heights.values;
    auto& out = heights.values;
    for (int row = 1; row + 1 < z.height(); ++row)
      for (int col = 1; col + 1 < z.width(); ++col) {
        double change = 0;
        for (int k = 0; k < 8; ++k) {
          const double length = std::hypot(impl::neighbour_col[k], impl::neighbour_row[k]);
          const float step =
              z.at(col + impl::neighbour_col[k], row + impl::neighbour_row[k]) - z.at(col, row);
          const double rise = step / length;
          const double excess = std::abs(rise) - steepest;
          // What falls off a face spreads on gentle ground.
          const double gentle = 1 - smoothstep(0.0, look::gentle * cell_, std::abs(rise));
          change += std::min(creep, look::most_creep) * gentle * rise / length +
                    look::shed * std::copysign(std::max(excess, 0.0), rise);
        }
        out.at(col, row) += static_cast<float>(change);
      }
  }

  /// Every pixel of the map, from the worn bowl: beds show where the ground is steep; debris covers them
  /// elsewhere.
  raster::Raster refine(const raster::Raster& coarse, Progress& progress) const {
    const Beds beds(p_.bed, p_.ledges, 1.2 * p_.relief, seed_);
    const PlaneNoise waves(look::wave_size * p_.fins, 2, seed_, Stream::waves),
        rocks(look::rock_size * p_.fins, 4, seed_, Stream::rocks);
    const auto fill = [&](int, const std::vector<Vec2d>& points, std::span<double> out) {
      const auto wave = waves.at(points), rock = rocks.at(points);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const double z = raster::sample_bicubic(coarse, points[i].x, points[i].y);
        const double bare = smoothstep(0.0, look::bare_run, slope_at(coarse, points[i]) - look::bare_from);
        const double dip = look::wave_height * p_.bed * wave[i];
        const double stepped = beds(z + dip) - dip;
        out[i] = z + bare * (stepped - z) +
                 p_.roughness * (look::rock_debris + look::rock_bare * bare) * look::rock_height * p_.fins *
                     rock[i];
      }
    };
    return impl::by_rows(p_, "badlands", progress, fill);
  }

  /// Rise over run of the worn bowl.
  double slope_at(const raster::Raster& coarse, Vec2d p) const {
    const double dx =
        raster::sample_bilinear(coarse, p.x + cell_, p.y) - raster::sample_bilinear(coarse, p.x - cell_, p.y);
    const double dy =
        raster::sample_bilinear(coarse, p.x, p.y + cell_) - raster::sample_bilinear(coarse, p.x, p.y - cell_);
    return std::hypot(dx, dy) / (2 * cell_);
  }

  Badlands p_;
  std::uint64_t seed_;
  Vec2d extent_;
  double cell_;
};

raster::Raster generate(const Values& values, std::uint64_t seed, Progress& progress) {
  Badlands p;
  assign(table().infos(), &p, values, "badlands");
  return Builder(p, seed).run(progress);
}

}  // namespace

const GeneratorType& declaration() {
  static const GeneratorType type{
      .about = {.name = "badlands",
                .doc = "An amphitheatre of fins, gullies and ledges below the rim of a plateau",
                .source = "stream power incision [Braun13] of a bowl, with hard and soft beds",
                .params = table()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain::generator_badlands
