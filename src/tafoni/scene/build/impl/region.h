#pragma once
// Where a layer may act: what its common settings, the files that they name and painting strokes leave of the
// scene.

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/landforms/site/region.h"
#include "tafoni/scene/build/impl/ground.h"
#include "tafoni/scene/sculpt/impl/paint.h"

namespace tafoni::scene::impl {

/// Where a layer acts; null where nothing limits it.
using RegionPtr = std::shared_ptr<const landforms::Region>;

/// The strokes that paint a mask, and the raster whose pixels it takes.
struct PaintedMask {
  PaintStrokes paint;
  Keyed<RasterPtr> like;  ///< local heights, whose pixels the mask has
};
inline auto parts(const PaintedMask& mask) {
  const auto& [paint, like] = mask;
  return std::tie(paint, like);
}

struct Limits {
  std::vector<double> altitude, box;  ///< as LayerSettings has them
  std::optional<File> polygons, mask;
  std::optional<PaintedMask> painted;  ///< in place of `mask`
  Vec3d origin;                        ///< of the scene
  std::vector<double> outline;  ///< of the terrain's pixels, for masks that say not where they lie: local
                                ///< west, south, east, north
  std::string crs;

  bool any() const { return !altitude.empty() || !box.empty() || polygons || mask || painted; }
};
inline auto parts(const Limits& limits) {
  const auto& [altitude, box, polygons, mask, painted, origin, outline, crs] = limits;
  return std::tie(altitude, box, polygons, mask, painted, origin, outline, crs);
}

RegionPtr make_region(const Limits& limits, Progress& progress);

}  // namespace tafoni::scene::impl
