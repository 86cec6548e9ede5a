#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/landforms/test/site.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::test {
namespace {

Result dug(const char* type, const Site& site, const Values& values) {
  return find_landform(type).generate(site, values, silent());
}

/// A hill with slopes of about 30 degrees, 120 m by 90 m.
Coast hill() {
  return Coast([](Vec3d) { return 0.5; },
               [](double x, double y) {
                 return 26 * std::exp(-(x * x / 900 + y * y / 700)) + 0.4 * std::sin(0.3 * x);
               });
}

std::vector<std::vector<Vec3d>> routes_of(const Result& result) {
  const auto all = fact<Places>(result, "routes").local;
  std::vector<std::vector<Vec3d>> out;
  std::size_t at = 0;
  for (double n : fact<std::vector<double>>(result, "route_points")) {
    const std::size_t end = at + round_to(n);
    out.emplace_back(all.begin() + at, all.begin() + end);
    at = end;
  }
  EXPECT_EQ(at, all.size());
  return out;
}

/// Whether a person fits above every place of a route, and what they stand on is not far below.
void expect_passable(const field::CompiledField& field, const std::vector<Vec3d>& route) {
  for (std::size_t i = 0; i + 1 < route.size(); ++i)
    for (double t = 0; t < 1; t += 0.1) {
      const Vec3d p = route[i] + (route[i + 1] - route[i]) * t;
      for (double up : {0.7, 1.2, 1.9}) EXPECT_LT(field.value(p + Vec3d{0, 0, up}), 0) << i;
      // Ends may stand out of the hill.
      if (i > 1 && i + 4 < route.size()) {
        EXPECT_GT(field.value(p - Vec3d{0, 0, 1.2}), 0) << i;
      }
    }
}

TEST(Hollows, TooFineASpacingIsRefusedBeforeItIsTried) {
  const Coast coast = hill();
  for (const char* name : {"chambers", "tunnels", "hive", "fractal-terrain"})
    EXPECT_THAT(error_of([&] {
                  dug(name, coast.site, {{"spacing", 0.001}});
                }),
                testing::AllOf(testing::HasSubstr("samples"), testing::HasSubstr("give a")))
        << name;
}

TEST(Tunnels, GivenOnesRunBetweenTheirEnds) {
  const Coast coast = hill();
  const Rows rows = {{{"from", "499955, 4000000, 4"}, {"to", "500045, 4000003, 4"}, {"radius", "2"}}};
  const Result result = dug("tunnels", coast.site, {{"tunnel", rows}});
  const auto field = carved(coast.site, result);
  const auto routes = routes_of(result);
  ASSERT_EQ(routes.size(), 1u);
  EXPECT_NEAR(length(routes[0].front() - Vec3d{-45, 0, 4 - 0.55 * 2}), 0, 1e-6);
  EXPECT_GT(fact<double>(result, "tunnel_length"), 90);
  expect_passable(field, routes[0]);
  // Volume: the part of the tunnel that lies in the hill.
  EXPECT_GT(fact<double>(result, "volume"), 300);
  EXPECT_LT(fact<double>(result, "volume"), 3.1416 * 4 * 1.7 * 100);
  EXPECT_THAT(error_of([&] {
                dug("tunnels", coast.site, {{"tunnel", Rows{{{"from", "1 2 3"}, {"to", "4 5"}}}}});
              }),
              testing::HasSubstr("tunnel, row 1: to must be"));
}

TEST(Tunnels, RandomOnesGoThroughTheHillAndCanBeWalked) {
  const Coast coast = hill();
  const Result result = dug("tunnels", coast.site, {{"count", std::int64_t{2}}, {"radius", 1.8}});
  const auto routes = routes_of(result);
  ASSERT_EQ(routes.size(), 2u);
  const auto field = carved(coast.site, result);
  for (const auto& route : routes) {
    expect_passable(field, route);
    for (std::size_t i = 0; i + 1 < route.size(); ++i) {
      const Vec3d d = route[i + 1] - route[i];
      // The floor follows the radius, too.
      EXPECT_LT(std::abs(d.z), std::tan(40 * 0.01745) * std::hypot(d.x, d.y) + 0.1);
    }
  }
}

TEST(Tunnels, OpenSpaceOnlyGrows) {
  const Coast coast = hill();
  const auto before = field::compile(coast.site.terrain),
             after = carved(coast.site, dug("hive", coast.site, {{"noise", 0.0}}));
  int open = 0;
  for (const Vec3d& p : places({{-58, -44, -12}, {58, 44, 30}}, 40000, 3)) {
    const float a = before.value(p), b = after.value(p);
    ASSERT_LE(b, a);
    open += a > 0 && b < 0;
  }
  EXPECT_GT(open, 100);
}

TEST(Chambers, TheUsersOwnLatticeIsCarved) {
  const Coast coast = hill();
  const Rows rows = {
      {{"at", "500000 4000000 2"},
       {"cell", "4"},
       {"lattice",
        "#####/#####/#####/#####/#####;#####/#...#/#.#.#/#...#/#####;#####/#####/#####/#####/#####"}}};
  const Result result = dug("chambers", coast.site, {{"chamber", rows}, {"roughness", 0.0}, {"relief", 0.0}});
  const auto field = carved(coast.site, result);
  EXPECT_GT(field.value({0, 0, 4}), 0) << "a pillar in the middle";
  for (Vec3d p : {Vec3d{4, 0, 4}, {-4, 0, 4}, {0, 4, 4}, {4, 4, 4}}) EXPECT_LT(field.value(p), 0);
  EXPECT_GT(field.value({4, 0, 1}), 0) << "its floor is at the height that was given";
  EXPECT_LT(field.value({4, 0, 2.6}), 0);
  EXPECT_THAT(error_of([&] {
                dug("chambers", coast.site, {{"chamber", Rows{{{"kind", "quen"}}}}});
              }),
              testing::HasSubstr("\"queen\""));
}

TEST(Hive, EntrancesTunnelsAndChambersHangTogether) {
  const Coast coast = hill();
  const Result result = dug("hive", coast.site,
                            {{"chambers", std::int64_t{2}},
                             {"entrances", std::int64_t{2}},
                             {"radius", 2.0},
                             {"depth", 14.0},
                             {"cell", 1.3},
                             {"noise", 0.1}});
  const auto field = carved(coast.site, result);
  const auto entrances = fact<Places>(result, "entrances").local,
             chambers = fact<Places>(result, "chambers").local;
  ASSERT_EQ(entrances.size(), 2u);
  ASSERT_GE(chambers.size(), 1u);
  for (const auto& route : routes_of(result)) expect_passable(field, route);
  // A flood through the open space from an entrance, only where there is rock overhead, reaches every
  // chamber.
  const Box3d box{{-58, -43, -14}, {58, 43, 28}};
  constexpr double step = 0.6;
  const Vec3i n{floor_to(box.size().x / step), floor_to(box.size().y / step), floor_to(box.size().z / step)};
  std::vector<Vec3d> points;
  for (int k = 0; k < n.z; ++k)
    for (int j = 0; j < n.y; ++j)
      for (int i = 0; i < n.x; ++i) points.push_back(box.lo + Vec3d{step * i, step * j, step * k});
  const auto f = values(field, points), ground = values(field::compile(coast.site.terrain), points);
  const auto index = [&](Vec3d p) {
    const Vec3d q = (p - box.lo) * (1 / step);
    return sample_index(n, {round_to(q.x), round_to(q.y), round_to(q.z)});
  };
  std::vector<bool> reached(f.size());
  std::vector<std::size_t> stack;
  const auto visit = [&](std::size_t at) {
    // Two metres under where the ground was: not over the hill.
    if (at >= f.size() || reached[at] || f[at] >= 0 || ground[at] < 2) return;
    reached[at] = true;
    stack.push_back(at);
  };
  for (std::size_t i = 0; i < points.size(); ++i)
    if (length(points[i] - entrances[0]) < 8) visit(i);
  while (!stack.empty()) {
    const std::size_t at = stack.back();
    stack.pop_back();
    const std::size_t row = n.x, plane = row * n.y;
    for (std::size_t d : {std::size_t{1}, row, plane}) visit(at + d), visit(at - d);
  }
  for (const Vec3d& chamber : chambers) EXPECT_TRUE(reached[index(chamber + Vec3d{0, 0, 1})]);
  EXPECT_TRUE([&] {
    for (std::size_t i = 0; i < points.size(); ++i)
      if (reached[i] && length(points[i] - entrances[1]) < 8) return true;
    return false;
  }()) << "the other entrance";
}

}  // namespace
}  // namespace tafoni::landforms::test
