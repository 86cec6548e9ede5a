// Our volumes as OpenVDB reads and meshes them, and what other programs write as we read it. OpenVDB is only
// given files that are whole.

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/io/test/volumes.h"

#ifdef TAFONI_OPENVDB

#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <utility>

#include <gmock/gmock.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>

#include "tafoni/math/half.h"

namespace tafoni::io {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using testing::HasSubstr;
using volume::Precision;

using Vdb = VolumeFiles;

void save(const std::filesystem::path& path, const openvdb::GridBase::Ptr& grid) {
  openvdb::io::File file(path.string());
  file.write({grid});
  file.close();
}

std::string told_sentence(const std::filesystem::path& path) {
  try {
    read_volume(path);
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::input);
    return error.what();
  }
  return {};
}

/// Signed, negative inside, limited to three cells, about (10, 20, 30).
FloatGrid::Ptr sphere(float radius, float cell) {
  openvdb::initialize();
  return openvdb::tools::createLevelSetSphere<FloatGrid>(radius, {10, 20, 30}, cell);
}

/// Greatest difference to a ball's distance within `reach` of its surface.
double error_of(const Volume& volume, float radius, double reach) {
  double worst = 0;
  int near = 0;
  const volume::GridFrame& frame = volume.grid.frame();
  for (int z = 0; z < frame.size.z; ++z)
    for (int y = 0; y < frame.size.y; ++y)
      for (int x = 0; x < frame.size.x; ++x) {
        const Vec3d p = volume.origin + frame.position({x, y, z});
        const double truth = radius - length(p - Vec3d{10, 20, 30});
        const double v = volume.grid.at({x, y, z});
        EXPECT_EQ(v > 0, truth > 1e-4 || (truth > -1e-4 && v > 0)) << p.x << " " << p.y << " " << p.z;
        if (std::abs(truth) > reach) continue;
        ++near;
        worst = std::max(worst, std::abs(v - truth));
      }
  EXPECT_GT(near, 1000);
  return worst;
}

TEST_F(Vdb, BitsComeBack) {
  for (const Precision precision : {Precision::single, Precision::half}) {
    const Volume volume = hollow_ball(precision);
    write_volume(path("a.vdb"), volume);
    const Volume back = read_volume(path("a.vdb"));
    expect_same(volume, back);
    EXPECT_LE(back.grid.full_chunks(), volume.grid.full_chunks());
  }
}

TEST_F(Vdb, HalfIsWithinHalfAnUlp) {
  const Volume single = hollow_ball(Precision::single), half = hollow_ball(Precision::half);
  write_volume(path("a.vdb"), half);
  const Volume back = read_volume(path("a.vdb"));
  const Vec3i n = single.grid.frame().size;
  for (int z = 0; z < n.z; ++z)
    for (int y = 0; y < n.y; ++y)
      for (int x = 0; x < n.x; ++x) {
        const float v = single.grid.at({x, y, z}), h = back.grid.at({x, y, z});
        const float ulp = std::ldexp(1.0f, std::max(std::ilogb(v == 0 ? 1e-9f : v), -14) - 10);
        ASSERT_LE(std::abs(v - h), ulp / 2);
      }
}

/// Whether one of the 26 voxels about it is on the other side of the surface.
bool beside(const FloatGrid::ConstAccessor& accessor, Coord at) {
  const bool inside = accessor.getValue(at) < 0;
  for (int i = 0; i < 27; ++i)
    if ((accessor.getValue(at.offsetBy(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1)) < 0) != inside) return true;
  return false;
}

FloatGrid::Ptr open_with_openvdb(const std::filesystem::path& path) {
  openvdb::initialize();
  openvdb::io::File file(path.string());
  file.open();
  const auto grid = openvdb::gridPtrCast<FloatGrid>(file.readGrid("surface"));
  file.close();
  return grid;
}

