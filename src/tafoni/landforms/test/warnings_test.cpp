// Where a layer makes nothing of what it was told, it says so; what would take forever is refused.
#include <cmath>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/heard_warnings.h"
#include "tafoni/landforms/test/site.h"

namespace tafoni::landforms::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// 120 m by 90 m.
Coast smooth_hill() {
  return Coast([](Vec3d) { return 0.5; },
               [](double x, double y) { return 26 * std::exp(-(x * x / 900 + y * y / 700)); });
}

std::vector<std::string> warnings(const char* type, const Values& values) {
  const Coast coast = smooth_hill();
  HeardWarnings warnings;
  find_landform(type).generate(coast.site, values, warnings);
  return warnings.said;
}

std::string refusal(const char* type, const Values& values) {
  const Coast coast = smooth_hill();
  try {
    find_landform(type).generate(coast.site, values, silent());
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

const Row far = {{"at", "600000 4000000 5"}}, near = {{"at", "500000 4000000 5"}};

TEST(Warnings, ChambersOutsideTheTerrain) {
  EXPECT_THAT(warnings("chambers", {{"chamber", Rows{near, far}}}),
              ElementsAre(HasSubstr("chambers: chamber, row 2 is not made: it lies outside")));
}

TEST(Warnings, TunnelsThatHaveNoHill) {
  EXPECT_THAT(warnings("tunnels", {{"radius", 60.0}}), ElementsAre(HasSubstr("tunnels digs nothing")));
  const Row away = {{"from", "600000 4000000 5"}, {"to", "600050 4000000 5"}};
  EXPECT_THAT(warnings("tunnels", {{"tunnel", Rows{away}}}),
              ElementsAre(HasSubstr("tunnels: tunnel, row 1 is not dug: it lies outside")));
}

TEST(Warnings, ExplosionsWithoutAPlace) {
  EXPECT_THAT(warnings("explosions", {{"radius", 100.0}}),
              ElementsAre(HasSubstr("explosions finds no place for a crater of 100 m")));
  EXPECT_THAT(warnings("explosions", {{"count", std::int64_t{0}}, {"blast", Rows{near, far}}}),
              ElementsAre(HasSubstr("explosions: blast, row 2 does nothing: it lies outside")));
}

TEST(Warnings, ToolsThatMeetNothing) {
  Row hit = near, miss = far;
  hit["radius"] = miss["radius"] = "3";
  const Values plain = {{"count", std::int64_t{0}}, {"spacing", 1.0}};
  Values values = plain;
  values["tool"] = Rows{hit, miss};
  EXPECT_THAT(warnings("prism-field", values),
              ElementsAre(HasSubstr("prism-field: tool, row 2 changes nothing: there is no matter")));
  values["tool"] = Rows{hit};
  EXPECT_THAT(warnings("prism-field", values), IsEmpty());
  values = plain;
  values["source"] = std::string("box");
  values["at"] = std::vector<double>{600000, 4000000, 5};
  EXPECT_THAT(warnings("prism-field", values), ElementsAre(HasSubstr("prism-field makes nothing")));
}

TEST(Warnings, CavesWhoseEntranceIsElsewhere) {
  EXPECT_THAT(warnings("grammar-cave", {{"at", std::vector<double>{600000, 4000000}}}),
              ElementsAre(HasSubstr("grammar-cave makes nothing: its entrance lies outside")));
}

TEST(Warnings, PlacesThatAreLeftOut) {
  const Values pillars = {{"at", std::vector<double>{500000, 4000000, 600000, 4000000}}, {"density", 0.0}};
  EXPECT_THAT(warnings("hoodoos", pillars), ElementsAre(HasSubstr("hoodoos: at: 1 of 2 places left out")));
  EXPECT_THAT(warnings("karst", {{"springs", std::vector<double>{600000, 4000000, 0}}}),
              testing::Contains(HasSubstr("karst: springs: 1 of 1 places left out")));
  EXPECT_THAT(warnings("hoodoos", {{"at", std::vector<double>{500000, 4000000}}, {"density", 0.0}}),
              IsEmpty());
}

TEST(Refusals, OfWhatWouldTakeForever) {
  Row wide = near;
  wide["radius"] = "9000";
  for (const char* mode : {"add", "remove"}) {
    wide["mode"] = mode;
    for (const char* source : {"box", "terrain"}) {
      if (source == std::string("box") && mode == std::string("remove")) continue;
      EXPECT_THAT(refusal("prism-field", {{"source", std::string(source)},
                                          {"spacing", 0.2},
                                          {"count", std::int64_t{0}},
                                          {"tool", Rows{wide}}}),
                  HasSubstr("too much at a spacing of 0.2 m"))
          << mode << " " << source;
    }
  }
  const Row long_one = {{"from", "500000 4000000 5"}, {"to", "-9e8 4000000 5"}};
  EXPECT_THAT(refusal("tunnels", {{"tunnel", Rows{long_one}}}),
              HasSubstr("tunnel, row 1: 9e+08 m are too long"));
}

TEST(Refusals, OfWhatIsUpsideDown) {
  EXPECT_THAT(refusal("prism-field", {{"radius", std::vector<double>{9, 3}}}),
              HasSubstr("radius = [9, 3] must not begin with the greater one"));
  EXPECT_THAT(refusal("grammar-cave", {{"solids", std::string("cube shpere")}}),
              HasSubstr("there is no solid \"shpere\"; did you mean \"sphere\"?"));
  EXPECT_THAT(refusal("grammar-cave", {{"size", 0.001}}),
              HasSubstr("size = 0.001 is outside 0.05 to 1000 m"));
}

}  // namespace
}  // namespace tafoni::landforms::test
