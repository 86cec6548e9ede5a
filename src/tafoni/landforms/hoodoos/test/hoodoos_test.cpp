#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms {
namespace {

using test::Coast;

Result grow(const Site& site, const Values& values = {}) {
  return find_landform("hoodoos").generate(site, values, silent());
}

std::vector<Vec3d> positions(const Result& result) {
  return test::fact<Places>(result, "positions").local;
}

/// Flat ground at 0 with hoodoos at points of a grid.
Coast plain(std::function<double(Vec3d)> rho) {
  Coast coast(std::move(rho), [](double, double) { return 0.0; });
  for (double x = -45; x <= 45; x += 15)
    for (double y = -30; y <= 30; y += 15) coast.site.points.push_back({x, y, 0});
  return coast;
}

const Values points_only{{"density", 0.0}, {"contrast", 0.0}, {"height", std::vector<double>{8, 8}}};

/// Mean distance from the axis at which rock ends, over 16 directions.
double radius_at(const field::CompiledField& field, Vec3d axis) {
  double sum = 0;
  for (int k = 0; k < 16; ++k) {
    const Vec3d along{std::cos(k * 0.3926990817), std::sin(k * 0.3926990817), 0};
    double r = 0;
    while (r < 6 && field.value(axis + along * r) > 0) r += 0.1;
    sum += r / 16;
  }
  return sum;
}

std::vector<double> ranks(const std::vector<double>& values) {
  std::vector<std::size_t> order(values.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return values[a] < values[b]; });
  std::vector<double> out(values.size());
  for (int i = 0; i < std::ssize(order); ++i) out[order[i]] = i;
  return out;
}

double spearman(const std::vector<double>& a, const std::vector<double>& b) {
  const auto x = ranks(a), y = ranks(b);
  const double n = static_cast<double>(x.size()), mean = (n - 1) / 2;
  double xy = 0, xx = 0, yy = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    xy += (x[i] - mean) * (y[i] - mean);
    xx += (x[i] - mean) * (x[i] - mean);
    yy += (y[i] - mean) * (y[i] - mean);
  }
  return xy / std::sqrt(xx * yy);
}

TEST(Hoodoos, AreWideWhereRockIsHard) {
  // Beds of 3 m, each of its own hardness at each hoodoo.
  const auto rho = [](Vec3d p) {
    const auto cell = [](double v, double size) {
      return static_cast<std::uint64_t>(std::lround(v / size) + 100);
    };
    const Random random(cell(p.x, 15), cell(p.y, 15));
    return unit_real(random.at(cell(p.z, 3)));
  };
  const Coast coast = plain(rho);
  const auto field = test::carved(coast.site, grow(coast.site, points_only));
  // Level by level, since they taper.
  for (const double z : {6.0, 9.0, 12.0}) {
    std::vector<double> hardness, radius;
    for (const Vec3d p : coast.site.points) {
      hardness.push_back(rho({p.x, p.y, z}));
      radius.push_back(radius_at(field, {p.x, p.y, z}));
    }
    EXPECT_GT(spearman(hardness, radius), 0.55) << z;
  }
}

TEST(Hoodoos, NeighboursShareTheirBeds) {
  // Uniform rock: what differs from bed to bed is the landform's own, and must be the same for all.
  const Coast coast = plain([](Vec3d) { return 0.5; });
  Values values = points_only;
  values["contrast"] = 0.5;
  const auto field = test::carved(coast.site, grow(coast.site, values));
  const auto profile = [&](Vec3d p) {
    std::vector<double> out;
    for (double z = 4; z < 14; z += 0.4) out.push_back(radius_at(field, {p.x, p.y, z}));
    return out;
  };
  const auto first = profile(coast.site.points[0]);
  double sum = 0;
  for (std::size_t i = 1; i < 12; ++i) sum += spearman(first, profile(coast.site.points[i])) / 11;
  EXPECT_GT(sum, 0.6);
}

