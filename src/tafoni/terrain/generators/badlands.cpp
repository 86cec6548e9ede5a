// An amphitheatre of badlands below the rim of a plateau: fins between gullies, ledges of hard beds that run
// from fin to fin, aprons of debris, a wash that leaves to the south.

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/raster/resample.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/plane_noise.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {
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
    t.real("relief", &Badlands::relief, "m", 1, 2000, "height of the plateau above the floor")
        .real("bowl", &Badlands::bowl, "", 0.1, 1, "depth of the amphitheatre, as a share of the map")
        .real("slope", &Badlands::slope, "deg", 5, 70, "steepness of the amphitheatre before gullies cut it")
        .real("fins", &Badlands::fins, "m", 2, 1000, "distance from fin to fin")
        .real("incision", &Badlands::incision, "", 0, 5, "how deeply water has cut, 0 for not at all")
        .real("bed", &Badlands::bed, "m", 0.5, 500, "mean thickness of the beds")
        .real("ledges", &Badlands::ledges, "", 0, 0.9, "how far hard beds stand out")
        .real("roughness", &Badlands::roughness, "", 0, 4, "strength of small relief");
    return t;
  }();
  return params;
}

double smooth(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

/// Heights before and after hard beds have been left standing: steep over a hard bed, gentle over a soft one.
class Beds {
 public:
  Beds(double thickness, double ledges, double top, std::uint64_t seed) {
    Random random(seed, 21);
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
        extent_{static_cast<double>(p.width) * p.pixel, static_cast<double>(p.height) * p.pixel},
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
    raster::Raster out;
    out.placement = {0, extent_.y, p_.pixel, p_.pixel};
    out.values = raster::Grid<float>(static_cast<int>(p_.width), static_cast<int>(p_.height));
    refine(coarse, out, progress);
    return out;
  }

 private:
  static constexpr int steps = 24;

  /// The plateau with its bowl, as it was before water cut it.
  raster::Raster valley() const {
    raster::Raster out;
    const int columns = static_cast<int>(std::ceil(extent_.x / cell_)) + 1;
    const int rows = static_cast<int>(std::ceil(extent_.y / cell_)) + 1;
    out.placement = {-0.5 * cell_, extent_.y + 0.5 * cell_, cell_, cell_};
    out.values = raster::Grid<float>(columns, rows);
    std::vector<Vec2d> at;
    for (int row = 0; row < rows; ++row)
      for (int col = 0; col < columns; ++col) at.push_back(out.placement.center(col, row));
    const double size = std::min(extent_.x, extent_.y);
    const auto bays = PlaneNoise(0.45 * size, 3, hash_combine(seed_, 1)).at(at);
    const auto hills = PlaneNoise(3 * p_.fins, 3, hash_combine(seed_, 2)).at(at);
    const auto grooves = PlaneNoise(p_.fins, 2, hash_combine(seed_, 3)).at(at);
    const double run = p_.relief / std::tan(p_.slope * 3.14159265358979323846 / 180);
    const Vec2d middle{0.5 * extent_.x, extent_.y * (1 - p_.bowl)};
    for (std::size_t i = 0; i < at.size(); ++i) {
      // Inside: the distance from the rim, which opens to the south.
      const double dx = at[i].x - middle.x, dy = std::max(at[i].y - middle.y, 0.0);
      const double reach = extent_.y * p_.bowl * 0.86 + 0.12 * size * bays[i];
      const double inside = reach - std::hypot(dx * extent_.y / extent_.x * 1.25, dy);
      const double t = inside / run;
      // A cliff at the rim, then a slope that flattens out.
      const double fall =
          t <= 0 ? 0 : 0.15 * smooth(t / 0.06) + 0.85 * (1 - std::exp(-1.5 * t)) / (1 - std::exp(-1.5));
      const double floor = 0.045 * at[i].y;
      const double plateau = p_.relief * (1 + 0.04 * at[i].y / extent_.y);
      const double z = floor + (plateau - floor) * std::max(0.0, 1 - std::min(fall, 1.0));
      const double rough = p_.roughness * (0.03 * p_.relief * hills[i] + 0.09 * p_.fins * grooves[i]);
      out.values.data()[i] = static_cast<float>(z + rough * (0.35 + smooth(t * 4)));
    }
    return out;
  }

  /// One step of dz/dt = -K sqrt(A) S, implicit (Braun & Willett 2013), on the filled surface.
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
    const double source = 0.12 * p_.fins * p_.fins;
    const double strength = 0.075 * p_.incision * 24 / steps;
    for (const std::uint32_t i : order) {
      const std::uint32_t r = receiver[i];
      if (r == i) continue;
      const double water = std::max(static_cast<double>(area[i]) - source, 0.0);
      const double f = strength * std::sqrt(water) / (static_cast<double>(step[i]) * cell_) *
                       hardness(static_cast<double>(z.data()[i]));
      const double below = z.data()[r];
      z.data()[i] = static_cast<float>((static_cast<double>(z.data()[i]) + f * below) / (1 + f));
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

  /// Soft beds give way faster; the wave keeps strata from being exactly level.
  double hardness(double z) const {
    return 1 + 0.5 * std::sin(2 * 3.14159265358979323846 * z / (3 * p_.bed));
  }

  /// Faces steeper than rock can stand shed debris, which comes to rest below them; rain wears gentle ground
  /// down.
  void slide(raster::Raster& heights) const {
    const double steepest = 2.2 * cell_, creep = 0.02 * p_.fins / cell_;
    const raster::Grid<float> z = heights.values;
    auto& out = heights.values;
    for (int row = 1; row + 1 < z.height(); ++row)
      for (int col = 1; col + 1 < z.width(); ++col) {
        double change = 0;
        for (int k = 0; k < 8; ++k) {
          const double length = std::hypot(impl::neighbour_col[k], impl::neighbour_row[k]);
          const double rise =
              static_cast<double>(z.at(col + impl::neighbour_col[k], row + impl::neighbour_row[k]) -
                                  z.at(col, row)) /
              length;
          const double excess = std::abs(rise) - steepest;
          // What falls off a face spreads on gentle ground.
          const double gentle = 1 - smooth(std::abs(rise) / (0.8 * cell_));
          change += std::min(creep, 0.12) * gentle * rise / length +
                    0.05 * std::copysign(std::max(excess, 0.0), rise);
        }
        out.at(col, row) += static_cast<float>(change);
      }
  }

  void refine(const raster::Raster& coarse, raster::Raster& out, Progress& progress) const {
    const Beds beds(p_.bed, p_.ledges, 1.2 * p_.relief, seed_);
    const PlaneNoise waves(6 * p_.fins, 2, hash_combine(seed_, 4)),
        rocks(0.35 * p_.fins, 4, hash_combine(seed_, 5));
    progress.begin("badlands", static_cast<std::uint64_t>(out.height()), "rows");
    parallel_for(
        out.height(),
        [&](std::int64_t r) {
          const int row = static_cast<int>(r);
          std::vector<Vec2d> at;
          for (int col = 0; col < out.width(); ++col) at.push_back(out.placement.center(col, row));
          const auto wave = waves.at(at), rock = rocks.at(at);
          for (int col = 0; col < out.width(); ++col) {
            const Vec2d p = at[static_cast<std::size_t>(col)];
            const double z = raster::sample_bicubic(coarse, p.x, p.y);
            const double dx = raster::sample_bilinear(coarse, p.x + cell_, p.y) -
                              raster::sample_bilinear(coarse, p.x - cell_, p.y);
            const double dy = raster::sample_bilinear(coarse, p.x, p.y + cell_) -
                              raster::sample_bilinear(coarse, p.x, p.y - cell_);
            const double slope = std::hypot(dx, dy) / (2 * cell_);
            // Beds show where the ground is steep; debris covers them elsewhere.
            const double bare = smooth((slope - 0.3) / 0.5);
            const double dip = 0.5 * p_.bed * wave[static_cast<std::size_t>(col)];
            const double stepped = beds(z + dip) - dip;
            out.values.at(col, row) = static_cast<float>(z + bare * (stepped - z) +
                                                         p_.roughness * (0.1 + 0.45 * bare) * 0.06 * p_.fins *
                                                             rock[static_cast<std::size_t>(col)]);
          }
        },
        progress);
    progress.end();
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

const GeneratorType& generator_badlands() {
  static const GeneratorType type{
      .about = {.name = "badlands",
                .doc = "An amphitheatre of fins, gullies and ledges below the rim of a plateau",
                .source = "stream power incision (Braun & Willett 2013) of a bowl, with hard and soft beds",
                .params = table().infos()},
      .generate = &generate,
  };
  return type;
}

}  // namespace tafoni::terrain
