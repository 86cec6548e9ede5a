// Heightmaps of game engines, tiles of web maps and depths, made here with what they mean known: what is read
// is compared with it, whatever the file is called.

#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <numbers>

#include <gmock/gmock.h>

#include "tafoni/core/random.h"
#include "tafoni/io/test/dem_inputs.h"

namespace tafoni::io {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

/// A hill of 0 to 1 over `side` pixels, which reaches both.
double shape(int c, int r) {
  return 0.5 - 0.5 * std::cos(2 * std::numbers::pi * c / side) * std::cos(2 * std::numbers::pi * r / side);
}
double grey16(int c, int r) {
  return std::round(65535 * shape(c, r));
}

/// Bands of a picture, in whichever format GDAL can copy to.
struct Picture {
  int width = side, height = side;
  GDALDataType type = GDT_Byte;
  std::vector<std::function<double(int, int)>> bands = {};
  const char* driver = "PNG";
};
void write_picture(const fs::path& path, const Picture& picture) {
  impl::ensure_gdal();
  const int bands = static_cast<int>(picture.bands.size());
  const impl::DatasetPtr memory(
      impl::memory_driver().Create("", picture.width, picture.height, bands, picture.type, nullptr));
  constexpr GDALColorInterp colours[] = {GCI_RedBand, GCI_GreenBand, GCI_BlueBand, GCI_AlphaBand};
  std::vector<double> row(picture.width);
  for (int b = 0; b < bands; ++b) {
    GDALRasterBand* band = memory->GetRasterBand(b + 1);
    band->SetColorInterpretation(bands >= 3 ? colours[b] : b == 0 ? GCI_GrayIndex : GCI_AlphaBand);
    for (int r = 0; r < picture.height; ++r) {
      for (int c = 0; c < picture.width; ++c) row[c] = picture.bands[b](c, r);
      ASSERT_EQ(
          band->RasterIO(GF_Write, 0, r, picture.width, 1, row.data(), picture.width, 1, GDT_Float64, 0, 0),
          CE_None);
    }
  }
  const impl::DatasetPtr out(GetGDALDriverManager()
                                 ->GetDriverByName(picture.driver)
                                 ->CreateCopy(path.c_str(), memory.get(), TRUE, nullptr, nullptr, nullptr));
  ASSERT_NE(out, nullptr);
}

/// A height in three bytes of colour.
Picture coloured(const std::function<double(int, int)>& height, double first, double per_metre,
                 int size = side) {
  Picture out{.width = size, .height = size};
  for (const int shift : {16, 8, 0})
    out.bands.push_back([=](int c, int r) {
      return static_cast<double>(std::lround((height(c, r) - first) * per_metre) >> shift & 0xff);
    });
  return out;
}
Picture mapbox(const std::function<double(int, int)>& height, int size = side) {
  return coloured(height, -10'000, 10, size);
}
Picture terrarium(const std::function<double(int, int)>& height, int size = side) {
  return coloured(height, -32'768, 256, size);
}

std::string bytes_of(int width, int height, int count, bool big,
                     const std::function<std::uint32_t(int, int)>& word) {
  std::string out;
  for (int r = 0; r < height; ++r)
    for (int c = 0; c < width; ++c)
      for (int i = 0; i < count; ++i)
        out += static_cast<char>(word(c, r) >> 8 * (big ? count - 1 - i : i) & 0xff);
  return out;
}

/// The greatest difference of what is read from what is meant.
double off_by(const Dem& dem, const std::function<double(int, int)>& meant) {
  double worst = 0;
  for (int r = 0; r < dem.raster.height(); ++r)
    for (int c = 0; c < dem.raster.width(); ++c)
      worst = std::max(worst, std::abs(at(dem.raster, c, r) - meant(c, r)));
  return worst;
}

TEST(Heightmap, SixteenBitsOfGreyMeanTheSameInAnyFile) {
  const auto metres = [](int c, int r) { return grey16(c, r) / 128; };
  write_tiff(temporary("grey16.tif"), {.type = GDT_UInt16, .transform = std::nullopt}, grey16);
  write_png(temporary("grey16.png"), grey16);
  write_picture(temporary("grey16_rgb.png"), {.type = GDT_UInt16, .bands = {grey16, grey16, grey16}});
  write_picture(temporary("grey16_alpha.png"),
                {.type = GDT_UInt16, .bands = {grey16, [](int, int) { return 65535; }}});
  write_tiff(temporary("float_units.tif"), {.transform = std::nullopt}, grey16);
  const auto word = [](int c, int r) { return static_cast<std::uint32_t>(grey16(c, r)); };
  for (const char* name : {"little.raw", "little.r16", "little.heights", "little"})
    written(name, bytes_of(side, side, 2, false, word));
  for (const char* name : {"big.raw", "big.r16", "big.heightmap"})
    written(name, bytes_of(side, side, 2, true, word));
  for (const char* name :
       {"grey16.tif", "grey16.png", "grey16_rgb.png", "grey16_alpha.png", "float_units.tif", "little.raw",
        "little.r16", "little.heights", "little", "big.raw", "big.r16", "big.heightmap"}) {
    const Dem dem = read_dem(temporary(name));
    EXPECT_LT(off_by(dem, metres), 1e-4) << name;
    EXPECT_THAT(joined(dem.notes), AllOf(HasSubstr("1/128 m"), HasSubstr("terrain.height_scale"))) << name;
    const DemInfo info = inspect_dem(temporary(name));
    EXPECT_NEAR(info.highest, 511.99, 0.01) << name;
    EXPECT_THAT(joined(info.notes), HasSubstr("1/128 m")) << name;
  }
}

TEST(Heightmap, FloatsFromZeroToOneSpanTheSame) {
  const auto metres = [](int c, int r) { return 512 * shape(c, r); };
  const auto word = [](int c, int r) {
    return std::bit_cast<std::uint32_t>(static_cast<float>(shape(c, r)));
  };
  write_tiff(temporary("unit.tif"), {.transform = std::nullopt}, shape);
  written("unit.r32", bytes_of(side, side, 4, false, word));
  written("unit_big.raw", bytes_of(side, side, 4, true, word));
  for (const char* name : {"unit.tif", "unit.r32", "unit_big.raw"}) {
    const Dem dem = read_dem(temporary(name));
    EXPECT_LT(off_by(dem, metres), 1e-3) << name;
    EXPECT_THAT(joined(dem.notes), HasSubstr("floats from 0 to 1 says nothing of heights; taken as 512 m"))
        << name;
  }
}

TEST(Heightmap, WhatSaysMoreIsLeftAlone) {
  // Metres without a place, numbers of 16 bits with one, or with a unit, a scale or a mark for missing data.
  const std::optional<std::array<double, 6>> nowhere;
  const auto metres = [](int c, int r) { return std::round(300 * shape(c, r)); };
  write_tiff(temporary("placed.tif"), {.type = GDT_UInt16}, metres);
  write_tiff(temporary("unit_named.tif"), {.type = GDT_UInt16, .transform = nowhere, .unit = "m"}, metres);
  write_tiff(temporary("marked.tif"), {.type = GDT_UInt16, .transform = nowhere, .nodata = 65535}, metres);
  write_tiff(temporary("signed.tif"), {.type = GDT_Int16, .transform = nowhere}, metres);
  write_tiff(temporary("floats.tif"), {.transform = nowhere}, metres);
  for (const char* name : {"placed.tif", "unit_named.tif", "marked.tif", "signed.tif", "floats.tif"}) {
    const Dem dem = read_dem(temporary(name));
    EXPECT_LT(off_by(dem, metres), 1e-4) << name;
    EXPECT_THAT(joined(dem.notes), Not(HasSubstr("heightmap"))) << name;
  }
}

TEST(Heightmap, TheUsersWordCountsMore) {
  write_png(temporary("said.png"), grey16);
  DemOptions options;
  options.encoding = HeightEncoding::heights;
  EXPECT_LT(off_by(read_dem(temporary("said.png"), options), grey16), 1e-2);
  write_tiff(temporary("said.tif"), {}, shape);
  options.encoding = HeightEncoding::heightmap;
  EXPECT_LT(off_by(read_dem(temporary("said.tif"), options), [](int c, int r) { return 512 * shape(c, r); }),
            1e-3);
  // Unreal at a scale of 200: z = (v - 32768) / 128 cm * 200.
  options = {};
  options.height_scale = 2.0 / 128;
  options.height_offset = -512;
  const Dem unreal = read_dem(temporary("said.png"), options);
  EXPECT_LT(off_by(unreal, [](int c, int r) { return (grey16(c, r) - 32768) / 64; }), 1e-3);
  EXPECT_THAT(joined(unreal.notes), Not(HasSubstr("1/128")));
}

TEST(Heightmap, RawFilesNeedNotBeSquare) {
  constexpr int width = 300, height = 192;  // 240 * 240 numbers of 16 bits, as it happens
  const auto word = [](int c, int r) { return static_cast<std::uint32_t>(grey16(c, r)); };
  const fs::path path = written("oblong.raw", bytes_of(width, height, 2, true, word));
  DemOptions options;
  options.raw_size = {width, height};
  const Dem dem = read_dem(path, options);
  EXPECT_EQ(dem.raster.width(), width);
  EXPECT_LT(off_by(dem, [](int c, int r) { return grey16(c, r) / 128; }), 1e-4);
  EXPECT_THAT(joined(dem.notes), HasSubstr("300 x 192 big-endian 16-bit"));
  options.byte_order = ByteOrder::little;
  EXPECT_THAT(joined(read_dem(path, options).notes), HasSubstr("little-endian"));
  options.raw_size = {300, 193};
  EXPECT_THAT(thrown_by([&] { read_dem(path, options); }).text, HasSubstr("not 300 x 193 heights"));
  options = {};
  options.raw_size = {300, 192};
  write_png(temporary("no_raw.png"), grey16);
  EXPECT_THAT(thrown_by([&] { read_dem(temporary("no_raw.png"), options); }).text,
              HasSubstr("says its own size"));
}

TEST(Heightmap, BytesAndOddSizesAreTold) {
  const fs::path bytes =
      written("bytes.raw",
              bytes_of(side, side, 1, false, [](int c, int r) { return std::lround(255 * shape(c, r)); }));
  EXPECT_LT(off_by(read_dem(bytes), [](int c, int r) { return std::round(255 * shape(c, r)); }), 1e-4);
  EXPECT_THAT(thrown_by([] { read_dem(written("odd.r16", std::string(1001, 'a'))); }).text,
              AllOf(HasSubstr("1001 bytes"), HasSubstr("terrain.raw_size")));
  // What is called otherwise must be smooth.
  Random random(3);
  std::string noise;
  for (int i = 0; i < 2 * 64 * 64; ++i) noise += static_cast<char>(random.below(256));
  EXPECT_THAT(thrown_by([&] { read_dem(written("noise.bin", noise)); }).text, HasSubstr("cannot be read"));
  // A tile or the rows of a file that has lost its name or header are no heightmap.
  const auto rows =
      bytes_of(side, side, 2, true, [](int c, int r) { return std::lround(300 * shape(c, r)); });
  for (const char* name : {"alps.hgt", "rows.bil", "rows.flt", "rows.TIF"})
    EXPECT_THAT(thrown_by([&] { read_dem(written(name, rows)); }).text, HasSubstr("cannot be read")) << name;
  EXPECT_THAT(joined(read_dem(written("noise.r16", noise)).notes), HasSubstr("its numbers jump about"));
}

TEST(ColourHeights, TilesAreToldFromPictures) {
  const auto hills = [](int c, int r) { return 700 + 400 * shape(c, r) + 3 * std::sin(c * 0.7 + r); };
  const auto gentle = [](int c, int r) { return 31 + 40 * shape(c, r) + 0.4 * std::sin(c * 0.3 - r * 0.2); };
  const auto alps = [](int c, int r) {
    return 1500 + 1400 * std::sin(c * 0.09) * std::cos(r * 0.07) + 2 * ((c * 7 + r * 3) % 5);
  };
  const auto seabed = [](int c, int r) { return -5200 + 5300 * shape(c, r); };
  struct Tile {
    const char* name;
    Picture picture;
    std::function<double(int, int)> height;
    double step;
    const char* says;
  };
  for (const Tile& tile : {Tile{"12_2138_1420.png", mapbox(hills), hills, 0.1, "terrain-rgb"},
                           Tile{"gentle_m.png", mapbox(gentle), gentle, 0.1, "terrain-rgb"},
                           Tile{"alps_m.png", mapbox(alps, 512), alps, 0.1, "terrain-rgb"},
                           Tile{"hills_t.png", terrarium(hills), hills, 1.0 / 256, "terrarium"},
                           Tile{"gentle_t.png", terrarium(gentle), gentle, 1.0 / 256, "terrarium"},
                           Tile{"alps_t.png", terrarium(alps), alps, 1.0 / 256, "terrarium"},
                           Tile{"seabed_t.png", terrarium(seabed), seabed, 1.0 / 256, "terrarium"}}) {
    write_picture(temporary(tile.name), tile.picture);
    const Dem dem = read_dem(temporary(tile.name));
    EXPECT_LT(off_by(dem, tile.height), 0.51 * tile.step + 1e-3) << tile.name;
    EXPECT_THAT(joined(dem.notes), HasSubstr(tile.says)) << tile.name;
  }
}

TEST(ColourHeights, PicturesAreRefusedAndMayBeSaidToHoldHeights) {
  Random random(11);
  std::vector<double> noise(side * side);
  for (double& v : noise) v = random.uniform();
  const auto wave = [](double a, double b, double lo, double hi) {
    return [=](int c, int r) {
      return std::round(lo + (hi - lo) * (0.5 + 0.5 * std::sin(a * c) * std::cos(b * r)));
    };
  };
  const auto noisy = [&](double lo, double hi) {
    return [&noise, lo, hi](int c, int r) { return std::round(lo + (hi - lo) * noise[r * side + c]); };
  };
  const auto flat = [](double v) { return [v](int, int) { return v; }; };
  const std::vector<std::function<double(int, int)>> photographs[] = {
      {wave(0.02, 0.03, 0, 255), wave(0.04, 0.01, 0, 255), wave(0.05, 0.05, 0, 255)},
      {wave(0.02, 0.03, 90, 150), wave(0.04, 0.01, 0, 255), wave(0.05, 0.05, 0, 255)},
      {noisy(90, 160), noisy(0, 255), noisy(0, 255)},
      {flat(1), noisy(120, 180), noisy(0, 255)},
      {flat(128), wave(0.02, 0.03, 20, 60), wave(0.03, 0.02, 20, 60)},
      {flat(1), wave(0.02, 0.03, 140, 180), flat(30)}};
  int n = 0;
  for (const auto& bands : photographs) {
    const fs::path path = temporary(fmt::format("photograph{}.png", n++));
    write_picture(path, {.bands = bands});
    EXPECT_THAT(thrown_by([&] { read_dem(path); }).text,
                AllOf(HasSubstr("is a picture"), HasSubstr("terrain.encoding")))
        << n;
  }
  DemOptions options;
  options.encoding = HeightEncoding::terrain_rgb;
  const auto deep = [](int c, int r) { return -7000 + 3000 * shape(c, r); };
  write_picture(temporary("deep.png"), mapbox(deep));
  EXPECT_THAT(thrown_by([] { read_dem(temporary("deep.png")); }).text, HasSubstr("terrain.encoding"));
  EXPECT_LT(off_by(read_dem(temporary("deep.png"), options), deep), 0.052);
  write_png(temporary("grey.png"), grey16);
  EXPECT_THAT(thrown_by([&] { read_dem(temporary("grey.png"), options); }).text,
              HasSubstr("no picture of three 8-bit colours"));
}

TEST(ColourHeights, BlackAndTransparencyAreMissing) {
  const auto hills = [](int c, int r) { return 700 + 400 * shape(c, r); };
  Picture tile = mapbox(hills);
  for (auto& band : tile.bands) band = [band](int c, int r) { return c < 64 ? 0 : band(c, r); };
  write_picture(temporary("black.png"), tile);
  EXPECT_NEAR(read_dem(temporary("black.png")).missing, 0.25, 1e-9);
  tile = mapbox(hills);
  tile.bands.push_back([](int c, int) { return c < 64 ? 0 : 255; });
  write_picture(temporary("transparent.png"), tile);
  EXPECT_NEAR(read_dem(temporary("transparent.png")).missing, 0.25, 1e-9);
}

TEST(Depths, AreTurnedWhereTheFileSaysSo) {
  const auto depth = [](int c, int r) { return 20 + 80 * shape(c, r); };
  const auto turned = [&](int c, int r) { return -depth(c, r); };
  write_tiff(temporary("axis.tif"), {.crs = "EPSG:32631+5715"}, depth);
  const auto with = [&](const char* name, const char* key, const char* value, const char* band) {
    write_tiff(temporary(name), {}, depth);
    const impl::DatasetPtr open(GDALDataset::Open(temporary(name).c_str(), GDAL_OF_UPDATE));
    if (*key != 0) open->SetMetadataItem(key, value);
    if (*band != 0) open->GetRasterBand(1)->SetDescription(band);
  };
  with("positive.tif", "positive", "down", "");
  with("standard.tif", "standard_name", "sea_floor_depth_below_mean_sea_level", "");
  with("image.tif", "TIFFTAG_IMAGEDESCRIPTION", "soundings in metres, positive down", "");
  with("band.tif", "", "", "Depth");
  with("bathy.tif", "", "", "Bathymetry");
  with("long.tif", "long_name", "bathymetric grid", "");
  with("sounding.tif", "description", "mean sounding", "");
  for (const char* name : {"axis.tif", "positive.tif", "standard.tif", "image.tif", "band.tif", "bathy.tif",
                           "long.tif", "sounding.tif"}) {
    const Dem dem = read_dem(temporary(name));
    EXPECT_LT(off_by(dem, turned), 1e-4) << name;
    EXPECT_THAT(joined(dem.notes), HasSubstr("holds depths, positive down")) << name;
  }
  // Heights below zero need no turning, whatever the band is called; nor does the name of a file decide.
  write_tiff(temporary("below.tif"), {}, turned);
  {
    const impl::DatasetPtr open(GDALDataset::Open(temporary("below.tif").c_str(), GDAL_OF_UPDATE));
    open->GetRasterBand(1)->SetDescription("depth");
  }
  EXPECT_LT(off_by(read_dem(temporary("below.tif")), turned), 1e-4);
  // Bathymetry that reaches above the sea is heights.
  const auto coast = [&](int c, int r) { return depth(c, r) - 25; };
  write_tiff(temporary("coast.tif"), {}, coast);
  {
    const impl::DatasetPtr open(GDALDataset::Open(temporary("coast.tif").c_str(), GDAL_OF_UPDATE));
    open->GetRasterBand(1)->SetDescription("bathymetry");
  }
  EXPECT_LT(off_by(read_dem(temporary("coast.tif")), coast), 1e-4);
  with("above.tif", "long_name", "elevation, depths negative", "elevation");
  EXPECT_LT(off_by(read_dem(temporary("above.tif")), depth), 1e-4);
  write_tiff(temporary("depths.tif"), {}, depth);
  DemOptions options;
  const Dem named = read_dem(temporary("depths.tif"), options);
  EXPECT_LT(off_by(named, depth), 1e-4);
  EXPECT_THAT(joined(named.notes), HasSubstr("terrain.height_scale = -1"));
  options.height_scale = -1;
  const Dem said = read_dem(temporary("depths.tif"), options);
  EXPECT_LT(off_by(said, turned), 1e-4);
  EXPECT_THAT(said.notes, IsEmpty());
  // Marks of missing data stay marks.
  options.fill_distance = 0;
  for (const double mark : {9999.0, 99999.0, 32767.0, -9999.0}) {
    write_tiff(temporary("marks.tif"), {}, [&](int c, int r) { return c + r < 40 ? mark : depth(c, r); });
    const Dem marked = read_dem(temporary("marks.tif"), options);
    EXPECT_TRUE(std::isnan(at(marked.raster, 3, 3))) << mark;
    EXPECT_NEAR(at(marked.raster, 100, 90), turned(100, 90), 1e-4);
  }
}

TEST(OwnCrs, IsTakenWhereTheFileNamesNone) {
  const fs::path metres = ascii("metres.asc", 8, 8, at_home, hill);
  DemOptions options;
  options.own_crs = "EPSG:32631";
  const Dem dem = read_dem(metres, options);
  EXPECT_THAT(dem.raster.crs, HasSubstr("UTM zone 31N"));
  EXPECT_EQ(dem.raster.placement.west, 500'000);
  const fs::path degrees = ascii("degrees.asc", 60, 60, "xllcorner 3\nyllcorner 50\ncellsize 0.001", hill);
  options.own_crs = "EPSG:4258";
  const Dem projected = read_dem(degrees, options);
  EXPECT_THAT(projected.raster.crs, HasSubstr("ETRS89"));
  EXPECT_NEAR(projected.raster.placement.west, 500'000, 30);
  options.own_crs = "EPSG:32631";
  write_tiff(temporary("own.tif"), {}, height);
  EXPECT_THAT(thrown_by([&] { read_dem(temporary("own.tif"), options); }).text,
              HasSubstr("leave out terrain.crs"));
  write_tiff(temporary("nowhere.tif"), {.transform = std::nullopt}, height);
  EXPECT_THAT(thrown_by([&] { read_dem(temporary("nowhere.tif"), options); }).text,
              HasSubstr("no georeference"));
  for (const char* text : {"nonsense", "/etc/hostname", "http://localhost/x.wkt"}) {
    options.own_crs = text;
    EXPECT_THAT(thrown_by([&] { read_dem(metres, options); }).text, HasSubstr("is not understood"));
  }
}

}  // namespace
}  // namespace tafoni::io
