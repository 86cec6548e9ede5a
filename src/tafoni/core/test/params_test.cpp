#include "tafoni/core/params.h"

#include <cmath>
#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"

namespace tafoni {
namespace {

using testing::HasSubstr;

struct Example {
  double range = 8;
  std::int64_t steps = 3;
  bool wet = false;
  std::string label = "cliff";
  std::string profile = "soft";
  std::vector<double> axis = {0, 0, 1};
  std::vector<double> weights = {1};
  Rows rule = {{{"from", "A"}, {"to", "B"}}, {{"from", "B"}, {"chance", "0.5"}}};
};

const std::vector<ParamInfo>& infos() {
  static const ParamTable<Example> table = [] {
    ParamTable<Example> t;
    t.real("range", &Example::range, "m", 0.1, 1000, "reach of the sea")
        .integer("steps", &Example::steps, "", 1, 8, "repetitions")
        .boolean("wet", &Example::wet, "whether the rock is wet")
        .text("label", &Example::label, "a name")
        .choice("profile", &Example::profile, {"soft", "hard"}, "the rock's profile")
        .numbers("axis", &Example::axis, "", 3, -1, 1, "a direction")
        .numbers("weights", &Example::weights, "", 0, 0, 1, "any number of weights")
        .rows("rule", &Example::rule,
              {column("from", "", "what is replaced"), column("to", "", "by what"),
               column("chance", "1", "how often")},
              "productions");
    return t;
  }();
  return table.infos();
}

const ParamInfo& info(std::string_view name) {
  return find_param(infos(), name, "test");
}

std::string error_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::usage);
    return e.what();
  }
  return "no error";
}

std::string set_error(const Values& values) {
  return error_of([&] {
    Example e;
    assign(infos(), &e, values, "sea-cliff");
  });
}

std::string parse_error(std::string_view name, std::string_view text) {
  return error_of([&] { parse_value(info(name), text, "sea-cliff"); });
}

TEST(Params, AssignStoresEveryKind) {
  Example e;
  assign(infos(), &e,
         {{"range", 2.5},
          {"steps", std::int64_t{5}},
          {"wet", true},
          {"label", std::string("x")},
          {"profile", std::string("hard")},
          {"axis", std::vector<double>{1, 0, 0}},
          {"weights", std::vector<double>{}}},
         "sea-cliff");
  EXPECT_EQ(e.range, 2.5);
  EXPECT_EQ(e.steps, 5);
  EXPECT_TRUE(e.wet);
  EXPECT_EQ(e.label, "x");
  EXPECT_EQ(e.profile, "hard");
  EXPECT_THAT(e.axis, testing::ElementsAre(1, 0, 0));
  EXPECT_TRUE(e.weights.empty());
}

TEST(Params, LoadGivesBackWhatIsStored) {
  Example e;
  e.range = 12;
  EXPECT_EQ(std::get<double>(info("range").load(info("range"), &e)), 12);
  EXPECT_EQ(std::get<double>(info("range").init), 8);
}

TEST(Params, ConvertsWhereNothingIsLost) {
  EXPECT_EQ(check_value(info("range"), Value(std::int64_t{4}), "w"), Value(4.0));
  EXPECT_EQ(check_value(info("steps"), Value(4.0), "w"), Value(std::int64_t{4}));
  EXPECT_EQ(check_value(info("weights"), Value(0.5), "w"), Value(std::vector<double>{0.5}));
  EXPECT_EQ(check_value(info("weights"), Value(std::int64_t{1}), "w"), Value(std::vector<double>{1}));
  EXPECT_EQ(error_of([&] { check_value(info("steps"), Value(4.5), "w"); }),
            "w: steps must be a whole number, 1 to 8, not 4.5");
  EXPECT_THAT(error_of([&] { check_value(info("steps"), Value(1e300), "w"); }),
              HasSubstr("w: steps must be a whole number, 1 to 8, not 1e+300"));
  EXPECT_EQ(error_of([&] { check_value(info("wet"), Value(std::int64_t{1}), "w"); }),
            "w: wet must be true or false, not 1");
}

