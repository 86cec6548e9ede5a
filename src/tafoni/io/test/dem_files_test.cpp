// Real files: those of ../shared/data/dem, each with its stated outcome.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "tafoni/io/test/dem_testing.h"
#include "tafoni/raster/resample.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

enum class Outcome { read, refused };

/// What must become of one awkward file.
struct Awkward {
  const char* file;
  Outcome outcome;
  std::vector<const char*> says;  ///< in the error, or in the notes; empty: no notes at all
  int width = 256, height = 256;
  raster::Placement placement{411000, 386000, 10, 10};
  double per_metre = 1;  ///< file's height of one metre of the truth
  double tolerance = 0.04;
  int row_step = 1;    ///< truth rows a row
  double missing = 0;  ///< share left out of the domain
  std::size_t filled = 0;
};

const Awkward awkward[] = {
    {"all_nodata.tif", Outcome::refused, {"no elevations", "every pixel"}},
    {"dem_in_band1_of_2.tif", Outcome::read, {"2 bands; band 1 is taken"}},
    {"ecef_like_offset_utm_cm.tif",
     Outcome::read,
     {},
     256,
     256,
     {447123.37, 5909876.54, 0.01, 0.01},
     1e-3,
     4e-5},
    {"empty_0_bytes.tif", Outcome::refused, {"is empty"}},
    {"esri_ascii_xllcenter.asc",
     Outcome::read,
     {"names no coordinate system", "45 in small holes"},
     128,
     128,
     {410995, 385995, 10, 10},
     1,
     0.04,
     1,
     5097.0 / 16384,
     45},
    {"feet_z_and_xy_ftUS_epsg2229.tif",
     Outcome::read,
     {"US survey foot"},
     256,
     256,
     {6.4e6 * 1200 / 3937, 1.9e6 * 1200 / 3937, 10, 10}},
    {"flat_constant.tif", Outcome::read, {}, 64, 64, {411000, 386000, 10, 10}, 0, 0},
    {"float64.tif", Outcome::read, {}},
    {"inf_values.tif",
     Outcome::read,
     {"29 pixels are NaN or infinite", "29 in small holes"},
     256,
     256,
     {411000, 386000, 10, 10},
     1,
     0.04,
     1,
     0,
     29},
    {"int16_bigendian.tif",
     Outcome::read,
     {"steps of 1 m", "ask for smoothing"},
     256,
     256,
     {411000, 386000, 10, 10},
     1,
     0.54},
    {"multiband_rgb_uint8_not_dem.tif", Outcome::refused, {"is a picture", "not an elevation model"}},
    {"nan_holes_no_nodata_tag.tif",
     Outcome::read,
     {"NaN", "447 in small holes"},
     256,
     256,
     {411000, 386000, 10, 10},
     1,
     0.04,
     1,
     12845.0 / 65536,
     447},
    {"no_georeferencing.tif",
     Outcome::read,
     {"no georeference; pixels are taken as 1 m"},
     256,
     256,
     {0, 256, 1, 1}},
    {"nodata_holes_float32.tif",
     Outcome::read,
     {"12845 are left out"},
     256,
     256,
     {411000, 386000, 10, 10},
     1,
     0.04,
     1,
     12845.0 / 65536,
     447},
    {"nonsquare_pixels_10x25.tif", Outcome::read, {}, 256, 128, {411000, 386000, 10, 25}, 1, 0.04, 2},
    {"one_pixel.tif", Outcome::refused, {"1 x 1 pixels", "at least 2 x 2"}},
    {"png16_heightmap.png",
     Outcome::read,
     {"16-bit heightmap", "1/128 m", "no georeference"},
     256,
     256,
     {0, 256, 1, 1},
     0.5},
    {"raw_r16_256x256.r16",
     Outcome::read,
     {"no header; taken as 256 x 256", "1/128 m", "no georeference"},
     256,
     256,
     {0, 256, 1, 1},
     0.5},
    {"south_up_positive_dy.tif", Outcome::read, {"south up; put upright"}},
    {"truncated_half.tif", Outcome::refused, {"cut short or damaged", "fetch it again"}},
    {"uint16_with_scale_offset.tif", Outcome::read, {}},
};

class AwkwardFile : public testing::TestWithParam<Awkward> {};

