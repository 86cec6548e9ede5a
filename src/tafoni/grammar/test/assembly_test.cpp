#include "tafoni/grammar/assembly.h"

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/field/compiled.h"
#include "tafoni/grammar/derive.h"

namespace tafoni::grammar {
namespace {

Shape solid(std::string_view name, Vec3d half) {
  const SolidType& type = find_solid(name);
  return shape_of(type.make(type.fit(half)));
}

float value(const FormPtr& form, Vec3d p) {
  return field::compile(tree(form)).value(p);
}

std::vector<Vec3d> places(const Box3d& box, int n, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> out;
  for (int i = 0; i < n; ++i)
    out.push_back({random.uniform(box.lo.x, box.hi.x), random.uniform(box.lo.y, box.hi.y),
                   random.uniform(box.lo.z, box.hi.z)});
  return out;
}

/// The equations 2 to 5 on plain numbers.
double reference(const Form& form, Vec3d p) {
  const Vec3d own = form.pose.own(p);
  if (form.solid) return form.solid->distance(own);
  double out = reference(*form.of[0], own);
  for (std::size_t i = 1; i < form.of.size(); ++i) {
    const double g = reference(*form.of[i], own);
    switch (form.operation) {
      case Operation::sum:
        out = std::max(out, g);
        break;
      case Operation::difference:
        out = std::min(out, -g);
        break;
      case Operation::intersection:
        out = std::min(out, g);
        break;
      case Operation::morph:
        out = out * (1 - form.alpha) + g * form.alpha;
    }
  }
  return out;
}

TEST(Bond, GluesWhereItsPointMeetsAnOppositeOne) {
  const Bond a{{1, 2, 3}, {1, 0, 0}};
  EXPECT_TRUE(glue(a, {{1, 2, 3}, {-1, 0, 0}}));
  EXPECT_FALSE(glue(a, {{1, 2, 3}, {1, 0, 0}}));
  EXPECT_FALSE(glue(a, {{1, 2, 3}, {0, 1, 0}}));
  EXPECT_FALSE(glue(a, {{1, 2, 3.01}, {-1, 0, 0}}));
  EXPECT_TRUE(glue(a, {{1, 2, 3}, {}}));
  EXPECT_TRUE(glue({{1, 2, 3}, {}}, {{1, 2, 3}, {}}));
  EXPECT_FALSE(glue({{1, 2, 3}, {}}, {{1, 2, 4}, {}}));
}

TEST(Form, IsTheDocumentsFourOperations) {
  Settings settings;
  settings.direction = "random";
  settings.classic = 12;
  settings.morphic = 3;
  settings.differences = 0.3;
  settings.intersections = 0.2;
  for (std::uint64_t seed = 1; seed < 6; ++seed) {
    settings.seed = seed;
    Assembly base;
    derive_at_random(base, settings);
    const FormPtr form = base.form();
    const field::CompiledField field = field::compile(tree(form));
    for (const Vec3d p : places(base.bounds().grown(1), 2000, seed))
      ASSERT_NEAR(field.value(p), reference(*form, p), 1e-4);
  }
}

TEST(Assembly, TwoCubesTouchFaceToFace) {
  Assembly base;
  Random random(1);
  ASSERT_TRUE(base.produce(solid("cube", {1, 1, 1}), {}, random));
  Production how;
  how.direction = {1, 0, 0};
  ASSERT_TRUE(base.produce(solid("cube", {2, 0.5, 0.5}), how, random));
  EXPECT_NEAR(base.bounds().lo.x, -1, 1e-12);
  EXPECT_NEAR(base.bounds().hi.x, 5, 1e-12);
  ASSERT_EQ(base.labels().size(), 1u);
  EXPECT_EQ(base.parts()[0].bonds.size(), 5u);
  EXPECT_EQ(base.parts()[1].bonds.size(), 5u);
  EXPECT_EQ(base.parts()[1].parent, 0);
  EXPECT_GT(value(base.form(), {4.9, 0, 0}), 0);
  EXPECT_LT(value(base.form(), {4.9, 0.6, 0}), 0);
}

TEST(Assembly, EachLabelIsADefinitionFiveAndNoBondIsUsedTwice) {
  Settings settings;
  settings.direction = "random";
  settings.branches = 0.5;
  settings.classic = 14;
  settings.intersections = 0.1;
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    settings.seed = seed;
    settings.overlap = seed % 2 ? 0 : 0.3;
    Assembly base;
    derive_at_random(base, settings);
    EXPECT_EQ(std::ssize(base.labels()), base.classic() + base.morphic() - 1);
    std::vector<Vec3d> used;
    for (const auto& [a, b] : base.labels()) {
      EXPECT_TRUE(glue(a, b));
      for (const Vec3d p : used) EXPECT_GT(length(p - a.point), 1e-9);
      used.push_back(a.point);
    }
    for (const Part& part : base.parts())
      for (const Bond& bond : part.bonds)
        for (const Vec3d p : used) EXPECT_GT(length(p - bond.point), 1e-9);
  }
}

TEST(Assembly, FreeBondsOfAnAssemblyLieOnItsSurface) {
  Settings settings;
  settings.direction = "random";
  settings.differences = 0.2;
  settings.intersections = 0.2;
  settings.morphic = 4;
  std::size_t seen = 0;
  for (std::uint64_t seed = 1; seed < 9; ++seed) {
    settings.seed = seed;
    Assembly base;
    derive_at_random(base, settings);
    const Shape shape = base.shape();
    for (const Bond& bond : shape.bonds) {
      EXPECT_NEAR(value(shape.form, bond.point), 0, 2e-3);
      if (bond.direction == Vec3d{}) continue;
      EXPECT_LT(value(shape.form, bond.point + bond.direction * 0.05), 0);
      ++seen;
    }
  }
  EXPECT_GT(seen, 100u);
}

TEST(Assembly, AStoredAssemblyIsAShape) {
  Random random(3);
  Assembly cross;
  cross.produce(solid("cube", {3, 1, 1}), {}, random);
  Production how;
  how.direction = {0, 0, 1};
  ASSERT_TRUE(cross.produce(solid("sphere", {1, 1, 1}), how, random));
  const Shape stored = cross.shape();
  EXPECT_EQ(stored.bonds.size(), 10u);
  Assembly base;
  base.begin(solid("cube", {1, 1, 1}));
  how.direction = {0, 1, 0};
  ASSERT_TRUE(base.produce(stored, how, random));
  EXPECT_EQ(base.elements(), 3u);
  // What is placed has the stored shape's values.
  const FormPtr added = base.parts()[1].form;
  for (const Vec3d p : places(stored.bounds.grown(1), 500, 4))
    EXPECT_NEAR(value(added, added->pose.placed(p)), value(stored.form, p), 1e-5);
}

TEST(Assembly, AMorphLiesBetween) {
  for (const double alpha : {0.0, 0.52, 1.0}) {
    Random random(5);
    Assembly base;
    base.begin(solid("sphere", {2, 2, 2}));
    Production how;
    how.operation = Operation::morph;
    how.alpha = alpha;
    how.sink = 0.5;
    how.direction = {1, 0, 0};
    ASSERT_TRUE(base.produce(solid("cube", {1, 1, 1}), how, random));
    EXPECT_EQ(base.morphic(), 1);
    const auto sphere = [](Vec3d p) { return 2 - length(p); };
    for (const Vec3d p : places({{-3, -3, -3}, {4, 3, 3}}, 300, 6)) {
      const Vec3d q{std::abs(p.x - 2) - 1, std::abs(p.y) - 1, std::abs(p.z) - 1};
      const double out = length(Vec3d{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)});
      const double cube = out > 0 ? -out : -std::max({q.x, q.y, q.z});
      EXPECT_NEAR(value(base.form(), p), sphere(p) * (1 - alpha) + cube * alpha, 1e-5);
    }
  }
}

