#pragma once
// Points in space hashed by cell, for Poisson-sphere tests: an open-addressed table of cells, each the head
// of a list of its points. An insertion and a query take constant time.

#include <cstdint>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/math/vec.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms {

/// A number for a cell of a lattice, to be mixed further.
inline std::uint64_t key_of_cell(std::int64_t x, std::int64_t y, std::int64_t z) {
  return x * 0x9e3779b97f4a7c15ull ^ y * 0xc2b2ae3d27d4eb4full ^ z * 0x165667b19e3779f9ull;
}

/// It grows as points come, which may lie up to 2^31 cells from zero. Queries of a radius up to half a cell
/// look into 8 cells at most.
class SpatialHash {
 public:
  explicit SpatialHash(double cell, std::size_t expected = 64) : scale_(1 / cell) {
    std::size_t slots = 64;
    while (slots < 2 * expected) slots *= 2;
    slots_.resize(slots);
  }

  std::size_t size() const { return points_.size(); }
  Vec3d point(std::uint32_t id) const { return points_[id].position; }

  /// The id of a point is its place in the order of insertion.
  std::uint32_t insert(Vec3d p) {
    if (2 * (used_ + 1) > slots_.size()) grow();
    const Cell cell = cell_of(p);
    Slot& slot = slots_[find(cell)];
    if (slot.head == none) {
      slot.cell = cell;
      ++used_;
    }
    const auto id = static_cast<std::uint32_t>(points_.size());
    points_.push_back({p, slot.head});
    slot.head = id;
    return id;
  }

  /// Calls visit(id, squared distance) for every point nearer than `radius`, until it returns true; returns
  /// whether it did.
  template <class F>
  bool near(Vec3d p, double radius, F&& visit) const {
    const Vec3d r{radius, radius, radius};
    const Cell lo = cell_of(p - r), hi = cell_of(p + r);
    for (std::int32_t z = lo.z; z <= hi.z; ++z)
      for (std::int32_t y = lo.y; y <= hi.y; ++y)
        for (std::int32_t x = lo.x; x <= hi.x; ++x)
          for (std::uint32_t i = slots_[find({x, y, z})].head; i != none; i = points_[i].next) {
            const Vec3d d = points_[i].position - p;
            const double d2 = dot(d, d);
            if (d2 < radius * radius && visit(i, d2)) return true;
          }
    return false;
  }

  bool any_near(Vec3d p, double radius) const {
    return near(p, radius, [](std::uint32_t, double) { return true; });
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  using Cell = Vec3i;
  struct Slot {
    Cell cell;
    std::uint32_t head = none;
  };
  struct Entry {
    Vec3d position;
    std::uint32_t next;
  };

  Cell cell_of(Vec3d p) const {
    return {floor_to(p.x * scale_), floor_to(p.y * scale_), floor_to(p.z * scale_)};
  }
  std::size_t find(Cell c) const {
    std::size_t i = mix64(key_of_cell(c.x, c.y, c.z)) & (slots_.size() - 1);
    while (slots_[i].head != none && !(slots_[i].cell == c)) i = (i + 1) & (slots_.size() - 1);
    return i;
  }
  void grow() {
    std::vector<Slot> old(2 * slots_.size());
    old.swap(slots_);
    for (const Slot& slot : old)
      if (slot.head != none) slots_[find(slot.cell)] = slot;
  }

  double scale_;
  std::vector<Slot> slots_;
  std::vector<Entry> points_;
  std::size_t used_ = 0;
};

}  // namespace tafoni::landforms
