#pragma once
// What the kinds of geology share.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "tafoni/core/random.h"
#include "tafoni/geology/geology.h"
#include "tafoni/math/noise.h"

namespace tafoni::geology::impl {

/// A node that is faster over many points than one by one; the kinds override raws() alone.
class BatchGeology : public Geology {
 public:
  double raw(Vec3d p) const final {
    double out = 0;
    raws({&p, 1}, {&out, 1});
    return out;
  }
  void raws(std::span<const Vec3d> points, std::span<double> out) const override = 0;
};

inline constexpr std::size_t noise_block = 256;

/// What the kinds draw noise for. The hash of a seed and a stream seeds the noise of one node.
enum class Stream : std::uint64_t {
  local = 0x6c6f,
  planes = 0x706c,
  turbulence = 0x7462,
  strata_beds = 0x7374,
  strata_waves = 0x7761,
  strata_roughness = 0x726f,
  fold_x = 0x666f,
  fold_y = 0x6670,
  fold_z = 0x6671
};

/// Calls body(begin, n) over blocks that fit a noise buffer.
template <class Body>
void for_blocks(std::size_t size, const Body& body) {
  for (std::size_t i = 0; i < size; i += noise_block) body(i, std::min(noise_block, size - i));
}

/// t(p * frequency) of one block, with an axis left out where its frequency is 0.
struct Turbulence {
  Turbulence() = default;
  Turbulence(Vec3d frequency_per_m, std::int64_t levels, std::uint64_t node_seed, Stream stream)
      : frequency(frequency_per_m),
        octaves(static_cast<int>(levels)),
        seed(hash_combine(node_seed, stream)) {}

  Vec3d frequency;  ///< 1 / m
  int octaves = 3;
  std::uint64_t seed = 0;

  /// Each in [0, 1].
  void sample(std::span<const Vec3d> world, std::span<float> t) const {
    std::array<Vec3d, noise_block> scaled;
    for (std::size_t i = 0; i < world.size(); ++i)
      scaled[i] = {world[i].x * frequency.x, world[i].y * frequency.y, world[i].z * frequency.z};
    fbm(std::span(scaled).first(world.size()), octaves, seed, t);
  }
};

/// Sine and cosine of degrees; the zeros are exact, so that upright planes are.
inline Vec2d sine_cosine(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  const auto exact = [](double v) { return std::abs(v) < 1e-15 ? 0.0 : v; };
  return {exact(std::sin(a)), exact(std::cos(a))};
}

/// Upward unit normal of a plane that dips by `dip` degrees towards `azimuth`, degrees clockwise from north.
inline Vec3d plane_normal(double dip, double azimuth) {
  const Vec2d d = sine_cosine(dip), a = sine_cosine(azimuth);
  return {d.x * a.x, d.x * a.y, d.y};
}

/// g at `r` radii of influence [Paris19 §4.2]: 1 at the skeleton, 0 from the radius on.
inline double falloff(double r) {
  if (!(r < 1)) return 0;
  const double s = 1 - r * r;
  return s * s * s;
}

}  // namespace tafoni::geology::impl