TEST(Hoodoos, KeepTheirDistance) {
  const Coast coast([](Vec3d) { return 0.5; },
                    [](double x, double y) { return 0.5 * x + std::sin(0.3 * y); });
  for (const double spacing : {6.0, 9.0}) {
    const auto feet = positions(grow(coast.site, {{"spacing", spacing}, {"ridges", 0.0}}));
    ASSERT_GT(feet.size(), 20u);
    double nearest = 1e9;
    for (std::size_t i = 0; i < feet.size(); ++i)
      for (std::size_t k = 0; k < i; ++k)
        nearest = std::min(nearest, std::hypot(feet[i].x - feet[k].x, feet[i].y - feet[k].y));
    EXPECT_GE(nearest, spacing);
  }
}

TEST(Hoodoos, StandOnMediumSlopes) {
  // Flat in the west, 31 degrees in the middle, 76 degrees in the east.
  const auto height = [](double x, double) {
    return x < -20 ? 0.0 : x < 20 ? 0.6 * (x + 20) : 24 + 4 * (x - 20);
  };
  const Coast coast([](Vec3d) { return 0.5; }, height);
  const auto feet = positions(grow(coast.site, {{"ridges", 0.0}, {"clusters", 0.0}}));
  ASSERT_GT(feet.size(), 30u);
  const auto middle = std::count_if(feet.begin(), feet.end(), [](Vec3d p) { return std::abs(p.x) <= 22; });
  EXPECT_GT(ratio(middle, feet.size()), 0.97);
}

TEST(Hoodoos, KeepOutOfGullies) {
  // A V-shaped valley that falls to the south.
  const Coast coast([](Vec3d) { return 0.5; },
                    [](double x, double y) { return 0.5 * std::abs(x) + 0.3 * y; });
  Values values{{"ridges", 0.0}, {"catchment", 100.0}, {"spacing", 5.0}};
  const auto feet = positions(grow(coast.site, values));
  values["catchment"] = 1e6;
  const auto anywhere = positions(grow(coast.site, values));
  const auto near = [](const std::vector<Vec3d>& all) {
    return std::count_if(all.begin(), all.end(), [](Vec3d p) { return std::abs(p.x) < 2.5 && p.y < 20; });
  };
  ASSERT_GT(feet.size(), 50u);
  EXPECT_EQ(near(feet), 0);
  EXPECT_GT(near(anywhere), 3);
}

TEST(Hoodoos, FollowRiversWhenTold) {
  const Coast coast([](Vec3d) { return 0.5; },
                    [](double x, double y) { return 0.4 * std::abs(x) + 0.2 * y; });
  const Values values{{"ridges", 0.0}, {"river", 18.0}, {"river_area", 1000.0}, {"catchment", 1000.0}};
  const auto feet = positions(grow(coast.site, values));
  ASSERT_GT(feet.size(), 8u);
  for (const Vec3d p : feet) EXPECT_LT(std::abs(p.x), 19);
}

TEST(Hoodoos, GrowByTheUsersRules) {
  const Coast coast = plain([](Vec3d) { return 0.5; });
  Values values = points_only;
  values["axiom"] = "Ball";
  values["roughness"] = 0.0;
  values["rule"] = Rows{{{"symbol", "Ball"}, {"weight", "1"}, {"make", "sphere(z = 9 - h, radius = 3)"}}};
  const Result result = grow(coast.site, values);
  EXPECT_EQ(test::fact<std::int64_t>(result, "primitives"), std::ssize(coast.site.points));
  const auto field = test::carved(coast.site, result);
  for (const Vec3d p : coast.site.points) {
    EXPECT_GT(field.value(p + Vec3d{0, 0, 9}), 0);
    EXPECT_GT(field.value(p + Vec3d{2.9, 0, 9}), 0);
    EXPECT_LT(field.value(p + Vec3d{3.8, 0, 9}), 0);
    EXPECT_LT(field.value(p + Vec3d{0, 0, 4}), 0);
  }
}

