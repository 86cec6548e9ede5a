#pragma once
// Rocks whose every value is known, for tests of what moves and cuts rock.

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/geology/kind.h"

namespace tafoni::geology {

/// Any function of position as a rock.
class Rock final : public Geology {
 public:
  explicit Rock(std::function<double(Vec3d)> f) : f_(std::move(f)) {}
  double raw(Vec3d p) const override { return f_(p); }

 private:
  std::function<double(Vec3d)> f_;
};

inline GeologyPtr rock(std::function<double(Vec3d)> f) {
  return std::make_shared<Rock>(std::move(f));
}

/// Where a kind of one child fetches the rock at p from: asked of three rocks that are x, y and z.
inline Vec3d source_of(const char* kind, const Values& values, Vec3d p, std::uint64_t seed = 0) {
  const auto at = [&](double Vec3d::*axis) {
    return make_geology(kind, values, {rock([=](Vec3d q) { return q.*axis; })}, {}, seed)->raw(p);
  };
  return {at(&Vec3d::x), at(&Vec3d::y), at(&Vec3d::z)};
}

inline std::vector<Vec3d> scattered(std::size_t n, double reach, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> out(n);
  for (Vec3d& p : out)
    p = {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
  return out;
}

}  // namespace tafoni::geology
