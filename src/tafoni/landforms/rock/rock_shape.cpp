#include "tafoni/landforms/rock/rock_shape.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tafoni/math/lattice.h"
#include "tafoni/math/noise.h"

namespace tafoni::landforms::impl {

double RockShape::margin() const {
  return 0.5 * std::abs(texture_.relief) + texture_.unevenness;
}

void RockShape::values(std::span<const Vec3d> points, std::span<float> out) const {
  constexpr int octaves = 3;
  const double least = -texture_.amplitude - margin();
  std::vector<std::size_t> near;
  std::vector<double> bodies;
  std::vector<Vec3d> places;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double b = body(points[i]);
    if (b <= least || b >= -least) {
      out[i] = static_cast<float>(b < 0 ? -texture_.amplitude : texture_.amplitude);
      continue;
    }
    near.push_back(i);
    bodies.push_back(b);
    places.push_back(points[i]);
  }
  if (near.empty()) return;
  std::vector<float> rho(near.size(), 0.5f), noise(near.size(), 0.5f);
  if (texture_.geology && texture_.relief != 0) texture_.geology->resistances(places, rho);
  if (texture_.unevenness > 0) {
    for (Vec3d& p : places) {
      p = (p + texture_.origin) * (1 / texture_.wavelength);
      p.z /= texture_.upright;
    }
    fbm(places, octaves, texture_.seed, noise);
  }
  for (std::size_t i = 0; i < near.size(); ++i) {
    const double value =
        bodies[i] + texture_.relief * (rho[i] - 0.5) + texture_.unevenness * (2 * double{noise[i]} - 1);
    out[near[i]] = static_cast<float>(std::clamp(value, -texture_.amplitude, texture_.amplitude));
  }
}

Interval RockShape::range(const Box3d& box) const {
  const Range r = body_range(box);
  const double slack = margin() + 1e-3;
  const double most = texture_.amplitude;
  return rounded(std::clamp(r.lo - slack, -most, most), std::clamp(r.hi + slack, -most, most));
}

}  // namespace tafoni::landforms::impl
