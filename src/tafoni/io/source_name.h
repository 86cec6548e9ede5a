#pragma once
// Names of inputs that are no paths: a file in an archive, one of several rasters in a file.

#include <filesystem>
#include <string>

namespace tafoni::io {

/// "/vsizip/tile.zip/dtm.tif" or "NETCDF:\"sea.nc\":depth", taken apart around the file that must be there.
struct SourceName {
  std::string before;
  std::filesystem::path file;  ///< empty where the name is no path, and no part of it is a file
  std::string after;

  bool plain() const { return before.empty() && after.empty(); }
  std::string text() const { return before + file.string() + after; }
};

/// Takes a name as GDAL takes it apart; relative files are looked for in `directory`, or where the program
/// runs when that is empty. What is no such name is a path: all of it is the file.
SourceName split_source(const std::string& name, const std::filesystem::path& directory);

}  // namespace tafoni::io
