#include "tafoni/volume/tool.h"

#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/math/draw.h"

namespace tafoni::volume {
namespace {

using testing::HasSubstr;

Vec3d within(Random& r, const Box3d& box) {
  const double x = r.uniform(box.lo.x, box.hi.x), y = r.uniform(box.lo.y, box.hi.y);
  return {x, y, r.uniform(box.lo.z, box.hi.z)};
}

const Box3d around{{-3, -3, -3}, {3, 3, 3}};

Tool random_tool(Random& r, int kind) {
  const Vec3d c = within(r, around);
  if (kind == 0) return Tool::sphere(c, r.uniform(0.1, 3));
  if (kind == 1) return Tool::capsule(c, within(r, around), r.uniform(0.1, 2));
  if (kind == 2) return Tool::capsule(c, c + Vec3d{0, 0, r.uniform(-3, 3)}, r.uniform(0.1, 2));
  if (kind == 3) return Tool::capsule(c, {c.x + 2, c.y - 1, c.z}, 0.7);
  if (kind == 4) return Tool::capsule(c, c, 0.9);
  if (kind == 5)
    return Tool::box(c, {r.uniform(0.1, 2), r.uniform(0.1, 2), r.uniform(0.1, 2)}, r.uniform(-4, 4));
  std::vector<Vec3d> points;
  for (std::uint64_t n = 4 + r.below(40); n > 0; --n) points.push_back(within(r, around));
  return Tool::hull(points);
}
constexpr int kinds = 7;

TEST(Tool, ColumnIsWhereDistanceIsPositive) {
  for (int kind = 0; kind < kinds; ++kind) {
    Random r(1, static_cast<std::uint64_t>(kind));
    int crossed = 0;
    for (int n = 0; n < 300; ++n) {
      const Tool tool = random_tool(r, kind);
      const Box3d box = tool.bounds();
      for (int c = 0; c < 20; ++c) {
        const Vec3d p = within(r, box.grown(0.5));
        const auto span = tool.column(p.x, p.y);
        if (span) {
          ++crossed;
          EXPECT_LT(span->lo, span->hi);
          EXPECT_NEAR(tool.distance({p.x, p.y, span->lo}), 0, 1e-7) << kind;
          EXPECT_NEAR(tool.distance({p.x, p.y, span->hi}), 0, 1e-7) << kind;
          EXPECT_TRUE(box.grown(1e-9).contains({p.x, p.y, span->lo}));
          EXPECT_TRUE(box.grown(1e-9).contains({p.x, p.y, span->hi}));
        }
        for (int s = 0; s < 50; ++s) {
          const double z = box.lo.z + (s - 5) * (box.hi.z - box.lo.z) / 40;
          const double d = tool.distance({p.x, p.y, z});
          if (std::abs(d) < 1e-9) continue;
          EXPECT_EQ(d > 0, span && z > span->lo && z < span->hi) << kind << " at " << z << ": " << d;
        }
      }
    }
    EXPECT_GT(crossed, 1000);
  }
}

TEST(Tool, BoundsAreTight) {
  for (int kind = 0; kind < kinds; ++kind) {
    Random r(2, static_cast<std::uint64_t>(kind));
    for (int n = 0; n < 20; ++n) {
      const Tool tool = random_tool(r, kind);
      // Of the inside, by sampling.
      Box3d found;
      const Box3d box = tool.bounds();
      for (int s = 0; s < 20000; ++s) {
        const Vec3d p = within(r, box.grown(0.1));
        if (tool.distance(p) > 0) {
          EXPECT_TRUE(box.contains(p));
          found.expand(p);
        }
      }
      if (kind == 6) continue;  // corners are too sharp for sampling; below
      const Vec3d size = box.size();
      EXPECT_LT(found.lo.x - box.lo.x, 0.25 * size.x) << kind;
      EXPECT_LT(box.hi.y - found.hi.y, 0.25 * size.y) << kind;
    }
  }
}

// The distance of sphere, capsule and box is the distance to the nearest point of the other side: no sampled
// point of the other side is nearer, and stepping along the gradient by it reaches the border.
TEST(Tool, DistanceIsExact) {
  for (int kind = 0; kind < 6; ++kind) {
    Random r(3, static_cast<std::uint64_t>(kind));
    for (int n = 0; n < 200; ++n) {
      const Tool tool = random_tool(r, kind);
      const Vec3d p = within(r, around.grown(3));
      const double d = tool.distance(p), h = 1e-6;
      const auto slope = [&](Vec3d e) {
        return (tool.distance(p + e * h) - tool.distance(p - e * h)) / (2 * h);
      };
      const Vec3d g{slope({1, 0, 0}), slope({0, 1, 0}), slope({0, 0, 1})};
      if (std::abs(length(g) - 1) > 1e-4) continue;  // on the medial axis
      EXPECT_NEAR(tool.distance(p - g * d), 0, 1e-4) << kind;
      for (int s = 0; s < 50; ++s) {
        const Vec3d q = within(r, around.grown(3));
        EXPECT_LE(std::abs(tool.distance(q) - d), length(q - p) + 1e-12) << kind;
      }
    }
  }
}

// A point is in the hull exactly if no plane through three of the points has it on one side and all the
// points on the other.
TEST(Tool, HullAgreesWithBruteForce) {
  for (int round = 0; round < 40; ++round) {
    Random r(4, static_cast<std::uint64_t>(round));
    std::vector<Vec3d> points;
    const int count = 4 + draw_index(r, 9);
    // Every other round on a small whole lattice: many points in a plane, in a line, and twice the same.
    for (int i = 0; i < count; ++i) {
      Vec3d p = within(r, around);
      if (round % 2 == 0) p = {std::floor(p.x / 2), std::floor(p.y / 2), std::floor(p.z / 2)};
      points.push_back(p);
    }
    struct Side {
      Vec3d n;
      double d;
    };
    std::vector<Side> sides;
    for (Vec3d a : points)
      for (Vec3d b : points)
        for (Vec3d c : points) {
          const Vec3d n = normalized(cross(b - a, c - a));
          if (length(n) == 0) continue;
          const bool all =
              std::all_of(points.begin(), points.end(), [&](Vec3d p) { return dot(n, p - a) <= 1e-12; });
          if (all) sides.push_back({n, dot(n, a)});
        }
    bool solid = false;
    for (Vec3d p : points)
      if (!sides.empty() && dot(sides[0].n, p) < sides[0].d - 1e-9) solid = true;
    if (!solid) {
      EXPECT_THAT(error_of([&] { Tool::hull(points); }), HasSubstr("lie in a plane")) << round;
      continue;
    }
    const Tool tool = Tool::hull(points);
    Box3d box;
    for (Vec3d p : points) {
      box.expand(p);
      EXPECT_GE(tool.distance(p), -1e-9);
    }
    EXPECT_EQ(tool.bounds().lo, box.lo);
    EXPECT_EQ(tool.bounds().hi, box.hi);
    for (int s = 0; s < 300; ++s) {
      const Vec3d p = within(r, around.grown(1));
      double least = 1e300;
      for (const Side& side : sides) least = std::min(least, side.d - dot(side.n, p));
      EXPECT_NEAR(tool.distance(p), least, 1e-9) << round;
    }
  }
}

TEST(Tool, HullOfManyPointsOfASphere) {
  Random r(5);
  std::vector<Vec3d> points;
  for (int i = 0; i < 600; ++i) points.push_back(Vec3d{500000, 2, -7} + normalized(within(r, around)) * 10);
  const Tool tool = Tool::hull(points);
  for (Vec3d p : points) EXPECT_NEAR(tool.distance(p), 0, 1e-8);
  EXPECT_NEAR(tool.distance({500000, 2, -7}), 10, 1);
}

TEST(Tool, RefusesWhatHasNoInside) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(error_of([&] { Tool::sphere({}, 0); }),
              HasSubstr("the radius of a sphere is not finite or not above 0"));
  EXPECT_THAT(error_of([&] {
                Tool::sphere({nan, 0, 0}, 1);
              }),
              HasSubstr("the centre of a sphere is not finite"));
  EXPECT_THAT(error_of([&] {
                Tool::capsule({}, {1, 0, 0}, -1);
              }),
              HasSubstr("the radius of a capsule is not finite or not above 0"));
  EXPECT_THAT(error_of([&] {
                Tool::box({}, {1, 0, 1});
              }),
              HasSubstr("half a side of a box is not finite or not above 0"));
  const std::vector<Vec3d> square{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0.3, 0.2, 0}};
  EXPECT_THAT(error_of([&] { Tool::hull(square); }), HasSubstr("the points of a hull lie in a plane"));
  EXPECT_THAT(error_of([&] { Tool::hull({}); }), HasSubstr("the points of a hull lie in a plane"));
  const std::vector<Vec3d> bad{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, nan}};
  EXPECT_THAT(error_of([&] { Tool::hull(bad); }), HasSubstr("a point of a hull is not finite"));
}