TEST(Params, LimitsBelongToTheRange) {
  EXPECT_EQ(check_value(info("range"), Value(0.1), "w"), Value(0.1));
  EXPECT_EQ(check_value(info("range"), Value(1000.0), "w"), Value(1000.0));
  EXPECT_THAT(error_of([&] { check_value(info("range"), Value(std::nextafter(1000.0, 2000.0)), "w"); }),
              HasSubstr("is outside 0.1 to 1000 m"));
  EXPECT_THAT(error_of([&] { check_value(info("range"), Value(std::nan("")), "w"); }),
              HasSubstr("w: range = nan is outside 0.1 to 1000 m"));
}

TEST(Params, SentencesNameThePlaceTheValueAndTheRange) {
  EXPECT_EQ(set_error({{"range", -3.0}}), "sea-cliff: range = -3 is outside 0.1 to 1000 m");
  EXPECT_EQ(set_error({{"steps", std::int64_t{9}}}), "sea-cliff: steps = 9 is outside 1 to 8");
  EXPECT_EQ(set_error({{"range", std::numeric_limits<double>::infinity()}}),
            "sea-cliff: range = inf is outside 0.1 to 1000 m");
  EXPECT_EQ(set_error({{"range", std::string("wide")}}),
            "sea-cliff: range must be a number, 0.1 to 1000 m, not \"wide\"");
  EXPECT_EQ(set_error({{"steps", 2.5}}), "sea-cliff: steps must be a whole number, 1 to 8, not 2.5");
  EXPECT_EQ(set_error({{"profile", std::string("sotf")}}),
            "sea-cliff: profile = \"sotf\" is not one of soft | hard; did you mean \"soft\"?");
  EXPECT_EQ(set_error({{"profile", std::string("marble")}}),
            "sea-cliff: profile = \"marble\" is not one of soft | hard");
  EXPECT_EQ(set_error({{"axis", std::vector<double>{1, 2}}}),
            "sea-cliff: axis = [1.0, 2.0] has 2 numbers, but must have 3");
  EXPECT_EQ(set_error({{"axis", std::vector<double>{0, 0, 2}}}), "sea-cliff: axis = 2 is outside -1 to 1");
  EXPECT_EQ(set_error({{"label", true}}), "sea-cliff: label must be text, not true");
}

TEST(Params, TheCommandLineIsShownHowAListIsWritten) {
  const auto said = [&](const char* text) {
    return error_of([&] { parse_value(info("axis"), text, "--set sea-cliff.axis"); });
  };
  EXPECT_EQ(said("0 0 1"),
            "--set sea-cliff.axis: axis must be 3 numbers, each -1 to 1, written as in 1,2,3, not \"0 0 1\"");
  EXPECT_EQ(said("0,1"),
            "--set sea-cliff.axis: axis must be 3 numbers, each -1 to 1, written as in 1,2,3, not \"0,1\"");
  const Value axis = std::vector<double>{0, 0.5, 1};
  EXPECT_EQ(parse_value(info("axis"), "0,0.5,1", "w"), axis);
  EXPECT_EQ(parse_value(info("axis"), "[0, 0.5, 1]", "w"), axis);
}

TEST(Params, AWordThatIsAWholeFileIsNearNothing) {
  const std::vector<std::string> known = {"range", "steps"};
  EXPECT_EQ(nearest(std::string(20'000'000, 'r'), known), "");
}

TEST(Params, UnknownNameGetsTheNearest) {
  EXPECT_EQ(set_error({{"rnage", 1.0}}), "sea-cliff: unknown parameter \"rnage\"; did you mean \"range\"?");
  EXPECT_EQ(set_error({{"zzzzzz", 1.0}}),
            "sea-cliff: unknown parameter \"zzzzzz\"; known are range, steps, wet, label, profile, axis, "
            "weights and rule");
  EXPECT_EQ(error_of([] { find_param({}, "a", "plain"); }),
            "plain: unknown parameter \"a\"; it has no parameters");
}

