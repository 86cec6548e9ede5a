#pragma once
// Noise over the plane, for generators.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/vec.h"

namespace tafoni::terrain::impl {

/// Fractal noise about 0 that uses most of [-1, 1].
class PlaneNoise {
 public:
  /// `stream` keeps it apart from the other noises of the seed.
  template <class Stream>
  PlaneNoise(double wavelength, int octaves, std::uint64_t seed, Stream stream)
      : PlaneNoise(wavelength, octaves, hash_combine(seed, stream)) {}
  PlaneNoise(double wavelength, int octaves, std::uint64_t seed)
      : frequency_(1 / wavelength), octaves_(octaves), seed_(seed) {}

  std::vector<double> at(std::span<const Vec2d> points) const {
    std::vector<Vec3d> scaled(points.size());
    // Off the lattice plane z = 0, where simplex noise is weakest.
    for (std::size_t i = 0; i < points.size(); ++i)
      scaled[i] = {points[i].x * frequency_, points[i].y * frequency_, 0.37};
    std::vector<float> t(points.size());
    fbm(scaled, octaves_, seed_, t);
    std::vector<double> out(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) out[i] = std::clamp(gain * (2.0 * t[i] - 1), -1.0, 1.0);
    return out;
  }
  double at(Vec2d p) const { return at(std::span(&p, 1)).front(); }

 private:
  static constexpr double gain = 1.8;  ///< plain fBm keeps within about half of its range
  double frequency_;
  int octaves_;
  std::uint64_t seed_;
};

}  // namespace tafoni::terrain::impl
