#pragma once
// The displacement of a warp, over SIMD lanes.

#include <cstddef>
#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::field::impl {

struct WarpNoise {
  double inv_lateral, inv_vertical;  ///< 1 / metres
  int octaves;
  std::uint32_t seed[3];  ///< one an axis
  float amplitude[3];     ///< metres
};

/// Displacements of up to eight points, metres, and their derivatives: jacobian[3 i + j] is that of component
/// i along axis j.
struct Displacement {
  alignas(32) float d[3][8];
  alignas(32) float jacobian[9][8];
};

struct WarpKernels {
  void (*displace)(const WarpNoise&, const Vec3d* points, std::size_t n, Displacement&);
  void (*displace_with_jacobian)(const WarpNoise&, const Vec3d* points, std::size_t n, Displacement&);
};
/// For the instruction set this machine has.
const WarpKernels& warp_kernels();

}  // namespace tafoni::field::impl
