#include "tafoni/geology/geology.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"

namespace tafoni::geology {
namespace {

class Height final : public Geology {
 public:
  double raw(Vec3d p) const override { return p.z; }
};

TEST(Geology, ResistanceIsClamped) {
  const Height g;
  EXPECT_EQ(g.resistance({0, 0, -3}), 0);
  EXPECT_EQ(g.resistance({0, 0, 0.25}), 0.25);
  EXPECT_EQ(g.resistance({0, 0, 3}), 1);
}

TEST(Geology, BatchesOfAnySizeGiveWhatPointsGive) {
  const Height g;
  for (const std::size_t n : {0u, 1u, 511u, 513u, 20000u}) {
    std::vector<Vec3d> points(n);
    for (std::size_t i = 0; i < n; ++i) points[i].z = static_cast<double>(i) / 1000 - 0.5;
    std::vector<float> out(n, -1);
    g.resistances(points, out);
    for (std::size_t i = 0; i < n; ++i)
      ASSERT_EQ(out[i], static_cast<float>(g.resistance(points[i]))) << i << " of " << n;
  }
}

}  // namespace
}  // namespace tafoni::geology
