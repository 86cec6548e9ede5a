// Reading scene files.

#include <gmock/gmock.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/scene/test/documents.h"

namespace tafoni::scene {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(ParseScene, ReadsTheExampleOfTheDesign) {
  const Document d = parse_scene(full, "dir/s.toml");
  EXPECT_EQ(d.scene.seed, 7);
  EXPECT_EQ(d.scene.voxel, 0.5);
  EXPECT_EQ(d.resolve(d.terrain.source), "dir/pointsal.tif");
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
        Wrong{"[scene]\n[terrain]\nfill = 3",
              "dir/s.toml:2: [terrain] needs a source (a path) or a generator"},
        Wrong{"[scene]\nvoxel = 1e-5\n[terrain]\nsource = \"a\"",
              "dir/s.toml:2: voxel = 1e-05 m is less than"},
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
              "dir/s.toml:2: there is no layer type \"sea-clif\"; did you mean \"sea-cliff\"?"},
        Wrong{"[[layer]]\ntype = \"zzzzzzz\"",
              "dir/s.toml:2: there is no layer type \"zzzzzzz\"; known are arch, canyon, "},
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
              "dir/s.toml:4: there is no geology \"starta\"; did you mean \"strata\"?"},
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
        Wrong{"[terrain]\nsource = \"a\"\ngenerator = \"coast\"",
              "dir/s.toml:3: [terrain] has both a source and a generator"},
        Wrong{"[terrain]\ngenerator = \"coats\"", "dir/s.toml:2: "},
        Wrong{"[terrain]\nsource = \"a\"\ninfluence = 30",
              "dir/s.toml:3: influence = 30 m is more than three times amplitude = 7.5 m, where the field "
              "stops growing with "
              "depth; raise the amplitude to at least 10 m or lower the influence"},
        Wrong{"[terrain]\nsource = \"a\"\nwindow = [0, 0, 0, 5]",
              "dir/s.toml:3: window = [0.0, 0.0, 0.0, 5.0] has no pixels"},
        Wrong{"[terrain]\ngenerator = \"coast\"\nwindow = [0, 0, 5, 5]",
              "dir/s.toml:3: window is for a source; a generator"},
        Wrong{"[terrain]\nsource = \"a\"\namplitude = 1", "dir/s.toml:3: influence = 15 m is more than"},
        Wrong{"[terrain]\nsource = \"a\"\nwindow = [0, 0, 1.5, 5]", "must be whole pixels"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"karst\"\naltitude = [9, 1]",
              "dir/s.toml:3: altitude = [9.0, 1.0] of layer karst has its ends swapped"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"karst\"\nbox = [0, 0, 0, 1, -1, 1]",
              "is empty"},
        Wrong{"[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"primitives\"",
              "dir/s.toml:3: a primitives layer needs file, the path of a CSV"},
        Wrong{"[terrain\nsource = 1", "dir/s.toml:1: is not valid TOML: "},
        Wrong{"[scene]\nseed = 1\nseed = 2", "dir/s.toml:3: is not valid TOML: "},
        Wrong{"[scene]\nseed = \"\xff\xfe\"", "dir/s.toml:2: is not UTF-8; save it as UTF-8"}));

TEST(ParseScene, WhatIsSetLaterIsNotTheLines) {
  Document d = parse_scene("[terrain]\nsource = \"a\"\n\ninfluence = 20\n", "s.toml");
  EXPECT_EQ(place_of(d, d.terrain.lines, "influence"), "s.toml:4: ");
  set(d, "terrain.influence=99");
  EXPECT_THAT(error_of([&] { check(d); }), HasSubstr("s.toml:1: influence = 99 m"));
}

TEST(ParseScene, ErrorsAreOneLine) {
  for (std::string_view text :
       {"a\nb = \"x\ny\"", "[scene]\n\"vox\\nel\" = 1", "[[layer]]\ntype = \"\"\"\na\nb\"\"\""})
    EXPECT_THAT(message(text), Not(HasSubstr("\n"))) << text;
}

