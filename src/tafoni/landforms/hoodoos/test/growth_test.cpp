#include "tafoni/landforms/hoodoos/growth.h"

#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"

namespace tafoni::landforms::impl {
namespace {

using testing::HasSubstr;

/// Ground at 0; beds of 2 m; rock as given.
class World final : public Surroundings {
 public:
  explicit World(std::function<double(Vec3d)> rho = [](Vec3d) { return 0.5; }) : rho_(std::move(rho)) {}
  double resistance(Vec3d p) const override { return rho_(p); }
  double ground(Vec3d) const override { return 0; }
  double bed(Vec3d p) const override { return 2 * (std::floor(p.z / 2) + 1) - p.z; }
  bool allowed(Vec3d p) const override { return p.z < ceiling; }
  double ceiling = 1e9;

 private:
  std::function<double(Vec3d)> rho_;
};

Row rule(std::string symbol, std::string weight, std::string make) {
  return {{"symbol", std::move(symbol)}, {"weight", std::move(weight)}, {"make", std::move(make)}};
}

std::vector<Terminal> grown(const Rows& rules, const World& world = World(), std::uint64_t seed = 1) {
  Axiom axiom;
  axiom.radius = 2;
  axiom.height = 10;
  axiom.seed = seed;
  return GrowthRules(rules, "hoodoos").grow("A", axiom, world);
}

std::string error_of(const Rows& rules) {
  try {
    grown(rules);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

TEST(Growth, ScalesAndMovesSymbols) {
  // The paper's C(p + s z, lambda s).
  const auto out = grown({rule("A", "1", "sphere(radius = s); C(z = s, s = 0.5*s)"),
                          rule("C", "s > 0.1", "sphere(radius = s); C(z = s, s = 0.5*s)")});
  ASSERT_EQ(out.size(), 5u);
  double z = 0, s = 2;
  for (const Terminal& t : out) {
    EXPECT_NEAR(t.position.z, z, 1e-12);
    EXPECT_FLOAT_EQ(t.shape[0], static_cast<float>(s));
    EXPECT_EQ(t.kind->about.name, "sphere");
    z += s;
    s *= 0.5;
  }
}

TEST(Growth, RepeatsAndTurns) {
  const auto out = grown({rule("A", "1", "B(turn = 90)"),
                          rule("B", "1", "segment(repeat = 4, turn = 90*i, x = 3, dx = n, dy = 0)")});
  ASSERT_EQ(out.size(), 4u);
  const Vec2d at[] = {{0, 3}, {-3, 0}, {0, -3}, {3, 0}};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(out[i].position.x, at[i].x, 1e-9);
    EXPECT_NEAR(out[i].position.y, at[i].y, 1e-9);
    // Directions turn too: dx points outward.
    EXPECT_NEAR(out[i].shape[1], at[i].x * 4 / 3, 1e-5);
    EXPECT_NEAR(out[i].shape[2], at[i].y * 4 / 3, 1e-5);
  }
}

TEST(Growth, SeesTheRockWhereItGrows) {
  const World world([](Vec3d p) { return p.z < 5 ? 0.2 : 0.8; });
  const auto out = grown({rule("A", "h < height", "sphere(radius = 1 + rho); A(z = bed)")}, world);
  ASSERT_EQ(out.size(), 5u);
  for (const Terminal& t : out) EXPECT_NEAR(t.shape[0], t.position.z < 5 ? 1.2 : 1.8, 1e-6);
  const auto above = grown({rule("A", "1", "sphere(radius = rho(6))")}, world);
  EXPECT_NEAR(above.at(0).shape[0], 0.8, 1e-6);
}

TEST(Growth, ChoosesByWeight) {
  const Rows rules = {rule("A", "1", "B(repeat = 900)"), rule("B", "rho", "sphere(radius = 1)"),
                      rule("B", "1 - rho", "sphere(radius = 2)"), rule("B", "-5", "sphere(radius = 3)")};
  for (const double rho : {0.0, 0.25, 0.8}) {
    const auto out = grown(rules, World([rho](Vec3d) { return rho; }));
    ASSERT_EQ(out.size(), 900u);
    double first = 0;
    for (const Terminal& t : out) {
      first += t.shape[0] == 1;
      ASSERT_LT(t.shape[0], 3);
    }
    EXPECT_NEAR(first / 900, rho, 0.06);
  }
}

TEST(Growth, DependsOnTheSeedAlone) {
  const Rows rules = {rule("A", "h < height", "sphere(x = random(), radius = random(1, 2)); A(z = bed)"),
                      rule("A", "0.3", "")};
  const auto a = grown(rules), b = grown(rules), c = grown(rules, World(), 2);
  const auto numbers = [](const std::vector<Terminal>& all) {
    std::vector<double> out;
    for (const Terminal& t : all) out.insert(out.end(), {t.position.x, t.position.z, t.shape[0]});
    return out;
  };
  EXPECT_EQ(numbers(a), numbers(b));
  EXPECT_NE(numbers(a), numbers(c));
}

TEST(Growth, StopsWhereItMayNotGrow) {
  World world;
  world.ceiling = 5;
  for (const Terminal& t : grown({rule("A", "h < height", "sphere(); A(z = bed)")}, world))
    EXPECT_LT(t.position.z, 5);
}

TEST(Growth, LeavesOutWhatHasNoSize) {
  EXPECT_TRUE(grown({rule("A", "1", "sphere(radius = 0); sphere(radius = -1); sphere(energy = 0)")}).empty());
}

TEST(Growth, ErrorsNameTheRule) {
  EXPECT_EQ(error_of({rule("A", "1", "sphere(radius = 2*)")}),
            "hoodoos: rule 1 (A), make, column 19: expected a value, found \")\"");
  EXPECT_EQ(error_of({rule("A", "1", "B()"), rule("B", "rh", "")}),
            "hoodoos: rule 2 (B), weight, column 1: there is no name \"rh\"; did you mean \"rho\"?");
  EXPECT_EQ(
      error_of({rule("A", "1", "Trunck()"), rule("Trunk", "1", "")}),
      "hoodoos: rule 1 (A), make, column 1: \"Trunck\" is neither a symbol nor a primitive; did you mean "
      "\"Trunk\"?");
  EXPECT_EQ(
      error_of({rule("A", "1", "sphere(); sphere(size = 2)")}),
      "hoodoos: rule 1 (A), make, column 18: sphere has no argument \"size\"; it has x, y, z, turn, repeat, "
      "energy, radius");
  EXPECT_EQ(error_of({rule("A b", "1", "")}),
            "hoodoos: rule 1, symbol, column 1: a symbol is a name of letters and digits");
  EXPECT_THAT(error_of({rule("A", "1", "sphere() sphere()")}), HasSubstr("column 10: expected \";\""));
  EXPECT_THAT(error_of({rule("A", "1 2", "")}), HasSubstr("column 3: \"2\" is not expected here"));
  EXPECT_THAT(error_of({rule("A", "1", "sphere(radius = 1/0)")}), HasSubstr("radius is not a finite number"));
  EXPECT_THAT(error_of({rule("A", "log(-1)", "")}), HasSubstr("weight: its value is not a finite number"));
  EXPECT_THAT(error_of({rule("B", "1", "")}), HasSubstr("no rule has the symbol \"A\""));
}

TEST(Growth, EndlessGrowthIsAnError) {
  EXPECT_THAT(error_of({rule("A", "1", "A()")}),
              HasSubstr("rule 1 (A) does not come to an end: 1000 generations"));
  EXPECT_THAT(error_of({rule("A", "1", "A(repeat = 2)")}),
              HasSubstr("does not come to an end: 20000 symbols"));
  // What is too small to stay counts as well: these would make 8,421,000 spheres.
  EXPECT_THAT(error_of({rule("A", "depth < 3", "sphere(repeat = 1000, radius = -1); A(repeat = 20)")}),
              HasSubstr("rule 1 (A), make, column 1: more than 200000 shapes in one hoodoo"));
  // 10^8 steps of arithmetic.
  std::string sum = "0";
  for (int i = 0; i < 50000; ++i) sum += " + 0";
  EXPECT_THAT(error_of({rule("A", "1", "sphere(repeat = 1000, x = " + sum + ")")}),
              HasSubstr("rule 1 (A): takes too long to work out"));
  EXPECT_THAT(error_of({rule("A", "1", "sphere(repeat = 1e9)")}), HasSubstr("repeat"));
}

}  // namespace
}  // namespace tafoni::landforms::impl
