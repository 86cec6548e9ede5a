#pragma once
// The edits of a terrain in order, and what they do to a grid.

#include <cstdint>
#include <utility>
#include <vector>

#include "tafoni/runtime/operation.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::runtime::impl {

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
  volume::ScalarGrid grid_at(std::uint64_t version, Vec3d origin, double band) const;
  /// Boxes that hold all that differs between that version and the present.
  std::vector<volume::SampleBox> changed_since(std::uint64_t version) const;

 private:
  bool keeps_past_;
  std::vector<Message> edits_;
  std::vector<volume::SampleBox> changed_;                          ///< around what each edit changed
  std::vector<std::pair<std::uint64_t, volume::ScalarGrid>> kept_;  ///< by version; the first is version 1
};

/// Makes edits, given in world positions, in a grid whose local zero lies at `origin`. Each gives boxes that
/// hold every sample that it changed.
class Editor {
 public:
  using Boxes = std::vector<volume::SampleBox>;
  Editor(volume::ScalarGrid& grid, Vec3d origin, double band, const History& history)
      : grid_(grid), origin_(origin), band_(band), history_(history) {}

  Boxes operator()(const ToolUse& use) const;
  Boxes operator()(const Explosion& explosion) const;
  Boxes operator()(const Radial& radial) const;
  Boxes operator()(const Rewind& rewind) const;

 private:
  volume::ScalarGrid& grid_;
  Vec3d origin_;
  double band_;
  const History& history_;
};

/// Samples that the edit looks at, one of a hull's sides at a time; 0 for a rewind.
std::uint64_t work_of(const Operation& operation, const volume::ScalarGrid& grid, Vec3d origin, double band);

}  // namespace tafoni::runtime::impl