TEST(Params, ParsesText) {
  EXPECT_EQ(parse_value(info("range"), " 2.5e1 ", "w"), Value(25.0));
  EXPECT_EQ(parse_value(info("steps"), "4", "w"), Value(std::int64_t{4}));
  EXPECT_EQ(parse_value(info("steps"), "4.0", "w"), Value(std::int64_t{4}));
  EXPECT_EQ(parse_value(info("wet"), "Yes", "w"), Value(true));
  EXPECT_EQ(parse_value(info("wet"), "off", "w"), Value(false));
  EXPECT_EQ(parse_value(info("label"), "a = b", "w"), Value(std::string("a = b")));
  EXPECT_EQ(parse_value(info("profile"), "hard", "w"), Value(std::string("hard")));
  EXPECT_EQ(parse_value(info("axis"), "0,1 , -0.5", "w"), Value(std::vector<double>{0, 1, -0.5}));
  EXPECT_EQ(parse_value(info("axis"), "[0, 1, 0]", "w"), Value(std::vector<double>{0, 1, 0}));
  EXPECT_EQ(parse_value(info("weights"), "[]", "w"), Value(std::vector<double>{}));
}

TEST(Params, ParseErrors) {
  EXPECT_EQ(parse_error("range", "8m"), "sea-cliff: range must be a number, 0.1 to 1000 m, not \"8m\"");
  EXPECT_EQ(parse_error("range", ""), "sea-cliff: range must be a number, 0.1 to 1000 m, not \"\"");
  EXPECT_EQ(parse_error("range", "5000"), "sea-cliff: range = 5000 is outside 0.1 to 1000 m");
  EXPECT_EQ(parse_error("steps", "99999999999999999999"),
            "sea-cliff: steps must be a whole number, 1 to 8, not \"99999999999999999999\"");
  EXPECT_EQ(parse_error("wet", "maybe"), "sea-cliff: wet must be true or false, not \"maybe\"");
  EXPECT_EQ(parse_error("axis", "1,,2"),
            "sea-cliff: axis must be 3 numbers, each -1 to 1, written as in 1,2,3, not \"1,,2\"");
  EXPECT_EQ(parse_error("axis", "1,2,"),
            "sea-cliff: axis must be 3 numbers, each -1 to 1, written as in 1,2,3, not \"1,2,\"");
}

TEST(Params, RowsGetTheColumnsTheyLack) {
  const Rows given = {{{"from", "A"}}, {{"to", "B"}, {"chance", "0.2"}}};
  const Rows full = {{{"from", "A"}, {"to", ""}, {"chance", "1"}},
                     {{"from", ""}, {"to", "B"}, {"chance", "0.2"}}};
  EXPECT_EQ(check_value(info("rule"), given, "w"), Value(full));
  EXPECT_EQ(check_value(info("rule"), full, "w"), Value(full));
  EXPECT_EQ(check_value(info("rule"), std::vector<double>{}, "w"), Value(Rows{}));
  EXPECT_EQ(std::get<Rows>(info("rule").init)[1].at("to"), "");
  Example e;
  assign(infos(), &e, {}, "hoodoo");
  EXPECT_EQ(Value(e.rule), info("rule").init);
  assign(infos(), &e, {{"rule", given}}, "hoodoo");
  EXPECT_EQ(e.rule, full);
  EXPECT_EQ(info("rule").load(info("rule"), &e), Value(full));
}

TEST(Params, RowErrors) {
  EXPECT_EQ(set_error({{"rule", Rows{{}, {{"form", "A"}}}}}),
            "sea-cliff: rule, row 2: unknown parameter \"form\"; did you mean \"from\"?");
  EXPECT_EQ(set_error({{"rule", 3.0}}), "sea-cliff: rule must be rows of from, to, chance, not 3.0");
  EXPECT_EQ(set_error({{"range", Rows{}}}), "sea-cliff: range must be a number, 0.1 to 1000 m, not []");
  EXPECT_EQ(parse_error("rule", "[{from = 1}]"),
            "sea-cliff: rule is a table, which only a scene file can give");
}

