#pragma once
// Volumes for tests of formats, and files that go away.

#include <bit>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include <gtest/gtest.h>

#include "tafoni/core/random.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/volume_file.h"

namespace tafoni::io {

/// A hollow ball of rock in air, limited to a band; with chunks all of rock, all of air and cut at the frame.
inline Volume hollow_ball(volume::Precision precision, Vec3i size = {101, 97, 70}, double spacing = 0.75) {
  const volume::GridFrame frame{{-12.5, 7.25, -40}, spacing, size};
  Volume out{volume::ScalarGrid(frame, -3, precision), {452300.5, 5528100.25, 120}, {}};
  const Vec3d middle = frame.box().center();
  const double radius = 0.45 * spacing * size.z;
  out.grid.edit(out.grid.samples(), [&](Vec3i first, std::span<float> row) {
    for (std::size_t i = 0; i < row.size(); ++i) {
      const double r = length(frame.position(first + Vec3i{static_cast<int>(i), 0, 0}) - middle);
      row[i] = static_cast<float>(std::clamp(std::min(radius - r, r - radius / 4), -3.0, 3.0));
    }
  });
  out.grid.compact();
  out.metadata.name = "ball";
  out.metadata.crs = "EPSG:25832";
  out.metadata.generator = {{"program", std::string("test")}, {"seed", std::int64_t{7}}, {"voxel", 0.75}};
  return out;
}

/// A folder of this test's own, removed at the end.
class VolumeFiles : public testing::Test {
 protected:
  std::filesystem::path path(const std::string& name) const { return folder_.path / name; }
  std::string bytes(const std::string& name) const {
    std::ifstream in(path(name), std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static Volume parse(const std::string& format, std::string_view bytes) {
    return read_volume(std::as_bytes(std::span(bytes.data(), bytes.size())), "test." + format);
  }

 private:
  const TestFolder folder_;
};

inline void expect_same(const Volume& a, const Volume& b) {
  EXPECT_TRUE(a.grid == b.grid);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.metadata.name, b.metadata.name);
  EXPECT_EQ(a.metadata.crs, b.metadata.crs);
  EXPECT_EQ(a.metadata.generator, b.metadata.generator);
}

}  // namespace tafoni::io
