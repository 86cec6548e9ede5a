#pragma once
// Elevation files as the tests want them: GeoTIFFs of any kind through GDAL, and HGT, USGS DEM and raw
// heightmaps byte by byte; with them the terrain that most of them hold.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/io/impl/gdal.h"
#include "tafoni/io/test/dem_testing.h"
#include "tafoni/math/angle.h"

namespace tafoni::io {

/// Metres: hills of a few hundred metres with ridges and slopes that change over a few pixels of 10 m.
inline double terrain(double east, double north) {
  return 340 + 90 * std::sin(east / 410) * std::cos(north / 530 + 0.4) +
         25 * std::sin((east + 0.6 * north) / 160) + 6 * std::cos((0.8 * east - north) / 57);
}

constexpr int side = 256;

/// The 256 x 256 heights that most of the files hold in one form or another.
inline const raster::Raster& truth() {
  static const raster::Raster raster = [] {
    raster::Raster made{raster::Grid<float>(side, side), {411000, 386000, 10, 10}, "EPSG:27700"};
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c)
        made.values.at(c, r) = static_cast<float>(terrain(10 * c + 5, 2560 - 10 * r - 5));
    return made;
  }();
  return raster;
}
inline double height(int col, int row) {
  return at(truth(), col, row);
}

/// What a GeoTIFF says of itself.
struct Tiff {
  int width = side, height = side;
  int bands = 1;
  GDALDataType type = GDT_Float32;
  std::optional<std::array<double, 6>> transform = std::array<double, 6>{411000, 10, 0, 386000, 0, -10};
  const char* crs = "EPSG:27700";
  double nodata = NAN;  ///< NaN: none is named
  const char* unit = "";
  double scale = 1, offset = 0;
  std::vector<const char*> options = {};  ///< of the driver, as NAME=VALUE
};

/// Writes the first band from `f(col, row)`, stored values; the others hold 1, 2, ….
template <class F>
void write_tiff(const fs::path& path, const Tiff& tiff, F&& f) {
  impl::ensure_gdal();
  std::vector<const char*> options = tiff.options;
  options.push_back(nullptr);
  const impl::DatasetPtr out(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      path.c_str(), tiff.width, tiff.height, tiff.bands, tiff.type, const_cast<char**>(options.data())));
  ASSERT_NE(out, nullptr);
  if (tiff.transform) {
    auto t = *tiff.transform;
    ASSERT_EQ(out->SetGeoTransform(t.data()), CE_None);
    const OGRSpatialReference crs = impl::crs_from_wkt(tiff.crs);
    ASSERT_EQ(out->SetSpatialRef(&crs), CE_None);
  }
  for (int b = 1; b <= tiff.bands; ++b) {
    GDALRasterBand* band = out->GetRasterBand(b);
    if (!std::isnan(tiff.nodata)) band->SetNoDataValue(tiff.nodata);
    if (*tiff.unit != 0) band->SetUnitType(tiff.unit);
    if (tiff.scale != 1) band->SetScale(tiff.scale);
    if (tiff.offset != 0) band->SetOffset(tiff.offset);
    std::vector<double> row(tiff.width, b - 1);
    for (int r = 0; r < tiff.height; ++r) {
      for (int c = 0; b == 1 && c < tiff.width; ++c) row[c] = f(c, r);
      ASSERT_EQ(band->RasterIO(GF_Write, 0, r, tiff.width, 1, row.data(), tiff.width, 1, GDT_Float64, 0, 0),
                CE_None);
    }
  }
}

/// A picture of 16 bits without a word on where it lies.
template <class F>
void write_png(const fs::path& path, F&& f) {
  const impl::DatasetPtr memory(impl::memory_driver().Create("", side, side, 1, GDT_UInt16, nullptr));
  std::vector<double> row(side);
  for (int r = 0; r < side; ++r) {
    for (int c = 0; c < side; ++c) row[c] = f(c, r);
    ASSERT_EQ(
        memory->GetRasterBand(1)->RasterIO(GF_Write, 0, r, side, 1, row.data(), side, 1, GDT_Float64, 0, 0),
        CE_None);
  }
  const impl::DatasetPtr out(GetGDALDriverManager()->GetDriverByName("PNG")->CreateCopy(
      path.c_str(), memory.get(), TRUE, nullptr, nullptr, nullptr));
  ASSERT_NE(out, nullptr);
}

/// SRTM's raw tiles: whole metres, 16 bits, the high byte first, from the north-west corner's point to the
/// south-east corner's. The name says where.
template <class F>
void write_hgt(const fs::path& path, F&& f) {
  constexpr int points = 1201;
  std::string bytes;
  for (int r = 0; r < points; ++r)
    for (int c = 0; c < points; ++c) {
      const auto v = static_cast<std::uint16_t>(std::lround(f(c, r)));
      bytes += static_cast<char>(v >> 8);
      bytes += static_cast<char>(v & 0xff);
    }
  std::ofstream(path, std::ios::binary) << bytes;
}