TEST(ParseScene, DeepNestingIsRefusedNotACrash) {
  EXPECT_THAT(message("a = " + std::string(100000, '[')), HasSubstr("is not valid TOML"));
  EXPECT_THAT(message("a = " + std::string(100000, '{')), HasSubstr("is not valid TOML"));
}

TEST(ParseScene, ManyDotsAreRefusedNotACrash) {
  std::string parts = "a";
  for (int i = 0; i < 100000; ++i) parts += ".a";
  for (const std::string& text :
       {"[" + parts + "]", "[[" + parts + "]]", parts + " = 1", "a = {" + parts + " = 1}"})
    EXPECT_THAT(message("# one\nb = \"\"\"\"\"\n\"\"\"\"\" # \"\n" + text),
                HasSubstr("s.toml:4: a header or key has more than 64 dots"));
  // Each key has few, and all of them together many.
  std::string nested_keys = "x = ";
  for (int i = 0; i < 20; ++i) nested_keys += "{a.b.c.d.e = ";
  EXPECT_THAT(message(nested_keys), HasSubstr("s.toml:1: a header or key has more than 64 dots"));
}

TEST(ParseScene, DotsInValuesAreNoNesting) {
  const std::string dots(1000, '.');
  std::string numbers = "1.5";
  for (int i = 0; i < 1000; ++i) numbers += ", 1.5";
  EXPECT_NO_THROW(
      parse_scene("# " + dots + "\n[terrain]\nsource = \"" + dots + "\\\"" + dots + "\"\n", "s.toml"));
  EXPECT_NO_THROW(parse_scene("[terrain]\nsource = '" + dots + "'\n", "s.toml"));
  EXPECT_NO_THROW(parse_scene("[terrain]\nsource = \'\'\'" + dots + "\n" + dots + "\'\'\'\'\'\n", "s.toml"));
  EXPECT_THAT(message("[terrain]\nsource = [" + numbers + "]"), HasSubstr("source must be"));
}

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

TEST(Nesting, TooDeepIsRefused) {
  std::string text = "[terrain]\nsource = \"a\"\n", path = "geology";
  for (int depth = 0; depth < 40; ++depth, path += ".of") text += "[[" + path + "]]\ntype = \"blend\"\n";
  EXPECT_THAT(message(text), HasSubstr("geology is nested more than 32 deep"));
}

TEST(Tables, SayWhatIsWrong) {
  ASSERT_FALSE(table_scenes().empty());
  const TableScene s = table_scenes().front();
  const std::string head = fmt::format("[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"{}\"\n", s.type);
  EXPECT_THAT(message(head + fmt::format("[[layer.{}]]\n{}x = 1", s.table, s.column)),
              HasSubstr(fmt::format(
                  "dir/s.toml:6: unknown key \"{}x\" in layer \"{}\": {}, row 1; did you mean \"{}\"?",
                  s.column, s.type, s.table, s.column)));
  EXPECT_THAT(message(head + fmt::format("{} = 3", s.table)),
              HasSubstr(fmt::format("dir/s.toml:5: {} must be rows of {}", s.table, s.column)));
  EXPECT_THAT(message(head + fmt::format("{} = [{{{} = [[1]]}}]", s.table, s.column)),
              HasSubstr(fmt::format("dir/s.toml:5: layer \"{}\": {}, row 1: {} must be text or numbers, not "
                                    "an array",
                                    s.type, s.table, s.column)));
}

TEST(Tables, CellsOutOfRangeAreNamedByLineLayerRowAndColumn) {
  const std::string head = "[terrain]\nsource = \"a\"\n[[layer]]\ntype = \"tunnels\"\n";
  const std::string row = "[[layer.tunnel]]\nfrom = [0, 0, 5]\nto = \"9, 9, 5\"\n";
  EXPECT_THAT(message(head + row + row + "wander = 7\n"),
              HasSubstr("dir/s.toml:11: layer \"tunnels\": tunnel, row 2: wander = 7 is outside 0 to 0.5"));
  EXPECT_THAT(message(head + "[[layer.tunnel]]\nfrom = [0, 0]\n"),
              HasSubstr("dir/s.toml:6: layer \"tunnels\": tunnel, row 1: from must be 3 numbers"));
}

}  // namespace
}  // namespace tafoni::scene
