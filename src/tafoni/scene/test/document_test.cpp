#include "tafoni/scene/document.h"

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/geology/kind.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/csv.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr std::string_view full = R"(# The coast, second try.
[scene]
seed = 7
voxel = 0.5            # metres

[terrain]
source = "pointsal.tif"   # anything GDAL reads
window = [
  10, 20,   # column, row
  300, 200,
]

[[geology]]
type = "strata"
thickness = 14.0

# Storm waves.
[[layer]]
type = "sea-cliff"
sea_level = 3.0
range = 8.25   # as measured

[[layer]]
type = "karst"
enabled = true
region = "plateau.geojson"
altitude = [20, 120.5]

[[layer]]
type = "primitives"
file = "spheres.csv"
)";

std::string message(std::string_view text) {
  try {
    parse_scene(text, "dir/s.toml");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return "no error";
}

TEST(ParseScene, ReadsTheExampleOfTheDesign) {
  const Document d = parse_scene(full, "dir/s.toml");
  EXPECT_EQ(d.scene.seed, 7);
  EXPECT_EQ(d.scene.voxel, 0.5);
  EXPECT_EQ(d.resolved(d.terrain.source), "dir/pointsal.tif");
  EXPECT_EQ(d.terrain.window, (std::vector<double>{10, 20, 300, 200}));
  ASSERT_EQ(d.geology.size(), 1u);
  EXPECT_EQ(std::get<std::vector<double>>(d.geology[0].values.at("thickness")), std::vector{14.0});
  ASSERT_EQ(d.layers.size(), 3u);
  EXPECT_EQ(std::get<double>(d.layers[0].values.at("range")), 8.25);
  EXPECT_EQ(d.layers[0].line, 18);
  EXPECT_TRUE(d.layers[1].settings.enabled);
  EXPECT_EQ(d.layers[1].settings.altitude, (std::vector<double>{20, 120.5}));
  EXPECT_EQ(std::get<std::string>(d.layers[2].values.at("file")), "spheres.csv");
}

TEST(ParseScene, NoParameterOfALayerHidesACommonOne) {
  for (const auto* landform : landforms::all_landforms())
    for (const ParamInfo& own : landform->params) {
      EXPECT_NE(own.name, "type") << landform->name;
      for (const ParamInfo& common : layer_params()) EXPECT_NE(own.name, common.name) << landform->name;
    }
}

TEST(ParseScene, NoParameterOfAGeologyHidesACommonOne) {
  for (const auto* kind : geology::all_geologies())
    for (const ParamInfo& own : kind->params)
      for (const char* common : {"type", "of", "name", "seed"}) EXPECT_NE(own.name, common) << kind->name;
}

struct Wrong {
  std::string_view text, says;
};

class WrongScene : public ::testing::TestWithParam<Wrong> {};

TEST_P(WrongScene, IsAnErrorThatNamesFileLineAndKey) {
  EXPECT_THAT(message(GetParam().text), HasSubstr(GetParam().says));
}

INSTANTIATE_TEST_SUITE_P(
    Table, WrongScene,
    ::testing::Values(
        Wrong{"", "dir/s.toml: [terrain] needs a source (a path) or a generator"},
        Wrong{"[scene]\nvoxl = 1", "dir/s.toml:2: unknown key \"voxl\" in [scene]; did you mean \"voxel\"?"},
        Wrong{"[scene]\n\nvoxel = -1", "dir/s.toml:3: voxel = -1 is outside 0 to 100000 m"},
        Wrong{"[scene]\nvoxel = \"big\"", "dir/s.toml:2: voxel must be a number, 0 to 100000 m, not \"big\""},
        Wrong{"[scene]\nvoxel = nan", "dir/s.toml:2: voxel = nan is outside 0 to 100000 m"},
        Wrong{"[scene]\nvoxel = 1979-05-27",
              "dir/s.toml:2: voxel must be 0 to 100000 m, not a date or a time"},
        Wrong{"[scene]\nvoxel = {}", "dir/s.toml:2: voxel must be 0 to 100000 m, not a table"},
        Wrong{"[scene]\nseed = 1.5", "dir/s.toml:2: seed must be a whole number"},
        Wrong{"[scene]\nboundary = \"sold\"",
              "dir/s.toml:2: boundary = \"sold\" is not one of solid | open; did you mean \"solid\"?"},
        Wrong{"[[scene]]\nvoxel = 1", "scene must be a section, written [scene]"},
        Wrong{"scene = 3", "dir/s.toml:1: scene must be a section, written [scene]"},
        Wrong{"[[layers]]\ntype = \"karst\"",
              "dir/s.toml:1: unknown key \"layers\" in the scene; did you mean \"layer\"?"},
        Wrong{"[layer]\ntype = \"karst\"", "dir/s.toml:1: layer must be written [[layer]], once for each"},
        Wrong{"layer = [1, 2]", "dir/s.toml:1: layer must be written [[layer]], once for each"},
        Wrong{"\n[[layer]]\nrange = 3",
              "dir/s.toml:2: [[layer]] has no type; add, for example, type = \"karst\""},
        Wrong{"[[layer]]\ntype = 3", "dir/s.toml:2: type must be text"},
        Wrong{"[[layer]]\ntype = \"sea-clif\"",
              "dir/s.toml:2: unknown layer type \"sea-clif\"; did you mean \"sea-cliff\"?"},
        Wrong{"[[layer]]\ntype = \"zzzzzzz\"",
              "dir/s.toml:2: unknown layer type \"zzzzzzz\"; known are primitives"},
        Wrong{"[[layer]]\ntype = \"sea-cliff\"\nrnage = 3",
              "dir/s.toml:3: unknown key \"rnage\" in layer \"sea-cliff\"; did you mean \"range\"?"},
        Wrong{"[[layer]]\ntype = \"sea-cliff\"\nenabeld = true", "did you mean \"enabled\"?"},
        Wrong{"[[layer]]\ntype = \"karst\"\naltitude = [1]",
              "dir/s.toml:3: altitude = [1.0] has 1 number, but must have 2"},
        Wrong{"[[layer]]\ntype = \"karst\"\nbox = \"here\"", "dir/s.toml:3: box must be 6 numbers"},
        Wrong{"[[geology]]\ntype = \"stratta\"", "dir/s.toml:2: "},
        Wrong{"[[geology]]\ntype = \"strata\"\nthicknes = 3",
              "dir/s.toml:3: unknown key \"thicknes\" in geology \"strata\"; did you mean \"thickness\"?"},
        Wrong{"[[geology]]\ntype = \"fold\"", "dir/s.toml:2: fold: takes 1 child, but has none"},
        Wrong{"[[geology]]\ntype = \"fold\"\n[[geology.of]]\ntype = \"strata\"\n[[geology.of.of]]\ntype = "
              "\"planes\"",
              "dir/s.toml:4: strata: takes no children, but has 1"},
        Wrong{"[[geology]]\ntype = \"fault\"\ndomain = \"field\"\n[[geology.of]]\ntype = \"strata\"",
              "dir/s.toml:2: fault: with domain = \"field\" it takes 2 children, but has 1"},
        Wrong{"[[geology]]\ntype = \"fold\"\n[[geology.of]]\ntype = \"starta\"",
              "dir/s.toml:4: unknown geology \"starta\"; did you mean \"strata\"?"},
        Wrong{"[[geology]]\ntype = \"fold\"\n[[geology.of]]\nthickness = 3",
              "dir/s.toml:3: [[geology.of]] has no type; add, for example, type = \"strata\""},
        Wrong{"[[geology]]\ntype = \"fold\"\n[[geology.off]]\ntype = \"strata\"",
              "dir/s.toml:3: unknown key \"off\" in geology \"fold\"; did you mean \"of\"?"},
        Wrong{"[[geology]]\ntype = \"fold\"\n[geology.of]\ntype = \"strata\"",
              "dir/s.toml:3: geology.of must be written [[geology.of]], once for each"},
        Wrong{"[[geology]]\ntype = \"sphere\"\nposition = [1, 2]",
              "dir/s.toml:2: sphere: position has 2 numbers"},
        Wrong{"[[geology]]\ntype = \"fold\"\n[[geology.of]]\ntype = \"planes\"\ndip = 91",
              "dir/s.toml:5: dip = 91 is outside 0 to 90 deg"},
        Wrong{"[terrain]\nsource = \"a\"\ngenerator = \"coast\"", "has both a source and a generator"},
        Wrong{"[terrain]\ngenerator = \"coats\"", "dir/s.toml:2: "},
        Wrong{
            "[terrain]\nsource = \"a\"\ninfluence = 30",
            "influence = 30 m is more than three times amplitude = 7.5 m, where the field stops growing with "
            "depth; raise the amplitude to at least 10 m or lower the influence"},
        Wrong{"[terrain]\nsource = \"a\"\nwindow = [0, 0, 0, 5]", "has no pixels"},
        Wrong{"[terrain]\ngenerator = \"coast\"\nwindow = [0, 0, 5, 5]",
              "window is for a source; a generator"},
        Wrong{"[terrain]\nsource = \"a\"\nwindow = [0, 0, 1.5, 5]", "must be whole pixels"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"karst\"\naltitude = [9, 1]",
              "dir/s.toml:3: altitude = [9.0, 1.0] of layer karst has its ends swapped"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"karst\"\nbox = [0, 0, 0, 1, -1, 1]",
              "is empty"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"primitives\"",
              "dir/s.toml:3: a primitives layer needs file, the path of a CSV"},
        Wrong{"[terrain\nsource = 1", "dir/s.toml:1: is not valid TOML: "},
        Wrong{"[scene]\nseed = 1\nseed = 2", "dir/s.toml:3: is not valid TOML: "},
        Wrong{"[scene]\nseed = \"\xff\xfe\"", "is not valid TOML: "}));

TEST(ParseScene, ErrorsAreOneLine) {
  for (std::string_view text :
       {"a\nb = \"x\ny\"", "[scene]\n\"vox\\nel\" = 1", "[[layer]]\ntype = \"\"\"\na\nb\"\"\""})
    EXPECT_THAT(message(text), Not(HasSubstr("\n"))) << text;
}

TEST(ParseScene, DeepNestingIsRefusedNotACrash) {
  EXPECT_THAT(message("a = " + std::string(100000, '[')), HasSubstr("is not valid TOML"));
  EXPECT_THAT(message("a = " + std::string(100000, '{')), HasSubstr("is not valid TOML"));
}

TEST(ToText, UnchangedIsTheSameText) {
  EXPECT_EQ(to_text(parse_scene(full, "dir/s.toml")), full);
}

TEST(ToText, FromScratchReadsBackTheSame) {
  Document d = parse_scene(full, "dir/s.toml");
  d.text.clear();
  const std::string text = to_text(d);
  EXPECT_THAT(text, Not(HasSubstr("#")));
  EXPECT_TRUE(same(parse_scene(text, "dir/s.toml"), d)) << text;
}

TEST(ToText, EditsKeepCommentsAndLayout) {
  Document d = parse_scene(full, "dir/s.toml");
  d.scene.voxel = 2;
  d.terrain.window = {1, 2, 3, 4};
  d.terrain.influence = 9;
  set(d, "sea-cliff.range=12.5");
  d.layers[1].settings.name = "deep";
  const std::string text = to_text(d);
  EXPECT_TRUE(same(parse_scene(text, "dir/s.toml"), d)) << text;
  for (const char* kept : {"# The coast, second try.\n", "voxel = 2.0            # metres\n",
                           "# Storm waves.\n[[layer]]\n", "range = 12.5   # as measured\n",
                           "# anything GDAL reads\n", "influence = 9.0\n", "window = [1.0, 2.0, 3.0, 4.0]\n"})
    EXPECT_THAT(text, HasSubstr(kept));
}

TEST(ToText, AddsRemovesAndReordersLayers) {
  Document d = parse_scene(full, "dir/s.toml");
  std::swap(d.layers[0], d.layers[1]);
  d.layers.pop_back();
  Layer added;
  added.type = "sea-cliff";
  added.settings.name = "upper";
  d.layers.push_back(added);
  d.layers.push_back(added);
  d.geology.push_back({"turbulence", {}, 0});
  const std::string text = to_text(d);
  EXPECT_TRUE(same(parse_scene(text, "dir/s.toml"), d)) << text;
  EXPECT_THAT(text, HasSubstr("# Storm waves.\n[[layer]]\ntype = \"sea-cliff\""));
  EXPECT_THAT(text, Not(HasSubstr("spheres.csv")));
  EXPECT_LT(text.find("karst"), text.find("sea-cliff"));

  d.layers.clear();
  d.geology.clear();
  EXPECT_TRUE(same(parse_scene(to_text(d), "dir/s.toml"), d)) << to_text(d);
}

TEST(ToText, UnusualLayoutsStillReadBack) {
  for (std::string_view text :
       {"terrain = {source = \"a.tif\"}\nlayer = [{type = \"karst\"}]\n",
        "terrain.source = \"a.tif\"\nscene.seed = 3",
        "[terrain]\r\nsource = 'a.tif' # end\r\n\r\n[[layer]]\r\ntype = \"karst\"\r\n",
        "[ terrain ]\nsource = \"\"\"a#[.tif\"\"\"\n[scene]", "[terrain]\n\"source\" = \"a.tif\""}) {
    Document d = parse_scene(text, "s.toml");
    d.scene.voxel = 3;
    d.terrain.amplitude = 40;
    Layer layer;
    layer.type = "sea-cliff";
    d.layers.insert(d.layers.begin(), layer);
    EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d)) << to_text(d);
  }
}