/// A USGS DEM of 30 m in UTM zone 10 on NAD27: columns from the south to the north, each with a place and a
/// base of its own. The first `short_columns` begin `short_by` points further north than the others.
struct UsgsDem {
  int columns = 80, rows = 100;
  double west = 557820, south = 5108010;
  int short_columns = 0, short_by = 0;
};
template <class F>
void write_usgs(const fs::path& path, const UsgsDem& dem, F&& f) {
  const auto real = [](double v) {  // FORTRAN's D24.15
    std::string text = fmt::format("{:24.14E}", v);
    return text.replace(text.find('E'), 1, "D");
  };
  const double east = dem.west + 30 * (dem.columns - 1), north = dem.south + 30 * (dem.rows - 1);
  std::string out = fmt::format("{:<144}{:6}{:6}{:6}{:6}", "A HILL", 1, 1, 1, 10);
  for (int i = 0; i < 15; ++i) out += real(0);
  out += fmt::format("{:6}{:6}{:6}", 2, 2, 4);
  for (const double v : {dem.west, dem.south, dem.west, north, east, north, east, dem.south}) out += real(v);
  out += real(0) + real(1000) + real(0) + fmt::format("{:6}", 1);
  out += "0.300000E+020.300000E+020.100000E+01" + fmt::format("{:6}{:6}", 1, dem.columns);
  out.resize(1024, ' ');
  for (int c = 0; c < dem.columns; ++c) {
    const int first = c < dem.short_columns ? dem.short_by : 0;
    std::string profile = fmt::format("{:6}{:6}{:6}{:6}", 1, c + 1, dem.rows - first, 1) +
                          real(dem.west + 30 * c) + real(dem.south + 30 * first) + real(0) + real(0) +
                          real(1000);
    for (int r = first; r < dem.rows; ++r)
      profile += fmt::format("{:6}", std::lround(f(c, dem.rows - 1 - r)));
    profile.resize(1024, ' ');  // 146 heights at most in the first block of a profile
    out += profile;
  }
  std::ofstream(path, std::ios::binary) << out;
}

/// Where degrees on WGS 84 lie in the UTM zone of a central meridian: Krüger's series to the third order in
/// the flattening, right to less than a millimetre within a zone.
inline Vec2d utm(double longitude, double latitude, double meridian) {
  constexpr double a = 6378137, f = 1 / 298.257223563, n = f / (2 - f), n2 = n * n, n3 = n2 * n;
  constexpr double radius = a / (1 + n) * (1 + n2 / 4 + n2 * n2 / 64);
  constexpr double alpha[] = {n / 2 - n2 * 2 / 3 + n3 * 5 / 16, n2 * 13 / 48 - n3 * 3 / 5, n3 * 61 / 240};
  const double phi = latitude * degree, lambda = (longitude - meridian) * degree;
  const double e = 2 * std::sqrt(n) / (1 + n);
  const double t = std::sinh(std::atanh(std::sin(phi)) - e * std::atanh(e * std::sin(phi)));
  const double xi = std::atan2(t, std::cos(lambda)), eta = std::atanh(std::sin(lambda) / std::hypot(1, t));
  Vec2d p{eta, xi};
  for (int j = 1; j <= 3; ++j) {
    p.x += alpha[j - 1] * std::cos(2 * j * xi) * std::sinh(2 * j * eta);
    p.y += alpha[j - 1] * std::sin(2 * j * xi) * std::cosh(2 * j * eta);
  }
  return {500000 + 0.9996 * radius * p.x, 0.9996 * radius * p.y};
}

/// The share of its hull in the UTM zone that a piece of a map in degrees leaves empty.
inline double share_outside(double west, double south, double east, double north, double meridian) {
  std::vector<Vec2d> rim;
  constexpr int pieces = 32;  // each edge bends
  const auto edge = [&](double x0, double y0, double x1, double y1) {
    for (int i = 0; i < pieces; ++i)
      rim.push_back(utm(x0 + (x1 - x0) * i / pieces, y0 + (y1 - y0) * i / pieces, meridian));
  };
  edge(west, south, east, south);
  edge(east, south, east, north);
  edge(east, north, west, north);
  edge(west, north, west, south);
  double area = 0;
  Vec2d lo = rim[0], hi = rim[0];
  for (std::size_t i = 0; i < rim.size(); ++i) {
    const Vec2d p = rim[i], q = rim[(i + 1) % rim.size()];
    area += (p.x * q.y - q.x * p.y) / 2;
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y)};
  }
  return 1 - area / ((hi.x - lo.x) * (hi.y - lo.y));
}

}  // namespace tafoni::io