TEST_F(Vdb, OpenVdbSeesALevelSet) {
  const Volume volume = hollow_ball(Precision::single);
  write_volume(path("a.vdb"), volume);
  const FloatGrid::Ptr grid = open_with_openvdb(path("a.vdb"));
  ASSERT_TRUE(grid);
  EXPECT_EQ(grid->getGridClass(), openvdb::GRID_LEVEL_SET);
  EXPECT_EQ(grid->background(), 3);
  EXPECT_TRUE(grid->hasUniformVoxels());
  EXPECT_EQ(grid->voxelSize().x(), 0.75);
  const volume::GridFrame& frame = volume.grid.frame();
  auto accessor = grid->getConstAccessor();
  for (int z = -3; z < frame.size.z + 3; ++z)
    for (int y = 0; y < frame.size.y; ++y)
      for (int x = -3; x < frame.size.x + 3; ++x) {
        const bool within = x >= 0 && x < frame.size.x && z >= 0 && z < frame.size.z;
        const float expected = within ? -volume.grid.at({x, y, z}) : 3;
        ASSERT_EQ(accessor.getValue(Coord(x, y, z)), expected) << x << " " << y << " " << z;
        ASSERT_EQ(accessor.isValueOn(Coord(x, y, z)), std::abs(expected) < 3 || beside(accessor, {x, y, z}));
      }
  // Programs keep places as floats: what is in the file is local, and the world's origin stands beside it.
  const openvdb::Vec3d at = grid->indexToWorld(Coord(7, 8, 9));
  const Vec3d local = frame.position({7, 8, 9});
  EXPECT_EQ(at, openvdb::Vec3d(local.x, local.y, local.z));
  const auto world = grid->getMetadata<openvdb::Vec3DMetadata>("world_origin");
  ASSERT_TRUE(world);
  EXPECT_EQ(world->value(), openvdb::Vec3d(volume.origin.x, volume.origin.y, volume.origin.z));
  // The ball and its hollow: deep rock and air are tiles, not voxels.
  EXPECT_LT(grid->activeVoxelCount(), grid->evalActiveVoxelBoundingBox().volume() / 2);
}

TEST_F(Vdb, VdbPrintOpensIt) {
  if (std::system("command -v vdb_print >/dev/null 2>&1") != 0)
    GTEST_SKIP() << "vdb_print is not installed (package libopenvdb-tools)";
  write_volume(path("a.vdb"), hollow_ball(Precision::half));
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(
      ::popen(("vdb_print -m '" + path("a.vdb").string() + "' 2>&1").c_str(), "r"), ::pclose);
  ASSERT_TRUE(pipe);
  std::string said;
  for (char line[256]; std::fgets(line, sizeof line, pipe.get());) said += line;
  EXPECT_THAT(said, HasSubstr("surface"));
  EXPECT_THAT(said, HasSubstr("level set"));
  EXPECT_THAT(said, HasSubstr("0.75"));
  EXPECT_THAT(said, HasSubstr("EPSG:25832"));
}

TEST_F(Vdb, ReadsLevelSetsOfOthers) {
  for (const float cell : {0.5f, 0.3f}) {
    save(path("a.vdb"), sphere(8, cell));
    const Volume volume = read_volume(path("a.vdb"));
    EXPECT_NEAR(volume.grid.frame().spacing, cell, 1e-6);
    EXPECT_LT(error_of(volume, 8, 2.5 * cell), 1e-4);
  }
}

TEST_F(Vdb, GridsWithoutAClassAreToldApartBySign) {
  auto grid = sphere(8, 0.5);
  grid->setGridClass(openvdb::GRID_UNKNOWN);
  save(path("a.vdb"), grid);
  EXPECT_LT(error_of(read_volume(path("a.vdb")), 8, 1.2), 1e-4);
}