TEST_P(AwkwardFile, HasItsStatedOutcome) {
  NEEDS_DATA();
  const Awkward& want = GetParam();
  const fs::path path = data / "awkward" / want.file;
  testing::internal::CaptureStderr();
  if (want.outcome == Outcome::refused) {
    for (const Thrown& thrown : {thrown_by([&] { read_dem(path); }), thrown_by([&] { inspect_dem(path); })}) {
      EXPECT_EQ(thrown.kind, ErrorKind::input);
      EXPECT_THAT(thrown.text, HasSubstr(want.file));
      for (const char* words : want.says) EXPECT_THAT(thrown.text, HasSubstr(words));
      EXPECT_EQ(std::count(thrown.text.begin(), thrown.text.end(), '\n'), 0);
    }
    EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
    return;
  }
  const Dem dem = read_dem(path);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
  for (const char* words : want.says) EXPECT_THAT(joined(dem.notes), HasSubstr(words));
  EXPECT_EQ(dem.notes.empty(), want.says.empty()) << joined(dem.notes);
  const raster::Placement& p = dem.raster.placement;
  ASSERT_EQ(dem.raster.width(), want.width);
  ASSERT_EQ(dem.raster.height(), want.height);
  EXPECT_NEAR(p.west, want.placement.west, 1e-6 * want.placement.dx);
  EXPECT_NEAR(p.north, want.placement.north, 1e-6 * want.placement.dy);
  EXPECT_NEAR(p.dx, want.placement.dx, 1e-6 * want.placement.dx);
  EXPECT_NEAR(p.dy, want.placement.dy, 1e-6 * want.placement.dy);
  EXPECT_NEAR(dem.missing, want.missing, 1e-9);
  EXPECT_EQ(dem.filled, want.filled);
  std::size_t wrong = 0;
  for (int r = 0; r < want.height; ++r)
    for (int c = 0; c < want.width; ++c) {
      if (std::isnan(dem.raster.values.at(c, r))) continue;
      const double expected =
          want.per_metre == 0 ? 123.5 : want.per_metre * at(truth(), c, r * want.row_step);
      wrong += !(std::abs(at(dem.raster, c, r) - expected) <= want.tolerance);
    }
  // What was filled need not be the truth, only near it.
  EXPECT_LE(wrong, want.filled);
}
INSTANTIATE_TEST_SUITE_P(Dem, AwkwardFile, testing::ValuesIn(awkward),
                         [](const auto& tested) { return test_name(tested.param.file); });

TEST(ReadDem, EveryAwkwardFileIsInTheTable) {
  NEEDS_DATA();
  for (const auto& entry : fs::directory_iterator(data / "awkward")) {
    const std::string file = entry.path().filename();
    const bool known =
        file == "rotated_geotransform_30deg.tif" || entry.path().extension() == ".xml" ||
        std::any_of(std::begin(awkward), std::end(awkward), [&](const Awkward& a) { return a.file == file; });
    EXPECT_TRUE(known) << file;
  }
}

TEST(ReadDem, TurnsARotatedGridNorthUp) {
  NEEDS_DATA();
  const Dem dem = read_dem(data / "awkward" / "rotated_geotransform_30deg.tif");
  EXPECT_THAT(joined(dem.notes), HasSubstr("rotated by 30.0 degrees"));
  EXPECT_NEAR(dem.raster.placement.dx, 10, 1e-6);
  // A square turned by 30 degrees fills 1 / (cos + sin)^2 of its box.
  EXPECT_NEAR(dem.missing, 1 - 1 / std::pow(std::cos(M_PI / 6) + std::sin(M_PI / 6), 2), 0.005);
  double sum = 0, worst = 0;
  for (int r = 4; r < 252; ++r)
    for (int c = 4; c < 252; ++c) {
      const double x = 411000 + (c + 0.5) * 8.660254037844386 + (r + 0.5) * 5;
      const double y = 386000 + (c + 0.5) * 5 - (r + 0.5) * 8.660254037844386;
      const double off = std::abs(raster::sample_bicubic(dem.raster, x, y) - at(truth(), c, r));
      sum += off * off;
      worst = std::max(worst, off);
    }
  EXPECT_LT(std::sqrt(sum) / 248, 0.2);
  EXPECT_LT(worst, 4);
}

TEST(ReadDem, HolesAreFilledCloseToTheTruth) {
  NEEDS_DATA();
  const Dem dem = read_dem(data / "awkward" / "inf_values.tif");
  double worst = 0;
  for (int r = 0; r < 256; ++r)
    for (int c = 0; c < 256; ++c) worst = std::max(worst, std::abs(at(dem.raster, c, r) - at(truth(), c, r)));
  EXPECT_LT(worst, 3);
}

