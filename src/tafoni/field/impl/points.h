#pragma once
// Evaluation of a program at up to eight points at once. Lists of primitives may be any superset, in
// canonical order, of those that touch the points: the rest add exactly zero.

#include <span>
#include <vector>

#include "tafoni/field/impl/program.h"

namespace tafoni::field::impl {

class PointWork {
 public:
  /// This thread's own.
  static PointWork& local();

  /// Loads points[pack[0]] …; unused lanes repeat the first.
  void load(std::span<const Vec3d> points, std::span<const std::uint32_t> pack);
  /// Finds the primitives that may touch any point of a group, once for all its packs.
  void collect(const Program& program, std::span<const Vec3d> points, std::span<const std::uint32_t> group);
  /// Narrows what collect() found to the loaded points, where that pays.
  void narrow(const Program& program);
  /// Or: takes decoded primitives and lists from elsewhere, one a cloud.
  struct List {
    const Primitives* primitives;
    const std::uint32_t* items;
    std::size_t count;
  };
  std::vector<List>& lists() { return lists_; }

  /// f at the loaded points.
  const float* values(const Program& program);
  const PointValues& gradients(const Program& program);

 private:
  Vec3d points_[8];
  PointLanes lanes_;
  std::vector<Primitives> decoded_;
  std::vector<std::uint32_t> iota_;
  std::vector<std::vector<std::uint32_t>> narrowed_;
  std::vector<List> lists_;
  struct Slot {
    alignas(32) float f[8];
  };
  std::vector<Slot> value_slots_;
  std::vector<PointValues> gradient_slots_;
};

}  // namespace tafoni::field::impl