TEST(Assembly, AZeroDirectionGluesWithAnyAndNothingGluesWithTheEmptyShape) {
  Random random(7);
  Assembly base;
  base.begin(solid("pyramid", {2, 2, 2}));
  Production how;
  how.direction = {0, 0, 1};
  how.turn = false;
  // Only the pyramid's point looks up, in no direction.
  ASSERT_TRUE(base.produce(solid("cube", {1, 1, 1}), how, random));
  EXPECT_EQ(base.labels()[0].first.direction, Vec3d{});
  EXPECT_NEAR(length(base.labels()[0].first.point - Vec3d{0, 0, 2}), 0, 1e-12);
  EXPECT_FALSE(base.produce(shape_of(find_solid("empty").make({})), {}, random));
  EXPECT_EQ(base.parts().size(), 2u);
}

TEST(Assembly, AHollowHasTheBondsOfWhatIsTakenAway) {
  Random random(8);
  Assembly base;
  base.begin(solid("cube", {2, 2, 2}));
  Production how;
  how.operation = Operation::difference;
  how.direction = {1, 0, 0};
  how.sink = 0.5;
  ASSERT_TRUE(base.produce(solid("cube", {1, 1, 1}), how, random));
  EXPECT_EQ(base.classic(), 1);
  EXPECT_EQ(base.elements(), 2u);
  // The wall at the end of the hollow, one metre in, looks out along +X.
  how.operation = Operation::sum;
  how.sink = 0;
  ASSERT_TRUE(base.open_towards(how.direction));
  ASSERT_TRUE(base.produce(solid("cube", {1, 0.5, 0.5}), how, random));
  EXPECT_NEAR(length(base.labels()[1].first.point - Vec3d{1, 0, 0}), 0, 1e-9);
  EXPECT_NEAR(base.bounds().hi.x, 3, 1e-9);
}

