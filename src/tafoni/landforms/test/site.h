#pragma once
// A plain coast to test on: a plateau north of a cliff, a shelf below the sea south of it.

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string_view>
#include <type_traits>

#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/landforms/site/region.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::landforms::test {

/// Resistance by a function of the local position.
class Rock final : public geology::Geology {
 public:
  explicit Rock(std::function<double(Vec3d)> rho) : rho_(std::move(rho)) {}
  double raw(Vec3d p) const override { return rho_(p); }

 private:
  std::function<double(Vec3d)> rho_;
};

struct Coast {
  static constexpr int width = 120, height = 90;
  static constexpr double shelf = -3, plateau = 30;

  static double ground(double x, double y) {
    const double t = std::clamp((y - 2 * std::sin(0.2 * x)) / 3 + 0.5, 0.0, 1.0);
    return shelf + (plateau - shelf) * t + 0.3 * std::sin(0.7 * x) * std::cos(0.5 * y);
  }

  /// The cliff runs along y = 0; `bay` moves it.
  explicit Coast(
      std::function<double(Vec3d)> rho = [](Vec3d) { return 0.3; },
      std::function<double(double, double)> elevation = nullptr)
      : rock(std::make_shared<const Rock>(std::move(rho))) {
    const raster::Placement placement{-width / 2.0, height / 2.0, 1, 1};
    const auto raster = std::make_shared<raster::Raster>(
        raster::sampled(width, height, placement, elevation ? elevation : ground));
    site.origin = {500000, 4000000, 0};
    site.heights = raster;
    site.terrain = field::heightfield(raster, {});
    site.geology = rock;
    site.seed = 5;
  }

  geology::GeologyPtr rock;
  Site site;
};

inline field::CompiledField carved(const Site& site, const Result& result) {
  return field::compile(apply_to(site.terrain, result));
}

/// Random places in a box.
inline std::vector<Vec3d> places(const Box3d& box, int n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points;
  for (int i = 0; i < n; ++i)
    points.push_back({random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                      random.uniform(box.lo.z, box.hi.z)});
  return points;
}

inline std::vector<float> values(const field::CompiledField& field, const std::vector<Vec3d>& points) {
  std::vector<float> out(points.size());
  field.values(points, out);
  return out;
}

template <class T>
T fact(const Result& result, std::string_view name) {
  if (const T* told = result.facts.find<T>(name)) return *told;
  throw std::runtime_error("no such fact");
}

}  // namespace tafoni::landforms::test