constexpr std::string_view nested = R"([terrain]
source = "a.tif"

# Left of the fault.
[[geology]]
type = "contact"
dip = 80.0

[[geology.of]]
type = "turbulence"

# Right of it.
[[geology.of]]
type = "fold"
name = "anticline"   # as mapped

# What is folded.
[[geology.of.of]]
type = "strata"
thickness = [4, 9]   # log of the well

[[geology]]
type = "sphere"
position = [1, 2, 3]

[[layer]]
type = "karst"
)";

TEST(Nesting, IsRead) {
  const Document d = parse_scene(nested, "s.toml");
  ASSERT_EQ(d.geology.size(), 2u);
  ASSERT_EQ(d.geology[0].of.size(), 2u);
  const GeologySettings& fold = d.geology[0].of[1];
  EXPECT_EQ(fold.type, "fold");
  EXPECT_EQ(fold.name, "anticline");
  EXPECT_EQ(fold.line, 13);
  ASSERT_EQ(fold.of.size(), 1u);
  EXPECT_EQ(std::get<std::vector<double>>(fold.of[0].values.at("thickness")), (std::vector<double>{4, 9}));
  EXPECT_TRUE(
      same(d, parse_scene("geology = [{type = 'contact', dip = 80, of = [{type = 'turbulence'}, {type = "
                          "'fold', name = 'anticline', of = [{type = 'strata', thickness = [4, 9]}]}]}, "
                          "{type = 'sphere', position = [1, 2, 3]}]\n"
                          "layer = [{type = 'karst'}]\n[terrain]\nsource = 'a.tif'",
                          "s.toml")));
  Document other = d;
  other.geology[0].of[1].of[0].seed = 4;
  EXPECT_FALSE(same(d, other));
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

TEST(Nesting, SavesKeepComments) {
  Document d = parse_scene(nested, "s.toml");
  set(d, "strata.thickness=3,5");
  set(d, "anticline.height=12");
  d.geology[0].of[0].of.clear();
  std::swap(d.geology[0], d.geology[1]);
  std::swap(d.geology[1].of[0], d.geology[1].of[1]);
  GeologySettings faulted{"fault", {}, 0};
  faulted.of.push_back({"planes", {}, 0});
  d.geology.push_back(faulted);
  const std::string text = to_text(d);
  EXPECT_TRUE(same(parse_scene(text, "s.toml"), d)) << text;
  for (const char* kept :
       {"# Left of the fault.\n[[geology]]\ntype = \"contact\"\n",
        "# Right of it.\n[[geology.of]]\ntype = \"fold\"\n",
        "name = \"anticline\"   # as mapped\nheight = 12.0\n", "# What is folded.\n[[geology.of.of]]\n",
        "thickness = [3.0, 5.0]   # log of the well\n"})
    EXPECT_THAT(text, HasSubstr(kept));

  d.geology[1].of[0].of.clear();
  d.geology[1].of.clear();
  d.geology[1].type = "turbulence";
  d.geology[1].values.clear();
  EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d)) << to_text(d);
  d.text.clear();
  EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d)) << to_text(d);
}

