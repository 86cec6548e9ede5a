// A file that no driver takes is often one beside, around or in place of the data: the header of raw pixels,
// an archive, a tile that has lost the name which says where it lies. GDAL is asked about what is near it.

#include <algorithm>
#include <string_view>

#include "tafoni/core/input_file.h"
#include "tafoni/io/impl/gdal.h"
#include "tafoni/io/impl/gdal_names.h"

namespace tafoni::io::impl {
namespace {

namespace fs = std::filesystem;

/// Entries of an archive that are looked at for one that can be read.
constexpr int most_entries = 1000;
/// Endings of files that say something of data beside them, and of such data.
constexpr std::string_view words_endings[] = {".hdr", ".prj",  ".tfw", ".wld", ".pgw", ".jgw",
                                              ".rdc", ".sgrd", ".gri", ".dbf", ".shx", ".cpg",
                                              ".xml", ".aux",  ".ovr", ".msk", ".rsc"};
constexpr const char* data_endings[] = {"",     ".img", ".bil", ".bip",  ".bsq",  ".flt", ".dat",
                                        ".bin", ".raw", ".tif", ".tiff", ".sdat", ".rst", ".grd",
                                        ".dem", ".asc", ".shp", ".png",  ".jpg"};

bool is_identified(const std::string& name, unsigned flags) {
  return GDALIdentifyDriverEx(name.c_str(), flags, listed_drivers(flags), nullptr) != nullptr;
}

/// How GDAL enters an archive; empty when the file is none.
std::string archive_prefix(const fs::path& path) {
  const std::string head = InputFile(path).first(512);
  if (head.starts_with("PK\x03\x04")) return "/vsizip/";
  if (head.size() > 262 && head.compare(257, 5, "ustar") == 0) return "/vsitar/";
  if (!head.starts_with("\x1f\x8b")) return "";
  return path.extension() == ".tgz" || path.stem().extension() == ".tar" ? "/vsitar/" : "/vsigzip/";
}

std::string archive_advice(const std::string& prefix, const fs::path& path, unsigned flags) {
  const std::string inside = prefix + path.string();
  if (prefix == "/vsigzip/") return fmt::format("it is packed; unpack it, or give {}", inside);
  std::string found;
  VSIDIR* const entries = VSIOpenDir(inside.c_str(), -1, nullptr);
  for (int i = 0; entries != nullptr && found.empty() && i < most_entries; ++i) {
    const VSIDIREntry* const entry = VSIGetNextDirEntry(entries);
    if (entry == nullptr) break;
    const std::string name = inside + "/" + entry->pszName;
    if (!VSI_ISDIR(entry->nMode) && is_identified(name, flags)) found = name;
  }
  VSICloseDir(entries);
  if (found.empty()) return "it is an archive, and holds nothing that is read as such";
  return fmt::format("it is an archive; name the file in it: {}", found);
}

}  // namespace

std::string advice_for(const fs::path& path, unsigned flags) {
  std::error_code code;
  if (!fs::is_regular_file(path, code)) return "";
  const GdalMessages unheard;
  if (const std::string prefix = archive_prefix(path); !prefix.empty())
    return archive_advice(prefix, path, flags);
  std::string ending = path.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  const bool words =
      std::find(std::begin(words_endings), std::end(words_endings), ending) != std::end(words_endings);
  for (const char* beside : data_endings) {
    if (!words) break;
    fs::path data = path;
    data.replace_extension() += beside;
    if (data != path && fs::is_regular_file(data, code) && is_identified(data.string(), flags))
      return fmt::format("it goes with {}, which holds the data; name that", data.string());
  }
  if (ending == ".hgt")
    return "the name of such a tile says where it lies, as N43E005.hgt does; give it its own back";
  return "";
}

}  // namespace tafoni::io::impl
