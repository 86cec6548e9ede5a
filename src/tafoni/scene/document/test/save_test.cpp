// Writing scene files, with as much as possible of what was read.

#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/test/test_folder.h"
#include "tafoni/scene/test/documents.h"

namespace tafoni::scene {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

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

TEST(Tables, AreReadAndWritten) {
  ASSERT_FALSE(table_scenes().empty());
  for (const TableScene& scene : table_scenes()) {
    const Document read = parse_scene(scene.text, "s.toml");
    const auto table = [&](Document& d) -> Rows& { return std::get<Rows>(d.layers[1].values[scene.table]); };
    Document d = read;
    ASSERT_EQ(table(d).size(), 2u);
    EXPECT_EQ(table(d)[0].at(scene.column), scene.cell[0]);
    EXPECT_EQ(numbers_in(table(d)[1].at(scene.column)), numbers_in(scene.cell[1]));

    table(d)[0].at(scene.column) = scene.cell[2];
    EXPECT_THAT(to_text(d), HasSubstr(fmt::format("# One.\n[[layer.{}]]\n{} = \"{}\"  # kept\n", scene.table,
                                                  scene.column, scene.cell[2])));
    table(d).insert(table(d).begin(), table(d)[1]);
    table(d)[0].at(scene.column) = scene.cell[3];
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

TEST(SaveScene, PathsFollowTheFile) {
  namespace fs = std::filesystem;
  const TestFolder folder;
  const fs::path& root = folder.path;
  fs::create_directories(root / "a");
  fs::create_directories(root / "b" / "c");
  Document d = parse_scene(full, root / "a" / "s.toml");
  save_scene(d, root / "b" / "c" / "t.toml");
  const Document e = load_scene(root / "b" / "c" / "t.toml");
  EXPECT_EQ(e.terrain.source, "../../a/pointsal.tif");
  EXPECT_EQ(e.resolve(e.terrain.source), d.resolve(d.terrain.source));
  EXPECT_EQ(e.resolve(e.layers[1].settings.region), d.resolve(d.layers[1].settings.region));
  EXPECT_EQ(e.resolve(std::get<std::string>(e.layers[2].values.at("file"))), root / "a" / "spheres.csv");
  EXPECT_THAT(e.text, HasSubstr("# Storm waves."));
}

// ".." leads up from where a link leads, as everywhere else on the system.
TEST(SaveScene, PathsThroughLinkedFoldersFollowTheFile) {
  namespace fs = std::filesystem;
  const TestFolder folder;
  const fs::path& root = folder.path;
  fs::create_directories(root / "far" / "deep");
  fs::create_directory_symlink("far/deep", root / "link");
  std::ofstream(root / "far" / "dem.tif") << "heights";
  const Document d = parse_scene("[terrain]\nsource = \"../dem.tif\"\n", root / "link" / "s.toml");
  EXPECT_TRUE(fs::exists(d.resolve(d.terrain.source)));
  for (const char* to : {"t.toml", "far/t.toml", "link/t.toml"}) {
    save_scene(d, root / to);
    const Document e = load_scene(root / to);
    EXPECT_TRUE(fs::equivalent(e.resolve(e.terrain.source), root / "far" / "dem.tif")) << e.terrain.source;
  }
}

TEST(SaveScene, NamesThatAreNoPathsFollowTheFile) {
  namespace fs = std::filesystem;
  const TestFolder folder;
  const fs::path& root = folder.path;
  fs::create_directories(root / "a");
  fs::create_directories(root / "b");
  for (const char* name : {"sea.nc", "tile.zip"}) std::ofstream(root / "a" / name) << "x";
  const auto moved = [&](const std::string& source) {
    Document d;
    d.directory = root / "a";
    d.terrain.source = source;
    save_scene(d, root / "b" / "t.toml");
    const Document e = load_scene(root / "b" / "t.toml");
    EXPECT_EQ(e.resolve(e.terrain.source), d.resolve(d.terrain.source));
    return e.terrain.source;
  };
  EXPECT_EQ(moved("/vsizip/tile.zip/data/dtm.tif"), "/vsizip/../a/tile.zip/data/dtm.tif");
  EXPECT_EQ(moved("NETCDF:\"sea.nc\":depth"), "NETCDF:\"../a/sea.nc\":depth");
  EXPECT_EQ(moved("WMS:elsewhere"), "WMS:elsewhere");
  Document d;
  d.directory = root / "a";
  EXPECT_EQ(d.resolve("NETCDF:sea.nc:depth"), "NETCDF:" + (root / "a" / "sea.nc").string() + ":depth");
  EXPECT_EQ(d.resolve("/vsizip/tile.zip/x.tif"), "/vsizip/" + (root / "a" / "tile.zip").string() + "/x.tif");
}

TEST(SaveScene, NamesNeedNotBeUtf8) {
  const TestFolder folder;
  Document d;
  d.directory = folder.path;
  d.terrain.source = "d\xe9nivel\xe9.tif";  // Latin-1
  Layer layer;
  layer.type = "karst";
  layer.settings.name = "\\xE9";
  layer.settings.region = "\xfc/r.geojson";
  d.layers.push_back(layer);
  save_scene(d, folder.path / "s.toml");
  const Document e = load_scene(folder.path / "s.toml");
  EXPECT_EQ(e.terrain.source, d.terrain.source);
  EXPECT_EQ(e.layers[0].settings.name, layer.settings.name);
  EXPECT_EQ(e.layers[0].settings.region, layer.settings.region);
  EXPECT_THAT(e.text, HasSubstr("d\\\\xE9nivel\\\\xE9.tif"));
  // An edit of a text that was read keeps it so.
  Document edited = e;
  edited.scene.seed = 3;
  edited.layers[0].settings.region = "\xf6.geojson";
  EXPECT_TRUE(same(parse_scene(to_text(edited), folder.path / "s.toml"), edited));
}

}  // namespace
}  // namespace tafoni::scene
