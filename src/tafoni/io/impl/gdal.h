#pragma once
// GDAL set up once, its messages kept off stderr and turned into our own sentences.

#include <filesystem>
#include <memory>
#include <string>

#include <gdal_priv.h>
#include <ogr_spatialref.h>

#include "tafoni/core/error.h"

namespace tafoni::io::impl {

/// Sets GDAL up on first use: of its drivers those that read nothing but the file they are given and what
/// lies beside it, without the network unless it is allowed, and a bounded block cache. A program that has
/// set GDAL up before keeps it as it is.
void ensure_gdal();

/// The names of the drivers that may open a file for these GDAL_OF_… flags; ends with null.
const char* const* listed_drivers(unsigned flags);

/// What a file that none of them takes is instead, and what to do: the end of a sentence, or nothing.
std::string advice_for(const std::filesystem::path& path, unsigned flags);

/// Makes data sets over memory. It opens none by name.
GDALDriver& memory_driver();

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

/// Opens a file for reading. Throws Error{input}: missing, a folder, empty, or nothing that is read as `what`
/// ("an elevation model"), with GDAL's own reason where it has one; and where the file leads to others than
/// those in its folder. Names of parts of files ("NETCDF:file:variable", "/vsizip/…") pass.
DatasetPtr open_dataset(const std::filesystem::path& path, unsigned flags, const char* what);

/// A CRS from WKT whose coordinates are x, y (longitude first). Throws Error{input}.
OGRSpatialReference crs_from_wkt(const std::string& wkt);

std::string to_wkt(const OGRSpatialReference& crs);
/// What messages call it.
std::string name_of(const OGRSpatialReference& crs);

/// "EPSG:32631" for a CRS of WKT that EPSG knows, else WKT of an older form, which tells no area of use.
std::string short_crs(const std::string& wkt);

struct DestroyTransformation {
  void operator()(OGRCoordinateTransformation* t) const { OCTDestroyCoordinateTransformation(t); }
};
using TransformationPtr = std::unique_ptr<OGRCoordinateTransformation, DestroyTransformation>;
/// Null when PROJ knows no way.
TransformationPtr transformation(const OGRSpatialReference& from, const OGRSpatialReference& to);

}  // namespace tafoni::io::impl