TEST_F(Vdb, FogIsSolidWhereItIsHalfDense) {
  for (const openvdb::GridClass own : {openvdb::GRID_FOG_VOLUME, openvdb::GRID_UNKNOWN}) {
    auto grid = sphere(8, 0.5);
    openvdb::tools::sdfToFogVolume(*grid);  // from 0 at the surface to 1 three cells within
    grid->setGridClass(own);
    grid->setName("density");
    save(path("a.vdb"), grid);
    const Volume volume = read_volume(path("a.vdb"));
    const volume::GridFrame& frame = volume.grid.frame();
    // Half dense is half of those three cells within.
    const double radius = 8 - 0.75;
    for (int i = 0; i < frame.size.x; ++i) {
      const Vec3d p = volume.origin + frame.position({i, frame.size.y / 2, frame.size.z / 2});
      const double inside = radius - length(p - Vec3d{10, 20, 30});
      if (std::abs(inside) > 0.02) {
        EXPECT_EQ(volume.grid.at({i, frame.size.y / 2, frame.size.z / 2}) > 0, inside > 0) << inside;
      }
    }
    const Interval range = volume.grid.range(frame.box());
    EXPECT_EQ(range.lo, -0.5f);
    EXPECT_EQ(range.hi, 0.5f);
  }
}

TEST_F(Vdb, RefusesWhatItCannotHold) {
  auto grid = sphere(8, 0.5);
  const auto with = [&](const openvdb::Mat4d& m) {
    grid->setTransform(openvdb::math::Transform::createLinearTransform(m));
    save(path("a.vdb"), grid);
    return told_sentence(path("a.vdb"));
  };
  openvdb::Mat4d m = openvdb::Mat4d::identity();
  m[2][2] = 2;
  EXPECT_THAT(with(m), HasSubstr("unequal sides"));
  m.setToRotation(openvdb::Vec3d(0, 0, 1), 0.3);
  EXPECT_THAT(with(m), HasSubstr("turned"));
  m = openvdb::Mat4d::identity();
  m[0][0] = m[1][1] = m[2][2] = -1;
  EXPECT_THAT(with(m), HasSubstr("mirrored"));

  save(path("b.vdb"), openvdb::DoubleGrid::create(1.0));
  EXPECT_THAT(told_sentence(path("b.vdb")), HasSubstr("double"));
  save(path("c.vdb"), FloatGrid::create(1.0f));
  EXPECT_THAT(told_sentence(path("c.vdb")), HasSubstr("no active voxels"));
}

TEST_F(Vdb, RefusedFramesNameTheFile) {
  openvdb::initialize();
  const auto with = [&](openvdb::Vec3i size, openvdb::Vec3d world) {
    auto grid = FloatGrid::create(1.0f);
    grid->tree().setValueOn(Coord(1, 1, 1), -1);
    grid->insertMeta("tafoni_size", openvdb::Vec3IMetadata(size));
    grid->insertMeta("world_origin", openvdb::Vec3DMetadata(world));
    save(path("d.vdb"), grid);
    return told_sentence(path("d.vdb"));
  };
  const openvdb::Vec3d zero(0, 0, 0);
  EXPECT_EQ(with({9, 9, 9}, zero), "");
  constexpr int most = std::numeric_limits<int>::max();
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  for (const openvdb::Vec3i& size :
       {openvdb::Vec3i(1 << 20, 1 << 20, 2), {most, 16, 16}, {-most, 9, 9}, {most, most, most}})
    EXPECT_THAT(with(size, zero), HasSubstr("d.vdb: ")) << size;
  EXPECT_THAT(with({9, 9, 9}, {0, nan, 0}), HasSubstr("d.vdb: "));
}

TEST_F(Vdb, VoxelsAtTheEndsOfTheIndexSpaceAreRefused) {
  openvdb::initialize();
  constexpr int most = std::numeric_limits<int>::max(), least = std::numeric_limits<int>::min();
  for (const auto& [lo, hi] : {std::pair{least, least + 3}, {most - 3, most}, {least, most}, {-5, 1 << 30}}) {
    auto grid = FloatGrid::create(1.0f);
    for (const int x : {lo, hi}) grid->tree().setValueOn(Coord(x, 0, 0), -1);
    save(path("e.vdb"), grid);
    EXPECT_THAT(told_sentence(path("e.vdb")), HasSubstr("indices")) << lo << " " << hi;
  }
  auto far = FloatGrid::create(1.0f);  // as far out as can be read
  for (int i = 0; i < 3; ++i) far->tree().setValueOn(Coord(most - 8 + i, 0, least + 9 + i), -1);
  save(path("f.vdb"), far);
  EXPECT_EQ(told_sentence(path("f.vdb")), "");
}

