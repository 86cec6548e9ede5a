#pragma once
// Towers of jointed, bedded rock: blocks with flat faces that narrow upward by steps.

#include <array>
#include <vector>

#include "tafoni/landforms/rock/rock_shape.h"

namespace tafoni::landforms::impl {

/// A prism on a rectangle with cut corners.
struct Block {
  Vec2d at;                        ///< local
  Vec2d half;                      ///< half-extents at the foot, metres
  double cut = 0;                  ///< of the corners, metres
  double turn = 0;                 ///< radians about z
  double top = 10;                 ///< above the tower's foot, metres
  Vec2d lean;                      ///< metres sideways a metre up
  Vec2d tilt;                      ///< slope of the top
  std::array<double, 6> widths{};  ///< share of the extents left at sixths of the height, falling
};

struct Tower {
  Vec3d foot;
  double height = 10;
  double sunk = 2;  ///< how far it reaches below its foot, metres
  std::vector<Block> blocks;
};

/// Many towers as one function; a point looks at those near it only.
class Towers final : public RockShape {
 public:
  Towers(std::vector<Tower> towers, const RockTexture& texture);
  /// Outside of it every value is -T.
  const Box3d& box() const { return box_; }

 protected:
  double body(Vec3d p) const override;
  Range body_range(const Box3d& box) const override;

 private:
  struct Cell {
    std::vector<std::uint32_t> towers;
  };
  Box3d reach(const Tower& tower) const;
  std::array<int, 4> cells(const Box3d& box) const;  ///< first and last column, first and last row

  std::vector<Tower> towers_;
  std::vector<Box3d> reaches_;
  Box3d box_;
  double cell_ = 1;
  int columns_ = 0, rows_ = 0;
  std::vector<Cell> cells_;
};

}  // namespace tafoni::landforms::impl
