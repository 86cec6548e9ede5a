// Heights in three bytes of colour. That a picture holds them shows in how it bends: the second difference
// along a row is small, and becomes large when the lower bytes are taken from elsewhere in the row. In a
// photograph the lower bytes matter to it no more there than here.

#include "tafoni/io/impl/colour_heights.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <vector>

#include "tafoni/io/impl/stored_heights.h"

namespace tafoni::io::impl {
namespace {

/// Rows that are looked at.
constexpr int looked_at_rows = 64;
/// The second difference as it is, in parts of what it is with strange lower bytes: below, they belong.
constexpr double belongs = 0.9;
/// Fewer places than this judge nothing.
constexpr double least_places = 500;
/// Metres between which the heights of a tile lie. Of Mapbox's encoding only land is told from pictures and
/// from other encodings that begin at black.
constexpr double lowest_tile = -11'000, highest_tile = 9'000, lowest_land = -500;

double decoded(HeightEncoding encoding, double value) {
  return encoding == HeightEncoding::terrarium ? value / 256 - 32768 : value * 0.1 - 10'000;
}

/// Rows of three bands as one number each, and what they have in common.
struct Look {
  bool readable = true, grey = true, bytes = true;
  double lo = std::numeric_limits<double>::infinity(), hi = -lo;
  double places = 0;
  double bend = 0;                  ///< sum of second differences
  std::array<double, 2> strange{};  ///< with the lowest, with the lower two bytes from elsewhere

  void add_row(const std::vector<std::uint32_t>& row) {
    // The halves of the row swap their lower bytes, so that these bend as much as before where they stand
    // alone.
    const std::size_t half = row.size() / 2, n = 2 * half;
    const auto bent = [&](std::size_t i, std::uint32_t mask) {
      const auto value = [&](std::size_t at) {
        const std::uint32_t lower = row[at < half ? at + half : at - half];
        return static_cast<double>((row[at] & ~mask) | (lower & mask));
      };
      return std::abs(value(i - 1) - 2 * value(i) + value(i + 1));
    };
    for (std::size_t i = 0; i < n; ++i) {
      if (row[i] == 0) continue;
      lo = std::min<double>(lo, row[i]);
      hi = std::max<double>(hi, row[i]);
      const bool at_end = i % half == 0 || (i + 1) % half == 0;
      if (at_end || row[i - 1] == 0 || row[i + 1] == 0) continue;
      ++places;
      bend += bent(i, 0);
      strange[0] += bent(i, 0xff);
      strange[1] += bent(i, 0xffff);
    }
  }
};

Look look_at(const ColourBands& bands) {
  Look out;
  const int width = bands[0]->GetXSize();
  std::array<std::vector<float>, 3> values;
  for (auto& band : values) band.resize(width);
  for (GDALRasterBand* band : bands) out.bytes = out.bytes && band->GetRasterDataType() == GDT_Byte;
  std::vector<std::uint32_t> row(width);
  for (const int r : spread_rows(bands[0]->GetYSize(), looked_at_rows)) {
    for (int b = 0; b < 3; ++b)
      out.readable = out.readable && bands[b]->RasterIO(GF_Read, 0, r, width, 1, values[b].data(), width, 1,
                                                        GDT_Float32, 0, 0) == CE_None;
    if (!out.readable) return out;
    const auto equal = [&](int b) {
      return std::memcmp(values[0].data(), values[b].data(), values[0].size() * sizeof(float)) == 0;
    };
    out.grey = out.grey && equal(1) && equal(2);
    if (!out.bytes) continue;
    for (int i = 0; i < width; ++i)
      row[i] = static_cast<std::uint32_t>(values[0][i]) << 16 |
               static_cast<std::uint32_t>(values[1][i]) << 8 | static_cast<std::uint32_t>(values[2][i]);
    out.add_row(row);
  }
  return out;
}

}  // namespace

ColourBands colour_bands(GDALDataset& dataset) {
  ColourBands out{};
  ColourBands plain{};
  std::size_t count = 0;
  for (int b = 1; b <= dataset.GetRasterCount(); ++b) {
    GDALRasterBand* band = dataset.GetRasterBand(b);
    const GDALColorInterp colour = band->GetColorInterpretation();
    if (colour == GCI_RedBand) out[0] = band;
    if (colour == GCI_GreenBand) out[1] = band;
    if (colour == GCI_BlueBand) out[2] = band;
    if (colour != GCI_AlphaBand && count < 3) plain[count++] = band;
  }
  if (out[0] != nullptr && out[1] != nullptr && out[2] != nullptr) return out;
  return count == 3 ? plain : ColourBands{};
}

Colours look_at_colours(const ColourBands& bands) {
  GdalMessages messages;
  const Look look = look_at(bands);
  if (!look.readable) return Colours::picture;
  if (look.grey) return Colours::grey;
  const bool belong = look.places >= least_places &&
                      (look.bend < belongs * look.strange[0] || look.bend < belongs * look.strange[1]);
  if (!look.bytes || !belong) return Colours::picture;
  const auto lies = [&](HeightEncoding encoding, double lowest) {
    return decoded(encoding, look.lo) >= lowest && decoded(encoding, look.hi) <= highest_tile;
  };
  if (lies(HeightEncoding::terrain_rgb, lowest_land)) return Colours::terrain_rgb;
  if (lies(HeightEncoding::terrarium, lowest_tile)) return Colours::terrarium;
  return Colours::picture;
}

bool read_colour_heights(const ColourBands& bands, HeightEncoding encoding, int x, int y, int w, int h,
                         double* out) {
  const std::size_t count = std::int64_t{w} * h;
  std::vector<std::uint8_t> bytes(count);
  std::fill(out, out + count, 0.0);
  for (GDALRasterBand* band : bands) {
    if (band->RasterIO(GF_Read, x, y, w, h, bytes.data(), w, h, GDT_Byte, 0, 0) != CE_None) return false;
    for (std::size_t i = 0; i < count; ++i) out[i] = out[i] * 256 + bytes[i];
  }
  for (std::size_t i = 0; i < count; ++i)
    out[i] = out[i] == 0 ? std::numeric_limits<double>::quiet_NaN() : decoded(encoding, out[i]);
  return true;
}

}  // namespace tafoni::io::impl
