#include "tafoni/field/inner/outside.h"

#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"

namespace tafoni::field {
namespace {

TEST(PrimitivesOutside, AreThoseThatTouchTheBoxNowhere) {
  Random random(4);
  const Box3d box{{-20, -10, -1e9}, {20, 30, 1e9}};
  CloudBuilder points{CloudSettings{}}, segments{CloudSettings{"segment", 15, {}}};
  std::uint64_t outside = 0;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d at{random.uniform(-60, 60), random.uniform(-60, 60), random.uniform(-60, 60)};
    const double radius = random.uniform(1, 5);
    add_point(points, at, radius, 1);
    const double dx = std::max({box.lo.x - at.x, at.x - box.hi.x, 0.0}),
                 dy = std::max({box.lo.y - at.y, at.y - box.hi.y, 0.0});
    // By boxes about them, so that none in a corner is doubtful.
    outside += dx > radius || dy > radius;
  }
  for (int i = 0; i < 100; ++i) add_segment(segments, {100.0 + i, 0, 0}, {200, 0, 0}, 3, 1);
  add_segment(segments, {-100, 0, 0}, {100, 0, 0}, 3, 1);
  const NodePtr tree = blend({constant(-1), points.finish(), unite({constant(-1), segments.finish()})});
  const double found = static_cast<double>(primitives_outside(tree, box));
  EXPECT_NEAR(found, static_cast<double>(outside) + 100, 0.01 * static_cast<double>(outside));
  EXPECT_GT(outside, 1000u);
  EXPECT_EQ(primitives_outside(tree, Box3d::everything()), 0u);
  EXPECT_EQ(primitives_outside(constant(1), box), 0u);
}

}  // namespace
}  // namespace tafoni::field
