#pragma once
// Makes the node of a sculpt layer from its strokes.
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
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include "tafoni/field/tree.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/scene/build/impl/memo.h"
#include "tafoni/scene/sculpt/impl/paint.h"
#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene::impl {

/// What strokes are cooked for: the same strokes in another frame make another node.
struct SculptFrame {
  Vec3d origin = {};       ///< world position of local zero
  double amplitude = 7.5;  ///< T
  std::uint64_t seed = 0;  ///< of the layer
  Keyed<std::shared_ptr<const landforms::Region>> region = {};
};
inline auto parts(const SculptFrame& frame) {
  const auto& [origin, amplitude, seed, region] = frame;
  return std::tie(origin, amplitude, seed, region);
}

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
  Digest digest;                                            ///< by what its strokes say
  std::uint64_t more = 0;                                   ///< primitives beyond one for each point
};

struct Sculpted {
  std::vector<std::shared_ptr<const SculptGroup>> groups;
  field::NodePtr node;  ///< S; null where no stroke does anything
};

// As parts of keys strokes count by their addresses: whoever keeps the key keeps the strokes.
inline void add_part(Digest& to, const std::shared_ptr<const Stroke>& stroke) {
  to.add(std::uint64_t{reinterpret_cast<std::uintptr_t>(stroke.get())});
}
inline auto parts(const Slot& slot) {
  const auto& [stroke, muted] = slot;
  return std::tie(stroke, muted);
}

/// Cooks strokes and groups, and keeps what it cooked.
class SculptCook {
 public:
  static constexpr std::size_t group_size = 128;

  /// The key tells what strokes say, not where they lie in memory.
  Keyed<std::shared_ptr<const Sculpted>> cook(std::span<const Slot> slots, const SculptFrame& frame);
  /// Strokes cooked and groups put together since the beginning, for tests of what is reused.
  std::uint64_t strokes_cooked() const { return strokes_.made(); }
  std::uint64_t groups_cooked() const { return groups_.made(); }

 private:
  struct Nothing {};
  using CookedPtr = std::shared_ptr<const CookedStroke>;
  using GroupPtr = std::shared_ptr<const SculptGroup>;
  using Strokes = Memo<CookedPtr, Nothing, std::shared_ptr<const Stroke>, SculptFrame>;
  using Groups = Memo<GroupPtr, Strokes, std::vector<Slot>, SculptFrame>;
  static CookedPtr cook_stroke(const std::shared_ptr<const Stroke>& stroke, const SculptFrame& frame,
                               Nothing&);
  static GroupPtr cook_group(const std::vector<Slot>& slots, const SculptFrame& frame, Strokes& strokes);

  Strokes strokes_{1 << 20, &cook_stroke};
  Groups groups_{1024, &cook_group};
};

/// Holds all that strokes carve and add.
Box3d box_of(const Sculpted& sculpted);

/// Of the strokes that act: how many there are, how many do nothing, and one of these.
struct IdleStrokes {
  std::uint64_t all = 0, count = 0;
  std::shared_ptr<const Stroke> first;
};
/// Those all of which, or what lies too far off to be carved at all, is where `over` says no.
IdleStrokes strokes_beside(const Sculpted& sculpted, const std::function<bool(const Box3d&)>& over);
/// Those that carve where `rock` says no and where no stroke adds any.
IdleStrokes strokes_in_air(const Sculpted& sculpted, const std::function<bool(const Box3d&)>& rock);

/// Appends boxes outside of which both layers have the same values, bit for bit. Either may be null.
void changed_boxes(const Sculpted* before, const Sculpted* now, std::vector<Box3d>& out);

}  // namespace tafoni::scene::impl