struct RealFile {
  const char* file;
  double lowest, highest, missing, tolerance;
};
class RealDem : public testing::TestWithParam<RealFile> {};
TEST_P(RealDem, Opens) {
  NEEDS_DATA();
  const RealFile& want = GetParam();
  testing::internal::CaptureStderr();
  const Dem dem = read_dem(data / want.file);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
  float lo = 1e9f, hi = -1e9f;
  for (const float v : dem.raster.values.values()) {
    if (std::isnan(v)) continue;
    lo = std::min(lo, v);
    hi = std::max(hi, v);
  }
  EXPECT_NEAR(lo, want.lowest, want.tolerance);
  EXPECT_NEAR(hi, want.highest, want.tolerance);
  EXPECT_NEAR(dem.missing, want.missing, 0.01);
  EXPECT_THAT(dem.raster.crs, HasSubstr("PROJCRS"));
}
INSTANTIATE_TEST_SUITE_P(Dem, RealDem,
                         testing::Values(RealFile{"pointsal_seacliff_1m.tif", -0.233, 268.538, 0.177, 0.01},
                                         RealFile{"peakdistrict_karst_10m.tif", 107.75, 635.969, 0.022, 0.01},
                                         RealFile{"p8_crop_10m.tif", 318.438, 495.469, 0, 0.01},
                                         RealFile{"zion_utm12_60m.tif", 1027, 2892, 0.043, 0.01},
                                         RealFile{"zion_srtm_3arcsec_geographic.tif", 1024, 2892, 0.045, 6},
                                         RealFile{"sthelens_usgs.dem", 682, 2543, 0, 0.01},
                                         RealFile{"N43E005.hgt", -10, 1253, 0.06, 3},
                                         RealFile{"jacksboro_fault_3arcsec.tif", 236, 1076, 0.056, 3}),
                         [](const auto& tested) { return test_name(tested.param.file); });

TEST(ReadDem, DegreesLandWhereAnIndependentReprojectionPutsThem) {
  NEEDS_DATA();
  const Dem ours = read_dem(data / "zion_srtm_3arcsec_geographic.tif");
  const Dem theirs = read_dem(data / "zion_utm12_60m.tif");
  EXPECT_THAT(joined(ours.notes), HasSubstr("reprojected to WGS 84 / UTM zone 12N"));
  const auto difference = [&](double east, double north) {
    double sum = 0;
    int count = 0;
    for (double x = 306'000; x < 331'000; x += 137)
      for (double y = 4'116'000; y < 4'149'000; y += 149) {
        const double d = raster::sample_bicubic(ours.raster, x + east, y + north) -
                         raster::sample_bicubic(theirs.raster, x, y);
        if (std::isnan(d)) continue;
        sum += d * d;
        ++count;
      }
    return std::sqrt(sum / count);
  };
  const double here = difference(0, 0);
  for (const auto& [east, north] : {std::pair{25, 0}, std::pair{-25, 0}, std::pair{0, 25}, std::pair{0, -25}})
    EXPECT_GT(difference(east, north), here);
  EXPECT_LT(here, 15);
}

TEST(ReadDem, WindowsEqualCropsOfTheWhole) {
  NEEDS_DATA();
  const fs::path path = data / "peakdistrict_karst_10m.tif";
  const Dem whole = read_dem(path);
  DemOptions options;
  for (const std::array<int, 4> window :
       {std::array{700, 400, 256, 256}, std::array{2300, 1700, 50, 100}, std::array{1203, 901, 2, 2}}) {
    options.window = window;
    const Dem part = read_dem(path, options);
    const auto [x, y, w, h] = window;
    EXPECT_EQ(part.raster.placement.west, whole.raster.placement.west + 10 * x);
    EXPECT_EQ(part.raster.placement.north, whole.raster.placement.north - 10 * y);
    ASSERT_EQ(part.raster.width(), w);
    ASSERT_EQ(part.raster.height(), h);
    for (int r = 0; r < h; ++r)
      for (int c = 0; c < w; ++c)
        ASSERT_EQ(part.raster.values.at(c, r), whole.raster.values.at(x + c, y + r));
  }
}

