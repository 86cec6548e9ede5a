#include "tafoni/scene/document/document.h"

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/geology/kind.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/test/documents.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {
namespace {

using ::testing::HasSubstr;

TEST(ParseScene, NoParameterOfALayerHidesACommonOne) {
  for (const auto* landform : landforms::all_landforms())
    for (const ParamInfo& own : landform->about.params) {
      EXPECT_NE(own.name, "type") << landform->about.name;
      for (const ParamInfo& common : layer_params()) EXPECT_NE(own.name, common.name) << landform->about.name;
    }
}

TEST(ParseScene, NoParameterOfAGeologyHidesACommonOne) {
  for (const auto* kind : geology::all_geologies())
    for (const ParamInfo& own : kind->about.params)
      for (const char* common : {"type", "of", "name", "seed"})
        EXPECT_NE(own.name, common) << kind->about.name;
}

TEST(Nesting, IsSetByNameAndType) {
  Document d = parse_scene(nested, "s.toml");
  set(d, "anticline.height=12");
  set(d, "strata.thickness=3,5");
  set(d, "contact.seed=8");
  EXPECT_EQ(std::get<double>(d.geology[0].of[1].values.at("height")), 12);
  EXPECT_EQ(std::get<std::vector<double>>(d.geology[0].of[1].of[0].values.at("thickness")),
            (std::vector<double>{3, 5}));
  EXPECT_EQ(d.geology[0].seed, 8);
  try {
    set(d, "antcline.height=12");
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("did you mean \"anticline\"?"));
  }
}

std::string set_message(std::string_view assignment) {
  Document d = parse_scene(full, "s.toml");
  try {
    set(d, assignment);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::usage);
    return error.what();
  }
  return "no error";
}

TEST(Set, ReachesEveryPart) {
  Document d = parse_scene(full, "s.toml");
  d.layers[1].settings.name = "deep";
  set(d, "scene.seed=9");
  set(d, "terrain.amplitude=20");
  set(d, "strata.thickness=3");
  set(d, "deep.enabled=false");
  set(d, "karst.altitude=1,2");
  EXPECT_EQ(d.scene.seed, 9);
  EXPECT_EQ(d.terrain.amplitude, 20);
  EXPECT_EQ(std::get<std::vector<double>>(d.geology[0].values.at("thickness")), std::vector{3.0});
  EXPECT_FALSE(d.layers[1].settings.enabled);
  EXPECT_EQ(d.layers[1].settings.altitude, (std::vector<double>{1, 2}));
}

TEST(Set, SaysWhatIsWrong) {
  EXPECT_THAT(set_message("range=8"), HasSubstr("expected TARGET.NAME=VALUE, as in sea-cliff.range=8"));
  EXPECT_THAT(set_message("sea-cliff.range"), HasSubstr("expected TARGET.NAME=VALUE"));
  EXPECT_THAT(set_message("sea-clif.range=8"), HasSubstr("did you mean \"sea-cliff\"?"));
  EXPECT_THAT(set_message("sea-cliff.rnage=8"), HasSubstr("did you mean \"range\"?"));
  EXPECT_THAT(set_message("sea-cliff.range=x"), HasSubstr("range must be a number"));
  EXPECT_THAT(set_message("scene.voxel=-1"), HasSubstr("voxel = -1 is outside 0 to 100000 m"));
}

TEST(ParseScene, EveryDefaultIsAllowed) {
  const auto all_allowed = [](const std::vector<ParamInfo>& infos, const std::string& owner) {
    for (const ParamInfo& info : infos) {
      const auto* list = std::get_if<std::vector<double>>(&info.init);
      if (list && list->empty()) continue;
      EXPECT_NO_THROW(check_value(info, info.init, owner)) << owner << '.' << info.name;
    }
  };
  all_allowed(scene_params(), "scene");
  all_allowed(terrain_params(), "terrain");
  all_allowed(layer_params(), "layer");
  for (const auto* type : landforms::all_landforms()) all_allowed(type->about.params, type->about.name);
  for (const auto* type : geology::all_geologies()) all_allowed(type->about.params, type->about.name);
}

TEST(ParseScene, NoParameterOfAGeneratorHidesAKeyOfTheTerrain) {
  for (const terrain::GeneratorType* type : terrain::all_generators())
    for (const ParamInfo& own : type->about.params)
      for (const ParamInfo& key : terrain_params()) EXPECT_NE(own.name, key.name) << type->about.name;
}

}  // namespace
}  // namespace tafoni::scene
