// Files that do not say what they hold, or say it wrongly: what is read is the terrain all the same, or the
// user is told.

#include <algorithm>
#include <cmath>
#include <functional>

#include <gmock/gmock.h>

#include "tafoni/io/impl/dem_levels.h"
#include "tafoni/io/test/dem_inputs.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// Appends a band of transparency: 0 in the corners, elsewhere as it is stored.
void write_with_alpha(const fs::path& path, GDALDataType type, double opaque) {
  Tiff tiff{.width = 40, .height = 40, .bands = 2, .type = type, .options = {"ALPHA=YES"}};
  write_tiff(path, tiff, [](int c, int r) { return c + r < 12 ? 0 : std::round(height(c, r)); });
  const impl::DatasetPtr file(GDALDataset::Open(path.c_str(), GDAL_OF_UPDATE));
  ASSERT_NE(file, nullptr);
  ASSERT_EQ(file->GetRasterBand(2)->GetColorInterpretation(), GCI_AlphaBand);
  std::vector<double> row(40);
  for (int r = 0; r < 40; ++r) {
    for (int c = 0; c < 40; ++c) row[c] = c + r < 12 ? 0 : opaque;
    ASSERT_EQ(file->GetRasterBand(2)->RasterIO(GF_Write, 0, r, 40, 1, row.data(), 40, 1, GDT_Float64, 0, 0),
              CE_None);
  }
}

TEST(TrustInDem, AlphaOfAnyTypeMarksMissingData) {
  struct Kind {
    const char* name;
    GDALDataType type;
    double opaque;
  };
  for (const Kind& kind : {Kind{"f32.tif", GDT_Float32, 255}, Kind{"share.tif", GDT_Float32, 0.25},
                           Kind{"i16.tif", GDT_Int16, 255}, Kind{"u16.tif", GDT_UInt16, 65535},
                           Kind{"f64.tif", GDT_Float64, 1}}) {
    const fs::path path = temporary(kind.name);
    write_with_alpha(path, kind.type, kind.opaque);
    DemOptions options;
    options.fill_distance = 0;
    const Dem dem = read_dem(path, options);
    for (int r = 0; r < 40; ++r)
      for (int c = 0; c < 40; ++c) {
        if (c + r < 12)
          ASSERT_TRUE(std::isnan(at(dem.raster, c, r))) << kind.name;
        else
          ASSERT_EQ(at(dem.raster, c, r), std::round(height(c, r))) << kind.name;
      }
  }
}

TEST(TrustInDem, GridsOfWholeNumbersMayHoldNan) {
  for (const char* word : {"nan", "NaN", "-nan", "1.#QNAN"}) {
    const fs::path path = ascii("whole.asc", 30, 30, at_home, [&](int c, int r) {
      return c == 9 && r == 7 ? std::string(word) : std::to_string(300 + c % 3);
    });
    DemOptions options;
    options.fill_distance = 0;
    const Dem dem = read_dem(path, options);
    EXPECT_TRUE(std::isnan(at(dem.raster, 9, 7))) << word;
    EXPECT_EQ(at(dem.raster, 10, 7), 301) << word;
    EXPECT_EQ(inspect_dem(path).lowest, 300) << word;
  }
  // A fraction far down is no whole number either.
  const fs::path late = ascii("late.asc", 500, 300, at_home, [](int c, int r) {
    return std::string(r == 299 && c == 400 ? "300.75" : "300");
  });
  EXPECT_EQ(at(read_dem(late).raster, 400, 299), 300.75);
}

TEST(TrustInDem, WordsAmongHeightsAreNotZero) {
  for (const char* word : {"*", "null", "NA", "--", "12m"}) {
    const fs::path path = ascii("words.asc", 12, 12, at_home, [&](int c, int r) {
      return c == 3 && r == 7 ? std::string(word) : std::string("300");
    });
    const Thrown thrown = thrown_by([&] { read_dem(path); });
    EXPECT_THAT(thrown.text, HasSubstr("line 13")) << word;
    EXPECT_THAT(thrown.text, HasSubstr(fmt::format("\"{}\" stands where a height belongs", word)));
  }
  EXPECT_THAT(read_dem(ascii("plain.asc", 12, 12, at_home + "\nNODATA_value nan",
                             [](int c, int) { return 300.5 + c * 1e-3; }))
                  .notes,
              Not(IsEmpty()));
}