TEST(Nesting, InlineTablesAreEditedInPlace) {
  constexpr std::string_view text =
      "# Mine.\n[terrain]\nsource = \"a.tif\"\n\n[[geology]]\ntype = \"fold\"\n"
      "of = [{type = \"taper\", of = [{type = \"planes\"}]}]  # inside\nheight = 3  # metres\n";
  Document d = parse_scene(text, "s.toml");
  set(d, "planes.dip=12");
  set(d, "fold.height=4");
  EXPECT_EQ(to_text(d),
            "# Mine.\n[terrain]\nsource = \"a.tif\"\n\n[[geology]]\ntype = \"fold\"\n"
            "of = [{type = \"taper\", of = [{type = \"planes\", dip = 12.0}]}]  # inside\nheight = 4.0  # "
            "metres\n");
  d.geology[0].of[0].of[0] = {"strata", {}, 0};
  EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d));
}

TEST(Nesting, TooDeepIsRefused) {
  std::string text = "[terrain]\nsource = \"a\"\n", path = "geology";
  for (int depth = 0; depth < 40; ++depth, path += ".of") text += "[[" + path + "]]\ntype = \"blend\"\n";
  EXPECT_THAT(message(text), HasSubstr("geology is nested more than 32 deep"));
}

/// A layer with a table of two rows between two others, for each landform that has a table.
struct TableScene {
  std::string type, table, column, text;
};

