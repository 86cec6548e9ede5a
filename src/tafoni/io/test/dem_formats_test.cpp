// Files of every format, made here: elevations in metres and in degrees, in tiles, as points and as areas.
// What lies in them is known, so what is read is compared with it.

#include <algorithm>
#include <cmath>
#include <numbers>

#include <gmock/gmock.h>

#include "tafoni/io/test/dem_inputs.h"
#include "tafoni/raster/resample.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// Hills between two heights, both of which occur: the lower one along the upper and the left rim.
double ripple(int c, int r, int width, int rows, double lowest, double highest) {
  const auto wave = [](int i, int of) { return 0.5 - 0.5 * std::cos(4 * std::numbers::pi * i / of); };
  return lowest + (highest - lowest) * wave(c, width) * wave(r, rows);
}

/// A file of a format, what lies in it, and how far rounding and reprojection may move that.
struct Kind {
  const char* file;
  void (*write)(const fs::path&);
  double lowest, highest;
  double tolerance;
  double missing = 0;
  double missing_tolerance = 1e-9;
};

void write_sea_cliff(const fs::path& path) {
  Tiff tiff{.width = 200, .height = 160, .crs = "EPSG:26910", .nodata = -3.4028234663852886e38};
  tiff.transform = {722000, 1, 0, 3866000, 0, -1};
  write_tiff(path, tiff, [](int c, int r) {
    return c < 36 ? -3.4028234663852886e38 : ripple(c, r, 200, 160, -0.25, 268.5);
  });
}
void write_karst(const fs::path& path) {
  write_tiff(
      path, {.width = 400, .height = 300, .nodata = -9999, .options = {"COMPRESS=DEFLATE", "TILED=YES"}},
      [](int c, int r) { return c < 60 && r < 40 ? -9999 : ripple(c, r, 400, 300, 107.75, 635.9375); });
}
void write_canyon(const fs::path& path) {
  Tiff tiff{.width = 200, .height = 160, .type = GDT_UInt16, .crs = "EPSG:32612", .nodata = 0};
  tiff.transform = {306000, 60, 0, 4149000, 0, -60};
  write_tiff(path, tiff, [](int c, int r) {
    const bool hole = c >= 100 && c < 140 && r >= 100 && r < 140;
    return hole ? 0 : std::round(ripple(c, r, 200, 160, 1027, 2892));
  });
}
constexpr double arcseconds_3 = 1.0 / 1200;
void write_canyon_in_degrees(const fs::path& path) {
  Tiff tiff{.width = 400, .height = 400, .type = GDT_UInt16, .crs = "EPSG:4326"};
  tiff.transform = {-113.2, arcseconds_3, 0, 37.5, 0, -arcseconds_3};
  write_tiff(path, tiff, [](int c, int r) { return std::round(ripple(c, r, 400, 400, 1024, 2892)); });
}
void write_fault(const fs::path& path) {
  Tiff tiff{.width = 400, .height = 340, .type = GDT_Int16, .crs = "EPSG:4269", .nodata = -32768};
  tiff.transform = {-84.4, arcseconds_3, 0, 36.6, 0, -arcseconds_3};
  write_tiff(path, tiff, [](int c, int r) { return std::round(ripple(c, r, 400, 340, 236, 1076)); });
}
/// A quadrangle whose first columns begin further north, as its edge slants.
void write_volcano(const fs::path& path) {
  write_usgs(path, {.short_columns = 20, .short_by = 45},
             [](int c, int r) { return ripple(c, r, 80, 100, 682, 2543); });
}
void write_srtm_tile(const fs::path& path) {
  write_hgt(path, [](int c, int r) { return ripple(c, r, 1200, 1200, -10, 1253); });
}

