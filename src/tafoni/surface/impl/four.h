#pragma once
// Four floats at once, for work on vertices that lies between kernels (g++ and clang).

#include <cmath>
#include <cstring>

#include "tafoni/math/vec.h"

namespace tafoni::surface::impl {

using Four = float __attribute__((vector_size(16)));

/// From memory of any alignment.
inline Four load_four(const float* from) {
  Four out;
  std::memcpy(&out, from, sizeof(out));
  return out;
}

/// Four vectors, one a lane.
inline Vec3<Four> load_vectors(const Vec3f* v) {
  static_assert(sizeof(Vec3f) == 3 * sizeof(float));
  const float* const from = &v->x;
  const Four a = load_four(from), b = load_four(from + 4), c = load_four(from + 8);  // xyzx yzxy zxyz
  const Four xy23 = __builtin_shufflevector(b, c, 2, 3, 5, 6),
             yz01 = __builtin_shufflevector(a, b, 1, 2, 4, 5);
  return {__builtin_shufflevector(a, xy23, 0, 3, 4, 6), __builtin_shufflevector(yz01, xy23, 0, 2, 5, 7),
          __builtin_shufflevector(yz01, c, 1, 3, 4, 7)};
}

inline Four sqrt(Four a) {
  return Four{std::sqrt(a[0]), std::sqrt(a[1]), std::sqrt(a[2]), std::sqrt(a[3])};
}

}  // namespace tafoni::surface::impl