std::vector<TableScene> table_scenes() {
  std::vector<TableScene> out;
  for (const auto* type : landforms::all_landforms())
    for (const ParamInfo& info : type->params)
      if (!info.columns.empty()) {
        const std::string& column = info.columns.front().name;
        const std::string row = fmt::format("[[layer.{}]]\n{} = ", info.name, column);
        out.push_back({type->name, info.name, column,
                       fmt::format("[terrain]\nsource = \"a.tif\"\n\n[[layer]]\ntype = \"karst\"\n\n"
                                   "[[layer]]\ntype = \"{}\"\n\n# One.\n{}\"A\"  # kept\n\n# Two.\n{}2\n\n"
                                   "# Last.\n[[layer]]\ntype = \"sea-cliff\"\n",
                                   type->name, row, row)});
      }
  return out;
}

TEST(Tables, AreReadAndWritten) {
  ASSERT_FALSE(table_scenes().empty());
  for (const TableScene& scene : table_scenes()) {
    const Document read = parse_scene(scene.text, "s.toml");
    const auto table = [&](Document& d) -> Rows& { return std::get<Rows>(d.layers[1].values[scene.table]); };
    Document d = read;
    ASSERT_EQ(table(d).size(), 2u);
    EXPECT_EQ(table(d)[0].at(scene.column), "A");
    EXPECT_EQ(table(d)[1].at(scene.column), "2");

    table(d)[0].at(scene.column) = "B";
    EXPECT_THAT(to_text(d), HasSubstr(fmt::format("# One.\n[[layer.{}]]\n{} = \"B\"  # kept\n", scene.table,
                                                  scene.column)));
    table(d).insert(table(d).begin(), table(d)[1]);
    table(d)[0].at(scene.column) = "new";
    for (const char* kept : {"# One.", "# kept", "# Two.", "# Last."})
      EXPECT_THAT(to_text(d), HasSubstr(kept));
    std::swap(d.layers[0], d.layers[1]);
    EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d)) << to_text(d);
    // Values hold only what differs from the defaults.
    if (find_param(params_of_layer(scene.type), scene.table, "").init == Value(Rows{}))
      d.layers[0].values.erase(scene.table);
    else
      d.layers[0].values[scene.table] = Rows{};
    EXPECT_TRUE(same(parse_scene(to_text(d), "s.toml"), d)) << to_text(d);

    Document fresh = read;
    fresh.text.clear();
    EXPECT_TRUE(same(parse_scene(to_text(fresh), "s.toml"), read)) << to_text(fresh);
  }
}

