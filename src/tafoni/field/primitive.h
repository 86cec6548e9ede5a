#pragma once
// What the program knows of a kind of primitive. A kind is one file in primitives/, which declares itself and
// gives the offset from its skeleton as one template; every kernel is made from that.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/registry.h"

namespace tafoni::field {

namespace impl {
struct PrimitiveKernels;
}

/// A primitive is energy * g(distance to a skeleton), g(u) = (1 - u^2)^3 inside its support and exactly 0
/// outside [Paris19 §5.2]. Its record is an anchor, an energy, a radius and `extras` further
/// floats.
struct PrimitiveType {
  /// Its parameters are the record's floats after anchor and energy, in order: "radius" first, then the
  /// extras.
  Declaration about = {};
  int extras = 0;           ///< floats after the radius; for a variable kind, floats a vertex
  bool variable = false;    ///< any number (at least one) of groups of `extras` floats
  bool volumetric = false;  ///< constant inside `radius`, then falls off over the cloud's falloff; else the
                            ///< falloff starts at the skeleton and ends at `radius`
  /// Greatest distance of the skeleton from the anchor, metres.
  float (*extent)(std::span<const float> extras) = nullptr;
  /// For the instruction set this machine has.
  const impl::PrimitiveKernels& (*kernels)() = nullptr;
};

std::span<const PrimitiveType* const> all_primitives();
/// Throws Error{usage} naming the nearest known kind.
const PrimitiveType& find_primitive(std::string_view name);

}  // namespace tafoni::field
