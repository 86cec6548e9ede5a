#include "tafoni/io/dem.h"

#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <fstream>

#include <gmock/gmock.h>
#include <sys/resource.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/raster/resample.h"

namespace tafoni::io {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::IsEmpty;

const fs::path data = fs::path(TAFONI_SOURCE_DIR) / ".." / "shared" / "data" / "dem";
#define NEEDS_DATA() \
  if (!fs::exists(data)) GTEST_SKIP() << "needs the elevation models of ../shared/data/dem"

struct TemporaryFolder {
  fs::path path = fs::temp_directory_path() / fmt::format("tafoni_dem_{}", ::getpid());
  TemporaryFolder() { fs::create_directories(path); }
  ~TemporaryFolder() { fs::remove_all(path); }
};
fs::path temporary(const std::string& name) {
  static const TemporaryFolder folder;
  return folder.path / name;
}
fs::path written(const std::string& name, const std::string& content) {
  std::ofstream(temporary(name), std::ios::binary) << content;
  return temporary(name);
}

/// An ESRI ASCII grid; `f(col, row)` in text.
template <class F>
fs::path ascii(const std::string& name, int width, int height, const std::string& place, F&& f) {
  std::string text = fmt::format("ncols {}\nnrows {}\n{}\n", width, height, place);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) text += fmt::format("{} ", f(c, r));
    text += '\n';
  }
  return written(name, text);
}
double hill(int c, int r) {
  return 300 + 0.5 * c + 10 * std::sin(0.21 * r);
}
const std::string at_home = "xllcorner 500000\nyllcorner 5900000\ncellsize 10";