TEST(TrustInDem, TagsOfMissingDataAreRoundedAsPixelsAre) {
  DemOptions options;
  options.fill_distance = 0;
  for (const double mark : {-9999.9, -9999.99, 0.1, -1e-3}) {
    const fs::path path = temporary("fraction.tif");
    write_tiff(path, {.nodata = mark}, [&](int c, int r) { return c + r < 12 ? mark : height(c, r); });
    const Dem dem = read_dem(path, options);
    EXPECT_TRUE(std::isnan(at(dem.raster, 5, 6))) << mark;
    EXPECT_EQ(at(dem.raster, 6, 6), height(6, 6)) << mark;
  }
}

/// Lines of x, y and z with a header; `z(col, row)` in text, none where it is empty.
template <class F>
fs::path xyz(const std::string& name, const std::string& header, F&& z) {
  std::string text = header;
  for (int r = 0; r < 12; ++r)
    for (int c = 0; c < 20; ++c)
      if (const std::string height = z(c, r); !height.empty())
        text += fmt::format("{} {} {}\n", 500005 + 10 * c, 5900115 - 10 * r, height);
  return written(name, text);
}

TEST(TrustInDem, LinesThatAnXyzLeavesOutAreMissing) {
  DemOptions options;
  options.fill_distance = 0;
  // Heights of one byte with zeros among them, with a nan, below -32768: GDAL says nothing of gaps there.
  for (const auto& words : {std::pair("0", "0"), std::pair("nan", "7.5"), std::pair("-40000", "0")}) {
    const char *const first = words.first, *const zero = words.second;
    const fs::path path = xyz("gaps.xyz", "x y z\n", [&](int c, int r) -> std::string {
      if (c % 7 == 3 && r > 0) return "";
      return c == 0 && r == 0 ? first : c == 4 ? zero : std::to_string(c + r);
    });
    const Dem dem = read_dem(path, options);
    ASSERT_EQ(dem.raster.values.width(), 20);
    for (int r = 1; r < 12; ++r)
      for (int c = 0; c < 20; ++c) {
        if (c % 7 == 3)
          EXPECT_TRUE(std::isnan(at(dem.raster, c, r))) << first << ' ' << c << ' ' << r;
        else
          EXPECT_EQ(at(dem.raster, c, r), c == 4 ? std::stod(zero) : c + r) << first;
      }
  }
}

TEST(TrustInDem, WordsInAnXyzAreNotZero) {
  for (const char* word : {"NA", "NULL", "-", "12m", "*"}) {
    const fs::path path = xyz("words.xyz", "x y z\n", [&](int c, int r) {
      return c == 3 && r == 7 ? std::string(word) : std::to_string(300 + c);
    });
    EXPECT_THAT(thrown_by([&] { read_dem(path); }).text,
                HasSubstr(fmt::format("line 145: \"{}\" stands where a height belongs", word)));
  }
  // Other columns, commas and words beside the height are as GDAL takes them.
  std::string text = "name,height,lon,lat\n";
  for (int r = 0; r < 4; ++r)
    for (int c = 0; c < 5; ++c)
      text += fmt::format("NA,{},{},{}\n", c == 2 && r == 2 ? "nan" : "5", 5 + 0.01 * c, 50 - 0.01 * r);
  EXPECT_EQ(inspect_dem(written("columns.xyz", text)).missing, 1 / 20.0);
  text.clear();
  for (int r = 0; r < 12; ++r)
    for (int c = 0; c < 20; ++c) text += fmt::format("{},5;{},5;{},25\n", 10 * c, 500 - 10 * r, 300 + c);
  EXPECT_EQ(at(read_dem(written("commas.xyz", text)).raster, 7, 3), 307.25);
  EXPECT_THAT(thrown_by([&] { read_dem(written("long.xyz", text + std::string(120, '1') + "\n")); }).text,
              HasSubstr("line 241: is longer than 99 letters"));
}

/// A GRASS grid of 20 by 12 heights.
template <class F>
fs::path grass(const std::string& edges, const std::string& more, F&& f) {
  std::string text = edges + "rows: 12\ncols: 20\n" + more;
  for (int r = 0; r < 12; ++r) {
    for (int c = 0; c < 20; ++c) text += fmt::format("{} ", f(c, r));
    text += '\n';
  }
  return written("grass.asc", text);
}

