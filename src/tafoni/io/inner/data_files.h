#pragma once
// Which files GDAL reads when it is given one.

#include <filesystem>
#include <vector>

namespace tafoni::io {

/// The file that a name stands for, also one in which GDAL finds a part ("/vsizip/a.zip/b.tif",
/// "NETCDF:a.nc:z"), and those beside it that are read along with it (.tfw, .aux.xml, .dbf …). Only what is
/// there is listed, a folder is not looked into, and of a name that stands for no file nothing is left.
std::vector<std::filesystem::path> data_files(const std::filesystem::path& name);

}  // namespace tafoni::io
