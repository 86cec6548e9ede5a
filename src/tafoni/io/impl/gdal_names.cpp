// GDAL takes nearly any text for the name of a data set: URLs, databases, XML, other programs' memory. Only
// regular files get to it, archives of them, and parts of files by the few prefixes listed
// here.

#include "tafoni/io/impl/gdal_names.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "tafoni/core/error.h"
#include "tafoni/core/input_file.h"
#include "tafoni/io/inner/data_files.h"
#include "tafoni/io/network.h"

namespace tafoni::io {
namespace impl {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view file_systems = "/vsi";
/// Those of GDAL's that unpack a file of this machine; all others are refused, or lead to the network.
constexpr std::string_view archive_prefixes[] = {"/vsizip/", "/vsitar/", "/vsigzip/"};
/// What GDAL's drivers put before a file's name to mean a part of it.
constexpr std::string_view part_prefixes[] = {"NETCDF:", "BAG:", "GTIFF_DIR:", "GPKG:"};
/// A path that was put into its normal form has one slash less than a URL.
constexpr std::string_view url_prefixes[] = {"http:/", "https:/", "ftp:/"};

/// What GDAL reads along with a file: by this in place of its ending, or after it.
constexpr std::string_view side_endings[] = {".aux.xml", ".msk", ".ovr", ".tfw", ".wld", ".pgw", ".jgw",
                                             ".prj",     ".hdr", ".dbf", ".shx", ".cpg", ".aux", ".rrd"};
/// The files of an Arc/Info grid, which is a folder; any of them is named for it.
constexpr std::string_view grid_files[] = {"dblbnd.adf", "hdr.adf",     "prj.adf",
                                           "sta.adf",    "w001001.adf", "w001001x.adf"};

bool starts_with_any(std::string_view name, const auto& prefixes) {
  return std::any_of(std::begin(prefixes), std::end(prefixes),
                     [&](std::string_view prefix) { return name.starts_with(prefix); });
}

bool is_regular(const fs::path& path) {
  std::error_code code;
  return fs::is_regular_file(path, code);
}

/// The longest beginning of a path that is a regular file.
std::optional<fs::path> file_above(fs::path path) {
  for (; !path.empty() && path != path.root_path(); path = path.parent_path())
    if (is_regular(path)) return path;
  return {};
}

std::string upper(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::toupper(c); });
  return out;
}

/// Beside `file`, whatever it is.
std::vector<fs::path> present_side_files(const fs::path& file) {
  std::vector<fs::path> out;
  std::error_code code;
  const auto add = [&](const fs::path& path) {
    if (path != file && fs::exists(path, code) && std::find(out.begin(), out.end(), path) == out.end())
      out.push_back(path);
  };
  for (const std::string_view ending : side_endings)
    for (const std::string& written : {std::string(ending), upper(ending)}) {
      fs::path replaced = file;
      add(replaced.replace_extension() += written);
      fs::path appended = file;
      add(appended += written);
    }
  if (file.extension() == ".adf")
    for (const std::string_view name : grid_files) add(file.parent_path() / name);
  return out;
}

std::string gdal_url(const std::string& name) {
  if (!starts_with_any(name, url_prefixes)) return name;
  const auto colon = name.find(':'), host = name.find_first_not_of('/', colon + 1);
  return "/vsicurl/" + name.substr(0, colon) + "://" + (host == name.npos ? "" : name.substr(host));
}

void check_regular(const fs::path& path, const char* what) {
  if (InputFile(path).size() == 0)
    fail(ErrorKind::input, "{} is empty (0 bytes); it is not {}.", path.string(), what);
  check_hdf5(path);
  for (const fs::path& side : present_side_files(path)) {
    std::error_code code;
    if (!fs::is_regular_file(side, code) || looks_like_vrt(side.string()))
      fail(ErrorKind::input,
           "{} would be read along with {}, and is no such file as its name says; put it elsewhere.",
           side.string(), path.string());
    check_hdf5(side);
  }
}