TEST(Assembly, WhatIsTakenFromTwoPartsIsOneElement) {
  Random random(12);
  Assembly base;
  base.begin(solid("cube", {1, 1, 1}));
  Production how;
  how.direction = {1, 0, 0};
  ASSERT_TRUE(base.produce(solid("cube", {1, 1, 1}), how, random));
  how.operation = Operation::difference;
  how.sink = 0.5;
  ASSERT_TRUE(base.produce(solid("cube", {2.5, 0.5, 0.5}), how, random));
  EXPECT_LT(value(base.form(), {0.8, 0, 0}), 0);
  EXPECT_LT(value(base.form(), {1.2, 0, 0}), 0);
  EXPECT_EQ(base.elements(), 3u);
  EXPECT_EQ(base.shape().elements, 3u);
}

TEST(Assembly, ADifferenceThatLeavesNothingIsRefused) {
  Random random(9);
  Assembly base;
  base.begin(solid("cube", {1, 1, 1}));
  Production how;
  how.operation = Operation::difference;
  how.direction = {1, 0, 0};
  how.sink = 1;
  EXPECT_FALSE(base.produce(solid("cube", {2, 2, 2}), how, random));
  EXPECT_EQ(base.classic(), 0);
  EXPECT_GT(value(base.form(), {0, 0, 0}), 0);
}

TEST(Assembly, OperationsOnTheWholeBaseAreTheDocuments) {
  for (const Operation operation : {Operation::intersection, Operation::morph}) {
    Random random(10);
    Assembly base;
    base.begin(solid("cube", {2, 1, 1}));
    Production how;
    how.direction = {1, 0, 0};
    ASSERT_TRUE(base.produce(solid("cube", {1, 0.5, 0.5}), how, random));
    const FormPtr before = base.form();
    how.operation = operation;
    how.alpha = 0.3;
    how.whole = true;
    how.sink = 1;
    ASSERT_TRUE(base.produce(solid("sphere", {1.2, 1.2, 1.2}), how, random));
    EXPECT_EQ(base.parts().size(), 1u);
    const Vec3d middle{4 - 1.2, 0, 0};
    for (const Vec3d p : places(base.bounds().grown(1), 500, 11)) {
      const double f = value(before, p), g = 1.2 - length(p - middle);
      EXPECT_NEAR(value(base.form(), p), operation == Operation::morph ? 0.7 * f + 0.3 * g : std::min(f, g),
                  1e-5);
    }
  }
}

