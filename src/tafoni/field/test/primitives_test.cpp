// The shape of each kind: its distance against the nearest of its body's points, found by search.

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/field/compiled.h"

namespace tafoni::field {
namespace {

constexpr double falloff = 60, rounding = 0.25;
constexpr double circle = 2 * std::numbers::pi;

/// A point of the body for every u in [0, 1]^3, and all of its surface among them; periodic.
using Body = std::function<Vec3d(Vec3d u)>;

/// Distance of p from the body: the best of many points, refined by shrinking random steps, of which some are
/// much smaller along one parameter than along another. Parameters beyond 1 continue from 0.
double searched(const Body& body, Vec3d p, Random& random) {
  Vec3d best{};
  double least = 1e300;
  const auto offer = [&](Vec3d u) {
    const auto wrapped = [](double v) { return v - std::floor(v); };
    u = {wrapped(u.x), wrapped(u.y), wrapped(u.z)};
    const double d = length(body(u) - p);
    if (d < least) least = d, best = u;
  };
  const auto step = [&](double size) {
    const auto one = [&] { return random.uniform(-size, size) * std::pow(10, random.uniform(-3, 0)); };
    return Vec3d{one(), one(), one()};
  };
  for (int i = 0; i < 3000; ++i) offer({random.uniform(0, 1), random.uniform(0, 1), random.uniform(0, 1)});
  for (double size = 0.3; size > 1e-6; size *= 0.9)
    for (int i = 0; i < 30; ++i) offer(best + step(size));
  return least;
}

/// Goes from 0 to 1 and back while u goes from 0 to 1, so that neither end is an edge of the parameters.
double there_and_back(double u) {
  return 1 - std::fabs(2 * u - 1);
}

/// The same from -1 to 1.
double both_ways(double u) {
  return 2 * there_and_back(u) - 1;
}

NodePtr one(std::string_view kind, const std::vector<double>& extras) {
  CloudBuilder cloud({kind, falloff, {}});
  std::vector<float> shape{static_cast<float>(rounding)};
  for (double e : extras) shape.push_back(static_cast<float>(e));
  cloud.add({0, 0, 0}, 1, shape);
  return cloud.finish();
}

/// The value says how far the rounded body is.
double distance(const CompiledField& field, Vec3d p) {
  return falloff * std::sqrt(std::max(1 - std::cbrt(double{field.value(p)}), 0.0)) + rounding;
}

/// A body about an axis: u is (along, outwards, around).
Body revolved(Vec3d axis, const std::function<Vec2d(double along, double outwards)>& profile) {
  const Vec3d n = normalized(axis);
  const Vec3d a = normalized(cross(n, std::fabs(n.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0})),
              b = cross(n, a);
  return [=](Vec3d u) {
    const Vec2d at = profile(there_and_back(u.x), there_and_back(u.y));
    return n * at.y + (a * std::cos(circle * u.z) + b * std::sin(circle * u.z)) * at.x;
  };
}

Body turned(double degrees, const Body& body) {
  const double c = std::cos(degrees * circle / 360), s = std::sin(degrees * circle / 360);
  return [=](Vec3d u) {
    const Vec3d p = body(u);
    return Vec3d{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  };
}

/// Compares with the search at many points about the body; returns the greatest relative error.
double worst(std::string_view kind, const std::vector<double>& extras, const Body& body, std::uint64_t seed) {
  const CompiledField field = compile(one(kind, extras));
  Random random(seed);
  double greatest = 0;
  int near = 0;
  for (int i = 0; i < 30; ++i) {
    const Vec3d p{random.uniform(-14, 14), random.uniform(-14, 14), random.uniform(-14, 14)};
    const double truth = searched(body, p, random), d = distance(field, p);
    if (truth < rounding + 0.3) {
      // Too near for the value to tell: constant inside, and hardly less there.
      EXPECT_LT(d, rounding + 0.5) << kind << " " << p.x << " " << p.y << " " << p.z << " " << truth;
      ++near;
      continue;
    }
    greatest = std::max(greatest, std::fabs(d - truth) / truth);
  }
  EXPECT_LT(near, 30) << kind;
  return greatest;
}

struct Draw {
  Random random;
  explicit Draw(std::uint64_t seed) : random(seed) {}
  double operator()(double lo, double hi) { return random.uniform(lo, hi); }
  Vec3d axis(double size) {
    const Vec3d d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
    return normalized(d) * size;
  }
};

TEST(Primitives, BoxIsABox) {
  Draw draw(1);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const Vec3d h{draw(0, 8), draw(0, 8), draw(0, 8)};
    const double turn = draw(-180, 180);
    const Body body = turned(turn, [=](Vec3d u) {
      return Vec3d{h.x * both_ways(u.x), h.y * both_ways(u.y), h.z * both_ways(u.z)};
    });
    EXPECT_LT(worst("box", {h.x, h.y, h.z, turn}, body, i), 2e-3);
  }
}

TEST(Primitives, EllipsoidIsAnEllipsoid) {
  Draw draw(2);
  for (std::uint64_t i = 0; i < 12; ++i) {
    // Down to a disc and a needle.
    const Vec3d h{draw(0.5, 9), std::exp(draw(-3, 2)), std::exp(draw(-4, 2))};
    const double turn = draw(-180, 180);
    const Body body = turned(turn, [=](Vec3d u) {
      const double z = both_ways(u.x), r = std::sqrt(1 - z * z);
      return Vec3d{h.x * r * std::cos(circle * u.y), h.y * r * std::sin(circle * u.y), h.z * z} *
             there_and_back(u.z);
    });
    EXPECT_LT(worst("ellipsoid", {h.x, h.y, h.z, turn}, body, i), 3e-3) << h.x << " " << h.y << " " << h.z;
  }
}

TEST(Primitives, CylinderHasFlatCaps) {
  Draw draw(3);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const double size = draw(0.1, 10), base = draw(0, 6);
    const Vec3d axis = draw.axis(size);
    const Body body = revolved(axis, [=](double along, double out) {
      return Vec2d{base * out, size * along};
    });
    EXPECT_LT(worst("cylinder", {axis.x, axis.y, axis.z, base}, body, i), 2e-3);
  }
}

TEST(Primitives, ConeIsPointedOrCapped) {
  Draw draw(4);
  for (std::uint64_t i = 0; i < 12; ++i) {
    const double size = draw(0.1, 10), base = draw(0, 6), tip = i % 2 ? draw(0, 8) : 0.0;
    const Vec3d axis = draw.axis(size);
    const Body body = revolved(axis, [=](double along, double out) {
      return Vec2d{(base + (tip - base) * along) * out, size * along};
    });
    EXPECT_LT(worst("cone", {axis.x, axis.y, axis.z, base, tip}, body, i), 2e-3);
  }
}

TEST(Primitives, ConeSphereIsTheHullOfTwoBalls) {
  Draw draw(5);
  for (std::uint64_t i = 0; i < 12; ++i) {
    // The last ones hold one ball in the other.
    const double size = i < 9 ? draw(4, 10) : draw(0, 1), base = draw(0, 5), tip = draw(0, 5);
    const Vec3d axis = draw.axis(size);
    const CompiledField field = compile(one("cone-sphere", {axis.x, axis.y, axis.z, base, tip}));
    for (int k = 0; k < 60; ++k) {
      const Vec3d p{draw(-14, 14), draw(-14, 14), draw(-14, 14)};
      double truth = 1e300;
      for (int m = 0; m <= 2000; ++m) {
        const double t = m / 2000.0;
        truth = std::min(truth, length(p - axis * t) - (base + (tip - base) * t));
      }
      if (truth > rounding + 0.3) {
        EXPECT_NEAR(distance(field, p), truth, 2e-3 * truth + 1e-3);
      } else {
        EXPECT_LT(distance(field, p), rounding + 0.5);
      }
    }
  }
}

TEST(Primitives, TorusIsATubeAboutACircle) {
  Draw draw(6);
  for (std::uint64_t i = 0; i < 8; ++i) {
    const double ring = draw(0, 10);
    const Vec3d normal = draw.axis(draw(0.1, 3));
    const Body body = revolved(normal, [=](double, double) { return Vec2d{ring, 0}; });
    EXPECT_LT(worst("torus", {normal.x, normal.y, normal.z, ring}, body, i), 2e-3);
  }
  // On its normal every direction is as good.
  const CompiledField field = compile(one("torus", {0, 0, 1, 4}));
  for (double z : {0.0, 0.5, 3.0}) EXPECT_NEAR(distance(field, {0, 0, z}), std::hypot(4, z), 1e-3);
}

TEST(Primitives, PyramidHasFourFaces) {
  Draw draw(7);
  for (std::uint64_t i = 0; i < 12; ++i) {
    const double hx = draw(0, 8), hy = draw(0, 8), height = draw(0.1, 10), turn = draw(-180, 180);
    const Body body = turned(turn, [=](Vec3d u) {
      const double up = there_and_back(u.z);
      return Vec3d{hx * both_ways(u.x) * (1 - up), hy * both_ways(u.y) * (1 - up), height * up};
    });
    EXPECT_LT(worst("pyramid", {hx, hy, height, turn}, body, i), 2e-3);
  }
}

TEST(Primitives, AxesWithoutLengthPointUp) {
  EXPECT_NEAR(distance(compile(one("cylinder", {0, 0, 0, 3})), {0, 0, 5}), 5, 1e-3);
  EXPECT_NEAR(distance(compile(one("cone", {0, 0, 0, 3, 1})), {0, 7, 0}), 4, 1e-3);
  EXPECT_NEAR(distance(compile(one("cone-sphere", {0, 0, 0, 3, 1})), {0, 7, 0}), 4, 1e-3);
  EXPECT_NEAR(distance(compile(one("torus", {0, 0, 0, 3})), {7, 0, 0}), 4, 1e-3);
}

TEST(Primitives, NoiseMovesTheWallAndLeavesTheInside) {
  const std::pair<const char*, std::vector<float>> bodies[] = {
      {"box", {1, 5, 4, 6, 30}},    {"ellipsoid", {1, 5, 4, 6, 30}},     {"cylinder", {1, 0, 1, 8, 4}},
      {"cone", {1, 0, 1, 8, 4, 2}}, {"cone-sphere", {1, 0, 1, 8, 4, 2}}, {"pyramid", {1, 5, 4, 6, 30}},
  };
  for (const auto& [kind, shape] : bodies) {
    // The core is the same body without its rounding: what noise may not reach.
    CloudBuilder smooth({kind, 3, {}}), noisy({kind, 3, {0.8, 2, 3, 1}}), core({kind, 1e-3, {}});
    std::vector<float> sharp = shape;
    sharp[0] = 1e-3f;
    smooth.add({0, 0, 0}, -5, shape);
    noisy.add({0, 0, 0}, -5, shape);
    core.add({0, 0, 0}, -5, sharp);
    const CompiledField a = compile(smooth.finish()), b = compile(noisy.finish()), c = compile(core.finish());
    Random random(3);
    int inside = 0, changed = 0;
    for (int i = 0; i < 3000; ++i) {
      const Vec3d p{random.uniform(-10, 10), random.uniform(-10, 10), random.uniform(-10, 10)};
      const float va = a.value(p), vb = b.value(p);
      EXPECT_LE(vb, 0);
      if (c.value(p) == -5) {
        EXPECT_EQ(vb, -5) << kind;
        ++inside;
      }
      changed += va != vb;
    }
    EXPECT_GT(inside, 50) << kind;
    EXPECT_GT(changed, 100) << kind;
  }
}

}  // namespace
}  // namespace tafoni::field
