#pragma once
// A hash of points by cubic cells: who lies within a fixed distance, in time that does not grow with the
// whole.

#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms {

class SpatialHash {
 public:
  /// `cell`: the greatest distance any query will ask for, metres.
  explicit SpatialHash(double cell) : inv_(1 / cell) {}

  std::size_t size() const { return points_.size(); }
  const Vec3d& operator[](std::uint32_t i) const { return points_[i]; }

  std::uint32_t insert(Vec3d p) {
    const auto i = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    const auto [at, fresh] = heads_.try_emplace(key(cell(p.x), cell(p.y), cell(p.z)), i);
    next_.push_back(fresh ? none : at->second);
    at->second = i;
    return i;
  }

  /// visit(index, squared distance) for every point closer than `distance`; stops when it returns false.
  template <class Visit>
  void near(Vec3d p, double distance, const Visit& visit) const {
    const double d2 = distance * distance;
    for (std::int64_t z = cell(p.z - distance); z <= cell(p.z + distance); ++z)
      for (std::int64_t y = cell(p.y - distance); y <= cell(p.y + distance); ++y)
        for (std::int64_t x = cell(p.x - distance); x <= cell(p.x + distance); ++x) {
          const auto at = heads_.find(key(x, y, z));
          if (at == heads_.end()) continue;
          for (std::uint32_t i = at->second; i != none; i = next_[i]) {
            const Vec3d d = points_[i] - p;
            const double r2 = dot(d, d);
            if (r2 < d2 && !visit(i, r2)) return;
          }
        }
  }

  bool free(Vec3d p, double distance) const {
    bool free = true;
    near(p, distance, [&](std::uint32_t, double) { return free = false; });
    return free;
  }

 private:
  static constexpr std::uint32_t none = 0xffffffffu;
  std::int64_t cell(double v) const { return static_cast<std::int64_t>(std::floor(v * inv_)); }
  /// 21 bits an axis: two cells share a key only 2 million cells apart, which costs time and nothing else.
  static std::uint64_t key(std::int64_t x, std::int64_t y, std::int64_t z) {
    const auto bits = [](std::int64_t v) { return static_cast<std::uint64_t>(v) & 0x1fffff; };
    return bits(x) | bits(y) << 21 | bits(z) << 42;
  }
  struct Mix {
    std::size_t operator()(std::uint64_t k) const { return mix64(k); }
  };

  double inv_;
  std::vector<Vec3d> points_;
  std::vector<std::uint32_t> next_;
  std::unordered_map<std::uint64_t, std::uint32_t, Mix> heads_;
};

}  // namespace tafoni::landforms
