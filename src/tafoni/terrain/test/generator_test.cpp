#include "tafoni/terrain/generator.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/test/effects.h"
#include "tafoni/core/test/errors.h"

namespace tafoni::terrain {
namespace {

using testing::HasSubstr;

const Values small{{"width", std::int64_t{90}}, {"height", std::int64_t{70}}, {"pixel", 4.0}};

class EveryGenerator : public testing::TestWithParam<const GeneratorType*> {};

TEST_P(EveryGenerator, IsDeclaredInFull) {
  const GeneratorType& type = *GetParam();
  EXPECT_EQ(&find_generator(type.about.name), &type);
  EXPECT_FALSE(type.about.doc.empty());
  ASSERT_GE(type.about.params.size(), 3u);
  EXPECT_EQ(type.about.params[0].name, "width");
  EXPECT_EQ(type.about.params[1].name, "height");
  EXPECT_EQ(type.about.params[2].name, "pixel");
  for (const ParamInfo& info : type.about.params) {
    EXPECT_FALSE(info.doc.empty()) << info.name;
    EXPECT_EQ(check_value(info, info.init, type.about.name), info.init) << info.name;
  }
}

TEST_P(EveryGenerator, MakesTheGridThatIsAskedFor) {
  const raster::Raster made = GetParam()->generate(small, 1, silent());
  EXPECT_EQ(made.width(), 90);
  EXPECT_EQ(made.height(), 70);
  EXPECT_EQ(made.placement.dx, 4);
  EXPECT_EQ(made.placement.dy, 4);
  EXPECT_EQ(made.placement.west, 0);
  EXPECT_EQ(made.placement.north, 280);
}

TEST_P(EveryGenerator, DependsOnTheSeedButNotOnThreads) {
  set_thread_count(1);
  const auto one = GetParam()->generate(small, 5, silent());
  set_thread_count(2);
  const auto two = GetParam()->generate(small, 5, silent());
  set_thread_count(0);
  EXPECT_EQ(one.values.values(), two.values.values());
  EXPECT_NE(one.values.values(), GetParam()->generate(small, 6, silent()).values.values());
}

TEST_P(EveryGenerator, IsFiniteAtTheEndsOfEveryRange) {
  for (const ParamInfo& info : GetParam()->about.params) {
    if (info.kind != ValueKind::real || info.name == "pixel") continue;
    for (double end : {info.min, info.max}) {
      Values values = small;
      values[info.name] = end;
      const auto made = GetParam()->generate(values, 2, silent());
      EXPECT_TRUE(std::all_of(made.values.values().begin(), made.values.values().end(),
                              [](float h) { return std::isfinite(h); }))
          << info.name << " = " << end;
    }
  }
}

TEST_P(EveryGenerator, EveryParameterDoesSomething) {
  const auto make = [&](const Values& values) {
    return std::optional(GetParam()->generate(values, 2, silent()).values.values());
  };
  // So large that what is far apart by default finds room, as steepheads and dolines do.
  Values wide = small;
  wide["pixel"] = GetParam()->about.name == "plateau" ? 40.0 : 8.0;
  for (const ParamInfo& info : GetParam()->about.params) {
    if (info.name == "width" || info.name == "height") continue;
    EXPECT_TRUE(has_effect(info, wide, make)) << info.name;
  }
}

TEST_P(EveryGenerator, MakesTheLeastGrid) {
  const auto made =
      GetParam()->generate({{"width", std::int64_t{2}}, {"height", std::int64_t{2}}}, 1, silent());
  for (float h : made.values.values()) EXPECT_TRUE(std::isfinite(h));
}

TEST_P(EveryGenerator, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  EXPECT_EQ(error_of([&] { GetParam()->generate(small, 1, progress); }), "cancelled");
}

INSTANTIATE_TEST_SUITE_P(Registry, EveryGenerator,
                         testing::ValuesIn(all_generators().begin(), all_generators().end()),
                         [](const auto& tested) { return tested.param->about.name; });

TEST(Generator, UnknownNameGetsTheNearest) {
  EXPECT_EQ(error_of([] { find_generator("caost"); }),
            "there is no generator \"caost\"; did you mean \"coast\"?");
  EXPECT_THAT(error_of([] { find_generator("moonscape"); }),
              HasSubstr("there is no generator \"moonscape\"; known are badlands, "));
}

}  // namespace
}  // namespace tafoni::terrain