TEST(Hoodoos, AWrongRuleIsOneSentence) {
  const Coast coast = plain([](Vec3d) { return 0.5; });
  const auto error = [&](const Values& values) -> std::string {
    try {
      grow(coast.site, values);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::usage);
      return e.what();
    }
    return "no error";
  };
  EXPECT_EQ(error({{"axiom", "A"},
                   {"rule", Rows{{{"symbol", "A"}, {"weight", "1"}, {"make", "sphere(radius = 2 +* 3)"}}}}}),
            "hoodoos: rule 1 (A), make, column 20: expected a value, found \"*\"");
  EXPECT_EQ(error({{"axiom", "Hodoo"}}),
            "hoodoos: no rule has the symbol \"Hodoo\"; did you mean \"Hoodoo\"?");
  EXPECT_THAT(error({{"height", std::vector<double>{9, 3}}}), testing::HasSubstr("height"));
}

TEST(Hoodoos, TooManyAreRefusedBeforeTheyTakeTheMemory) {
  Coast coast = plain([](Vec3d) { return 0.5; });
  for (const double spacing : {1e-12, 1e-3})
    EXPECT_THAT(error_of([&] {
                  grow(coast.site, {{"spacing", spacing}});
                }),
                testing::HasSubstr("leaves room for more than 10 million; give a spacing of"));
  // 19,000 shapes each.
  Values values = points_only;
  values["axiom"] = "A";
  values["rule"] = Rows{{{"symbol", "A"}, {"weight", "1"}, {"make", "B(repeat = 19)"}},
                        {{"symbol", "B"}, {"weight", "1"}, {"make", "sphere(radius = 1, repeat = 999)"}}};
  while (coast.site.points.size() < 300) coast.site.points.push_back(coast.site.points[0]);
  EXPECT_THAT(error_of([&] { grow(coast.site, values); }),
              testing::HasSubstr("300 of them have more than 4 million shapes together"));
}

/// Lattice points of rock in a box that no path of rock joins to the box's lowest layer.
int floating(const field::CompiledField& field, const Box3d& box, double step) {
  const auto count = [&](double lo, double hi) { return floor_to((hi - lo) / step) + 1; };
  const int nx = count(box.lo.x, box.hi.x), ny = count(box.lo.y, box.hi.y), nz = count(box.lo.z, box.hi.z);
  std::vector<Vec3d> points;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) points.push_back(box.lo + Vec3d{step * i, step * j, step * k});
  const auto f = test::values(field, points);
  std::vector<char> joined(f.size());
  std::vector<int> stack;
  const auto visit = [&](int i, int j, int k) {
    if (i < 0 || j < 0 || k < 0 || i >= nx || j >= ny || k >= nz) return;
    const int at = (k * ny + j) * nx + i;
    if (joined[at] || f[at] <= 0) return;
    joined[at] = 1;
    stack.push_back(at);
  };
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i) visit(i, j, 0);
  while (!stack.empty()) {
    const int at = stack.back(), i = at % nx, j = at / nx % ny, k = at / nx / ny;
    stack.pop_back();
    for (const int d : {-1, 1}) {
      visit(i + d, j, k);
      visit(i, j + d, k);
      visit(i, j, k + d);
    }
  }
  int out = 0;
  for (std::size_t at = 0; at < f.size(); ++at) out += f[at] > 0 && !joined[at];
  return out;
}

class EveryAxiom : public testing::TestWithParam<std::string> {};

TEST_P(EveryAxiom, StandsOnTheGround) {
  Coast coast([](Vec3d p) { return 0.5 + 0.5 * std::sin(1.3 * p.z); },
              [](double x, double y) { return 0.5 * x + 2 * std::sin(0.2 * y); });
  for (double x = -44; x <= 44; x += 22) coast.site.points.push_back({x, 10 * std::sin(x), 0});
  Values values = points_only;
  values["axiom"] = GetParam();
  values["contrast"] = 1.0;
  const Result result = grow(coast.site, values);
  const auto field = test::carved(coast.site, result);
  for (const Vec3d p : positions(result)) {
    int above = 0;
    for (double z = 0; z < 30; z += 0.5) above += field.value(p + Vec3d{0, 0, z}) > 0;
    EXPECT_GE(above, 5);
    EXPECT_EQ(floating(field, {p - Vec3d{7, 7, 9}, p + Vec3d{7, 7, 34}}, 0.4), 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Hoodoos, EveryAxiom, testing::Values("Hoodoo", "Goblin"));

}  // namespace
}  // namespace tafoni::landforms
