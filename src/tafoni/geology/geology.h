#pragma once
// Geology: bedrock resistance rho in [0, 1] as a function of position [Paris19 §4].

#include <memory>
#include <span>

#include "tafoni/field/function.h"
#include "tafoni/math/vec.h"

namespace tafoni::geology {

/// An immutable geology tree. Positions are double metres, in the scene's local frame where make_geology()
/// made it. The kinds work on world positions, so that neither elevations nor noise depend on the local
/// origin.
class Geology {
 public:
  virtual ~Geology() = default;
  /// Resistance before the final clamp; blends add these.
  virtual double raw(Vec3d p) const = 0;
  /// raw() at many points, bit-identical to one by one. A node that can be faster overrides it.
  virtual void raws(std::span<const Vec3d> points, std::span<double> out) const;
  /// Resistance, clamped to [0, 1].
  double resistance(Vec3d p) const;
  /// resistance() at many points, in parallel when there are enough of them.
  void resistances(std::span<const Vec3d> points, std::span<float> out) const;
};
using GeologyPtr = std::shared_ptr<const Geology>;

/// The clamped resistance as a function that trees can hold.
field::FunctionPtr as_function(GeologyPtr geology);

}  // namespace tafoni::geology
