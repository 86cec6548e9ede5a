#pragma once
// A function's values where they are worked out one by one, in double.

#include <span>

#include "tafoni/math/vec.h"

namespace tafoni::field {

/// out[i] = value(points[i]), rounded.
template <class Value>
void each_point(std::span<const Vec3d> points, std::span<float> out, const Value& value) {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = static_cast<float>(value(points[i]));
}

}  // namespace tafoni::field
