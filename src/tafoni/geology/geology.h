#pragma once
// Geology: bedrock resistance rho in [0, 1] as a function of position (document 003, section 4).

#include <memory>

#include "tafoni/math/vec.h"

namespace tafoni::geology {

/// An immutable geology tree. Positions are double metres in the scene's local frame, except that elevation
/// is world elevation (a stratum's height in the scene file is an elevation).
class Geology {
 public:
  virtual ~Geology() = default;
  /// Resistance before the final clamp; blends add these.
  virtual double raw(Vec3d p) const = 0;
  /// Resistance, clamped to [0, 1].
  double resistance(Vec3d p) const;
};
using GeologyPtr = std::shared_ptr<const Geology>;

}  // namespace tafoni::geology