/// What is packed cannot be looked into as check_hdf5() does.
void check_packed(const std::string& name) {
  const bool part = starts_with_any(name, part_prefixes);
  if (part ? on_network(name) || name.find(file_systems) != std::string::npos : holds_hdf5(name))
    fail(ErrorKind::input,
         "{} is a netCDF or BAG file within an archive or on the network; fetch or unpack it, and name that.",
         name);
}

}  // namespace

bool on_network(const std::string& name) {
  if (starts_with_any(name, url_prefixes) || name.find("://") != std::string::npos) return true;
  for (auto at = name.find(file_systems); at != std::string::npos; at = name.find(file_systems, at + 1))
    if (!starts_with_any(std::string_view(name).substr(at), archive_prefixes)) return true;
  return false;
}

std::optional<fs::path> file_in_name(const std::string& name) {
  if (on_network(name)) return {};
  std::string_view rest = name;
  bool composed = false;
  const auto strip = [&](const auto& prefixes) {
    for (const std::string_view prefix : prefixes)
      if (rest.starts_with(prefix)) {
        rest.remove_prefix(prefix.size());
        return composed = true;
      }
    return false;
  };
  if (strip(part_prefixes)) {
    // The file stands between quotes, or as one of the pieces between colons.
    std::string_view left = rest;
    rest = {};
    while (!left.empty() && rest.empty()) {
      const char end = left.front() == '"' ? '"' : ':';
      if (end == '"') left.remove_prefix(1);
      const std::string_view piece = left.substr(0, left.find(end));
      left.remove_prefix(std::min(left.size(), piece.size() + 1));
      if (is_regular(piece) || starts_with_any(piece, archive_prefixes)) rest = piece;
    }
  }
  while (strip(archive_prefixes)) {
  }
  if (!composed || rest.empty()) return {};
  return file_above(fs::path(rest));
}

std::string checked_name(const fs::path& path, const char* what) {
  const std::string name = path.string();
  std::error_code code;
  const fs::file_status status = fs::status(path, code);
  if (fs::is_directory(status))
    fail(ErrorKind::input, "{} is a folder, not {}; name the file in it.", name, what);
  if (fs::exists(status)) {
    check_regular(path, what);
    // What is a file is not to be taken for a name that GDAL composes.
    return path.is_absolute() || name.starts_with('.') ? name : "./" + name;
  }
  if (on_network(name)) {
    if (!network_allowed())
      fail(ErrorKind::input, "{} is not on this machine; fetch it, or give --allow-network.", name);
    const std::string url = gdal_url(name);
    check_packed(url);
    return url;
  }
  const auto file = file_in_name(name);
  if (!file) fail(ErrorKind::input, "{}: there is no such file; check the path.", name);
  check_regular(*file, what);
  check_packed(name);
  return name;
}

bool inside(const fs::path& file, const fs::path& owner) {
  // Empty where it cannot be found out.
  const auto whole = [](const fs::path& path) {
    std::error_code code;
    const fs::path absolute = fs::absolute(path, code);
    const fs::path real = code ? fs::path() : fs::weakly_canonical(absolute, code);
    return code ? fs::path() : real;
  };
  const fs::path folder = whole(owner).parent_path(), where = whole(file);
  const auto [end, ignored] = std::mismatch(folder.begin(), folder.end(), where.begin(), where.end());
  return !folder.empty() && end == folder.end();
}

void check_inside(const fs::path& file, const fs::path& owner, std::string_view advice) {
  if (inside(file, owner)) return;
  fail(ErrorKind::input, "{} names {}, which does not lie in its folder; {}.", owner.string(), file.string(),
       advice);
}

}  // namespace impl

std::vector<std::filesystem::path> data_files(const std::filesystem::path& name) {
  std::error_code code;
  std::filesystem::path file = name;
  if (!std::filesystem::exists(name, code)) {
    const auto inside = impl::file_in_name(name.string());
    if (!inside) return {};
    file = *inside;
  }
  std::vector<std::filesystem::path> out{file};
  const auto sides = impl::present_side_files(file);
  out.insert(out.end(), sides.begin(), sides.end());
  return out;
}

}  // namespace tafoni::io
