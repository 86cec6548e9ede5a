#include "tafoni/terrain/impl/face.h"

#include "tafoni/core/random.h"

namespace tafoni::terrain::impl {

Face::Face(double height, const FaceBeds& beds, std::uint64_t seed) : step_(std::max(0.25, height / 32768)) {
  Random random(seed, 11);
  const auto between = [&](const double(&limits)[2]) { return random.uniform(limits[0], limits[1]); };
  double x = 0, top = beds.foot, run = beds.foot_run;
  bool hard = false;
  for (double z = 0; z <= height + step_; z += step_) {
    if (z >= top) {
      hard = !hard;
      top = z + between(hard ? beds.hard_thickness : beds.soft_thickness);
      run = between(hard ? beds.hard_run : beds.soft_run);
    }
    reach_.push_back(x);
    x += step_ * run;
  }
}

double Face::height(double reach) const {
  if (reach <= 0) return 0;
  const auto above = std::upper_bound(reach_.begin(), reach_.end(), reach);
  const auto i = static_cast<double>(above - reach_.begin());
  if (above == reach_.end()) return i * step_;
  const double x0 = *(above - 1), x1 = *above;
  return (i - 1 + (reach - x0) / (x1 - x0)) * step_;
}

double Face::reach(double height) const {
  const double at = std::clamp(height / step_, 0.0, static_cast<double>(reach_.size() - 1));
  const auto i = std::min(static_cast<std::size_t>(at), reach_.size() - 2);
  return reach_[i] + (at - static_cast<double>(i)) * (reach_[i + 1] - reach_[i]);
}

}  // namespace tafoni::terrain::impl
