// Beds of rock, one above the other without end. A table of the beds near the first makes a look-up of the
// one at a height fast; noise waves the beds and roughens the rock.

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/geology/impl/rock.h"
#include "tafoni/geology/kind.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::geology::geology_strata {
namespace {

struct Params {
  std::vector<double> thickness = {14, 8, 11, 6};
  std::vector<double> hardness = {0.85, 0.35, 0.75, 0.2};
  double variation = 0.4;
  double hardness_variation = 0.15;
  double transition = 0.8;
  double elevation = 0;
  double dip = 0;
  double azimuth = 90;
  std::vector<double> position = {0, 0};
  double waviness = 1.5;
  double wave_length = 70;
  double turbulence = 0.35;
  double wavelength = 9;
  std::int64_t octaves = 3;
};

const ParamTable<Params>& table() {
  static const ParamTable<Params> params = [] {
    ParamTable<Params> t;
    t.numbers("thickness", &Params::thickness, "m", 0, 0.05, 10000,
              "Thicknesses of the beds from below, repeated without end")
        .numbers("hardness", &Params::hardness, "", 0, 0, 1,
                 "Resistances of the beds from below, repeated without end; 1 for the hardest rock")
        .real("variation", &Params::variation, "", 0, 0.9,
              "Share by which thicknesses vary at random; 0 for beds as they are given")
        .real("hardness_variation", &Params::hardness_variation, "", 0, 1,
              "Most that a bed's resistance differs at random from what is given")
        .real("transition", &Params::transition, "m", 0, 100,
              "Height over which one bed turns into the next; 0 for sharp borders")
        .real("elevation", &Params::elevation, "m", -20000, 20000,
              "World elevation of the foot of the first bed")
        .real("dip", &Params::dip, "deg", 0, 90,
              "Steepest descent of the beds: 0 for level ones, 90 for upright ones")
        .real("azimuth", &Params::azimuth, "deg", -360, 360,
              "Direction in which the beds descend, clockwise from north")
        .only("where dip is above 0", {{"dip", 30.0}})
        .numbers("position", &Params::position, "m", 2, -1e8, 1e8,
                 "World x and y where the first bed has its elevation")
        .only("where dip is above 0", {{"dip", 30.0}})
        .real("waviness", &Params::waviness, "m", 0, 1000,
              "Most that a bed rises or sinks in gentle waves; 0 for none")
        .real("wave_length", &Params::wave_length, "m", 1, 100000, "Length of the gentle waves")
        .only("where waviness is above 0")
        .real("turbulence", &Params::turbulence, "", 0, 2,
              "Strength of small irregularities, such as joints and lenses; 0 for none")
        .real("wavelength", &Params::wavelength, "m", 0.1, 10000, "Size of the coarsest irregularities")
        .only("where turbulence is above 0")
        .integer("octaves", &Params::octaves, "", 1, 12,
                 "Levels of detail of the irregularities, each half as large as the one before")
        .only("where turbulence is above 0");
    return t;
  }();
  return params;
}

/// What the random numbers of a stack of beds are for.
enum class Stream : std::uint64_t { hardness = 1, boundary = 2 };

/// i in a cycle of n, for i below 0 too.
std::int64_t wrap(std::int64_t i, std::int64_t n) {
  return ((i % n) + n) % n;
}

/// Beds stacked without end; bed i lies between boundaries i and i + 1. Distances are along the normal.
class Stack {
 public:
  Stack(const Params& p, std::uint64_t seed)
      : p_(p), hardness_(seed, Stream::hardness), boundary_(seed, Stream::boundary) {
    for (double t : p.thickness) {
      feet_.push_back(cycle_);
      cycle_ += t;
    }
    for (std::int64_t i = 0; i < known_beds; ++i) known_.push_back(make(i - known_beds / 2));
    index();
  }

  double at(double d) const {
    const double cell = (d - known_[1].foot) * cells_per_metre_;
    if (!(cell >= 0 && cell < static_cast<double>(first_in_cell_.size()))) return beyond(d);
    std::size_t i = first_in_cell_[static_cast<std::size_t>(cell)];
    i += d >= known_[i + 1].foot ? 1 : 0;
    while (d >= known_[i + 1].foot) ++i;
    // The nearer boundary without a branch: for scattered points no guess of it is good.
    const std::size_t j = i + (d - known_[i].foot < known_[i + 1].foot - d ? 0 : 1);
    return mix(known_[j - 1], known_[j], d);
  }

 private:
  struct Bed {
    double foot;      ///< its lower boundary
    double softness;  ///< half the width of the transition there
    double rho;
  };
  static constexpr std::int64_t known_beds = 2048;  ///< kept ready about the first bed: hashing takes longer

  /// Which known bed holds the foot of each cell of a division of their height.
  void index() {
    constexpr double most = 1 << 15;
    const double foot = known_[1].foot, height = known_[known_beds - 2].foot - foot;
    double thinnest = height;
    for (std::size_t i = 1; i + 2 < known_.size(); ++i)
      thinnest = std::min(thinnest, known_[i + 1].foot - known_[i].foot);
    cells_per_metre_ = std::min(most / height, 1 / thinnest);
    // The last cell may reach beyond the last bed.
    first_in_cell_.resize(static_cast<std::size_t>(height * cells_per_metre_));
    std::size_t bed = 1;
    for (std::size_t c = 0; c < first_in_cell_.size(); ++c) {
      // Rounding may put a point of the cell a little below its foot.
      const double at = foot + (static_cast<double>(c) - 1e-6) / cells_per_metre_;
      while (known_[bed + 1].foot <= at) ++bed;
      first_in_cell_[c] = static_cast<std::uint16_t>(bed);
    }
  }

