#pragma once
// The edits of a terrain in order, and what they do to a grid.

#include <cstdint>
#include <set>
#include <vector>

#include "tafoni/runtime/operation.h"
#include "tafoni/surface/chunk.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::runtime::impl {

/// What edits have to know of a ground besides its samples.
struct Place {
  Vec3d origin;         ///< world position of local zero
  double band = 0;      ///< greatest magnitude of a value
  int first_layer = 0;  ///< samples of a lesser z are the floor, which no edit changes
};

/// Version 1 is before the first edit; version v after the first v - 1.
class History {
 public:
  explicit History(bool keeps_past) : keeps_past_(keeps_past) {}

  const std::vector<Message>& edits() const { return edits_; }
  std::uint64_t version() const { return edits_.size() + 1; }
  /// `changed`: boxes that hold every sample that the edit changed.
  void add(const Message& message, const std::vector<volume::SampleBox>& changed);
  /// Forgets all edits but the first `count`.
  void cut(std::size_t count);
  /// The grid of the present version. Every 64th is kept to rewind from.
  void remember(const volume::ScalarGrid& grid);

  /// Throws Error{usage} where the past is not kept and for versions that are not past.
  void check_rewind(std::uint64_t version) const;
  /// The grid of that version, made from the nearest before it that is kept.
  volume::ScalarGrid grid_at(std::uint64_t version, const Place& place) const;
  /// Boxes that hold all that differs between that version and the present.
  std::vector<volume::SampleBox> changed_since(std::uint64_t version) const;
  /// Of memory, at most: messages, and chunks of grids that are kept and are not the present one's. The same
  /// on every machine.
  std::uint64_t bytes() const;

 private:
  using Chunks = std::set<Vec3i, surface::ChunkOrder>;
  Chunks chunks_since(std::uint64_t version) const;

  bool keeps_past_;
  std::uint64_t message_bytes_ = 0;
  std::vector<Message> edits_;
  std::vector<volume::SampleBox> changed_;  ///< around what each edit changed
  struct Kept {
    std::uint64_t version = 0;
    volume::ScalarGrid grid;
    /// The chunks that edits changed before the next version that is kept, which shares the others; of the
    /// last one yet to be found.
    Chunks own = {};
  };
  std::vector<Kept> kept_;  ///< by version; the first is version 1
};

/// Makes edits, given in world positions, in a grid whose local zero lies at `origin`. Each gives boxes that
/// hold every sample that it changed.
class Editor {
 public:
  using Boxes = std::vector<volume::SampleBox>;
  Editor(volume::ScalarGrid& grid, const Place& place, const History& history)
      : grid_(grid), place_(place), history_(history) {}

  Boxes operator()(const ToolUse& use) const;
  Boxes operator()(const Explosion& explosion) const;
  Boxes operator()(const Radial& radial) const;
  Boxes operator()(const Rewind& rewind) const;

 private:
  template <class Change>
  Boxes above_floor(const Box3d& bounds, const Change& change) const;

  volume::ScalarGrid& grid_;
  Place place_;
  const History& history_;
};

/// How many chunks the samples of the box belong to.
std::uint64_t chunks_of(const volume::SampleBox& box);

/// Samples that the edit looks at, one of a hull's sides at a time; 0 for a rewind.
std::uint64_t work_of(const Operation& operation, const volume::ScalarGrid& grid, const Place& place);

}  // namespace tafoni::runtime::impl