TEST(Derive, KeepsTheSixParameters) {
  Settings settings;
  settings.classic = 8;
  settings.morphic = 3;
  settings.per_shape = 2;
  settings.differences = 0;
  settings.seed = 4;
  Assembly base;
  derive_at_random(base, settings);
  EXPECT_EQ(base.classic(), 8);
  EXPECT_EQ(base.morphic(), 3);
  EXPECT_EQ(base.elements(), 2u * 11u);
  for (const auto& [bond, added] : base.labels()) {
    if (bond.direction != Vec3d{}) {
      EXPECT_GT(bond.direction.x, 0.7);
    }
  }
  // A chain along +X.
  EXPECT_GT(base.bounds().size().x, 2 * base.bounds().size().y);
  settings.direction = "-Z";
  Assembly down;
  derive_at_random(down, settings);
  EXPECT_GT(down.bounds().size().z, 2 * down.bounds().size().y);
  EXPECT_EQ(error_of([&] { direction_of("+W"); }),
            "there is no direction \"+W\"; write +X, -X, +Y, -Y, +Z, -Z or random");
}

TEST(Derive, NearlyAlwaysMakesAllProductions) {
  for (const bool along : {true, false})
    for (const double cuts : {0.1, 0.4}) {
      Settings settings;
      settings.direction = along ? "+X" : "random";
      settings.differences = cuts;
      settings.intersections = along ? 0 : 0.2;
      settings.per_shape = 1;
      int lacking = 0;
      constexpr int seeds = 60;
      for (settings.seed = 0; settings.seed < seeds; ++settings.seed) {
        Assembly base;
        derive_at_random(base, settings);
        EXPECT_LE(base.classic(), settings.classic);
        EXPECT_LE(base.morphic(), settings.morphic);
        lacking += base.classic() + base.morphic() < settings.classic + settings.morphic;
      }
      EXPECT_LE(lacking, 1) << along << ' ' << cuts;
    }
}

TEST(Derive, TheSameSeedMakesTheSameAssembly) {
  Settings settings;
  settings.direction = "random";
  Assembly a, b, c;
  derive_at_random(a, settings);
  derive_at_random(b, settings);
  settings.seed = 1;
  derive_at_random(c, settings);
  int differ = 0;
  for (const Vec3d p : places(a.bounds(), 300, 1)) {
    EXPECT_EQ(value(a.form(), p), value(b.form(), p));
    differ += value(a.form(), p) != value(c.form(), p);
  }
  EXPECT_GT(differ, 100);
}

TEST(Derive, RefusedPlacesStayFree) {
  Settings settings;
  settings.direction = "random";
  settings.per_shape = 1;
  Assembly base;
  const Box3d room{{-3, -3, -3}, {3, 3, 3}};
  derive_at_random(base, settings,
                   [&](const Box3d& box) { return room.contains(box.lo) && room.contains(box.hi); });
  EXPECT_GT(base.classic(), 1);
  for (const Part& part : base.parts()) {
    EXPECT_TRUE(room.contains(part.core.lo) && room.contains(part.core.hi));
  }
}

Rows checked_rows(Rows rows) {
  ParamInfo info;
  info.name = "rule";
  info.kind = ValueKind::rows;
  info.columns = rule_columns();
  info.init = Rows{};
  return std::get<Rows>(check_value(info, rows, "test"));
}

TEST(Rules, MakeWhatTheySay) {
  const Rows rules = checked_rows(
      {{{"symbol", "Cave"}, {"shape", "cube"}, {"size", "2 2 1"}, {"next", "Hall Way"}},
       {{"symbol", "Hall"}, {"shape", "sphere"}, {"label", "+Y"}, {"size", "1.5"}, {"sink", "0.1"}},
       {{"symbol", "Way"}, {"shape", "Bead"}, {"label", "+X"}, {"sink", "0"}, {"next", "Way"}},
       {{"symbol", "Bead"}, {"shape", "cube"}, {"size", "1 0.5 0.5"}, {"next", "Knob"}},
       {{"symbol", "Knob"}, {"shape", "cube"}, {"size", "0.2"}, {"label", "+Z"}, {"sink", "0"}}});
  Settings settings;
  settings.classic = 5;
  settings.morphic = 0;
  settings.per_shape = 2;
  Assembly base;
  derive_by_rules(base, rules, settings);
  ASSERT_EQ(base.parts().size(), 5u);
  EXPECT_EQ(base.parts()[1].parent, 0);
  EXPECT_EQ(base.parts()[2].parent, 0);
  EXPECT_EQ(base.parts()[3].parent, 2);
  EXPECT_EQ(base.elements(), 2u + 3u * 2u);
  EXPECT_NEAR(base.bounds().hi.x, 2 + 3 * 2, 1e-9);
  EXPECT_NEAR(base.parts()[1].core.hi.y, 2 + 3 - 0.3, 1e-9);
}

