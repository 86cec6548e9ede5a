// Files as users have them, each made here with its own oddity and its stated outcome. They hold one terrain,
// with which what is read is compared.

#include <algorithm>
#include <cmath>

#include <gmock/gmock.h>

#include "tafoni/io/test/dem_inputs.h"
#include "tafoni/raster/resample.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

/// A box of pixels.
struct Box {
  int x, y, width, height;
  bool contains(int c, int r) const { return c >= x && c < x + width && r >= y && r < y + height; }
};
template <class Boxes>
bool in_any(const Boxes& boxes, int c, int r) {
  return std::any_of(std::begin(boxes), std::end(boxes), [&](const Box& box) { return box.contains(c, r); });
}

/// Eight pixels from data is how far a hole is filled: these are left out, 12845 pixels …
constexpr Box wide_holes[] = {{60, 100, 100, 120}, {200, 20, 19, 19}, {0, 0, 22, 22}};
/// … and these are filled, 447 pixels.
constexpr Box small_holes[] = {{40, 40, 13, 13}, {180, 60, 12, 12}, {20, 150, 10, 10}, {230, 200, 17, 2}};
/// Where a quarter of the terrain has none: 5097 pixels left out and 45 filled.
constexpr Box wide_in_quarter[] = {{30, 20, 64, 64}, {0, 40, 13, 77}};
constexpr Box small_in_quarter[] = {{110, 100, 9, 5}};

constexpr double us_survey_foot = 1200.0 / 3937;

double with_holes(int c, int r, double mark) {
  return in_any(wide_holes, c, r) || in_any(small_holes, c, r) ? mark : height(c, r);
}
double with_infinities(int c, int r) {
  constexpr double odd[] = {INFINITY, -INFINITY, NAN};
  const int i = (c - 1) / 9;  // one in each of 29 columns
  return c == 9 * i + 1 && r == (i * 53 + 7) % side ? odd[i % 3] : height(c, r);
}

void write_ascii(const fs::path& path) {
  ascii(path.filename(), 128, 128,
        "XLLCENTER 411000.0\nYLLCENTER 384720.0\ncellsize 10.0\nnodata_value -9999.00", [](int c, int r) {
          const bool hole = in_any(wide_in_quarter, c, r) || in_any(small_in_quarter, c, r);
          return fmt::format("{:.2f}", hole ? -9999 : height(c, r));
        });
}
void write_raw(const fs::path& path) {
  std::string bytes;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) {
      const auto v = static_cast<std::uint16_t>(std::lround(64 * height(c, r)));
      bytes += static_cast<char>(v & 0xff);
      bytes += static_cast<char>(v >> 8);
    }
  written(path.filename(), bytes);
}
void write_heightmap(const fs::path& path) {
  write_png(path, [](int c, int r) { return std::round(64 * height(c, r)); });
}
void write_feet(const fs::path& path) {
  const double pixel = 10 / us_survey_foot;
  Tiff tiff{.crs = "EPSG:2229", .unit = "US survey foot"};
  tiff.transform = {6.4e6, pixel, 0, 1.9e6, 0, -pixel};
  write_tiff(path, tiff, [](int c, int r) { return height(c, r) / us_survey_foot; });
}
void write_rotated(const fs::path& path) {
  const double along = 10 * std::cos(30 * degree), across = 10 * std::sin(30 * degree);
  Tiff tiff;
  tiff.transform = {411000, along, across, 386000, across, -along};
  write_tiff(path, tiff, height);
}
void write_holes(const fs::path& path) {
  write_tiff(path, {.nodata = -9999}, [](int c, int r) { return with_holes(c, r, -9999); });
}
/// Without compression, so that its upper half can be read.
void write_truncated(const fs::path& path) {
  write_tiff(path, {}, height);
  fs::resize_file(path, fs::file_size(path) / 2);
}
void write_south_up(const fs::path& path) {
  Tiff tiff;
  tiff.transform = {411000, 10, 0, 386000 - 2560, 0, 10};
  write_tiff(path, tiff, [](int c, int r) { return height(c, side - 1 - r); });
}
void write_tiny_pixels(const fs::path& path) {
  Tiff tiff{.crs = "EPSG:32630"};
  tiff.transform = {447123.37, 0.01, 0, 5909876.54, 0, -0.01};
  write_tiff(path, tiff, [](int c, int r) { return 1e-3 * height(c, r); });
}
void write_oblong(const fs::path& path) {
  Tiff tiff{.height = side / 2};
  tiff.transform = {411000, 10, 0, 386000, 0, -25};
  write_tiff(path, tiff, [](int c, int r) { return height(c, 2 * r); });
}