TEST_F(Vdb, WhatOthersAddBeyondTheFrameIsRead) {
  const Volume volume = hollow_ball(Precision::single, {40, 40, 40});
  write_volume(path("a.vdb"), volume);
  const auto changed = [&](const auto& change) {
    const FloatGrid::Ptr grid = open_with_openvdb(path("a.vdb"));
    change(*grid);
    save(path("b.vdb"), grid);
    return read_volume(path("b.vdb"));
  };
  const auto world = [](const Volume& v, Vec3i sample) { return v.origin + v.grid.frame().position(sample); };
  // A voxel of rock on each side: every sample is where it was, the new ones too.
  const Volume larger = changed([](FloatGrid& grid) {
    grid.tree().setValueOn(Coord(-20, 5, 5), -2);
    grid.tree().setValueOn(Coord(5, 5, 70), -2);
  });
  const volume::GridFrame& frame = larger.grid.frame();
  const auto value = [&](Vec3i index) {
    const Vec3d at = (world(volume, index) - larger.origin - frame.origin) * (1 / frame.spacing);
    const Vec3i sample{static_cast<int>(std::lround(at.x)), static_cast<int>(std::lround(at.y)),
                       static_cast<int>(std::lround(at.z))};
    EXPECT_NEAR(length(world(larger, sample) - world(volume, index)), 0, 1e-9);
    EXPECT_TRUE(sample.x >= 0 && sample.y >= 0 && sample.z >= 0 && sample.x < frame.size.x &&
                sample.y < frame.size.y && sample.z < frame.size.z);
    return larger.grid.at(sample);
  };
  EXPECT_EQ(value({-20, 5, 5}), 2);
  EXPECT_EQ(value({5, 5, 70}), 2);
  EXPECT_EQ(value({-10, 5, 5}), -3);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(value({i, 20, 20}), volume.grid.at({i, 20, 20}));
  // A grid that was moved is read where it is now.
  const Volume moved = changed([](FloatGrid& grid) { grid.transform().postTranslate({100, 0, -7}); });
  EXPECT_NEAR(length(world(moved, {3, 4, 5}) - world(volume, {3, 4, 5}) - Vec3d{100, 0, -7}), 0, 1e-9);
  // Of a part cut out the frame stays, with air where nothing is left.
  const Volume part = changed([](FloatGrid& grid) { grid.clip(openvdb::CoordBBox(10, 0, 0, 25, 39, 39)); });
  EXPECT_EQ(part.grid.frame(), volume.grid.frame());
  EXPECT_EQ(part.origin, volume.origin);
  for (int i = 0; i < 40; ++i)
    EXPECT_EQ(part.grid.at({i, 20, 20}), i >= 10 && i <= 25 ? volume.grid.at({i, 20, 20}) : -3) << i;
}

TEST_F(Vdb, CutOffFilesGiveASentence) {
  write_volume(path("a.vdb"), hollow_ball(Precision::single, {40, 40, 40}));
  const std::string good = bytes("a.vdb");
  for (const double share : {0.0, 0.001, 0.01, 0.1, 0.4, 0.7, 0.95}) {
    const auto n = static_cast<std::size_t>(share * static_cast<double>(good.size()));
    try {
      parse("vdb", std::string_view(good).substr(0, n));
      ADD_FAILURE() << n << " of " << good.size() << " bytes were read";
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr("test.vdb: "));
    }
  }
  EXPECT_THAT(tafoni::error_of([] { parse("vdb", "solid ball\nendsolid\n"); }),
              HasSubstr("test.vdb: does not begin as an OpenVDB file does"));
}

}  // namespace
}  // namespace tafoni::io

#else

namespace tafoni::io {
namespace {

using Vdb = VolumeFiles;

TEST_F(Vdb, WithoutOpenVdbItSaysSo) {
  EXPECT_NE(tafoni::error_of([&] {
              write_volume(path("a.vdb"), hollow_ball(volume::Precision::single));
            }).find("this build has no OpenVDB"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(path("a.vdb")));
}

}  // namespace
}  // namespace tafoni::io

#endif