TEST(Params, CellsHoldWhatTheirColumnsSay) {
  ParamInfo table;
  table.name = "tool";
  table.kind = ValueKind::rows;
  table.columns = {numbers_column("at", "", "m", 3, -1e6, 1e6, "where"),
                   numbers_column("radius", "5", "m", 1, 0.1, 500, "how wide"),
                   numbers_column("points", "", "m", 0, -9, 9, "corners"),
                   choice_column("shape", "", {"sphere", "box"}, "what")};
  const auto row = [&](const char* column, const char* text) {
    return std::get<Rows>(check_value(table, Rows{{}, {{column, text}}}, "dig"))[1].at(column);
  };
  EXPECT_EQ(row("at", "1, 2 -3e0"), "1, 2 -3e0");
  EXPECT_EQ(row("at", " "), "");
  EXPECT_EQ(row("radius", ""), "5");
  EXPECT_EQ(row("points", "1 2\n3 4"), "1 2\n3 4");
  EXPECT_EQ(row("shape", "box"), "box");
  const auto error = [&](const char* column, const char* text) {
    return error_of([&] { row(column, text); });
  };
  EXPECT_EQ(error("radius", "1e6"), "dig: tool, row 2: radius = 1000000 is outside 0.1 to 500 m");
  EXPECT_EQ(error("radius", "nan"), "dig: tool, row 2: radius must be a number, 0.1 to 500 m, not \"nan\"");
  EXPECT_EQ(error("radius", "5m"), "dig: tool, row 2: radius must be a number, 0.1 to 500 m, not \"5m\"");
  EXPECT_EQ(error("at", "1 2"),
            "dig: tool, row 2: at must be 3 numbers, each -1000000 to 1000000 m, not \"1 2\"");
  EXPECT_EQ(error("at", "1 2 3 4"),
            "dig: tool, row 2: at must be 3 numbers, each -1000000 to 1000000 m, not \"1 2 3 4\"");
  EXPECT_EQ(error("points", "1 10"), "dig: tool, row 2: points = 10 is outside -9 to 9 m");
  EXPECT_EQ(error("shape", "shpere"),
            "dig: tool, row 2: shape = \"shpere\" is not one of sphere | box; did you mean \"sphere\"?");
}

TEST(Params, Nearest) {
  const std::vector<std::string> known = {"sea-cliff", "karst", "amplitude", "sea_level"};
  EXPECT_EQ(nearest("karts", known), "karst");
  EXPECT_EQ(nearest("seacliff", known), "sea-cliff");
  EXPECT_EQ(nearest("sea-level", known), "sea_level");
  EXPECT_EQ(nearest("ampl", known), "amplitude");
  EXPECT_EQ(nearest("KARST", known), "karst");
  EXPECT_EQ(nearest("hoodoo", known), "");
  EXPECT_EQ(nearest("", known), "");
  EXPECT_EQ(nearest("x", std::vector<std::string>{"y"}), "");
}

TEST(Params, ToToml) {
  EXPECT_EQ(to_toml(Value(8.0)), "8.0");
  EXPECT_EQ(to_toml(Value(0.1)), "0.1");
  EXPECT_EQ(to_toml(Value(1e300)), "1e+300");
  EXPECT_EQ(to_toml(Value(std::int64_t{8})), "8");
  EXPECT_EQ(to_toml(Value(true)), "true");
  EXPECT_EQ(to_toml(Value(std::string("a\"b\\c\nd\x01"))), "\"a\\\"b\\\\c\\nd\\u0001\"");
  EXPECT_EQ(to_toml(Value(std::vector<double>{1, -0.5})), "[1.0, -0.5]");
  EXPECT_EQ(to_toml(Value(Rows{{{"a", "x\"y"}, {"b", ""}}, {}})), "[{a = \"x\\\"y\", b = \"\"}, {}]");
}

TEST(Params, Allowed) {
  EXPECT_EQ(allowed(info("range")), "0.1 to 1000 m");
  EXPECT_EQ(allowed(info("profile")), "soft | hard");
  EXPECT_EQ(allowed(info("axis")), "3 numbers, each -1 to 1");
  EXPECT_EQ(allowed(info("wet")), "true or false");
  ParamInfo open = info("range");
  open.max = std::numeric_limits<double>::infinity();
  EXPECT_EQ(allowed(open), "0.1 m or more");
  open.min = -open.max;
  EXPECT_EQ(allowed(open), "any number of m");
}

}  // namespace
}  // namespace tafoni
