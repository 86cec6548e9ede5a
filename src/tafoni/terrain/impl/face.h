#pragma once
// The profile of bedded rock faces, and the rounding of corners, for generators.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

namespace tafoni::terrain::impl {

/// A minimum whose corner is rounded over a height of about r.
inline double soft_min(double a, double b, double r) {
  const double h = std::max(r - std::abs(a - b), 0.0) / r;
  return std::min(a, b) - h * h * r * 0.25;
}

/// Thicknesses in metres and run over rise, each drawn between two limits.
struct FaceBeds {
  double hard_thickness[2] = {6, 14}, hard_run[2] = {0.04, 0.11};
  double soft_thickness[2] = {1, 3.5}, soft_run[2] = {0.5, 1.2};
  double foot = 0;      ///< thickness of an apron below the lowest bed
  double foot_run = 1;  ///< its run over rise
};

/// Horizontal reach of a bedded rock face by height: hard beds stand steep, soft ones lie back as ledges.
class Face {
 public:
  /// From 0 up to `height`; the first bed is hard.
  Face(double height, const FaceBeds& beds, std::uint64_t seed);

  /// Height at a distance behind the foot.
  double height(double reach) const;
  /// The inverse: distance behind the foot at a height.
  double reach(double height) const;

 private:
  double step_ = 0.25;
  std::vector<double> reach_;
};

}  // namespace tafoni::terrain::impl
