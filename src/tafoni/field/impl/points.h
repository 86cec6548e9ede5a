#pragma once
// Evaluation of a program at up to eight points at once. Lists of primitives may be any superset, in
// canonical order, of those that touch the points: the rest add exactly zero.

#include <memory>
#include <span>
#include <vector>

#include "tafoni/field/impl/program.h"
#include "tafoni/field/impl/warp_noise.h"

namespace tafoni::field::impl {

class PointWork {
 public:
  PointWork();
  ~PointWork();
  PointWork(PointWork&&) noexcept;

  /// One of this thread's own, for as long as this lives: a function that evaluation asks may evaluate fields
  /// itself.
  class Lease {
   public:
    Lease();
    ~Lease();
    Lease(const Lease&) = delete;
    Lease& operator=(const Lease&) = delete;
    PointWork& operator*() const { return work_; }
    PointWork* operator->() const { return &work_; }

   private:
    PointWork& work_;
  };

  /// f at neighbouring points: primitives are found once for all of them.
  void values(const Program& program, std::span<const Vec3d> points, float* out);
  /// Lane i % 8 of out[i / 8]; lanes beyond the points repeat the first of their pack.
  void gradients(const Program& program, std::span<const Vec3d> points, PointValues* out);
  /// Encloses f over the box.
  Interval range(const Program& program, const Box3d& box);
  /// Elevations over the column's x and y beyond which the program's leaves mostly stay as they are.
  Interval extent(const Program& program, const Box3d& column);

  /// What the nested leaf `index` of the program works in.
  PointWork& nested(std::size_t index);
  /// Buffers of a nested leaf.
  struct Scratch {
    std::vector<Vec3d> points;
    std::vector<float> values, control;
    std::vector<PointValues> gradients;
    std::vector<Vec3f> slopes;
    std::vector<Displacement> displacements;
    struct Ball {
      Vec3d center;
      double radius;
    };
    std::vector<Ball> balls;
    std::vector<std::uint32_t> items;
  };
  Scratch scratch;

  // The steps of the above, for who has points in an order of their own.

  static constexpr std::size_t pack_size = 8;
  /// Asks the nested leaves at all points of a group, before its packs are loaded.
  void ask_nested(const Program& program, std::span<const Vec3d> points, std::span<const std::uint32_t> group,
                  bool with_gradients);
  /// Loads the group's pack that begins at `first`, a multiple of eight: points[pack[0]] …; unused lanes
  /// repeat the first.
  void load(std::span<const Vec3d> points, std::span<const std::uint32_t> pack, std::size_t first);
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
  /// Calls run(first, count) for each pack of the points, loaded and with its primitives found.
  template <class Run>
  void in_packs(const Program& program, std::span<const Vec3d> points, bool with_gradients, const Run& run);

  Vec3d points_[8];
  std::size_t first_ = 0;  ///< of the pack in its group
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
  RangeWork ranges_;
  Primitives in_box_;
  std::vector<std::uint32_t> group_;
  std::vector<std::unique_ptr<PointWork>> nested_;
  // What the nested leaves said of the group.
  std::vector<Vec3d> group_points_;
  std::vector<std::vector<float>> nested_values_;
  std::vector<std::vector<PointValues>> nested_gradients_;
};

}  // namespace tafoni::field::impl