TEST(Tool, DataMakesTheSameToolAgain) {
  for (int kind = 0; kind < kinds; ++kind) {
    Random r(9, static_cast<std::uint64_t>(kind));
    for (int n = 0; n < 50; ++n) {
      const Tool tool = random_tool(r, kind), again = Tool::from(tool.data());
      EXPECT_EQ(again.data(), tool.data());
      for (int i = 0; i < 50; ++i) {
        const Vec3d p = within(r, tool.bounds().grown(1));
        if (kind == kinds - 1)
          EXPECT_NEAR(again.distance(p), tool.distance(p), 1e-9);
        else
          EXPECT_EQ(again.distance(p), tool.distance(p)) << kind;
      }
    }
  }
}

TEST(Tool, DataOfNoToolIsRefused) {
  const auto error = [](const ToolData& data) { return error_of([&] { Tool::from(data); }); };
  EXPECT_EQ(error({}), "0 points and 0 sizes make no tool of kind 0");
  EXPECT_EQ(error({ToolData::Kind::sphere, {{0, 0, 0}}, {}}), "1 points and 0 sizes make no tool of kind 0");
  EXPECT_THAT(error({ToolData::Kind::sphere, {{0, 0, 0}}, {-1}}), HasSubstr("the radius of a sphere"));
  EXPECT_EQ(error({ToolData::Kind::capsule, {{0, 0, 0}}, {1}}),
            "1 points and 1 sizes make no tool of kind 1");
  EXPECT_THAT(error({ToolData::Kind::box, {{0, 0, 0}}, {1, 1, 1, 0.5, 0.5}}), HasSubstr("the turn of a box"));
  EXPECT_THAT(error({ToolData::Kind::box, {{0, 0, 0}}, {1, -1, 1, 1, 0}}), HasSubstr("half a side of a box"));
  EXPECT_THAT(error({ToolData::Kind::hull, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}, {}}),
              HasSubstr("lie in a plane"));
  EXPECT_EQ(error({static_cast<ToolData::Kind>(4), {{0, 0, 0}}, {1}}),
            "1 points and 1 sizes make no tool of kind 4");
}

}  // namespace
}  // namespace tafoni::volume
