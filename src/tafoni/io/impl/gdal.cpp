// GDAL is set up once, its messages are collected by thread, and what it opens is checked beforehand, so
// that every failure is one sentence of ours.

#include "tafoni/io/impl/gdal.h"

#include <algorithm>
#include <cstdlib>
#include <mutex>

#include <cpl_conv.h>

namespace tafoni::io::impl {
namespace {

void CPL_STDCALL ignore(CPLErr, CPLErrorNum, const char*) {}

bool composed_name(const std::string& name) {
  return name.rfind("/vsi", 0) == 0 || name.find(':') != std::string::npos;
}

}  // namespace

void ensure_gdal() {
  static std::once_flag once;
  std::call_once(once, [] {
    // Helper threads of GDAL's have no handler of ours on their stack.
    CPLSetErrorHandler(ignore);
    // PROJ contexts that GDAL's GeoTIFF library makes for itself print to stderr otherwise.
    ::setenv("PROJ_DEBUG", "0", 0);
    GDALAllRegister();
    if (CPLGetConfigOption("GDAL_CACHEMAX", nullptr) == nullptr) GDALSetCacheMax64(GIntBig{64} << 20);
  });
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

void require_file(const std::filesystem::path& path, const char* what) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) {
    if (composed_name(path.string())) return;
    fail(ErrorKind::input, "{}: there is no such file; check the path.", path.string());
  }
  if (fs::is_regular_file(status) && fs::file_size(path, error) == 0)
    fail(ErrorKind::input, "{} is empty (0 bytes); it is not {}.", path.string(), what);
}

DatasetPtr open_dataset(const std::filesystem::path& path, unsigned flags, const char* what) {
  require_file(path, what);
  GdalMessages messages;
  const char* const options[] = {"NUM_THREADS=ALL_CPUS", nullptr};
  // Only the GeoTIFF driver knows the option; the others' objections are not shown.
  DatasetPtr dataset(GDALDataset::Open(path.c_str(), flags | GDAL_OF_READONLY, nullptr,
                                       flags & GDAL_OF_RASTER ? options : nullptr, nullptr));
  if (dataset) return dataset;
  std::error_code error;
  if (std::filesystem::is_directory(path, error))
    fail(ErrorKind::input, "{} is a folder, not {}; name the file in it.", path.string(), what);
  fail(ErrorKind::input, "{} cannot be read as {}: no format that GDAL knows, or damaged from its start.",
       path.string(), what);
}

OGRSpatialReference crs_from_wkt(const std::string& wkt) {
  GdalMessages messages;
  OGRSpatialReference crs;
  // GDAL would follow a file's name or an address, and the text may be a stranger's.
  const char* const options[] = {"ALLOW_FILE_ACCESS=NO", "ALLOW_NETWORK_ACCESS=NO", nullptr};
  if (crs.SetFromUserInput(wkt.c_str(), options) != OGRERR_NONE)
    fail(ErrorKind::input, "the coordinate system \"{}\" is not understood; give WKT or EPSG:NUMBER.",
         wkt.substr(0, 60));
  crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return crs;
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