class DemOfKind : public testing::TestWithParam<Kind> {};
TEST_P(DemOfKind, Opens) {
  const Kind& want = GetParam();
  const fs::path path = temporary(want.file);
  want.write(path);
  testing::internal::CaptureStderr();
  const Dem dem = read_dem(path);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
  float lo = 1e9f, hi = -1e9f;
  for (const float v : dem.raster.values.values()) {
    if (std::isnan(v)) continue;
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  EXPECT_NEAR(lo, want.lowest, want.tolerance);
  EXPECT_NEAR(hi, want.highest, want.tolerance);
  EXPECT_NEAR(dem.missing, want.missing, want.missing_tolerance);
  EXPECT_THAT(dem.raster.crs, HasSubstr("PROJCRS"));
}
INSTANTIATE_TEST_SUITE_P(
    Dem, DemOfKind,
    testing::Values(
        Kind{"sea_cliff_1m.tif", &write_sea_cliff, -0.25, 268.5, 1e-4, 0.18},
        Kind{"karst_10m.tif", &write_karst, 107.75, 635.9375, 1e-4, 0.02},
        Kind{"crop_10m.tif",
             [](const fs::path& p) {
               write_tiff(p, {.width = 200, .height = 200},
                          [](int c, int r) { return ripple(c, r, 200, 200, 318.4375, 495.46875); });
             },
             318.4375, 495.46875, 1e-4},
        Kind{"canyon_utm12_60m.tif", &write_canyon, 1027, 2892, 1e-4, 0.05},
        Kind{"canyon_3arcsec_geographic.tif", &write_canyon_in_degrees, 1024, 2892, 1,
             share_outside(-113.2, 37.5 - 400 * arcseconds_3, -113.2 + 400 * arcseconds_3, 37.5, -111), 0.01},
        Kind{"volcano_usgs.dem", &write_volcano, 682, 2543, 1e-4, 0.1125},
        Kind{"N43E005.hgt", &write_srtm_tile, -10, 1253, 1, share_outside(5, 43, 6, 44, 3), 0.005},
        Kind{"fault_3arcsec.tif", &write_fault, 236, 1076, 1,
             share_outside(-84.4, 36.6 - 340 * arcseconds_3, -84.4 + 400 * arcseconds_3, 36.6, -87), 0.01}),
    [](const auto& tested) { return test_name(tested.param.file); });

TEST(ReadDem, DegreesLandWhereAnIndependentProjectionPutsThem) {
  const auto land = [](double x, double y) {
    return 1700 + 500 * std::sin(x / 1300) * std::cos(y / 1700) + 60 * std::sin((x + y) / 600);
  };
  Tiff tiff{.width = 300, .height = 300, .crs = "EPSG:4326"};
  tiff.transform = {-113.2, arcseconds_3, 0, 37.5, 0, -arcseconds_3};
  const fs::path path = temporary("degrees.tif");
  write_tiff(path, tiff, [&](int c, int r) {
    const Vec2d p = utm(-113.2 + (c + 0.5) * arcseconds_3, 37.5 - (r + 0.5) * arcseconds_3, -111);
    return land(p.x, p.y);
  });
  const Dem dem = read_dem(path);
  EXPECT_THAT(joined(dem.notes), HasSubstr("reprojected to WGS 84 / UTM zone 12N"));
  const Vec2d middle = utm(-113.2 + 150 * arcseconds_3, 37.5 - 150 * arcseconds_3, -111);
  const auto difference = [&](double east, double north) {
    double sum = 0;
    int count = 0;
    for (double x = middle.x - 9000; x < middle.x + 9000; x += 137)
      for (double y = middle.y - 11'000; y < middle.y + 11'000; y += 149) {
        const double d = raster::sample_bicubic(dem.raster, x + east, y + north) - land(x, y);
        if (std::isnan(d)) continue;
        sum += d * d;
        ++count;
      }
    EXPECT_GT(count, 15'000);
    return std::sqrt(sum / count);
  };
  const double here = difference(0, 0);
  EXPECT_LT(here, 0.2);
  for (const auto& [east, north] : {std::pair{2, 0}, std::pair{-2, 0}, std::pair{0, 2}, std::pair{0, -2}})
    EXPECT_GT(difference(east, north), 1.5 * here);
}

/// A compressed file in tiles, larger than the truth, which lies in it from (300, 200) on.
fs::path tiled() {
  const fs::path path = temporary("tiled.tif");
  if (fs::exists(path)) return path;
  Tiff tiff{.width = 700, .height = 520};
  tiff.transform = {411000 - 3000, 10, 0, 386000 + 2000, 0, -10};
  tiff.options = {"COMPRESS=DEFLATE", "TILED=YES", "BLOCKXSIZE=128", "BLOCKYSIZE=128"};
  write_tiff(path, tiff, [](int c, int r) { return terrain(10 * (c - 300) + 5, 2560 - 10 * (r - 200) - 5); });
  return path;
}

TEST(ReadDem, WindowsEqualCropsOfTheWhole) {
  const Dem whole = read_dem(tiled());
  DemOptions options;
  for (const std::array<int, 4> window :
       {std::array{300, 200, 256, 256}, std::array{650, 420, 50, 100}, std::array{255, 127, 2, 2}}) {
    options.window = window;
    const Dem part = read_dem(tiled(), options);
    const auto [x, y, w, h] = window;
    EXPECT_EQ(part.raster.placement.west, whole.raster.placement.west + 10 * x);
    EXPECT_EQ(part.raster.placement.north, whole.raster.placement.north - 10 * y);
    ASSERT_EQ(part.raster.width(), w);
    ASSERT_EQ(part.raster.height(), h);
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c)
        ASSERT_EQ(part.raster.values.at(c, r), whole.raster.values.at(x + c, y + r));
  }
  options.window = {300, 200, 256, 256};
  EXPECT_EQ(read_dem(tiled(), options).raster.values.values(), truth().values.values());
}

TEST(ReadDem, CoarserResolutionsAreAreaAverages) {
  DemOptions options;
  options.window = {300, 200, 256, 256};
  options.resolution = 40;
  const Dem coarse = read_dem(tiled(), options);
  ASSERT_EQ(coarse.raster.width(), 64);
  EXPECT_EQ(coarse.raster.placement.dx, 40);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) {
      double sum = 0;
      for (int i = 0; i < 16; ++i) sum += height(4 * c + i % 4, 4 * r + i / 4);
      ASSERT_NEAR(at(coarse.raster, c, r), sum / 16, 1e-3);
    }
  options.resolution = 27;  // does not divide
  const Dem odd = read_dem(tiled(), options);
  const raster::Raster want = raster::at_resolution(truth(), 27);
  ASSERT_EQ(odd.raster.width(), want.width());
  for (std::size_t i = 0; i < want.values.size(); ++i)
    ASSERT_NEAR(odd.raster.values.values()[i], want.values.values()[i], 1e-3);
}