struct Thrown {
  ErrorKind kind = ErrorKind::internal;
  std::string text;
};
template <class F>
Thrown thrown_by(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return {error.kind(), error.what()};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

double at(const raster::Raster& r, int col, int row) {
  return static_cast<double>(r.values.at(col, row));
}
std::string test_name(std::string file) {
  for (char& c : file)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return file;
}
std::string joined(const std::vector<std::string>& notes) {
  std::string out;
  for (const auto& note : notes) out += note + "\n";
  return out;
}

/// The 256 x 256 pixels that the awkward files were cut from.
const raster::Raster& truth() {
  static const raster::Raster raster = [] {
    DemOptions options;
    options.window = {700, 400, 256, 256};
    return read_dem(data / "peakdistrict_karst_10m.tif", options).raster;
  }();
  return raster;
}

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

TEST(ReadDem, FinerResolutionsAreSaidToAddNothing) {
  const fs::path path = ascii("fine.asc", 30, 20, at_home, hill);
  DemOptions options;
  options.resolution = 2.5;
  const Dem dem = read_dem(path, options);
  EXPECT_EQ(dem.raster.width(), 120);
  EXPECT_EQ(dem.raster.height(), 80);
  EXPECT_THAT(joined(dem.notes), HasSubstr("finer than its own pixels"));
  const Vec2d p = dem.raster.placement.center(50, 40);
  EXPECT_NEAR(at(dem.raster, 50, 40),
              300 + 0.5 * ((p.x - 500'000) / 10 - 0.5) + 10 * std::sin(0.21 * ((5'900'200 - p.y) / 10 - 0.5)),
              0.05);
}

TEST(ReadDem, RemovesTheStepsOfEightBitDataOnRequest) {
  std::string pgm = "P5\n128 96\n255\n";
  for (int r = 0; r < 96; ++r)
    for (int c = 0; c < 128; ++c)
      pgm += static_cast<char>(std::lround(60 + 12 * std::sin(c / 19.0) + 9 * std::cos(r / 17.0)));
  const fs::path path = written("steps.pgm", pgm);
  DemOptions options;
  const Dem raw = read_dem(path, options);
  EXPECT_DOUBLE_EQ(raw.step, 1);
  EXPECT_THAT(joined(raw.notes), HasSubstr("terraces"));
  options.smooth = true;
  const Dem smooth = read_dem(path, options);
  EXPECT_THAT(joined(smooth.notes), HasSubstr("smoothed within half a step"));
  double before = 0, after = 0;
  for (int r = 0; r < 96; ++r)
    for (int c = 0; c < 128; ++c) {
      const double want = 60 + 12 * std::sin(c / 19.0) + 9 * std::cos(r / 17.0);
      before += std::pow(at(raw.raster, c, r) - want, 2);
      after += std::pow(at(smooth.raster, c, r) - want, 2);
    }
  EXPECT_LT(after, 0.25 * before);
}

TEST(ReadDem, MarksWithoutATagAreMissing) {
  for (const double mark : {-9999.0, -32768.0, 3.4e38, -1e30}) {
    const fs::path path = ascii("marks.asc", 40, 40, at_home,
                                [&](int c, int r) { return c > 3 && c < 7 && r == 20 ? mark : hill(c, r); });
    const Dem dem = read_dem(path);
    EXPECT_EQ(dem.filled, 3u) << mark;
    EXPECT_THAT(joined(dem.notes), HasSubstr("3 pixels hold")) << mark;
    EXPECT_NEAR(at(dem.raster, 5, 20), hill(5, 20), 1) << mark;
  }
}

TEST(ReadDem, TheSeaFloorMayLieAtMinus9999) {
  const fs::path path =
      ascii("trench.asc", 40, 40, at_home, [](int c, int r) { return -9990 - c % 20 + 0 * r; });
  const Dem dem = read_dem(path);
  EXPECT_EQ(dem.filled, 0u);
  EXPECT_EQ(at(dem.raster, 9, 5), -9999);
}

TEST(ReadDem, FillDistanceDecidesWhatIsLeftOut) {
  const fs::path path = ascii("hole.asc", 60, 60, at_home + "\nNODATA_value -1",
                              [](int c, int r) { return std::hypot(c - 30, r - 30) < 6 ? -1 : hill(c, r); });
  DemOptions options;
  options.fill_distance = 30;
  const Dem left = read_dem(path, options);
  EXPECT_EQ(left.filled, 0u);
  EXPECT_GT(left.missing, 0.02);
  options.fill_distance = 60;
  const Dem filled = read_dem(path, options);
  EXPECT_EQ(filled.missing, 0);
  EXPECT_NEAR(at(filled.raster, 30, 30), hill(30, 30), 4);
}

TEST(ReadDem, QuarterTurnsAndMirrorsAreExact) {
  // World files put a headerless picture anywhere.
  std::string pgm = "P5\n5 3\n255\n";
  for (int i = 0; i < 15; ++i) pgm += static_cast<char>(10 * i);
  struct Case {
    const char* name;
    double a, d, b, e;  ///< of the world file: x and y a column, x and y a row
  };
  for (const Case& turn :
       {Case{"plain", 2, 0, 0, -2}, Case{"mirror", -2, 0, 0, -2}, Case{"half", -2, 0, 0, 2},
        Case{"left", 0, 2, 2, 0}, Case{"right", 0, -2, -2, 0}, Case{"odd", 0, 2, -2, 0}}) {
    const fs::path path = written(fmt::format("{}.pgm", turn.name), pgm);
    written(fmt::format("{}.wld", turn.name),
            fmt::format("{}\n{}\n{}\n{}\n1000\n2000\n", turn.a, turn.d, turn.b, turn.e));
    const Dem dem = read_dem(path);
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 5; ++c) {
        const Vec2d p =
            dem.raster.placement.pixel(1000 + c * turn.a + r * turn.b, 2000 + c * turn.d + r * turn.e);
        ASSERT_NEAR(p.x, std::round(p.x), 1e-9);
        ASSERT_EQ(at(dem.raster, static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y))),
                  10 * (r * 5 + c))
            << turn.name;
      }
  }
}