TEST(TrustInDem, GrassMarksWhatIsMissingByWords) {
  DemOptions options;
  options.fill_distance = 0;
  const std::string edges = "north: 5900120\nsouth: 5900000\neast: 500200\nwest: 500000\n";
  for (const auto& words : {std::pair("", "*"), std::pair("null: *\n", "*"), std::pair("null: NA\n", "NA"),
                            std::pair("type: int\n", "nan"), std::pair("type: int\nnull: *\n", "*"),
                            std::pair("type: float\nnull: -5\n", "-5")}) {
    const char *const more = words.first, *const word = words.second;
    const Dem dem = read_dem(
        grass(edges, more,
              [&](int c, int r) { return (c + r) % 5 == 3 ? std::string(word) : std::to_string(c * r); }),
        options);
    EXPECT_EQ(dem.raster.placement.north, 5900120);
    for (int r = 0; r < 12; ++r)
      for (int c = 0; c < 20; ++c) {
        if ((c + r) % 5 == 3)
          EXPECT_TRUE(std::isnan(at(dem.raster, c, r))) << more;
        else
          EXPECT_EQ(at(dem.raster, c, r), c * r) << more;
      }
  }
  const auto says = [&](const char* more, const char* word) {
    const fs::path path = grass(
        edges, more, [&](int c, int r) { return c == 3 && r == 7 ? std::string(word) : std::string("300"); });
    return thrown_by([&] { read_dem(path); }).text;
  };
  EXPECT_THAT(says("type: int\n", "4.75"),
              HasSubstr("line 15: \"4.75\" stands in a grid whose header says type: int"));
  EXPECT_THAT(says("", "NA"), HasSubstr("line 14: \"NA\" stands where a height belongs"));
}

TEST(TrustInDem, HeightsThatBeginWithALetterAreNoHeader) {
  const auto f = [](int c, int r) { return c + r == 0 ? std::string("nan") : std::to_string(300 + c); };
  EXPECT_THAT(thrown_by([&] { read_dem(ascii("first.asc", 20, 12, at_home, f)); }).text,
              HasSubstr("line 6: \"nan\" begins the heights"));
  const std::string edges = "north: 120\nsouth: 0\neast: 200\nwest: 0\n";
  EXPECT_THAT(thrown_by([&] { read_dem(grass(edges, "", f)); }).text,
              HasSubstr("line 7: \"nan\" begins the heights"));
}

TEST(TrustInDem, GrassHasDegreesMinutesAndSeconds) {
  const auto flat = [](int c, int) { return 300 + c; };
  const DemInfo info = inspect_dem(
      grass("north: 51:06:00N\nsouth: 50:54N\neast: 1:20:00W\nwest: 1.66666666666666667W\n", "", flat));
  EXPECT_NEAR(info.north, 51.1, 1e-9);
  EXPECT_NEAR(info.south, 50.9, 1e-9);
  EXPECT_NEAR(info.east, -4 / 3.0, 1e-9);
  EXPECT_NEAR(info.west, -5 / 3.0, 1e-9);
  for (const char* north : {"51:60:00N", "51:6:0:0N", "51:00:00E", "51-06N", ""})
    EXPECT_THAT(
        thrown_by([&] {
          inspect_dem(grass(fmt::format("north: {}\nsouth: 50S\neast: 2E\nwest: 1E\n", north), "", flat));
        }).text,
        HasSubstr(fmt::format("its header says \"north: {}\"", north)));
}

TEST(TrustInDem, CornersAndCentresMayBeMixed) {
  for (const std::string& place : {std::string("xllcenter 500005\nyllcorner 5900000\ncellsize 10"),
                                   std::string("xllcorner 500000\nYLLCENTER 5900005\ncellsize 10"),
                                   std::string("yllcorner 5900000\nxllcenter 500005\ndx 10\ndy 10")}) {
    const Dem dem = read_dem(ascii("mixed.asc", 20, 15, place, hill));
    EXPECT_EQ(dem.raster.placement.west, 500000) << place;
    EXPECT_EQ(dem.raster.placement.north, 5900150) << place;
  }
  const Dem none = read_dem(ascii("nowhere.asc", 20, 15, "xllcorner 700\ncellsize 10", hill));
  EXPECT_THAT(joined(none.notes), HasSubstr("names no corner"));
  EXPECT_EQ(none.raster.placement.north, 150);
}

