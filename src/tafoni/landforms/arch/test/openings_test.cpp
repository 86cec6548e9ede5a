#include "tafoni/landforms/arch/openings.h"

#include <gtest/gtest.h>

#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms {
namespace {

impl::RockTexture rough() {
  impl::RockTexture texture;
  texture.unevenness = 0.7;
  texture.relief = -1;
  texture.wavelength = 3;
  return texture;
}

/// Of boxes of many sizes about `around`: every value lies in the box's range; outside of `reach` all is -T.
void check(const impl::RockShape& shape, const Box3d& reach, const Box3d& around, std::uint64_t seed) {
  Random random(seed);
  for (int i = 0; i < 1500; ++i) {
    const double size = std::exp(random.uniform(-1.5, 3.5));
    const Vec3d lo = test::places(around, 1, random.next()).front();
    const Box3d box{lo, lo + Vec3d{size, random.uniform(0.1, 1) * size, random.uniform(0.1, 1) * size}};
    const Interval range = shape.range(box);
    const auto points = test::places(box, 12, random.next());
    std::vector<float> values(points.size());
    shape.values(points, values);
    for (std::size_t k = 0; k < points.size(); ++k) {
      ASSERT_TRUE(range.contains(values[k])) << range.lo << " " << values[k] << " " << range.hi;
      if (!reach.contains(points[k])) {
        ASSERT_EQ(values[k], -7.5f);
      }
    }
  }
}

TEST(Window, RangesEncloseValuesAndItEndsWhereItSays) {
  Random random(3);
  for (std::uint64_t i = 0; i < 8; ++i) {
    impl::Window w;
    const double turn = random.uniform(0, 6.28);
    w.center = {random.uniform(-5, 5), random.uniform(-5, 5), random.uniform(-5, 5)};
    w.through = {std::cos(turn), std::sin(turn), 0};
    w.half_width = random.uniform(2, 8);
    w.half_height = random.uniform(2, 8);
    w.half_length = random.uniform(3, 15);
    if (i % 2) {
      w.shaft_at = 0.7 * w.half_length;
      w.shaft_radius = 0.5 * w.half_width;
      w.shaft_top = 3 * w.half_height;
    }
    const auto shape = impl::window_shape(w, rough());
    check(*shape, impl::reach(w, shape->margin(), 7.5), {{-40, -40, -30}, {30, 30, 40}}, i);
  }
}

TEST(Bridge, RangesEncloseValuesAndItEndsWhereItSays) {
  Random random(4);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const impl::Bridge b{{random.uniform(-30, -5), random.uniform(-10, 10), random.uniform(-5, 5)},
                         {random.uniform(5, 30), random.uniform(-10, 10), random.uniform(-5, 5)},
                         random.uniform(0, 6),
                         random.uniform(1.5, 4),
                         random.uniform(1.2, 3),
                         random.uniform(-3, 3)};
    const auto shape = impl::bridge_shape(b, rough());
    check(*shape, impl::reach(b, shape->margin(), 7.5), {{-60, -50, -40}, {50, 40, 40}}, i);
  }
}

}  // namespace
}  // namespace tafoni::landforms
