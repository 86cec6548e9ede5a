#include "tafoni/scene/products/facts.h"

#include <gtest/gtest.h>

#include "tafoni/field/tree.h"

namespace tafoni::scene {
namespace {

TEST(Facts, TextHasUnitsAndNoLists) {
  landforms::Facts facts;
  facts.count("primitives", 12)
      .length("tunnel_length", 12.3456789)
      .places("mouths", {{1, 2, 3}})
      .lengths("sizes", {1, 2})
      .area("river_bed", 11636)
      .volume("volume", 0.5)
      .number("strongest_effect", 0.25)
      .count("arches", 11)
      .flag("dry", true)
      .text("mode", "carve");
  EXPECT_EQ(facts_text(facts),
            "tunnel length 12.3457 m, river bed 11636 m2, volume 0.5 m3, strongest effect 0.25, arches 11, "
            "dry true, mode carve");
  EXPECT_EQ(facts_text({}), "");
}

TEST(Facts, KeysEndInUnitsAndPlacesAreWorldPositions) {
  const Vec3d origin{100, 200, 0};
  landforms::Facts facts;
  facts.area("river_bed", 4).places("mouths", {{1, 2, 3}}).count("arches", 2);
  std::vector<std::pair<std::string, Value>> entries;
  for (const landforms::Fact& fact : facts) entries.push_back(report_entry(fact, origin));
  const std::vector<std::pair<std::string, Value>> wanted = {
      {"river_bed_m2", 4.0}, {"mouths", std::vector<double>{101, 202, 3}}, {"arches", std::int64_t{2}}};
  EXPECT_EQ(entries, wanted);
}

TEST(Facts, PrimitivesAreToldOrCounted) {
  landforms::Result made;
  EXPECT_EQ(primitives_of(made), 0);
  field::CloudBuilder cloud{field::CloudSettings{}};
  const float radius = 2;
  cloud.add({0, 0, 0}, 30, {&radius, 1});
  cloud.add({5, 0, 0}, 30, {&radius, 1});
  made.nodes = {cloud.finish(), field::constant(1)};
  EXPECT_EQ(primitives_of(made), 2);
  made.facts.count("primitives", 7);
  EXPECT_EQ(primitives_of(made), 7);
}

}  // namespace
}  // namespace tafoni::scene
