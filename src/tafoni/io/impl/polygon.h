#pragma once
// Polygons of mesh files as triangles.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "tafoni/math/vec.h"

namespace tafoni::io::impl {

/// Cuts one polygon after another; memory is used again.
class PolygonCutter {
 public:
  /// Places within `polygon` of the corners of its triangles, always two fewer than it has corners. A fan
  /// from the first corner where that covers it; else ears are cut off, seen from where the polygon is
  /// largest. Corners whose positions are not known, polygons that cross themselves or wind so that ears are
  /// hard to find, and concave ones of more than `most_corners` become fans. Valid until the next call.
  std::span<const std::array<std::uint32_t, 3>> cut(std::span<const std::uint32_t> polygon,
                                                    std::span<const Vec3d> positions);

  /// The time that ears take grows with the square.
  static constexpr std::size_t most_corners = 512;

 private:
  bool look_at(std::span<const std::uint32_t> polygon, std::span<const Vec3d> positions);
  bool fan_covers(Vec3d normal) const;
  bool cut_ears();
  bool is_ear(std::size_t at) const;

  std::vector<std::array<std::uint32_t, 3>> triangles_;
  std::vector<Vec3d> corners_;
  std::vector<Vec2d> flat_;
  std::vector<std::uint32_t> left_;  ///< corners that are not cut off yet
};

}  // namespace tafoni::io::impl
