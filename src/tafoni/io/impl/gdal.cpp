// GDAL is set up once, its messages are collected by thread, and what it opens is checked beforehand, so
// that every failure is one sentence of ours.

#include "tafoni/io/impl/gdal.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <mutex>
#include <string_view>

#include <cpl_conv.h>
#include <cpl_http.h>
#include <ogr_srs_api.h>

#include "tafoni/io/impl/gdal_names.h"
#include "tafoni/io/network.h"

namespace tafoni::io::impl {
namespace {

/// Formats that hold elevations, or a mask of a region, and that name no other files but by their own name.
/// A VRT does; it is checked before it is opened.
constexpr std::array raster_drivers = {"GTiff",       "VRT",
                                       "AAIGrid",     "GRASSASCIIGrid",
                                       "ISG",         "ENVI",
                                       "EHdr",        "HFA",
                                       "AIG",         "DTED",
                                       "SRTMHGT",     "USGSDEM",
                                       "SDTS",        "XYZ",
                                       "GSAG",        "GSBG",
                                       "GS7BG",       "NWT_GRD",
                                       "GXF",         "ZMap",
                                       "BT",          "Terragen",
                                       "HF2",         "Leveller",
                                       "SAGA",        "RST",
                                       "PCRaster",    "netCDF",
                                       "BAG",         "GRIB",
                                       "GPKG",        "MBTiles",
                                       "JP2OpenJPEG", "PNG",
                                       "JPEG",        "WEBP",
                                       "BMP",         "PNM",
                                       "GIF",         "RRASTER",
                                       "ROI_PAC",     "LCP",
                                       "GTX",         "ACE2",
                                       "JDEM",        static_cast<const char*>(nullptr)};
constexpr std::array vector_drivers = {
    "GeoJSON", "GeoJSONSeq",   "TopoJSON", "ESRI Shapefile",
    "GPKG",    "FlatGeobuf",   "KML",      "LIBKML",
    "GPX",     "DXF",          "GML",      "CSV",
    "JML",     "MapInfo File", "OGR_GMT",  static_cast<const char*>(nullptr)};
/// GDAL's file systems that stay on this machine, and within a file that was asked for.
constexpr std::string_view local_systems[] = {"/vsizip/", "/vsitar/", "/vsigzip/", "/vsisubfile/",
                                              "/vsimem/"};

void CPL_STDCALL ignore(CPLErr, CPLErrorNum, const char*) {}

CPLHTTPResult* fetch_nothing(const char*, CSLConstList, GDALProgressFunc, void*, CPLHTTPFetchWriteFunc, void*,
                             void*) {
  return nullptr;
}

/// Whatever way a file finds around the checks of names, nothing answers there.
void shut_network() {
  CPLHTTPSetFetchCallback(fetch_nothing, nullptr);
  OSRSetPROJEnableNetwork(FALSE);
  VSIFilesystemPluginCallbacksStruct* const nothing = VSIAllocFilesystemPluginCallbacksStruct();
  nothing->open = [](void*, const char*, const char*) -> void* { return nullptr; };
  nothing->stat = [](void*, const char*, VSIStatBufL*, int) { return -1; };
  char** const systems = VSIGetFileSystemsPrefixes();
  for (int i = 0; i < CSLCount(systems); ++i)
    if (std::find(std::begin(local_systems), std::end(local_systems), std::string_view(systems[i])) ==
        std::end(local_systems))
      VSIInstallPluginHandler(systems[i], nothing);
  CSLDestroy(systems);
  VSIFreeFilesystemPluginCallbacksStruct(nothing);
}

GDALDriver* kept_memory_driver = nullptr;

/// GDAL's own nested opens ask all drivers there are, so others than the listed are taken away.
void keep_listed_drivers() {
  GDALDriverManager& manager = *GetGDALDriverManager();
  const auto listed = [](const char* name, const auto& list) {
    return std::any_of(list.begin(), list.end() - 1,
                       [&](const char* other) { return std::string_view(name) == other; });
  };
  for (int i = manager.GetDriverCount() - 1; i >= 0; --i) {
    GDALDriver* const driver = manager.GetDriver(i);
    const char* const name = driver->GetDescription();
    if (listed(name, raster_drivers) || listed(name, vector_drivers)) continue;
    manager.DeregisterDriver(driver);
    if (driver != kept_memory_driver) GDALDestroyDriver(driver);
  }
}

/// The sentence of a file that no driver takes.
[[noreturn]] void fail_unknown(const std::filesystem::path& path, unsigned flags, const char* what,
                               const GdalMessages& messages) {
  const std::string advice = advice_for(path, flags);
  if (!advice.empty()) fail(ErrorKind::input, "{} cannot be read as {}: {}.", path.string(), what, advice);
  if (messages.failed())
    fail(ErrorKind::input, "{} cannot be read as {}: {}.", path.string(), what, messages.reason());
  fail(ErrorKind::input,
       "{} cannot be read as {}: it is none of the formats that are read, or damaged from its start; convert "
       "it to {}.",
       path.string(), what, flags & GDAL_OF_RASTER ? "GeoTIFF" : "GeoJSON");
}

}  // namespace

void ensure_gdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    const bool ours = GetGDALDriverManager()->GetDriverCount() == 0;
    if (ours) {
      // Helper threads of GDAL's have no handler of ours on their stack.
      CPLSetErrorHandler(ignore);
      // PROJ contexts that GDAL's GeoTIFF library makes for itself print to stderr otherwise.
      ::setenv("PROJ_DEBUG", "0", 0);
    }
    GDALAllRegister();
    kept_memory_driver = GetGDALDriverManager()->GetDriverByName("MEM");
    if (ours) {
      keep_listed_drivers();
      if (!network_allowed()) shut_network();
      // Views of a stranger's database may call only what cannot do harm.
      CPLSetConfigOption("OGR_SQLITE_PRAGMA", "trusted_schema=OFF");
    }
    if (CPLGetConfigOption("GDAL_CACHEMAX", nullptr) == nullptr) GDALSetCacheMax64(GIntBig{64} << 20);
  });
}

