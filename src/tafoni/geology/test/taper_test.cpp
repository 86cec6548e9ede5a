#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/geology/test/rocks.h"

namespace tafoni::geology {
namespace {

Values values(double ratio) {
  return {
      {"position", std::vector<double>{10, -20, 100}}, {"radius", 200.0}, {"height", 30.0}, {"ratio", ratio}};
}

TEST(Taper, BedsAtThePositionHaveTheRatioOfTheirThickness) {
  for (const double ratio : {0.25, 0.8, 3.0}) {
    const double top = 100 + 30 * ratio;  // of what is compressed
    for (double z = -29; z < 30; z += 5)
      EXPECT_NEAR(source_of("taper", values(ratio), {10, -20, 100 + z * ratio}).z, 100 + z, 1e-9);
    EXPECT_NEAR(source_of("taper", values(ratio), {10, -20, top + 7}).z, 137, 1e-9);
    EXPECT_NEAR(source_of("taper", values(ratio), {10, -20, 200 - top - 7}).z, 63, 1e-9);
  }
}

TEST(Taper, LeavesWhatIsFartherThanTheRadius) {
  for (Vec3d p : scattered(200, 150, 1)) {
    const Vec3d beyond = p + Vec3d{400, 0, 0};
    EXPECT_EQ(source_of("taper", values(0.3), beyond), beyond);
    const Vec3d q = source_of("taper", values(0.3), p);
    EXPECT_EQ(q.x, p.x);
    EXPECT_EQ(q.y, p.y);
  }
}

TEST(Taper, IsTheInverseOfItsDocumentedMapping) {
  const double ratio = 0.3, height = 30;
  for (Vec3d q : scattered(500, 150, 3)) {
    q.z += 100;
    const double r = std::hypot(q.x - 10, q.y + 20) / 200;
    const double g = r < 1 ? std::pow(1 - r * r, 3) : 0;
    const double k = 1 - (1 - ratio) * g, z = q.z - 100;
    // Where the rock of q goes.
    const double to = std::abs(z) < height ? k * z : z - std::copysign((1 - k) * height, z);
    EXPECT_NEAR(source_of("taper", values(ratio), {q.x, q.y, 100 + to}).z, q.z, 1e-9);
  }
}

TEST(Taper, KeepsTheOrderOfBedsAndTearsNothing) {
  for (const double ratio : {0.02, 0.5, 5.0})
    for (double x : {-150.0, 0.0, 12.0, 90.0}) {
      double last = source_of("taper", values(ratio), {x, -20, -100}).z;
      for (double z = -99.9; z < 300; z += 0.1) {
        const double now = source_of("taper", values(ratio), {x, -20, z}).z;
        ASSERT_GT(now, last);
        ASSERT_LT(now - last, 0.1 / std::min(ratio, 1.0) + 1e-6);
        last = now;
      }
    }
}

}  // namespace
}  // namespace tafoni::geology
