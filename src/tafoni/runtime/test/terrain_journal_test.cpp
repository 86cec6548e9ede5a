// Journals of a terrain: what was dug comes back, byte for byte.

#include <csignal>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/runtime/test/operations.h"
#include "tafoni/runtime/test/rocks.h"

namespace tafoni::runtime {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

class TerrainJournal : public ::testing::Test {
 protected:
  template <class F>
  static std::string failure(F&& f) {
    try {
      f();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }
  const TestFolder folder;
  const fs::path root = folder.path;
  fs::path file = root / "a.edits";
};

void expect_same(const DestructibleTerrain& a, const DestructibleTerrain& b) {
  EXPECT_EQ(a.state(), b.state());
  EXPECT_TRUE(a.snapshot()->grid() == b.snapshot()->grid());
  EXPECT_THAT(differing(*a.snapshot(), *b.snapshot()), ElementsAre());
  EXPECT_EQ(a.edits_since(1), b.edits_since(1));
}

TEST_F(TerrainJournal, TenThousandEditsComeBackByteForByte) {
  DestructibleTerrainSettings settings;
  settings.polygons = false;  // half the work, and other tests compare them
  DestructibleTerrain terrain = hills(settings);
  terrain.record(file);
  const Box3d box = world_box(terrain);
  for (std::uint64_t i = 0; i < 10000; ++i) {
    terrain.apply(random_operation(i, box, 2));
    if (i % 1000 != 999) continue;
    const SnapshotPtr now = terrain.snapshot();
    surface::GridMesher anew({surface::Boundary::solid, false});
    anew.update(now->grid(), {});
    for (const Vec3i c : anew.chunks()) ASSERT_TRUE(same(*now->chunk(c).mesh, *anew.chunk(c))) << i;
  }
  DestructibleTerrain again = hills(settings);
  EXPECT_EQ(again.replay(file), 10000u);
  expect_same(again, terrain);

  terrain.save(root / "b.edits");
  const auto bytes = [](const fs::path& path) {
    std::ifstream in(path, std::ios::binary);
    return std::string(std::istreambuf_iterator<char>(in), {});
  };
  EXPECT_EQ(bytes(root / "b.edits"), bytes(file));
}

TEST_F(TerrainJournal, GoesOnWhereACrashCutIt) {
  std::vector<std::uintmax_t> sizes;
  std::vector<DestructibleTerrain::State> states;
  const auto edit = [](std::uint64_t i) { return random_operation(i, {{-20, -20, -9}, {20, 20, 5}}, 3); };
  {
    DestructibleTerrain terrain = hills({});
    terrain.apply(edit(0));  // before the journal begins
    terrain.record(file);
    for (std::uint64_t i = 1; i < 40; ++i) {
      sizes.push_back(fs::file_size(file));
      states.push_back(terrain.state());
      terrain.apply(edit(i));
    }
    terrain.sync();
  }
  Random r(8);
  for (int round = 0; round < 12; ++round) {
    fs::copy_file(file, root / "torn", fs::copy_options::overwrite_existing);
    const auto size = sizes[0] + r.below(fs::file_size(file) - sizes[0]);
    fs::resize_file(root / "torn", size);
    std::size_t whole = 0;
    while (whole + 1 < sizes.size() && sizes[whole + 1] <= size) ++whole;
    {
      DestructibleTerrain terrain = hills({});
      terrain.record(root / "torn");
      ASSERT_EQ(terrain.state(), states[whole]);
      for (std::uint64_t i = whole + 1; i < 39; ++i) terrain.apply(edit(i));
      ASSERT_EQ(terrain.state(), states.back());
    }
    EXPECT_EQ(fs::file_size(root / "torn"), sizes.back());
  }
}

TEST_F(TerrainJournal, FlippedBitsAreOneErrorAndChangeNothing) {
  DestructibleTerrain terrain = hills({});
  terrain.record(file);
  for (std::uint64_t i = 0; i < 200; ++i) terrain.apply(random_operation(i, world_box(terrain), 3));
  DestructibleTerrain target = hills({});
  const auto state = target.state();
  Random r(9);
  for (int round = 0; round < 50; ++round) {
    fs::copy_file(file, root / "flipped", fs::copy_options::overwrite_existing);
    const auto at = static_cast<std::streamoff>(r.below(fs::file_size(file)));
    std::fstream f(root / "flipped", std::ios::binary | std::ios::in | std::ios::out);
    f.seekg(at);
    const char byte = static_cast<char>(f.get() ^ (1 << r.below(8)));
    f.seekp(at);
    f.put(byte);
    f.close();
    EXPECT_THAT(failure([&] { target.replay(root / "flipped"); }), HasSubstr("flipped: "));
    EXPECT_EQ(target.state(), state);
  }
  EXPECT_EQ(target.replay(file), 200u);
  expect_same(target, terrain);
}

TEST_F(TerrainJournal, BelongsToOneTerrain) {
  DestructibleTerrain terrain = hills({});
  terrain.explode({0, 0, 0}, 3, 4);
  terrain.save(file);
  DestructibleTerrainSettings deeper;
  deeper.band = 3;
  for (DestructibleTerrain* other :
       {new DestructibleTerrain(hills(deeper)), new DestructibleTerrain(hills({}, volume::Precision::half)),
        new DestructibleTerrain(hills({}, volume::Precision::single, far_away))}) {
    EXPECT_THAT(failure([&] { other->replay(file); }), HasSubstr("another terrain"));
    EXPECT_THAT(failure([&] { other->record(file); }), HasSubstr("another terrain"));
    EXPECT_EQ(other->version(), 1u);
    delete other;
  }
  EXPECT_THAT(failure([&] { terrain.replay(file); }), HasSubstr("without edits"));
}

TEST_F(TerrainJournal, AFullDiskRefusesTheEdit) {
  DestructibleTerrain terrain = hills({});
  terrain.record(file);
  terrain.explode({0, 0, 0}, 3, 4);
  const auto state = terrain.state();
  const SnapshotPtr before = terrain.snapshot();
  const mesh::Mesh mesh = terrain.mesh();
  const std::vector<Message> two{encode(Explosion{{9, 9, 0}, 3, 4}), encode(Explosion{{-9, 9, 0}, 3, 4})};

  const auto old_handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit old_limit{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &old_limit), 0);
  rlimit limit = old_limit;
  limit.rlim_cur = fs::file_size(file) + 20;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  const std::string error = failure([&] { terrain.explode({5, 5, 0}, 3, 4); });
  const mesh::Mesh after = terrain.mesh();
  // Room for the first of two that are made at once.
  limit.rlim_cur = fs::file_size(file) + two[0].size() + 40;
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &limit), 0);
  EXPECT_THAT(failure([&] { terrain.apply(two); }), HasSubstr("a.edits"));
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &old_limit), 0);
  std::signal(SIGXFSZ, old_handler);

  EXPECT_THAT(error, HasSubstr("a.edits"));
  EXPECT_EQ(terrain.state(), state);
  EXPECT_EQ(terrain.snapshot(), before);
  EXPECT_TRUE(same_bytes(after.positions, mesh.positions));
  EXPECT_TRUE(same_bytes(after.triangles, mesh.triangles));
  terrain.explode({-5, 5, 0}, 3, 4);
  DestructibleTerrain again = hills({});
  EXPECT_EQ(again.replay(file), 2u);
  expect_same(again, terrain);
}

TEST_F(TerrainJournal, TwoTerrainsNeverRecordInOneFile) {
  DestructibleTerrain one = hills({}), other = hills({});
  std::ofstream(file).flush();  // no bytes are no journal yet
  one.record(file);
  one.explode({0, 0, 0}, 3, 5);
  EXPECT_THAT(failure([&] { other.record(file); }), HasSubstr("another program records in it"));
  EXPECT_THAT(failure([&] { other.save(file); }), HasSubstr("a program records in it"));
  one.save(file);
  one.record(file);
  other.replay(file);
  one.explode({4, 0, 0}, 3, 5);
  EXPECT_EQ(read_journal(file).edits, one.edits_since(1));
  // One that was taken away is saved anew.
  fs::remove(file);
  one.save(file);
  EXPECT_EQ(read_journal(file).edits, one.edits_since(1));
}

}  // namespace
}  // namespace tafoni::runtime
