#include "tafoni/io/dem.h"

#include <cmath>
#include <csignal>
#include <cstdint>

#include <gmock/gmock.h>
#include <sys/resource.h>

#include "tafoni/io/test/dem_testing.h"
#include "tafoni/raster/resample.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::IsEmpty;

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

TEST(ReadDem, GoesWhereItIsWanted) {
  const fs::path path = temporary("utm30.tif");
  raster::Raster made{raster::Grid<float>(50, 40), {600000, 5900000, 10, 10}, "EPSG:32630"};
  for (int r = 0; r < 40; ++r)
    for (int c = 0; c < 50; ++c) made.values.at(c, r) = static_cast<float>(hill(c, r));
  write_geotiff(path, made);
  DemOptions options;
  options.crs = "EPSG:32630";
  const Dem same = read_dem(path, options);
  EXPECT_EQ(same.raster.values.values(), made.values.values());
  EXPECT_THAT(same.notes, IsEmpty());
  // ETRS89 and WGS 84 agree to a metre; zone 31 begins 6 degrees further east.
  options.crs = "EPSG:25830";
  const Dem near = read_dem(path, options);
  EXPECT_THAT(joined(near.notes), HasSubstr("reprojected to ETRS89 / UTM zone 30N"));
  EXPECT_NEAR(raster::sample_bicubic(near.raster, 600205, 5899795), hill(20, 20), 0.3);
  options.crs = "EPSG:32631";
  const Dem far = read_dem(path, options);
  EXPECT_LT(far.raster.placement.west, 210'000);
  EXPECT_NEAR(far.raster.placement.dx, 10, 0.1);
  options.crs = "EPSG:4326";
  EXPECT_EQ(thrown_by([&] { read_dem(path, options); }).kind, ErrorKind::usage);
  options.crs = "EPSG:32630";
  const Dem placed = read_dem(ascii("bare.asc", 20, 10, at_home, hill), options);
  EXPECT_THAT(joined(placed.notes), HasSubstr("taken to be in WGS 84 / UTM zone 30N"));
  EXPECT_THAT(placed.raster.crs, HasSubstr("UTM zone 30N"));
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
  EXPECT_THAT(read(written("odd.r16", "123")).text, HasSubstr("no square of 16-bit heights"));
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
  for (const double resolution : {-1.0, double{NAN}, double{INFINITY}, 1e6, 1e-4}) {
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
