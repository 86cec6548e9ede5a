#pragma once
// Simplex noise [Perlin01] and fractal Brownian motion [Paris19 §3.3].

#include <cstdint>
#include <span>

#include "tafoni/math/vec.h"

namespace tafoni {

/// 3D simplex noise in [0, 1], mean 1/2, feature size about 1. Positions to 10^9: no jitter far from zero.
float simplex(Vec3d p, std::uint64_t seed);

/// t(p) = sum over k < octaves of 2^-k n(2^k p), divided by the sum of 2^-k, so in [0, 1].
/// (The paper's t is not normalised.) Each octave has a seed of its own.
float fbm(Vec3d p, int octaves, std::uint64_t seed);

/// The same at many points, several times as fast; out[i] is bit-identical to fbm(points[i], ...).
void fbm(std::span<const Vec3d> points, int octaves, std::uint64_t seed, std::span<float> out);

}  // namespace tafoni
