#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "tafoni/geology/test/rocks.h"

namespace tafoni::geology {
namespace {

const Values calm = {{"amplitude", 0.0}, {"lateral", 0.0}};

TEST(Fold, IsTheRockAtTheWarpedPoint) {
  const Values values = {{"amplitude", 20.0}, {"lateral", 7.0}, {"wavelength", 40.0}, {"height", 5.0}};
  const auto strata = make_geology("strata", {}, {}, {}, 2);
  const auto folded = make_geology("fold", values, {strata}, {}, 3);
  for (Vec3d p : scattered(300, 200, 1))
    ASSERT_EQ(folded->raw(p), strata->raw(source_of("fold", values, p, 3)));
}

TEST(Fold, RandomFoldsMoveRockAsFarAsIsSaidOnEachAxis) {
  const Values values = {
      {"amplitude", 20.0}, {"lateral", 7.0}, {"wavelength", 40.0}, {"octaves", std::int64_t{1}}};
  Vec3d most{}, mean{};
  double xy = 0;
  const auto points = scattered(4000, 2000, 5);
  for (Vec3d p : points) {
    const Vec3d d = source_of("fold", values, p) - p;
    most = {std::max(most.x, std::abs(d.x)), std::max(most.y, std::abs(d.y)),
            std::max(most.z, std::abs(d.z))};
    mean += d * (1.0 / static_cast<double>(points.size()));
    xy += d.x * d.y / static_cast<double>(points.size());
  }
  EXPECT_LE(most.x, 7);
  EXPECT_LE(most.z, 20);
  EXPECT_GT(most.x, 4.5);
  EXPECT_GT(most.y, 4.5);
  EXPECT_GT(most.z, 13);
  EXPECT_NEAR(mean.x, 0, 0.3);
  EXPECT_NEAR(mean.z, 0, 0.9);
  EXPECT_LT(std::abs(xy), 1) << "east and north move together";
}

TEST(Fold, RandomFoldsAreContinuous) {
  const Values values = {{"amplitude", 20.0}, {"lateral", 10.0}, {"wavelength", 40.0}};
  Vec3d last = source_of("fold", values, {0, 0, 0});
  for (double x = 0; x < 200; x += 0.1) {
    const Vec3d now = source_of("fold", values, {x, 0.3 * x, 0});
    ASSERT_LT(length(now - last), 0.7) << x;
    last = now;
  }
}

TEST(Fold, CrestsOfRegularFoldsStandWhereTheyAreSaid) {
  Values values = calm;
  values.insert(
      {{"height", 12.0}, {"length", 80.0}, {"axis", 30.0}, {"position", std::vector<double>{100, 50}}});
  const double a = 30 * std::numbers::pi / 180;
  const Vec3d along{std::sin(a), std::cos(a), 0}, across{std::cos(a), -std::sin(a), 0};
  const Vec3d crest{100, 50, 0};
  for (double t = -200; t < 200; t += 17) {
    for (double z : {-30.0, 0.0, 44.0}) {
      // What is found on a crest lay 12 m deeper.
      EXPECT_NEAR(source_of("fold", values, crest + along * t + Vec3d{0, 0, z}).z, z - 12, 1e-9);
      EXPECT_NEAR(source_of("fold", values, crest + along * t + across * 40.0 + Vec3d{0, 0, z}).z, z + 12,
                  1e-9);
      EXPECT_NEAR(source_of("fold", values, crest + along * t + across * 20.0 + Vec3d{0, 0, z}).z, z, 1e-9);
    }
    EXPECT_NEAR(source_of("fold", values, crest + across * t).x, (crest + across * t).x, 1e-12);
  }
}

TEST(Fold, LeaningFoldsMoveTheirCrestsWithHeight) {
  Values values = calm;
  values.insert({{"height", 6.0}, {"length", 90.0}, {"lean", 45.0}});
  for (double z : {-20.0, 0.0, 35.0}) EXPECT_NEAR(source_of("fold", values, {z, 77, z}).z, z - 6, 1e-9);
}

TEST(Fold, FoldsNest) {
  Values regular = calm;
  regular["height"] = 10.0;
  const auto strata = make_geology("strata", {}, {}, {}, 2);
  const auto once = make_geology("fold", regular, {strata}, {}, 3);
  const auto twice = make_geology("fold", regular, {once}, {}, 3);
  for (Vec3d p : scattered(100, 200, 2)) {
    const Vec3d q = source_of("fold", regular, p);
    ASSERT_EQ(twice->raw(p), once->raw(q));
    ASSERT_EQ(twice->raw(p), strata->raw(source_of("fold", regular, q)));
  }
}

}  // namespace
}  // namespace tafoni::geology