TEST(Rules, BadOnesAreNamed) {
  const auto message = [](Row row) -> std::string {
    Assembly base;
    return error_of([&] { derive_by_rules(base, checked_rows({std::move(row)}), {}); });
  };
  using testing::HasSubstr;
  EXPECT_THAT(message({{"symbol", "A"}}), HasSubstr("rule, row 1: it needs"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cubes"}}), HasSubstr("did you mean \"cube\""));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"operation", "add"}}),
              HasSubstr("operation = \"add\" is not one of"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"label", "up"}}),
              HasSubstr("label = \"up\" is not one of"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"size", "1 2"}}), HasSubstr("size must be"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"size", "x"}}), HasSubstr("size = \"x\""));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"morph", "120"}}),
              HasSubstr("morph = 120 is outside 0 to 100 %"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"next", "B"}}), HasSubstr("\"B\""));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "A"}}), HasSubstr("made of itself"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "empty"}, {"next", "A"}}), HasSubstr("without end"));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"size", "1e400"}}), HasSubstr("size ="));
  EXPECT_THAT(message({{"symbol", "A"}, {"shape", "cube"}, {"weight", "nan"}}), HasSubstr("row 1: weight"));
  EXPECT_EQ(message({{"symbol", "A"}, {"shape", "cube"}}), "");
}

TEST(Rules, TablesThatGrowWithoutMeasureAreRefused) {
  const auto message = [](const Rows& rows, const Settings& settings) -> std::string {
    Assembly base;
    return error_of([&] { derive_by_rules(base, checked_rows(rows), settings); });
  };
  using testing::HasSubstr;
  Rows nested;
  for (char c = 'A'; c < 'H'; ++c)
    nested.push_back({{"symbol", std::string(1, c)},
                      {"shape", c == 'G' ? "cube" : std::string(1, static_cast<char>(c + 1))},
                      {"label", "random"},
                      {"next", std::string(1, c)}});
  Settings settings;
  settings.per_shape = 10;
  EXPECT_THAT(message(nested, settings), HasSubstr("made of more than"));
  std::string many;
  for (int i = 0; i < 2000; ++i) many += "A ";
  EXPECT_THAT(message({{{"symbol", "A"}, {"shape", "empty"}, {"next", many}}}, settings),
              HasSubstr("symbols wait"));
  settings.size = 1e3;
  EXPECT_THAT(message({{{"symbol", "A"}, {"shape", "cube"}, {"size", "1e4"}}}, settings),
              HasSubstr("row 1: cube"));
}

TEST(Rules, GoOnAfterTheWholeWasMorphed) {
  const Rows rules = checked_rows({{{"symbol", "A"}, {"shape", "cube"}, {"label", "+X"}, {"next", "A B"}},
                                   {{"symbol", "B"},
                                    {"shape", "sphere"},
                                    {"operation", "morph"},
                                    {"label", "random"},
                                    {"morph", "20"},
                                    {"next", "A"}}});
  Settings settings;
  settings.whole = true;
  settings.classic = 12;
  settings.morphic = 4;
  Assembly base;
  derive_by_rules(base, rules, settings);
  EXPECT_EQ(base.morphic(), 4);
  for (int i = 1; i < std::ssize(base.parts()); ++i) EXPECT_LT(base.parts()[i].parent, i);
}

}  // namespace
}  // namespace tafoni::grammar