enum class Outcome { read, refused };

/// What must become of one awkward file.
struct Awkward {
  const char* file;
  void (*write)(const fs::path&);
  Outcome outcome = Outcome::read;
  std::vector<const char*> says = {};  ///< in the error, or in the notes; empty: no notes at all
  int width = side, height = side;
  raster::Placement placement{411000, 386000, 10, 10};
  double per_metre = 1;     ///< file's height of one metre of the truth; 0 where all is 123.5
  double tolerance = 1e-4;  ///< metres; half a step of what the file can say
  int row_step = 1;         ///< truth rows a row
  double missing = 0;       ///< share left out of the domain
  std::size_t filled = 0;
};

const Awkward awkward[] = {
    {"all_nodata.tif",
     [](const fs::path& p) { write_tiff(p, {.nodata = -9999}, [](int, int) { return -9999; }); },
     Outcome::refused,
     {"no elevations", "every pixel"}},
    {.file = "dem_in_band1_of_2.tif",
     .write = [](const fs::path& p) { write_tiff(p, {.bands = 2}, height); },
     .says = {"2 bands; band 1 is taken"}},
    {.file = "huge_offset_pixels_of_cm.tif",
     .write = &write_tiny_pixels,
     .placement = {447123.37, 5909876.54, 0.01, 0.01},
     .per_metre = 1e-3,
     .tolerance = 1e-7},
    {"empty_0_bytes.tif",
     [](const fs::path& p) { written(p.filename(), ""); },
     Outcome::refused,
     {"is empty"}},
    {.file = "esri_ascii_xllcenter.asc",
     .write = &write_ascii,
     .says = {"names no coordinate system", "45 in small holes"},
     .width = 128,
     .height = 128,
     .placement = {410995, 385995, 10, 10},
     .tolerance = 0.0051,
     .missing = 5097.0 / 16384,
     .filled = 45},
    {.file = "feet_z_and_xy_ftUS_epsg2229.tif",
     .write = &write_feet,
     .says = {"US survey foot"},
     .placement = {6.4e6 * us_survey_foot, 1.9e6 * us_survey_foot, 10, 10}},
    {.file = "flat_constant.tif",
     .write =
         [](const fs::path& p) {
           write_tiff(p, {.width = 64, .height = 64}, [](int, int) { return 123.5; });
         },
     .width = 64,
     .height = 64,
     .per_metre = 0,
     .tolerance = 0},
    {.file = "float64.tif", .write = [](const fs::path& p) { write_tiff(p, {.type = GDT_Float64}, height); }},
    {.file = "inf_values.tif",
     .write = [](const fs::path& p) { write_tiff(p, {}, with_infinities); },
     .says = {"29 pixels are NaN or infinite", "29 in small holes"},
     .filled = 29},
    {.file = "int16_bigendian.tif",
     .write =
         [](const fs::path& p) {
           write_tiff(p, {.type = GDT_Int16, .options = {"ENDIANNESS=BIG"}},
                      [](int c, int r) { return std::round(0.25 * height(c, r)); });
         },
     .says = {"steps of 1 m", "ask for smoothing"},
     .per_metre = 0.25,
     .tolerance = 0.5},
    {"multiband_rgb_uint8_not_dem.tif",
     [](const fs::path& p) {
       write_tiff(p, {.bands = 3, .type = GDT_Byte, .options = {"PHOTOMETRIC=RGB"}},
                  [](int c, int) { return c; });
     },
     Outcome::refused,
     {"is a picture", "not an elevation model"}},
    {.file = "nan_holes_no_nodata_tag.tif",
     .write =
         [](const fs::path& p) { write_tiff(p, {}, [](int c, int r) { return with_holes(c, r, NAN); }); },
     .says = {"NaN", "447 in small holes"},
     .missing = 12845.0 / 65536,
     .filled = 447},
    {.file = "no_georeferencing.tif",
     .write = [](const fs::path& p) { write_tiff(p, {.transform = std::nullopt}, height); },
     .says = {"no georeference; pixels are taken as 1 m"},
     .placement = {0, 256, 1, 1}},
    {.file = "nodata_holes_float32.tif",
     .write = &write_holes,
     .says = {"12845 are left out", "447 in small holes"},
     .missing = 12845.0 / 65536,
     .filled = 447},
    {.file = "nonsquare_pixels_10x25.tif",
     .write = &write_oblong,
     .height = side / 2,
     .placement = {411000, 386000, 10, 25},
     .row_step = 2},
    {"one_pixel.tif",
     [](const fs::path& p) { write_tiff(p, {.width = 1, .height = 1}, height); },
     Outcome::refused,
     {"1 x 1 pixels", "at least 2 x 2"}},
    {.file = "png16_heightmap.png",
     .write = &write_heightmap,
     .says = {"16-bit heightmap", "1/128 m", "no georeference"},
     .placement = {0, 256, 1, 1},
     .per_metre = 0.5,
     .tolerance = 0.004},
    {.file = "raw_r16_256x256.r16",
     .write = &write_raw,
     .says = {"no header; taken as 256 x 256", "1/128 m", "no georeference"},
     .placement = {0, 256, 1, 1},
     .per_metre = 0.5,
     .tolerance = 0.004},
    {.file = "south_up_positive_dy.tif", .write = &write_south_up, .says = {"south up; put upright"}},
    {"truncated_half.tif", &write_truncated, Outcome::refused, {"cut short or damaged", "fetch it again"}},
    {.file = "uint16_with_scale_offset.tif",
     .write =
         [](const fs::path& p) {
           write_tiff(p, {.type = GDT_UInt16, .scale = 0.01, .offset = 100},
                      [](int c, int r) { return std::round(100 * (height(c, r) - 100)); });
         },
     .tolerance = 0.0051},
};