  double beyond(double d) const {
    const double turns = std::floor(d / cycle_);
    const double rest = d - turns * cycle_;
    std::int64_t i = static_cast<std::int64_t>(turns) * std::ssize(feet_);
    for (std::size_t k = 1; k < feet_.size() && rest >= feet_[k]; ++k) ++i;
    Bed bed = get(i), above = get(i + 1);
    if (d < bed.foot) {
      above = bed;
      bed = get(--i);
    } else if (d >= above.foot) {
      bed = above;
      above = get(++i + 1);
    }
    if (d - bed.foot < above.foot - d) return mix(get(i - 1), bed, d);
    return mix(bed, above, d);
  }

  Bed get(std::int64_t i) const {
    const std::int64_t k = i + known_beds / 2;
    return k >= 0 && k < known_beds ? known_[k] : make(i);
  }

  Bed make(std::int64_t i) const {
    const std::int64_t k = wrap(i, std::ssize(feet_)), turns = (i - k) / std::ssize(feet_);
    const double thinner = std::min(thickness(i - 1), thickness(i));
    const double given = p_.hardness[wrap(i, std::ssize(p_.hardness))];
    // A boundary moves by less than half of the thinner neighbour and so does its transition reach, so that
    // boundaries keep their order and transitions do not overlap.
    return {
        static_cast<double>(turns) * cycle_ + feet_[k] + unit(boundary_, i) * 0.5 * p_.variation * thinner,
        std::min(0.5 * p_.transition, 0.5 * (1 - p_.variation) * thinner),
        std::clamp(given + p_.hardness_variation * unit(hardness_, i), 0.0, 1.0)};
  }

  double thickness(std::int64_t i) const { return p_.thickness[wrap(i, std::ssize(p_.thickness))]; }

  static double mix(const Bed& below, const Bed& above, double d) {
    const double from = d - above.foot, half = above.softness;
    if (half == 0) return from >= 0 ? above.rho : below.rho;
    const double w = smoothstep(std::clamp((from + half) / (2 * half), 0.0, 1.0));
    return below.rho * (1 - w) + above.rho * w;
  }

  /// Uniform in [-1, 1).
  static double unit(const Random& random, std::int64_t i) { return 2 * unit_real(random.at(i)) - 1; }

  Params p_;
  Random hardness_, boundary_;
  std::vector<double> feet_;  ///< of the beds of one cycle
  double cycle_ = 0;
  std::vector<Bed> known_;
  std::vector<std::uint16_t> first_in_cell_;
  double cells_per_metre_ = 0;
};

class Node final : public impl::BatchGeology {
 public:
  Node(const Params& p, std::uint64_t seed)
      : p_(p),
        normal_(impl::plane_normal(p.dip, p.azimuth)),
        stack_(p, hash_combine(seed, impl::Stream::strata_beds)) {
    const double wave = 1 / p.wave_length, f = 1 / p.wavelength;
    waves_ = {{wave, wave, 0}, wave_octaves, seed, impl::Stream::strata_waves};
    // Joints and lenses are longer than high.
    rough_ = {{flatness * f, flatness * f, f}, p.octaves, seed, impl::Stream::strata_roughness};
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    const Vec3d pivot{p_.position[0], p_.position[1], p_.elevation};
    impl::for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      const auto world = points.subspan(begin, n);
      std::array<float, impl::noise_block> wave{}, rough{};
      if (p_.waviness > 0) waves_.sample(world, std::span(wave).first(n));
      if (p_.turbulence > 0) rough_.sample(world, std::span(rough).first(n));
      for (std::size_t i = 0; i < n; ++i) {
        const double d = dot(world[i] - pivot, normal_) + p_.waviness * (2.0 * wave[i] - 1);
        out[begin + i] = stack_.at(d) + p_.turbulence * (2.0 * rough[i] - 1);
      }
    });
  }

 private:
  static constexpr int wave_octaves = 2;   // beds bend gently
  static constexpr double flatness = 0.5;  // height of joints and lenses as a share of their length
  Params p_;
  Vec3d normal_;
  Stack stack_;
  impl::Turbulence waves_, rough_;
};

GeologyPtr make(const Values& values, std::vector<GeologyPtr>, std::uint64_t seed) {
  Params p;
  assign(table().infos(), &p, values, "strata");
  if (p.thickness.empty()) fail(ErrorKind::usage, "strata: thickness must name at least one bed");
  if (p.hardness.empty()) fail(ErrorKind::usage, "strata: hardness must name at least one bed");
  return std::make_shared<Node>(p, seed);
}

}  // namespace

const GeologyType& declaration() {
  static const GeologyType type{
      .about = {.name = "strata",
                .doc = "Beds of hard and soft rock, one above the other",
                .source = "[Paris19 §4.2], as a sequence of beds",
                .params = table()},
      .make = &make,
  };
  return type;
}

}  // namespace tafoni::geology::geology_strata
