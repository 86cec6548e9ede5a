// Whatever OpenVDB writes, in each of its ways, is read back as OpenVDB itself reads it; what is not as it
// should be gives one sentence, for any bytes.

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/rounds.h"
#include "tafoni/io/test/volumes.h"

#ifdef TAFONI_OPENVDB

#include <cstring>
#include <fstream>
#include <set>

#include <gmock/gmock.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>

namespace tafoni::io {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using testing::HasSubstr;

constexpr float outside = 2.5f;  // exact as a half

/// What inactive values of a leaf are, in the order of OpenVDB's own cases.
float inactive_value(int kind, Random& random) {
  const bool other = random.below(2) != 0;
  switch (kind) {
    case 0:
      return outside;
    case 1:
      return -outside;
    case 2:
      return 0.75f;
    case 3:
      return other ? outside : -outside;
    case 4:
      return other ? outside : 1.3f;
    case 5:
      return other ? -0.1f : 0.2f;
    default:
      return static_cast<float>(random.uniform(-3, 3));
  }
}

/// Leaves of all kinds, full, empty and between, and tiles of each level, active or not.
FloatGrid::Ptr motley(std::uint64_t seed) {
  openvdb::initialize();
  Random random(seed);
  auto grid = FloatGrid::create(outside);
  auto& tree = grid->tree();
  for (int kind = 0; kind < 7; ++kind)
    for (const double share : {0.0, 0.02, 0.5, 1.0}) {
      const Coord at(8 * (kind - 3) + 120, 8 * static_cast<int>(random.below(40)) - 160,
                     static_cast<int>(8 * share * 50));
      const int x = at.x() & ~7;
      for (int i = 0; i < 512; ++i) {
        const Coord voxel(x + (i >> 6), at.y() + (i >> 3 & 7), (at.z() & ~7) + (i & 7));
        if (random.uniform() < share)
          tree.setValueOn(voxel, static_cast<float>(random.below(3) ? random.uniform(-2.5, 2.5) : 0.5));
        else
          tree.setValueOff(voxel, inactive_value(kind, random));
      }
    }
  tree.addTile(1, Coord(64, 64, 64), -1.25f, true);
  tree.addTile(1, Coord(80, 64, 64), -1.75f, false);
  tree.addTile(2, Coord(256, 0, 0), -outside, false);
  tree.addTile(2, Coord(0, 128, 128), 0.375f, true);
  tree.addTile(3, Coord(-4096, 0, 0), -0.25f, false);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setTransform(openvdb::math::Transform::createLinearTransform(0.5));
  return grid;
}

using VdbRead = VolumeFiles;

/// Our reading of a file beside a tree of OpenVDB's.
void expect_tree(const Volume& volume, const FloatGrid& grid) {
  const volume::GridFrame& frame = volume.grid.frame();
  const auto accessor = grid.getConstAccessor();
  std::int64_t different = 0;
  for (int z = 0; z < frame.size.z; z += 3)  // which is enough to meet every leaf
    for (int y = 0; y < frame.size.y; ++y)
      for (int x = 0; x < frame.size.x; ++x) {
        const Vec3d p = volume.origin + frame.position({x, y, z});
        const Coord at = Coord::round(grid.worldToIndex({p.x, p.y, p.z}));
        const float ours = volume.grid.at({x, y, z}), theirs = -accessor.getValue(at);
        different += std::memcmp(&ours, &theirs, sizeof ours) != 0;
      }
  EXPECT_EQ(different, 0);
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  const openvdb::Vec3d lo = grid.indexToWorld(box.min()), hi = grid.indexToWorld(box.max());
  const Vec3d first = volume.origin + frame.box().lo, last = volume.origin + frame.box().hi;
  EXPECT_TRUE(first.x < lo.x() && first.y < lo.y() && first.z < lo.z());
  EXPECT_TRUE(last.x > hi.x() && last.y > hi.y() && last.z > hi.z());
}

TEST_F(VdbRead, EveryCompressionComesBack) {
  using namespace openvdb::io;
  for (const bool half : {false, true})
    for (const int flags : {+COMPRESS_NONE, +COMPRESS_ZIP, +COMPRESS_ACTIVE_MASK, +COMPRESS_BLOSC,
                            COMPRESS_ZIP | COMPRESS_ACTIVE_MASK, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}) {
      auto grid = motley(flags + 1);
      grid->setSaveFloatAsHalf(half);
      if (flags & COMPRESS_ZIP) grid->setGridClass(openvdb::GRID_UNKNOWN);  // others are not zipped
      File file(path("a.vdb").string());
      file.setCompression(flags);
      file.write({grid});
      file.close();
      const Volume volume = read_volume(path("a.vdb"));
      EXPECT_EQ(volume.grid.precision(), half ? volume::Precision::half : volume::Precision::single);
      file.open();
      expect_tree(volume, *openvdb::gridPtrCast<FloatGrid>(file.readGrid(file.beginName().gridName())));
      file.close();
    }
}

TEST_F(VdbRead, GridsAreFoundAmongOthers) {
  const auto wanted = motley(3);
  wanted->setName("surface");
  const auto other = motley(4);
  other->setGridClass(openvdb::GRID_UNKNOWN);
  const auto vectors = openvdb::Vec3SGrid::create();
  vectors->tree().setValueOn(Coord(1, 2, 3), {1, 2, 3});
  vectors->setName("v");
  const auto shared = wanted->copy();  // shares the tree
  shared->setTransform(openvdb::math::Transform::createLinearTransform(2));
  shared->setName("shared");
  // A file that says where its grids are, and a stream that does not.
  openvdb::io::File(path("a.vdb").string()).write({vectors, other, wanted});
  expect_tree(read_volume(path("a.vdb")), *wanted);
  const auto stream = [&](const openvdb::GridCPtrVec& grids) {
    std::ofstream out(path("b.vdb"), std::ios::binary);
    openvdb::io::Stream(out).write(grids);
  };
  stream({other, wanted, vectors});
  expect_tree(read_volume(path("b.vdb")), *wanted);
  stream({vectors, wanted});
  EXPECT_THAT(tafoni::error_of([&] { read_volume(path("b.vdb")); }), HasSubstr("its grid v is of a kind"));
  for (const bool places : {true, false}) {
    const openvdb::GridCPtrVec grids = {other, wanted, shared};
    if (places)
      openvdb::io::File(path("b.vdb").string()).write(grids);
    else
      stream(grids);
    expect_tree(read_volume(path("b.vdb")), *wanted);
  }
  wanted->setGridClass(openvdb::GRID_UNKNOWN);
  wanted->setName("a");
  shared->setGridClass(openvdb::GRID_LEVEL_SET);
  stream({wanted, shared});
  expect_tree(read_volume(path("b.vdb")), *shared);
}

TEST_F(VdbRead, EveryTransformThatMovesAndScalesIsRead) {
  auto grid = motley(5);
  using namespace openvdb::math;
  const openvdb::Vec3d at(10, 20, 30), cell(0.5, 0.5, 0.5);
  openvdb::Mat4d matrix = openvdb::Mat4d::identity();
  matrix.setToScale(cell);
  matrix.setTranslation(at);
  for (const MapBase::Ptr& map : std::vector<MapBase::Ptr>{
           std::make_shared<UniformScaleMap>(0.5), std::make_shared<ScaleMap>(cell),
           std::make_shared<TranslationMap>(at), std::make_shared<UniformScaleTranslateMap>(0.5, at),
           std::make_shared<ScaleTranslateMap>(cell, at), std::make_shared<AffineMap>(matrix),
           std::make_shared<UnitaryMap>(openvdb::Vec3d(0, 0, 1), 0.0)}) {
    grid->setTransform(std::make_shared<Transform>(map));
    openvdb::io::File(path("a.vdb").string()).write({grid});
    expect_tree(read_volume(path("a.vdb")), *grid);
  }
  grid->setTransform(Transform::createFrustumTransform({{0, 0, 0}, {100, 100, 100}}, 0.5, 10));
  openvdb::io::File(path("a.vdb").string()).write({grid});
  EXPECT_THAT(tafoni::error_of([&] { read_volume(path("a.vdb")); }), HasSubstr("frustum"));
}

TEST_F(VdbRead, AnActiveTileOfTheRootIsRead) {
  openvdb::initialize();
  auto grid = FloatGrid::create(1.0f);
  grid->tree().addTile(3, Coord(0, 0, 0), -1, true);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  openvdb::io::File(path("a.vdb").string()).write({grid});
  const Volume volume = read_volume(path("a.vdb"));
  EXPECT_EQ(volume.grid.frame().size, (Vec3i{4129, 4129, 4129}));
  EXPECT_EQ(volume.grid.at({32, 32, 32}), 1);
  EXPECT_EQ(volume.grid.at({4127, 4127, 4127}), 1);
  EXPECT_EQ(volume.grid.at({31, 32, 32}), -1);
  EXPECT_EQ(volume.grid.at({4128, 32, 32}), -1);
  EXPECT_LT(volume.grid.bytes(), std::size_t{100} << 20);
}

/// Of a block of 16 by 16 by 16 tiles, `side` voxels apart.
Coord tile_place(int i, int side) {
  return {side * (i >> 8), side * (i >> 4 & 15), side * (i & 15)};
}

TEST_F(VdbRead, SmallTilesOfUnlikeValuesFillChunksOfThemselves) {
  openvdb::initialize();
  auto grid = FloatGrid::create(1.0f);
  // One tile of another value in each of 4096 chunks takes them to half a gigabyte.
  for (int i = 0; i < 4096; ++i) grid->tree().addTile(1, tile_place(i, 32), -1, true);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  openvdb::io::File(path("a.vdb").string()).write({grid});
  EXPECT_THAT(error_of([&] { read_volume(path("a.vdb")); }), HasSubstr("would take 0.54 GB of memory"));
}

TEST_F(VdbRead, SmallTilesOfOneValueTakeNoMemory) {
  openvdb::initialize();
  auto grid = FloatGrid::create(1.0f);
  for (int i = 0; i < 4096; ++i) grid->tree().addTile(1, tile_place(i, 8), -1, true);
  grid->tree().addTile(1, Coord(0, 0, 128), -1, true);
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  openvdb::io::File(path("a.vdb").string()).write({grid});
  const Volume volume = read_volume(path("a.vdb"));
  EXPECT_EQ(volume.grid.at({32 + 127, 32 + 127, 32 + 127}), 1);
  EXPECT_EQ(volume.grid.at({32 + 7, 32 + 7, 32 + 135}), 1);
  EXPECT_EQ(volume.grid.at({32 + 8, 32 + 7, 32 + 135}), -1);
}

/// "" or the sentence.
std::string said(std::string_view bytes) {
  try {
    read_volume(std::as_bytes(std::span(bytes.data(), bytes.size())), "test.vdb");
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return {};
}

TEST_F(VdbRead, EachShorterFileGivesASentence) {
  using namespace openvdb::io;
  std::size_t first = 0;
  for (const int flags : {+COMPRESS_NONE, +COMPRESS_ZIP, COMPRESS_BLOSC | COMPRESS_ACTIVE_MASK}) {
    File file(path("a.vdb").string());
    file.setCompression(flags);
    auto grid = motley(6);
    grid->setGridClass(openvdb::GRID_UNKNOWN);
    file.write({grid});
    file.close();
    const std::string good = bytes("a.vdb");
    // The three files are cut at different places, 5 bytes apart where the description stands.
    for (std::size_t n = first++; n < good.size(); n += n < 1200 ? 5 : 4099)
      ASSERT_THAT(said(std::string_view(good).substr(0, n)), HasSubstr("test.vdb: ")) << n;
    // One byte changed: a sentence or other values, and nothing worse.
    Random random(flags);
    std::set<std::string> sentences;
    for (int i = 0; i < rounds(200); ++i) {  // vdb_fuzz tries far more
      std::string bad = good;
      bad[random.below(i % 2 ? 1500 : bad.size())] = static_cast<char>(random.below(256));
      sentences.insert(said(bad));
    }
    EXPECT_GT(std::ssize(sentences), rounds(200) / 40);
  }
}

TEST_F(VdbRead, OtherVersionsAreNamed) {
  write_volume(path("a.vdb"), hollow_ball(volume::Precision::single, {40, 40, 40}));
  std::string file = bytes("a.vdb");
  file[8] = static_cast<char>(221);
  EXPECT_THAT(said(file), HasSubstr("has version 221 of the OpenVDB format"));
  EXPECT_THAT(said("VDB"), HasSubstr("another format or cut off"));
}

}  // namespace
}  // namespace tafoni::io

#endif