/// Made by the first who asks for it.
fs::path awkward_file(const std::string& name) {
  const auto* found =
      std::find_if(std::begin(awkward), std::end(awkward), [&](const Awkward& a) { return a.file == name; });
  const fs::path path = temporary(name);
  if (!fs::exists(path)) found->write(path);
  return path;
}

class AwkwardFile : public testing::TestWithParam<Awkward> {};

TEST_P(AwkwardFile, HasItsStatedOutcome) {
  const Awkward& want = GetParam();
  const fs::path path = awkward_file(want.file);
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
      const double expected = want.per_metre == 0 ? 123.5 : want.per_metre * height(c, r * want.row_step);
      wrong += !(std::abs(at(dem.raster, c, r) - expected) <= want.tolerance);
    }
  // What was filled need not be the truth, only near it.
  EXPECT_LE(wrong, want.filled);
}
INSTANTIATE_TEST_SUITE_P(Dem, AwkwardFile, testing::ValuesIn(awkward),
                         [](const auto& tested) { return test_name(tested.param.file); });

TEST(ReadDem, TurnsARotatedGridNorthUp) {
  const fs::path path = temporary("rotated.tif");
  write_rotated(path);
  const Dem dem = read_dem(path);
  EXPECT_THAT(joined(dem.notes), HasSubstr("rotated by 30.0 degrees"));
  EXPECT_NEAR(dem.raster.placement.dx, 10, 1e-6);
  // A square turned by 30 degrees fills 1 / (cos + sin)^2 of its box.
  EXPECT_NEAR(dem.missing, 1 - 1 / std::pow(std::cos(30 * degree) + std::sin(30 * degree), 2), 0.005);
  double sum = 0, worst = 0;
  for (int r = 4; r < 252; ++r)
    for (int c = 4; c < 252; ++c) {
      const double x = 411000 + (c + 0.5) * 8.660254037844386 + (r + 0.5) * 5;
      const double y = 386000 + (c + 0.5) * 5 - (r + 0.5) * 8.660254037844386;
      const double off = std::abs(raster::sample_bicubic(dem.raster, x, y) - height(c, r));
      sum += off * off;
      worst = std::max(worst, off);
    }
  EXPECT_LT(std::sqrt(sum) / 248, 0.02);
  EXPECT_LT(worst, 0.2);
}

