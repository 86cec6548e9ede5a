#include "tafoni/field/function.h"

#include <vector>

namespace tafoni::field {

void Function::gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const {
  const double h = step();
  std::vector<Vec3d> around;
  around.reserve(6 * points.size());
  for (const Vec3d& p : points)
    for (const Vec3d& d : {Vec3d{h, 0, 0}, Vec3d{0, h, 0}, Vec3d{0, 0, h}}) {
      around.push_back(p + d);
      around.push_back(p - d);
    }
  std::vector<float> f(around.size());
  values(around, f);
  const auto scale = static_cast<float>(0.5 / h);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const float* at = f.data() + 6 * i;
    out[i] = {(at[0] - at[1]) * scale, (at[2] - at[3]) * scale, (at[4] - at[5]) * scale};
  }
}

}  // namespace tafoni::field
