#include "tafoni/landforms/site/spatial_hash.h"

#include <set>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni::landforms {
namespace {

TEST(SpatialHash, FindsWhatBruteForceFinds) {
  Random random(9);
  SpatialHash hash(2.0, 1);
  std::vector<Vec3d> points;
  for (std::uint32_t i = 0; i < 3000; ++i) {
    points.push_back({random.uniform(-20, 20), random.uniform(-20, 20), random.uniform(-9, 9)});
    EXPECT_EQ(hash.insert(points.back()), i);
  }
  ASSERT_EQ(hash.size(), points.size());
  for (int i = 0; i < 500; ++i) {
    const Vec3d p{random.uniform(-22, 22), random.uniform(-22, 22), random.uniform(-10, 10)};
    const double radius = random.uniform(0, 3.5);  // beyond half a cell as well
    std::set<std::uint32_t> expected, found;
    for (std::uint32_t k = 0; k < points.size(); ++k)
      if (length(points[k] - p) < radius) expected.insert(k);
    hash.near(p, radius, [&](std::uint32_t id, double d2) {
      EXPECT_NEAR(d2, dot(points[id] - p, points[id] - p), 1e-12);
      EXPECT_TRUE(found.insert(id).second);
      return false;
    });
    ASSERT_EQ(found, expected);
    EXPECT_EQ(hash.any_near(p, radius), !expected.empty());
  }
}

}  // namespace
}  // namespace tafoni::landforms
