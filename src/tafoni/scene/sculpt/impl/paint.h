#pragma once
// The masks that strokes paint.

#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/raster/grid.h"
#include "tafoni/scene/build/impl/digest.h"
#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene::impl {

/// A place in the list of a layer's strokes.
struct Slot {
  std::shared_ptr<const Stroke> stroke;
  bool muted = false;
  friend bool operator==(const Slot&, const Slot&) = default;
};

/// The strokes that paint one mask, in their order.
struct PaintStrokes {
  std::vector<std::shared_ptr<const Stroke>> strokes;
};
/// Strokes count by what they say.
void add_part(Digest& to, const PaintStrokes& paint);

/// The masks that strokes paint which are not muted.
std::vector<std::string> painted_masks(std::span<const Slot> slots);
/// The strokes that paint the mask `name` and are not muted.
PaintStrokes paint_strokes(std::span<const Slot> slots, std::string_view name);

/// A mask of weights in [0, 1], with the pixels and the frame of `like`, whose origin in the world is
/// `origin`.
raster::Raster paint_mask(const PaintStrokes& paint, const raster::Raster& like, Vec3d origin);

}  // namespace tafoni::scene::impl