TEST(ReadDem, DegreesWithoutACoordinateSystemAreNotMetres) {
  const fs::path path =
      ascii("degrees.asc", 40, 40, "xllcorner 5.25\nyllcorner 43.2\ncellsize 0.000833333333", hill);
  const Dem dem = read_dem(path);
  EXPECT_THAT(joined(dem.notes), HasSubstr("read as degrees"));
  EXPECT_GT(dem.raster.placement.dx, 40);
  EXPECT_LT(dem.raster.placement.dx, 100);
  EXPECT_NEAR(dem.raster.placement.west, 682'700, 500);
}

TEST(ReadDem, WebMercatorMetresAreNotMetres) {
  const fs::path path =
      ascii("mercator.asc", 64, 64, "xllcorner -200000\nyllcorner 7086000\ncellsize 10", hill);
  written(
      "mercator.prj",
      "PROJCS[\"WGS 84 / Pseudo-Mercator\",GEOGCS[\"WGS 84\",DATUM[\"WGS_1984\",SPHEROID[\"WGS "
      "84\",6378137,298.257223563]],"
      "PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],PROJECTION[\"Mercator_1SP\"],"
      "PARAMETER[\"central_meridian\",0],PARAMETER[\"scale_factor\",1],PARAMETER[\"false_easting\",0],"
      "PARAMETER[\"false_northing\",0],UNIT[\"metre\",1],AXIS[\"Easting\",EAST],AXIS[\"Northing\",NORTH],"
      "EXTENSION[\"PROJ4\",\"+proj=merc +a=6378137 +b=6378137 +lat_ts=0 +lon_0=0 +x_0=0 +y_0=0 +k=1 +units=m "
      "+nadgrids=@null +wktext +no_defs\"],AUTHORITY[\"EPSG\",\"3857\"]]");
  const Dem dem = read_dem(path);
  EXPECT_THAT(joined(dem.notes), HasSubstr("a metre on the map"));
  EXPECT_NEAR(dem.raster.placement.dx, 10 * std::cos(53.53 * M_PI / 180), 0.05);
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

TEST(ReadDem, FeetOnTheMapDoNotMakeTheHeightsFeet) {
  const fs::path path = ascii("feet.asc", 8, 8, "xllcorner 6400000\nyllcorner 1900000\ncellsize 10", hill);
  written("feet.prj",
          "PROJCS[\"NAD83 / California zone 5 (ftUS)\",GEOGCS[\"NAD83\",DATUM[\"North_American_Datum_1983\","
          "SPHEROID[\"GRS "
          "1980\",6378137,298.257222101]],PRIMEM[\"Greenwich\",0],UNIT[\"degree\",0.0174532925199433]],"
          "PROJECTION[\"Lambert_Conformal_Conic_2SP\"],PARAMETER[\"standard_parallel_1\",35.4666666666667],"
          "PARAMETER[\"standard_parallel_2\",34.0333333333333],PARAMETER[\"latitude_of_origin\",33.5],"
          "PARAMETER[\"central_meridian\",-118],PARAMETER[\"false_easting\",6561666.667],"
          "PARAMETER[\"false_northing\",1640416.667],UNIT[\"US survey foot\",0.304800609601219]]");
  const Dem dem = read_dem(path);
  EXPECT_THAT(joined(dem.notes), HasSubstr("names no unit of height"));
  EXPECT_NEAR(dem.raster.placement.dx, 12000.0 / 3937, 1e-6);
  EXPECT_NEAR(at(dem.raster, 3, 4), hill(3, 4), 1e-3);
}

/// A little-endian GeoTIFF of 4 x 3 floats, tie point (0, 0) = (500000, 5900000), 10 m; `type` 1 says that
/// pixels are areas, 2 that they are points (GTRasterTypeGeoKey).
std::string tiny_geotiff(int type) {
  std::string out("II\x2a\0\x08\0\0\0", 8), after;
  const auto put = [](std::string& to, auto value) {
    to.append(reinterpret_cast<const char*>(&value), sizeof(value));
  };
  constexpr std::uint16_t u16 = 3, u32 = 4, f64 = 12;
  constexpr std::uint16_t entries = 13;
  const std::uint32_t base = 8 + 2 + entries * 12 + 4;
  put(out, entries);
  const auto entry = [&](int tag, std::uint16_t kind, std::uint32_t count, std::uint32_t value) {
    put(out, static_cast<std::uint16_t>(tag));
    put(out, kind);
    put(out, count);
    put(out, value);
  };
  for (const double v : {10.0, 10.0, 0.0, 0.0, 0.0, 0.0, 500000.0, 5900000.0, 0.0}) put(after, v);
  const auto keys = static_cast<std::uint32_t>(after.size());
  for (const int v : {1, 1, 0, 3, 1024, 0, 1, 1, 1025, 0, 1, type, 3072, 0, 1, 32630})
    put(after, static_cast<std::uint16_t>(v));
  const auto pixels = static_cast<std::uint32_t>(after.size());
  for (int i = 0; i < 12; ++i) put(after, static_cast<float>(100 + i * i));
  entry(256, u32, 1, 4);              // width
  entry(257, u32, 1, 3);              // height
  entry(258, u16, 1, 32);             // bits
  entry(259, u16, 1, 1);              // not compressed
  entry(262, u16, 1, 1);              // black is zero
  entry(273, u32, 1, base + pixels);  // where the strip lies
  entry(277, u16, 1, 1);              // samples a pixel
  entry(278, u32, 1, 3);              // rows a strip
  entry(279, u32, 1, 48);             // bytes of the strip
  entry(339, u16, 1, 3);              // floats
  entry(33550, f64, 3, base);         // pixel scale
  entry(33922, f64, 6, base + 24);    // tie point
  entry(34735, u16, 16, base + keys);
  put(out, std::uint32_t{0});
  return out + after;
}

TEST(ReadDem, HonoursPixelIsPointInGeotiff) {
  const Dem area = read_dem(written("area.tif", tiny_geotiff(1)));
  const Dem point = read_dem(written("point.tif", tiny_geotiff(2)));
  EXPECT_EQ(area.raster.placement.west, 500000);
  EXPECT_EQ(area.raster.placement.north, 5900000);
  EXPECT_EQ(point.raster.placement.west, 499995);
  EXPECT_EQ(point.raster.placement.north, 5900005);
  for (const Dem* dem : {&area, &point}) {
    EXPECT_EQ(at(dem->raster, 3, 2), 221);
    EXPECT_THAT(dem->raster.crs, HasSubstr("UTM zone 30N"));
  }
}

TEST(ReadDem, SurvivesAnyDamage) {
  const std::string good = tiny_geotiff(2);
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::string bad = good;
    unsigned h = seed * 2654435761u + 1;
    for (int i = 0; i < 1 + static_cast<int>(seed % 4); ++i) {
      h = h * 1664525u + 1013904223u;
      bad[(h >> 8) % bad.size()] = static_cast<char>(h >> 24);
    }
    if (seed % 7 == 0) bad.resize((h >> 4) % bad.size());
    const fs::path path = written("bad.tif", bad);
    try {
      DemOptions options;
      options.window = {0, 0, 3, 3};
      if (seed % 2) options.window.reset();
      read_dem(path, options);
    } catch (const Error& error) {
      ASSERT_TRUE(error.kind() == ErrorKind::input || error.kind() == ErrorKind::usage)
          << seed << error.what();
    }
  }
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

TEST(ReadDem, RefusesWrongThingsInOneSentence) {
  const fs::path good = ascii("good.asc", 20, 10, at_home, hill);
  const auto read = [](const fs::path& path, const DemOptions& options = {}) {
    return thrown_by([&] { read_dem(path, options); });
  };
  testing::internal::CaptureStderr();
  EXPECT_THAT(read(temporary("")).text, HasSubstr("is a folder"));
  EXPECT_THAT(read(temporary("none.tif")).text, HasSubstr("no such file"));
  EXPECT_THAT(read(written("words.tif", "This is no picture at all.\n")).text,
              HasSubstr("cannot be read as an elevation model"));
  EXPECT_THAT(read(written("odd.r16", "123")).text, HasSubstr("no square 16-bit heightmap"));
  EXPECT_THAT(
      read(written("cut.asc", "ncols 20\nnrows 10\ncellsize 1\nxllcorner 0\nyllcorner 0\n1 2 3\n")).text,
      HasSubstr("cut.asc"));
  for (const std::array<int, 4> window :
       {std::array{15, 0, 6, 5}, std::array{-1, 0, 5, 5}, std::array{0, 0, 1, 5}, std::array{0, 0, -4, 5},
        std::array{0, 8, 5, 3}, std::array{2147483647, 0, 2147483647, 5}}) {
    DemOptions options;
    options.window = window;
    const Thrown thrown = read(good, options);
    EXPECT_EQ(thrown.kind, ErrorKind::usage) << thrown.text;
    EXPECT_THAT(thrown.text, HasSubstr("window"));
  }
  for (const double resolution : {-1.0, static_cast<double>(NAN), static_cast<double>(INFINITY), 1e6, 1e-4}) {
    DemOptions options;
    options.resolution = resolution;
    EXPECT_EQ(read(good, options).kind, ErrorKind::usage) << resolution;
  }
  DemOptions options;
  options.band = 9;
  EXPECT_THAT(read(good, options).text, HasSubstr("no band 9"));
  options.band = -1;
  EXPECT_EQ(read(good, options).kind, ErrorKind::usage);
  options.band = 0;
  options.pixel_size = 3;
  EXPECT_THAT(read(good, options).text, HasSubstr("has a georeference"));
  EXPECT_THAT(testing::internal::GetCapturedStderr(), IsEmpty());
}

TEST(ReadDem, CanBeCancelled) {
  Progress progress;
  progress.cancel();
  const Thrown thrown = thrown_by([&] { read_dem(ascii("stop.asc", 20, 10, at_home, hill), {}, progress); });
  EXPECT_EQ(thrown.kind, ErrorKind::cancelled);
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

TEST(WriteGeotiff, RoundTrips) {
  raster::Raster want{raster::Grid<float>(70, 40), {447123.37, 5909876.54, 0.25, 0.5}, "EPSG:32630"};
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 70; ++c) want.values.at(c, r) = static_cast<float>(hill(c, r));
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 20; ++c) want.values.at(c, r) = raster::no_data;
  const fs::path path = temporary("round.tif");
  write_geotiff(path, want);
  const Dem got = read_dem(path);
  EXPECT_EQ(got.raster.placement.west, want.placement.west);
  EXPECT_EQ(got.raster.placement.north, want.placement.north);
  EXPECT_EQ(got.raster.placement.dx, want.placement.dx);
  EXPECT_EQ(got.raster.placement.dy, want.placement.dy);
  EXPECT_THAT(got.raster.crs, HasSubstr("UTM zone 30N"));
  for (std::size_t i = 0; i < want.values.size(); ++i) {
    const float a = got.raster.values.values()[i], b = want.values.values()[i];
    ASSERT_TRUE(a == b || (std::isnan(a) && std::isnan(b)));
  }
}

TEST(WriteGeotiff, FailsInOneSentenceAndLeavesNothing) {
  const raster::Raster any{raster::Grid<float>(900, 900), {0, 900, 1, 1}, ""};
  EXPECT_EQ(thrown_by([&] { write_geotiff("/no/such/folder/a.tif", any); }).kind, ErrorKind::output);
  raster::Raster noisy = any;
  for (std::size_t i = 0; i < noisy.values.size(); ++i)
    noisy.values.values()[i] = static_cast<float>(std::sin(static_cast<double>(i * i)));
  rlimit old{};
  ::getrlimit(RLIMIT_FSIZE, &old);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit low = old;
  low.rlim_cur = 1 << 16;
  ::setrlimit(RLIMIT_FSIZE, &low);
  const fs::path path = temporary("full") / "a.tif";
  fs::create_directories(path.parent_path());
  const Thrown thrown = thrown_by([&] { write_geotiff(path, noisy); });
  ::setrlimit(RLIMIT_FSIZE, &old);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(thrown.kind, ErrorKind::output);
  EXPECT_THAT(thrown.text, HasSubstr("cannot write"));
  EXPECT_TRUE(fs::is_empty(path.parent_path()));
}

}  // namespace
}  // namespace tafoni::io