TEST(ReadDem, HolesAreFilledCloseToTheTruth) {
  const Dem dem = read_dem(awkward_file("inf_values.tif"));
  double worst = 0;
  for (int r = 0; r < side; ++r)
    for (int c = 0; c < side; ++c) worst = std::max(worst, std::abs(at(dem.raster, c, r) - height(c, r)));
  EXPECT_LT(worst, 0.5);
}

TEST(ReadDem, ReadsNothingOutsideTheWindow) {
  // The lower half of this file is missing.
  DemOptions options;
  options.window = {10, 4, 200, 8};
  const Dem dem = read_dem(awkward_file("truncated_half.tif"), options);
  EXPECT_EQ(at(dem.raster, 5, 3), height(15, 7));
}

TEST(ReadDem, HeightmapsTakeTheUsersScale) {
  DemOptions options;
  options.height_scale = 1.0 / 64;
  options.pixel_size = 10;
  for (const char* file : {"png16_heightmap.png", "raw_r16_256x256.r16"}) {
    const Dem dem = read_dem(awkward_file(file), options);
    EXPECT_EQ(dem.raster.placement.dx, 10);
    EXPECT_EQ(dem.raster.placement.north, 2560);
    EXPECT_NEAR(at(dem.raster, 100, 30), height(100, 30), 0.008);
    EXPECT_THAT(joined(dem.notes), testing::Not(HasSubstr("1/128")));
  }
}

TEST(InspectDem, TellsWhatTheFileHolds) {
  const DemInfo feet = inspect_dem(awkward_file("feet_z_and_xy_ftUS_epsg2229.tif"));
  EXPECT_EQ(feet.unit, "US survey foot");
  EXPECT_EQ(feet.height_unit, "US survey foot");
  EXPECT_NEAR(feet.dx, 32.8083333, 1e-6);
  const auto& heights = truth().values.values();
  EXPECT_NEAR(feet.lowest, *std::min_element(heights.begin(), heights.end()), 1e-4);
  EXPECT_NEAR(feet.highest, *std::max_element(heights.begin(), heights.end()), 1e-4);
  const fs::path rotated = temporary("turned.tif");
  write_rotated(rotated);
  const DemInfo turned = inspect_dem(rotated);
  EXPECT_FALSE(turned.north_up);
  EXPECT_NEAR(turned.angle, 30 * degree, 1e-9);
  EXPECT_NEAR(turned.dx, 10, 1e-9);
  const DemInfo holes = inspect_dem(awkward_file("nodata_holes_float32.tif"));
  EXPECT_NEAR(holes.missing, 13292.0 / 65536, 1e-9);
  EXPECT_EQ(holes.type, "Float32");
}

}  // namespace
}  // namespace tafoni::io