TEST(Tables, SayWhatIsWrong) {
  ASSERT_FALSE(table_scenes().empty());
  const TableScene s = table_scenes().front();
  const std::string head = fmt::format("[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"{}\"\n", s.type);
  EXPECT_THAT(
      message(head + fmt::format("[[layer.{}]]\n{}x = 1", s.table, s.column)),
      HasSubstr(fmt::format("dir/s.toml:6: unknown key \"{}x\" in a row of \"{}\"; did you mean \"{}\"?",
                            s.column, s.table, s.column)));
  EXPECT_THAT(message(head + fmt::format("{} = 3", s.table)),
              HasSubstr(fmt::format("dir/s.toml:5: {} must be rows of {}", s.table, s.column)));
  EXPECT_THAT(message(head + fmt::format("{} = [{{{} = [1]}}]", s.table, s.column)),
              HasSubstr(fmt::format("dir/s.toml:5: {} must be text or a number, not an array", s.column)));
}

TEST(SaveScene, PathsFollowTheFile) {
  namespace fs = std::filesystem;
  const fs::path root = fs::path(::testing::TempDir()) / "tafoni_save_scene";
  fs::create_directories(root / "a");
  fs::create_directories(root / "b" / "c");
  Document d = parse_scene(full, root / "a" / "s.toml");
  save_scene(d, root / "b" / "c" / "t.toml");
  const Document e = load_scene(root / "b" / "c" / "t.toml");
  EXPECT_EQ(e.terrain.source, "../../a/pointsal.tif");
  EXPECT_EQ(e.resolved(e.terrain.source), d.resolved(d.terrain.source));
  EXPECT_EQ(e.resolved(e.layers[1].settings.region), d.resolved(d.layers[1].settings.region));
  EXPECT_EQ(e.resolved(std::get<std::string>(e.layers[2].values.at("file"))), root / "a" / "spheres.csv");
  EXPECT_THAT(e.text, HasSubstr("# Storm waves."));
  fs::remove_all(root);
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
      EXPECT_NO_THROW(checked(info, info.init, owner)) << owner << '.' << info.name;
    }
  };
  all_allowed(scene_params(), "scene");
  all_allowed(terrain_params(), "terrain");
  all_allowed(layer_params(), "layer");
  for (const auto* type : landforms::all_landforms()) all_allowed(type->params, type->name);
  for (const auto* type : geology::all_geologies()) all_allowed(type->params, type->name);
}

TEST(ParseScene, NoParameterOfAGeneratorHidesAKeyOfTheTerrain) {
  for (const terrain::GeneratorType* type : terrain::all_generators())
    for (const ParamInfo& own : type->params)
      for (const ParamInfo& key : terrain_params()) EXPECT_NE(own.name, key.name) << type->name;
}

}  // namespace
}  // namespace tafoni::scene