TEST(TrustInDem, TheCoordinateSystemKnowsTheUnitBetterThanATag) {
  // EPSG:5703 are heights in metres, EPSG:6360 in US survey feet.
  struct Case {
    const char *crs, *tag;
    double metres;
    bool told;
  };
  constexpr double foot = 1200.0 / 3937;
  for (const Case& c :
       {Case{"EPSG:26910+5703", "US survey foot", 1, true}, Case{"EPSG:26910+6360", "m", foot, true},
        Case{"EPSG:26910+6360", "US survey foot", foot, false}, Case{"EPSG:26910+5703", "metre", 1, false},
        Case{"EPSG:26910", "US survey foot", foot, false}, Case{"EPSG:26910+5703", "cubits", 1, true}}) {
    const fs::path path = temporary("unit.tif");
    fs::remove(path.string() + ".aux.xml");
    write_tiff(path, {.crs = c.crs, .unit = c.tag}, height);
    const Dem dem = read_dem(path);
    EXPECT_NEAR(at(dem.raster, 50, 60), c.metres * height(50, 60), 1e-3) << c.crs << c.tag;
    EXPECT_EQ(joined(dem.notes).find("which is believed") != std::string::npos, c.told)
        << c.crs << c.tag << joined(dem.notes);
  }
}

TEST(TrustInDem, UndeclaredMarksAreFoundAndSaid) {
  for (const double mark :
       {-9999.0, -999.0, 9999.0, 32767.0, 65535.0, 99999.0, 1.70141e38, 1e20, -2147483648.0}) {
    const fs::path path = temporary("marks.tif");
    write_tiff(path, {.type = GDT_Float64},
               [&](int c, int r) { return c < 4 && r < 5 ? mark : height(c, r); });
    DemOptions options;
    options.fill_distance = 0;
    const Dem dem = read_dem(path, options);
    EXPECT_THAT(joined(dem.notes), HasSubstr("20 pixels hold")) << mark;
    EXPECT_TRUE(std::isnan(at(dem.raster, 3, 4))) << mark;
    EXPECT_EQ(inspect_dem(path).highest, inspect_dem(path).highest);
    EXPECT_LT(inspect_dem(path).highest, 1000) << mark;
  }
  // Two of them in one file, and one that is a height as others are near it.
  const fs::path both = temporary("both.tif");
  write_tiff(both, {.type = GDT_Int16}, [&](int c, int r) {
    return c == 3 ? -9999 : c == 9 ? -32768 : std::round(height(c, r));
  });
  const Dem dem = read_dem(both);
  EXPECT_THAT(joined(dem.notes), HasSubstr("512 pixels hold"));
  EXPECT_NEAR(at(dem.raster, 3, 40), height(3, 40), 20);
  const fs::path depths = temporary("depths.tif");
  write_tiff(depths, {}, [](int c, int r) { return -1040.0 + (c + r) % 80; });
  EXPECT_EQ(at(read_dem(depths).raster, 41, 0), -999);
}

// As who turns or cuts a file without naming a nodata value leaves it.
TEST(TrustInDem, ZerosAboutHighGroundAreMissing) {
  const auto turned = [](int c, int r) { return std::abs(c - 128) + std::abs(r - 128) < 110; };
  const auto heights = [&](int c, int r) { return turned(c, r) ? height(c, r) : 0; };
  DemOptions options;
  options.fill_distance = 0;
  for (const bool tagged : {false, true}) {
    const fs::path path = temporary("turned.tif");
    write_tiff(path, {.nodata = tagged ? -5.0 : NAN}, heights);
    const Dem dem = read_dem(path, options);
    for (int r = 0; r < side; ++r)
      for (int c = 0; c < side; ++c)
        ASSERT_EQ(std::isnan(at(dem.raster, c, r)), !tagged && !turned(c, r)) << c << ' ' << r;
    EXPECT_THAT(dem.notes,
                Contains(HasSubstr(tagged ? "heights jump" : "hold exactly 0 m, while all ground")));
  }
}

