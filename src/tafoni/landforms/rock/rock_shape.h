#pragma once
// Bodies and openings in bedded rock, as functions: a smooth shape whose walls stand out where the rock is
// hard and recede where it is soft, with unevenness on top.

#include <cstdint>

#include "tafoni/field/function.h"
#include "tafoni/geology/geology.h"

namespace tafoni::landforms::impl {

struct RockTexture {
  geology::GeologyPtr geology;  ///< null: half resistant everywhere
  double relief = 0;            ///< metres between the walls of the softest and of the hardest rock;
                                ///< negative for an opening, which is wider where rock is soft
  double unevenness = 0;        ///< metres to either side
  double wavelength = 4;        ///< metres: that of the unevenness
  double upright = 1;           ///< how many times longer it is upward than sideways
  double amplitude = 7.5;       ///< T: values are clamped to [-T, T]
  Vec3d origin;                 ///< world position of local zero
  std::uint64_t seed = 0;
};

/// body(p) + relief (rho(p) - 1/2) + unevenness, clamped. It is exactly -T wherever body(p) + margin() <= -T.
class RockShape : public field::Function {
 public:
  explicit RockShape(const RockTexture& texture) : texture_(texture) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const final;
  Interval range(const Box3d& box) const final;
  /// Metres that rock and unevenness move the wall, at most.
  double margin() const;

 protected:
  struct Range {
    double lo, hi;
  };
  /// About the distance inward from the wall in metres, negative outside.
  virtual double body(Vec3d p) const = 0;
  virtual Range body_range(const Box3d& box) const = 0;
  const RockTexture& texture() const { return texture_; }

 private:
  RockTexture texture_;
};

}  // namespace tafoni::landforms::impl
