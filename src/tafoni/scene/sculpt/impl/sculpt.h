#pragma once
// From the strokes of a sculpt layer to its node.
//
// Strokes act in their order: a stroke that adds fills what earlier ones carved. The layer is one sum S, kept
// within [-L, L] after every run of strokes that carve alike or add alike, so that repeating a stroke piles
// up nothing:
//
//   S = clamp(... clamp(clamp(run 1) + run 2) ... + run n), added to the tree below.
//
// The list of strokes is cut into groups of `group_size` places. In a group the order counts only where
// strokes overlap: a stroke's level is above that of every earlier one of the other mode that it overlaps,
// and a run is the strokes of one level. So there are few runs however modes alternate. Places, levels and
// the order of summation depend on nothing but the list, a muted stroke keeps its place, and what is appended
// changes no other's level: appending, muting, undoing and redoing cook one group again and change no value,
// not a bit of it, outside of the stroke's own support.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tafoni/field/tree.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/raster/grid.h"
#include "tafoni/scene/build/impl/digest.h"
#include "tafoni/scene/build/impl/recent.h"
#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene::impl {

/// A place in the list of a layer's strokes.
struct Slot {
  std::shared_ptr<const Stroke> stroke;
  bool muted = false;
  friend bool operator==(const Slot&, const Slot&) = default;
};

/// What strokes are cooked for.
struct SculptFrame {
  Vec3d origin;            ///< world position of local zero
  double amplitude = 7.5;  ///< T
  std::uint64_t seed = 0;  ///< of the layer
  const landforms::Region* region = nullptr;
  Digest region_digest;
};

struct CookedStroke;

/// The strokes of one level of one group.
struct SculptRun {
  bool adds = false;
  std::vector<field::NodePtr> clouds;
};

struct SculptGroup {
  std::vector<Slot> slots;
  std::vector<std::shared_ptr<const CookedStroke>> cooked;  ///< by place; null where muted
  std::vector<int> levels;                                  ///< by place; even where it carves
  std::vector<SculptRun> runs;                              ///< by level
  Digest digest;
};

struct Sculpted {
  std::vector<std::shared_ptr<const SculptGroup>> groups;
  field::NodePtr node;  ///< S; null where no stroke does anything
  Digest digest;
};

/// Keeps what it cooked.
class SculptCook {
 public:
  static constexpr std::size_t group_size = 128;

  std::shared_ptr<const Sculpted> cook(std::span<const Slot> slots, const SculptFrame& frame);
  /// Strokes cooked and groups put together since the beginning, for tests of what is reused.
  std::uint64_t strokes_cooked = 0, groups_cooked = 0;

 private:
  std::shared_ptr<const CookedStroke> cook_stroke(const std::shared_ptr<const Stroke>& stroke,
                                                  const SculptFrame& frame, const Digest& frame_digest);
  std::shared_ptr<const SculptGroup> cook_group(std::span<const Slot> slots, const SculptFrame& frame,
                                                const Digest& frame_digest);

  using StrokeKey = std::pair<const Stroke*, Digest>;
  struct KeptStroke {
    std::shared_ptr<const Stroke> stroke;  ///< keeps the key's address its own
    std::shared_ptr<const CookedStroke> cooked;
  };
  Recent<StrokeKey, KeptStroke> strokes_{1 << 20};
  /// By the addresses of their strokes, which they keep alive.
  Recent<Digest, std::shared_ptr<const SculptGroup>> groups_{1024};
};

/// Appends boxes outside of which both layers have the same values, bit for bit. Either may be null.
void changed_boxes(const Sculpted* before, const Sculpted* now, std::vector<Box3d>& out);

/// The mask `name` that the strokes paint: one pixel a pixel of `like`, weights in [0, 1], in the frame of
/// `like`, whose origin in the world is `origin`.
raster::Raster painted(std::span<const Slot> slots, std::string_view name, const raster::Raster& like,
                       Vec3d origin);
/// Of the strokes that paint `name`.
Digest painted_digest(std::span<const Slot> slots, std::string_view name);

}  // namespace tafoni::scene::impl