TEST(TrustInDem, HeightsThatTheEarthDoesNotHaveAreSaid) {
  const fs::path feet = temporary("feet.tif");
  write_tiff(feet, {}, [](int c, int r) { return 21000 + 20 * height(c, r) / 2; });
  EXPECT_THAT(joined(read_dem(feet).notes), HasSubstr("higher than anything on earth"));
  EXPECT_THAT(joined(inspect_dem(feet).notes), HasSubstr("higher than anything on earth"));
  const fs::path deep = temporary("deep.tif");
  write_tiff(deep, {}, [](int c, int r) { return -50 * height(c, r); });
  EXPECT_THAT(joined(read_dem(deep).notes), HasSubstr("deeper than anything on earth"));
  DemOptions options;
  options.height_scale = 0.3048;
  options.window = {0, 0, 20, 20};
  write_tiff(feet, {}, [](int, int) { return 29029; });
  EXPECT_THAT(joined(read_dem(feet, options).notes), Not(HasSubstr("on earth")));
  // Mars has higher mountains.
  write_tiff(feet, {.crs = "+proj=eqc +R=3396190 +units=m"}, [](int, int) { return 21900; });
  EXPECT_THAT(joined(read_dem(feet).notes), Not(HasSubstr("on earth")));
}

TEST(TrustInDem, SpikesAndPitsAreSaidWithTheirPlace) {
  const fs::path path = temporary("spike.tif");
  write_tiff(path, {}, [](int c, int r) { return height(c, r) + (c == 31 && r == 77 ? 700 : 0); });
  DemOptions options;
  options.window = {20, 70, 60, 60};
  for (const auto& notes : {read_dem(path).notes, read_dem(path, options).notes, inspect_dem(path).notes}) {
    EXPECT_THAT(joined(notes), HasSubstr("in 4 places"));
    EXPECT_THAT(joined(notes), testing::ContainsRegex("column 3[01], row 7[67]"));
  }
  // A cliff as steep as they come is none: 80 m over a pixel of 10 m.
  write_tiff(path, {}, [](int c, int) { return c < 100 ? 0 : 80; });
  EXPECT_THAT(joined(read_dem(path).notes), Not(HasSubstr("jump")));
}

/// A large file with an overview a fourth as wide, that holds what `overview` gives.
constexpr int large = 4200;
double rough(int c, int r) {
  static const auto waves = [](double length) {
    std::vector<double> out(large);
    for (int i = 0; i < large; ++i) out[i] = std::sin(i / length);
    return out;
  };
  static const std::vector<double> across = waves(37), down = waves(29);
  return 300 + 40 * across[c] * down[r] + 7 * ((c * 7 + r * 13) % 5);
}
double mean_of(int c, int r) {
  double sum = 0;
  for (int i = 0; i < 16; ++i) sum += rough(4 * c + i % 4, 4 * r + i / 4);
  return sum / 16;
}
fs::path with_overview(const std::string& name, double (*f)(int, int), double (*overview)(int, int)) {
  const fs::path path = temporary(name);
  Tiff tiff{.width = large, .height = large, .nodata = -9999, .options = {"TILED=YES"}};
  tiff.transform = {0, 1, 0, large, 0, -1};
  write_tiff(path, tiff, f);
  const impl::DatasetPtr file(GDALDataset::Open(path.c_str(), GDAL_OF_UPDATE));
  int level = 4;
  if (file->BuildOverviews("NEAREST", 1, &level, 0, nullptr, GDALDummyProgress, nullptr) != CE_None)
    ADD_FAILURE() << "no overview";
  GDALRasterBand* const coarse = file->GetRasterBand(1)->GetOverview(0);
  std::vector<double> row(coarse->GetXSize());
  for (int r = 0; r < coarse->GetYSize(); ++r) {
    for (int c = 0; c < coarse->GetXSize(); ++c) row[c] = overview(c, r);
    if (coarse->RasterIO(GF_Write, 0, r, coarse->GetXSize(), 1, row.data(), coarse->GetXSize(), 1,
                         GDT_Float64, 0, 0) != CE_None)
      ADD_FAILURE() << "not written";
  }
  return path;
}