TEST(ReadDem, ReadsNothingOutsideTheWindow) {
  NEEDS_DATA();
  // The lower half of this file is missing.
  DemOptions options;
  options.window = {10, 4, 200, 8};
  const Dem dem = read_dem(data / "awkward" / "truncated_half.tif", options);
  EXPECT_NEAR(at(dem.raster, 5, 3), at(truth(), 15, 7), 0.04);
}

TEST(ReadDem, CoarserResolutionsAreAreaAverages) {
  NEEDS_DATA();
  const fs::path path = data / "peakdistrict_karst_10m.tif";
  DemOptions options;
  options.window = {700, 400, 256, 256};
  options.resolution = 40;
  const Dem coarse = read_dem(path, options);
  ASSERT_EQ(coarse.raster.width(), 64);
  EXPECT_EQ(coarse.raster.placement.dx, 40);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) {
      double sum = 0;
      for (int i = 0; i < 16; ++i) sum += at(truth(), 4 * c + i % 4, 4 * r + i / 4);
      ASSERT_NEAR(at(coarse.raster, c, r), sum / 16, 1e-3);
    }
  options.resolution = 27;  // does not divide
  const Dem odd = read_dem(path, options);
  const raster::Raster want = raster::at_resolution(truth(), 27);
  ASSERT_EQ(odd.raster.width(), want.width());
  for (std::size_t i = 0; i < want.values.size(); ++i)
    ASSERT_NEAR(odd.raster.values.values()[i], want.values.values()[i], 1e-3);
}

TEST(ReadDem, PixelIsPointFilesAreHalfAPixelApart) {
  NEEDS_DATA();
  // The centres of an HGT tile's corner pixels are whole degrees.
  const DemInfo info = inspect_dem(data / "N43E005.hgt");
  EXPECT_NEAR(info.west + info.dx / 2, 5, 1e-9);
  EXPECT_NEAR(info.north - info.dy / 2, 44, 1e-9);
  const DemInfo centre =
      inspect_dem(ascii("centre.asc", 4, 4, "xllcenter 100\nyllcenter 200\ncellsize 10", hill));
  EXPECT_DOUBLE_EQ(centre.west, 95);
  EXPECT_DOUBLE_EQ(centre.south, 195);
}

TEST(ReadDem, HeightmapsTakeTheUsersScale) {
  NEEDS_DATA();
  DemOptions options;
  options.height_scale = 1.0 / 64;
  options.pixel_size = 10;
  for (const char* file : {"png16_heightmap.png", "raw_r16_256x256.r16"}) {
    const Dem dem = read_dem(data / "awkward" / file, options);
    EXPECT_EQ(dem.raster.placement.dx, 10);
    EXPECT_EQ(dem.raster.placement.north, 2560);
    EXPECT_NEAR(at(dem.raster, 100, 30), at(truth(), 100, 30), 0.04);
    EXPECT_THAT(joined(dem.notes), testing::Not(HasSubstr("1/128")));
  }
}

TEST(InspectDem, TellsWhatTheFileHolds) {
  NEEDS_DATA();
  const DemInfo feet = inspect_dem(data / "awkward" / "feet_z_and_xy_ftUS_epsg2229.tif");
  EXPECT_EQ(feet.unit, "US survey foot");
  EXPECT_EQ(feet.height_unit, "US survey foot");
  EXPECT_NEAR(feet.dx, 32.8083333, 1e-6);
  EXPECT_NEAR(feet.lowest, 214.533, 0.01);
  const DemInfo turned = inspect_dem(data / "awkward" / "rotated_geotransform_30deg.tif");
  EXPECT_FALSE(turned.north_up);
  EXPECT_NEAR(turned.angle, M_PI / 6, 1e-9);
  EXPECT_NEAR(turned.dx, 10, 1e-9);
  const DemInfo holes = inspect_dem(data / "awkward" / "nodata_holes_float32.tif");
  EXPECT_NEAR(holes.missing, 13292.0 / 65536, 1e-9);
  EXPECT_EQ(holes.type, "Float32");
  const DemInfo whole = inspect_dem(data / "large_peakdistrict_4096x4096_5m_resampled.tif");
  EXPECT_EQ(whole.width, 4096);
  EXPECT_DOUBLE_EQ(whole.lowest, 106.5);
  EXPECT_DOUBLE_EQ(whole.highest, 636.0625);
  EXPECT_THAT(whole.crs, HasSubstr("British National Grid"));
}

}  // namespace
}  // namespace tafoni::io