TEST(ReadDem, PixelIsPointFilesAreHalfAPixelApart) {
  // The centres of an HGT tile's corner pixels are whole degrees.
  const fs::path tile = temporary("S34W071.hgt");
  write_hgt(tile, [](int c, int r) { return ripple(c, r, 1200, 1200, 100, 900); });
  const DemInfo info = inspect_dem(tile);
  EXPECT_NEAR(info.west + info.dx / 2, -71, 1e-9);
  EXPECT_NEAR(info.north - info.dy / 2, -33, 1e-9);
  const fs::path quadrangle = temporary("quadrangle.dem");
  write_usgs(quadrangle, {}, [](int c, int r) { return 100 + c + r; });
  const DemInfo usgs = inspect_dem(quadrangle);
  EXPECT_DOUBLE_EQ(usgs.west + 15, UsgsDem{}.west);
  EXPECT_DOUBLE_EQ(usgs.south + 15, UsgsDem{}.south);
  const DemInfo centre =
      inspect_dem(ascii("centre.asc", 4, 4, "xllcenter 100\nyllcenter 200\ncellsize 10", hill));
  EXPECT_DOUBLE_EQ(centre.west, 95);
  EXPECT_DOUBLE_EQ(centre.south, 195);
}

TEST(InspectDem, SeesEveryStripOfALargeFile) {
  // It is read by two million pixels at a time; the extremes lie in the last of three strips.
  constexpr int width = 4096, rows = 1100;
  const fs::path path = temporary("large.tif");
  write_tiff(path, {.width = width, .height = rows, .options = {"COMPRESS=DEFLATE", "TILED=YES"}},
             [](int c, int r) {
               if (c == 10 && r == rows - 1) return 106.5;
               return c == width - 1 && r == rows - 2 ? 636.0625 : 300.0 + (c + r) % 7;
             });
  const DemInfo whole = inspect_dem(path);
  EXPECT_EQ(whole.width, width);
  EXPECT_DOUBLE_EQ(whole.lowest, 106.5);
  EXPECT_DOUBLE_EQ(whole.highest, 636.0625);
  EXPECT_THAT(whole.crs, HasSubstr("British National Grid"));
}

}  // namespace
}  // namespace tafoni::io