const char* const* listed_drivers(unsigned flags) {
  return flags & GDAL_OF_RASTER ? raster_drivers.data() : vector_drivers.data();
}

GDALDriver& memory_driver() {
  ensure_gdal();
  return *kept_memory_driver;
}

GdalMessages::GdalMessages() {
  ensure_gdal();
  CPLPushErrorHandlerEx(collect, this);
}

GdalMessages::~GdalMessages() {
  CPLPopErrorHandler();
  CPLErrorReset();
}

void CPL_STDCALL GdalMessages::collect(CPLErr kind, CPLErrorNum, const char* text) {
  if (kind != CE_Failure && kind != CE_Fatal) return;
  auto& self = *static_cast<GdalMessages*>(CPLGetErrorHandlerUserData());
  if (!self.failed_) self.first_ = text;
  self.failed_ = true;
}

std::string GdalMessages::reason() const {
  std::string text = first_;
  std::replace(text.begin(), text.end(), '\n', ' ');
  while (!text.empty() && (text.back() == '.' || text.back() == ' ')) text.pop_back();
  return text;
}

std::string GdalMessages::because() const {
  const std::string text = reason();
  return text.empty() ? text : " (" + text + ")";
}

DatasetPtr open_dataset(const std::filesystem::path& path, unsigned flags, const char* what) {
  GdalMessages messages;
  const std::string name = checked_name(path, what);
  std::error_code code;
  const bool file = std::filesystem::is_regular_file(path, code);
  const bool vrt = looks_like_vrt(name);
  if (vrt && !file)
    fail(ErrorKind::input,
         "{} is a mosaic within an archive or on the network; fetch or unpack it, and name that.",
         path.string());
  if (vrt) check_vrt(path);
  // Drivers object to each other's options, which is not shown. Grids of text may hold "nan", or a fraction
  // far down, where their first lines look like whole numbers.
  const char* const options[] = {"NUM_THREADS=ALL_CPUS", "DATATYPE=Float64", nullptr};
  DatasetPtr dataset(GDALDataset::Open(name.c_str(), flags | GDAL_OF_READONLY, listed_drivers(flags),
                                       flags & GDAL_OF_RASTER ? options : nullptr, nullptr));
  if (!dataset) fail_unknown(path, flags, what, messages);
  // Overviews are opened when they are counted, from where this says.
  if (dataset->GetMetadataItem("OVERVIEW_FILE", "OVERVIEWS") != nullptr)
    fail(ErrorKind::input, "{} names overviews in another file, which are not read; make a GeoTIFF of it.",
         path.string());
  if (vrt) return dataset;
  char** const files = dataset->GetFileList();
  const std::vector<std::string> together(files, files + CSLCount(files));
  CSLDestroy(files);
  for (const std::string& other : together) {
    // Side files lie beside the name given, which may be a link to elsewhere.
    if (file && std::filesystem::path(other).parent_path() != std::filesystem::path(name).parent_path())
      check_inside(other, path, "copy that file there, or move it to a folder above all that it names");
    if (looks_like_vrt(other))
      fail(ErrorKind::input, "{} leads to a mosaic of other files, {}; put that elsewhere.", path.string(),
           other);
  }
  return dataset;
}

OGRSpatialReference crs_from_wkt(const std::string& wkt) {
  GdalMessages messages;
  OGRSpatialReference crs;
  // What is given may come from a stranger's file: no file is opened for it, and no URL.
  if (crs.SetFromUserInput(wkt.c_str(), OGRSpatialReference::SET_FROM_USER_INPUT_LIMITATIONS_get()) !=
      OGRERR_NONE)
    fail(ErrorKind::input, "the coordinate system \"{}\" is not understood; give WKT or EPSG:NUMBER.",
         wkt.substr(0, 60));
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
}

std::string name_of(const OGRSpatialReference& crs) {
  const char* name = crs.GetName();
  return name != nullptr ? name : "an unnamed system";
}

std::string to_wkt(const OGRSpatialReference& crs) {
  char* text = nullptr;
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  const OGRErr error = crs.exportToWkt(&text, options);
  std::string out = error == OGRERR_NONE && text != nullptr ? text : "";
  CPLFree(text);
  return out;
}

std::string short_crs(const std::string& wkt) {
  OGRSpatialReference crs;
  try {
    crs = crs_from_wkt(wkt);
  } catch (const Error&) {
    return wkt;
  }
  const char *authority = crs.GetAuthorityName(nullptr), *code = crs.GetAuthorityCode(nullptr);
  if (authority != nullptr && code != nullptr) return fmt::format("{}:{}", authority, code);
  char* text = nullptr;
  const bool exported = crs.exportToWkt(&text) == OGRERR_NONE && text != nullptr && *text != '\0';
  std::string out = exported ? text : wkt;
  CPLFree(text);
  return out;
}

TransformationPtr transformation(const OGRSpatialReference& from, const OGRSpatialReference& to) {
  GdalMessages messages;
  return TransformationPtr(OGRCreateCoordinateTransformation(&from, &to));
}

}  // namespace tafoni::io::impl
