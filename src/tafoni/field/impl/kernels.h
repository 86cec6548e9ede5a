#pragma once
// What evaluation hands to SIMD kernels: positions on a fixed-point grid, decoded primitives, blocks of
// samples.
//
// A position is an integer count of `unit` plus a float remainder under one unit. The difference of two
// positions is exact before it is rounded, so kernels neither jitter far from the origin nor depend on which
// block, chunk or thread they run in: that is what makes pruned, tiled and brute-force evaluation agree bit
// for bit.

#include <cmath>
#include <cstdint>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

inline constexpr int unit_bits = 13;
inline constexpr double unit = 1.0 / (1 << unit_bits);  ///< metres, about 0.12 mm
/// Positions lie within +-131 km, so that the difference of any two fits 32 bits.
inline constexpr double reach_limit = 131000.0;

/// What a position may lose when it is rounded to float, metres: bounds are widened by it.
inline constexpr float position_slack = 0.0131f;

struct Fixed {
  std::int32_t units;
  float rest;
};
/// Nearest unit; |rest| <= unit / 2. Clamped to the limit, where nothing lives.
inline Fixed to_fixed(double metres) {
  const double clamped = metres > reach_limit ? reach_limit : metres < -reach_limit ? -reach_limit : metres;
  // Adding 1.5 * 2^52 rounds to the nearest integer, ties to even, without a call.
  constexpr double magic = 6755399441055744.0;
  const double units = (clamped * (1 << unit_bits) + magic) - magic;
  return {static_cast<std::int32_t>(units), static_cast<float>(clamped - units * unit)};
}
inline double to_metres(std::int32_t units) {
  return units * unit;
}
/// The same rounded to float, as boxes and bounds take it.
inline float to_float_metres(std::int32_t units) {
  return static_cast<float>(to_metres(units));
}

/// Noise of a cloud's metric, as kernels take it.
struct Noise {
  float amplitude = 0;       ///< metres
  float inv_wavelength = 0;  ///< 1 / metres
  int octaves = 0;
  std::uint32_t seed = 0;
};

/// Decoded primitives, structure of arrays, in canonical order. The arrays are longer than size(): kernels
/// store whole vectors.
struct Primitives {
  std::vector<std::int32_t> x, y, z;  ///< anchors, units
  std::vector<float> radius, energy;  ///< metres
  std::vector<float> reach;           ///< contributes exactly 0 beyond this distance from the anchor
  std::vector<std::uint32_t> extra, extra_count;  ///< into the cloud's pool; empty for kinds without extras
  std::size_t count = 0;

  std::size_t size() const { return count; }
  void clear() {
    count = 0;
    extra.clear();
    extra_count.clear();
  }
  /// Room for `more` primitives beyond size().
  void reserve(std::size_t more) {
    if (count + more <= x.size()) return;
    const std::size_t n = 2 * (count + more);
    for (auto* v : {&x, &y, &z}) v->resize(n);
    for (auto* v : {&radius, &energy, &reach}) v->resize(n);
  }
};

/// What all primitives of a cloud share.
struct CloudView {
  const Primitives* primitives;
  const float* pool;
  float falloff;
  Noise noise;
};

/// A block of samples: 8 along x, ny rows, nz planes; sample (i, j, k) at f[k * plane + j * row + i].
struct Block {
  const std::int32_t *x, *y, *z;  ///< units
  const float *xr, *yr, *zr;      ///< remainders, metres
  int ny, nz;
  float* f;
  std::ptrdiff_t row, plane;
};

/// Up to eight points, one a lane; unused lanes repeat the first.
struct PointLanes {
  alignas(32) std::int32_t x[8], y[8], z[8];
  alignas(32) float xr[8], yr[8], zr[8];
};

/// Values and gradients of eight points.
struct PointValues {
  alignas(32) float v[8], gx[8], gy[8], gz[8];
};

/// One primitive kind compiled for one instruction set. `list` holds `n` ascending indices.
struct PrimitiveKernels {
  void (*add_block)(const CloudView&, const std::uint32_t* list, std::size_t n, const Block&);
  void (*add_points)(const CloudView&, const std::uint32_t* list, std::size_t n, const PointLanes&, float* f);
  void (*add_gradients)(const CloudView&, const std::uint32_t* list, std::size_t n, const PointLanes&,
                        PointValues&);
  /// Distance of eight points from the skeleton of primitive `i`, metres.
  void (*distance)(const CloudView&, std::uint32_t i, const PointLanes&, float* out);
};

}  // namespace tafoni::field::impl
