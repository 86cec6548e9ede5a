#pragma once
// Names that users and files give, and what GDAL may make of them.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tafoni::io::impl {

/// Whether a name leads to the network: a URL, or one of GDAL's file systems that are not this machine's.
bool on_network(const std::string& name);

/// The file of this machine in which a name that GDAL composes finds a part: "/vsizip/a.zip/b.tif" names
/// a.zip, "NETCDF:a.nc:z" names a.nc. Nothing when the name is none of the known kinds or there is no such
/// file.
std::optional<std::filesystem::path> file_in_name(const std::string& name);

/// The name that GDAL is to be given. Throws Error{input}: missing, a folder, a pipe or a device, empty; on
/// the network, which is not allowed; a side file that is no regular file; an HDF5 file that leads to others.
/// `what` is "an elevation model".
std::string checked_name(const std::filesystem::path& path, const char* what);

/// Throws Error{input} where the file at `path` is a VRT that names anything beyond its own folder, unless
/// that is allowed, directly or through others, or that holds more than a mosaic of files.
void check_vrt(const std::filesystem::path& path);

/// Throws Error{input} where the file at `path` is an HDF5 file, as netCDF and BAG may be, that takes data
/// from other files, or one that cannot be looked through.
void check_hdf5(const std::filesystem::path& path);
/// Whether what GDAL opens by a name is an HDF5 file, to any of its drivers.
bool holds_hdf5(const std::string& name);

/// Whether `file` lies in the folder of `owner` or below it.
bool inside(const std::filesystem::path& file, const std::filesystem::path& owner);
/// Throws Error{input} unless it does, with what to do about it.
void check_inside(const std::filesystem::path& file, const std::filesystem::path& owner,
                  std::string_view advice);

/// Whether what GDAL opens by a name begins as a VRT does, whatever the name says.
bool looks_like_vrt(const std::string& name);

}  // namespace tafoni::io::impl
