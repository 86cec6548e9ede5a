#include <cmath>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/query/test/meshes.h"
#include "tafoni/query/walks.h"

namespace tafoni::query {
namespace {

/// Rock whose distance from air is known, as a field whose values are anything but that.
class KnownDepth : public field::Function {
 public:
  virtual double depth(Vec3d p) const = 0;
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double d = depth(points[i]), steep = 1 + 90 * std::abs(std::sin(points[i].x));
      out[i] = static_cast<float>(steep * d * (1 + d * d));
    }
  }
  Interval range(const Box3d&) const override { return {-1e30f, 1e30f}; }
};

struct Tilted : KnownDepth {
  Vec3d normal = normalized(Vec3d{0.4, -0.3, 0.8});
  double depth(Vec3d p) const override { return -dot(p, normal); }
};

/// A hollow ball, and beside it a plane.
struct Hollow : KnownDepth {
  double depth(Vec3d p) const override { return std::min(length(p) - 3, 8 - p.z); }
};

void compare(const std::shared_ptr<const KnownDepth>& known) {
  const field::CompiledField field = field::compile(field::function(known));
  Random random(3);
  for (int i = 0; i < 400; ++i) {
    const Vec3d p = testing::random_point(random, i % 2 ? 9 : 4);
    const double depth = known->depth(p);
    if (depth > 2.5) continue;  // from farther off the ball is so small that lines miss it
    const double found = depth_in(field, p);
    if (depth <= 0)
      EXPECT_EQ(found, 0);
    else
      EXPECT_NEAR(found, depth, 0.02 * depth + 0.001) << p.x << " " << p.y << " " << p.z;
  }
}

TEST(DepthIn, IsMetresWhateverTheFieldsValues) {
  compare(std::make_shared<Tilted>());
  compare(std::make_shared<Hollow>());
}

TEST(DepthIn, EndsWhereAllIsRock) {
  EXPECT_EQ(depth_in(field::compile(field::constant(1)), {1, 2, 3}), 100);
  EXPECT_EQ(depth_in(field::compile(field::constant(-1)), {1, 2, 3}), 0);
}

}  // namespace
}  // namespace tafoni::query
