#pragma once
// GDAL set up once, its messages kept off stderr and turned into our own sentences.

#include <filesystem>
#include <memory>
#include <string>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "tafoni/core/error.h"

namespace tafoni::io::impl {

/// Registers the drivers on first use and bounds the block cache.
void ensure_gdal();

/// While it lives, GDAL's messages of this thread are collected instead of printed.
class GdalMessages {
 public:
  GdalMessages();
  ~GdalMessages();
  GdalMessages(const GdalMessages&) = delete;
  GdalMessages& operator=(const GdalMessages&) = delete;

  bool failed() const { return failed_; }
  /// " (the first failure)" for the end of a sentence; empty when GDAL said nothing.
  std::string because() const;
  /// The first failure, without line breaks or a full stop at its end; empty when there was none.
  std::string reason() const;

 private:
  static void CPL_STDCALL collect(CPLErr kind, CPLErrorNum, const char* text);
  std::string first_;
  bool failed_ = false;
};

struct CloseDataset {
  void operator()(GDALDataset* dataset) const { GDALClose(dataset); }
};
using DatasetPtr = std::unique_ptr<GDALDataset, CloseDataset>;

/// Opens a file for reading. Throws Error{input}: missing, a folder, empty, or nothing GDAL knows as `what`
/// ("an elevation model"). Names that GDAL itself composes ("NETCDF:file:variable", "/vsizip/…") pass.
DatasetPtr open_dataset(const std::filesystem::path& path, unsigned flags, const char* what);

/// Throws Error{input} unless `path` is a file that is there and not empty, or a name GDAL composes.
void require_file(const std::filesystem::path& path, const char* what);

/// A CRS from WKT whose coordinates are x, y (longitude first). Throws Error{input}.
OGRSpatialReference crs_from_wkt(const std::string& wkt);

std::string to_wkt(const OGRSpatialReference& crs);

/// "EPSG:32631" for a CRS of WKT that EPSG knows, else WKT of an older form, which tells no area of use.
std::string short_crs(const std::string& wkt);

struct DestroyTransformation {
  void operator()(OGRCoordinateTransformation* t) const { OCTDestroyCoordinateTransformation(t); }
};
using TransformationPtr = std::unique_ptr<OGRCoordinateTransformation, DestroyTransformation>;
/// Null when PROJ knows no way.
TransformationPtr transformation(const OGRSpatialReference& from, const OGRSpatialReference& to);

}  // namespace tafoni::io::impl
