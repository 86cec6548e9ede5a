#include "tafoni/io/source_name.h"

#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/test/test_folder.h"

namespace tafoni::io {
namespace {

namespace fs = std::filesystem;

class SourceNames : public testing::Test {
 protected:
  SourceNames() {
    fs::create_directories(folder_.path / "data");
    for (const char* name : {"sea.nc", "tile.zip", "data/deep.nc", "a:b.tif", "one.tif.gz"})
      std::ofstream(folder_.path / name) << "x";
  }
  /// "before|file|after".
  std::string split(const std::string& name) const {
    const SourceName parts = split_source(name, folder_.path);
    EXPECT_EQ(parts.text(), name);
    return parts.before + "|" + parts.file.string() + "|" + parts.after;
  }
  const TestFolder folder_;
};

TEST_F(SourceNames, PathsAreFiles) {
  for (const char* path : {"sea.nc", "a:b.tif", "data", "none.tif", "new:name.csv", "/etc/hostname", ""})
    EXPECT_EQ(split(path), std::string("|") + path + "|");
}

TEST_F(SourceNames, TheFileIsFoundInWhatIsNoPath) {
  EXPECT_EQ(split("NETCDF:sea.nc:depth"), "NETCDF:|sea.nc|:depth");
  EXPECT_EQ(split("NETCDF:\"data/deep.nc\":z"), "NETCDF:\"|data/deep.nc|\":z");
  EXPECT_EQ(split("HDF5:\"sea.nc\"://a/b"), "HDF5:\"|sea.nc|\"://a/b");
  EXPECT_EQ(split("GTIFF_DIR:2:sea.nc"), "GTIFF_DIR:2:|sea.nc|");
  EXPECT_EQ(split("/vsizip/tile.zip/data/dtm.tif"), "/vsizip/|tile.zip|/data/dtm.tif");
  EXPECT_EQ(split("/vsizip/{tile.zip}/dtm.tif"), "/vsizip/{|tile.zip|}/dtm.tif");
  EXPECT_EQ(split("/vsigzip/one.tif.gz"), "/vsigzip/|one.tif.gz|");
  EXPECT_EQ(split("/vsizip//vsigzip/one.tif.gz/x"), "/vsizip//vsigzip/|one.tif.gz|/x");
  EXPECT_EQ(split("NETCDF:\"/vsizip/tile.zip/s.nc\":z"), "NETCDF:\"/vsizip/|tile.zip|/s.nc\":z");
  const std::string absolute = (folder_.path / "tile.zip").string();
  EXPECT_EQ(split("/vsizip/" + absolute + "/x.tif"), "/vsizip/|" + absolute + "|/x.tif");
}

TEST_F(SourceNames, WhatNamesNoFileStaysAsItIs) {
  EXPECT_EQ(split("NETCDF:none.nc:z"), "NETCDF:none.nc:z||");
  EXPECT_EQ(split("/vsizip/none.zip/x.tif"), "/vsizip/none.zip/x.tif||");
  EXPECT_EQ(split("/vsicurl/https://example.org/x.tif"), "/vsicurl/https://example.org/x.tif||");
}

}  // namespace
}  // namespace tafoni::io
