// Any bytes as an elevation model. The first line of an input is the end of the file's name and options, see
// options_of(); what follows is the file. Bare numbers are read by code of our own, text and pixels by GDAL,
// of which heights, a place and a size are made here.

#include <algorithm>
#include <array>
#include <charconv>
#include <iterator>

#include "fuzz.h"

#include "tafoni/core/parallel.h"
#include "tafoni/io/dem.h"

using namespace tafoni;

std::vector<std::string> fuzz_seeds() {
  set_thread_count(1);
  std::string rows, big, floats, tiles = "ppm\nP6 5 4 255\n";
  for (int i = 0; i < 144; ++i) {
    const int height = i / 12 * 3 + i % 12 * 2;
    rows += {static_cast<char>(height), '\1'};
    big += {'\1', static_cast<char>(height)};
    const float metres = 0.01f * static_cast<float>(height);
    floats.append(reinterpret_cast<const char*>(&metres), sizeof metres);
  }
  for (int i = 0; i < 20; ++i) tiles += {'\1', static_cast<char>(0x90 + i / 10), static_cast<char>(25 * i)};
  const std::string text =
      "ncols 4\nnrows 3\nxllcorner 447000.5\nyllcorner 5909000\ncellsize 2\n"
      "NODATA_value -9999\n1 2 3 4.5\n5 -9999 7e1 8\n9 10 11 nan\n";
  return {"r16\n" + rows,
          "r16 w=9 h=16 order=2 scale=0.5\n" + big,
          "raw order=1\n" + floats,
          "r32 w=4 h=36 smooth=1 fill=100\n" + floats,
          "r8 pixel=2 offset=-3\n" + rows.substr(0, 64),
          "heights\n" + rows,
          "asc smooth=1\n" + text,
          "asc crs=1 left=1 top=0 width=3 height=3 resolution=4\n" + text,
          "asc\nncols 3\nnrows 2\nxllcenter 8.5\nyllcenter 47\ndx 0.01\ndy 0.02\n1 2 3\n4 5 6\n",
          tiles,
          "ppm encoding=3" + tiles.substr(3),
          "ppm encoding=4" + tiles.substr(3),
          "pgm encoding=2\nP5\n4 4 65535\n" + rows.substr(0, 32)};
}

namespace {

/// NAME=VALUE; what is not known, and what is no number, is passed over.
io::DemOptions options_of(std::string_view line) {
  io::DemOptions out;
  std::array<int, 4> window{0, 0, 4, 4};
  while (!line.empty()) {
    std::string_view value = take_until(line, ' ');
    const std::string_view name = take_until(value, '=');
    double number = 0;
    std::from_chars(value.data(), value.data() + value.size(), number);
    const int whole = std::isfinite(number) ? static_cast<int>(std::clamp(number, -1e6, 1e6)) : 0;
    const auto choice = [&](int most) { return std::clamp(whole, 0, most); };
    if (name == "w") out.raw_size[0] = whole;
    if (name == "h") out.raw_size[1] = whole;
    if (name == "order") out.byte_order = static_cast<io::ByteOrder>(choice(2));
    if (name == "encoding") out.encoding = static_cast<io::HeightEncoding>(choice(4));
    if (name == "scale") out.height_scale = number;
    if (name == "offset") out.height_offset = number;
    if (name == "pixel") out.pixel_size = number;
    if (name == "resolution") out.resolution = number;
    if (name == "fill") out.fill_distance = number;
    if (name == "smooth") out.smooth = whole != 0;
    if (name == "band") out.band = whole;
    if (name == "crs") out.own_crs = whole == 1 ? "EPSG:25832" : "EPSG:4326";
    constexpr std::string_view sides[] = {"left", "top", "width", "height"};
    for (int i = 0; i < 4; ++i)
      if (name == sides[i]) window[i] = whole, out.window = window;
  }
  return out;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  std::string_view text = as_text(data, size), line = take_until(text, '\n');
  constexpr std::string_view ends[] = {"raw", "r8", "r16", "r32", "heights", "asc", "ppm", "pgm"};
  const std::string_view end = take_until(line, ' ');
  if (std::find(std::begin(ends), std::end(ends), end) == std::end(ends)) return 0;
  const std::filesystem::path file = folder.write("a." + std::string(end), text);
  const io::DemOptions options = options_of(line);
  // Of some the whole is looked at, as `tafoni info` does.
  if (size % 4 == 0) {
    accepts(
        [&] {
          const io::DemInfo info = io::inspect_dem(file, options);
          require(info.width > 0 && info.height > 0 && info.missing >= 0 && info.missing <= 1);
        },
        {ErrorKind::input, ErrorKind::usage});
    return 0;
  }
  accepts(
      [&] {
        const io::Dem dem = io::read_dem(file, options);
        const raster::Raster& raster = dem.raster;
        require(raster.width() >= 2 && raster.height() >= 2 && dem.missing >= 0 && dem.missing <= 1);
        const raster::Placement& at = raster.placement;
        require(std::isfinite(at.west) && std::isfinite(at.north) && at.dx > 0 && at.dy > 0);
        for (const float v : raster.values.values()) require(!std::isinf(v));
      },
      {ErrorKind::input, ErrorKind::usage});
  return 0;
}