struct Coarse {
  double worst = 0;  ///< off the area averages
  double overviews_off = 0;
  double pixels = 0;  ///< that were read
};
Coarse read_coarse(const fs::path& path) {
  const auto source = impl::DemSource::open(path, {});
  const auto reading = impl::read_window(*source, {0, 0, large, large}, 8, 8, large / 8, large / 8, silent());
  Coarse out{0, reading.overviews_off, static_cast<double>(source->report.pixels)};
  for (int r = 0; r < large / 8; ++r)
    for (int c = 0; c < large / 8; ++c) {
      double sum = 0;
      for (int i = 0; i < 4; ++i) sum += mean_of(2 * c + i % 2, 2 * r + i / 2);
      const double v = reading.heights.at(c, r);
      if (!std::isnan(v)) out.worst = std::max(out.worst, std::abs(v - sum / 4));
    }
  return out;
}

TEST(TrustInDem, OverviewsOfAreaAveragesServe) {
  const Coarse read = read_coarse(with_overview("average.tif", rough, mean_of));
  EXPECT_LT(read.worst, 1e-3);
  EXPECT_EQ(read.overviews_off, 0);
  EXPECT_LT(read.pixels, 0.1 * large * large);
}

TEST(TrustInDem, OverviewsOfEveryFourthPixelDoNot) {
  const Coarse read = read_coarse(
      with_overview("nearest.tif", rough, [](int c, int r) { return rough(4 * c + 2, 4 * r + 2); }));
  EXPECT_LT(read.worst, 1e-3);
  EXPECT_GT(read.overviews_off, 1);
  EXPECT_EQ(read.pixels, 1.0 * large * large);
}

TEST(TrustInDem, OverviewsWithMarksMixedInDoNot) {
  // A small hole, of which averages were made before -9999 was said to mean missing.
  const auto own = [](int c, int r) {
    return c >= 2001 && c < 2007 && r >= 901 && r < 907 ? -9999 : rough(c, r);
  };
  const Coarse read = read_coarse(with_overview("mixed.tif", own, [](int c, int r) {
    double sum = 0;
    for (int i = 0; i < 16; ++i) {
      const int x = 4 * c + i % 4, y = 4 * r + i / 4;
      sum += x >= 2001 && x < 2007 && y >= 901 && y < 907 ? -9999 : rough(x, y);
    }
    return sum / 16;
  }));
  EXPECT_LT(read.worst, 40);
  EXPECT_GT(read.overviews_off, 100);
}

TEST(TrustInDem, SmallFilesNeedNoOverviews) {
  const fs::path path = temporary("small.tif");
  write_tiff(path, {.options = {"TILED=YES"}}, height);
  {
    const impl::DatasetPtr file(GDALDataset::Open(path.c_str(), GDAL_OF_UPDATE));
    int level = 4;
    ASSERT_EQ(file->BuildOverviews("NEAREST", 1, &level, 0, nullptr, GDALDummyProgress, nullptr), CE_None);
  }
  DemOptions options;
  options.resolution = 40;
  const Dem dem = read_dem(path, options);
  for (int r = 0; r < 64; ++r)
    for (int c = 0; c < 64; ++c) {
      double sum = 0;
      for (int i = 0; i < 16; ++i) sum += height(4 * c + i % 4, 4 * r + i / 4);
      ASSERT_NEAR(at(dem.raster, c, r), sum / 16, 1e-3);
    }
}

TEST(TrustInDem, AMosaicAcrossTheDateLineIsExplained) {
  const fs::path path = temporary("fiji.tif");
  Tiff tiff{.width = 3600, .height = 20, .crs = "EPSG:4326", .nodata = -9999};
  tiff.transform = {-180, 0.1, 0, -15, 0, -0.1};
  write_tiff(path, tiff, [](int c, int r) { return c < 5 || c >= 3593 ? 100 + c % 7 + r : -9999; });
  const Thrown thrown = thrown_by([&] { read_dem(path); });
  EXPECT_EQ(thrown.kind, ErrorKind::input);
  for (const std::string& text : {thrown.text, joined(inspect_dem(path).notes)}) {
    EXPECT_THAT(text, HasSubstr("cut along the meridian of 180 degrees"));
    EXPECT_THAT(text, HasSubstr("-te 179.3 -17 180.5 -15"));
    EXPECT_THAT(text, Not(HasSubstr("UTM")));
  }
  DemOptions options;
  options.window = {3593, 0, 7, 20};
  EXPECT_GT(read_dem(path, options).raster.width(), 2);
  write_tiff(path, tiff, [](int, int) { return 5; });
  EXPECT_THAT(thrown_by([&] { read_dem(path); }).text, HasSubstr("choose a window"));
}

}  // namespace
}  // namespace tafoni::io
