// Elevation files as windows of heights: through GDAL, or as headerless square heightmaps of 16 bits.
// Marks of missing data that no tag admits to are found here, and windows are averaged down by strips
// from the coarsest overview that is fine enough.

#include "tafoni/io/impl/dem_source.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <optional>

#include "tafoni/io/impl/gdal_names.h"
#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

/// Metres; beyond it a height is a mark for missing data, whatever the tags say.
constexpr double absurd_height = 1e5;

/// Values that stand for missing data when no tag says so.
constexpr double sentinels[] = {-9999, -32768, -32767, -99999};
/// Metres: other heights this near to a sentinel make it a height as well.
constexpr double near_sentinel = 200;

/// A tag this large or larger is compared to so many parts of itself, as it is often written with fewer
/// digits than the value it means (-3.402823e+38); smaller ones are exact.
constexpr double long_tag = 1e6, long_tag_error = 1e-6;

/// An overview serves although rounding made it so much smaller than the size asked for.
constexpr double overview_share = 0.999;

/// The share of a pixel of an average that must be known, and the part by which rounding may make it less.
constexpr double known_share = 0.5, known_rounding = 1e-6;

/// Pixels read at once: 16 MB of doubles.
constexpr int strip_pixels = 1 << 21;

/// The sentinel among the values, unless true values lie near it, as the sea floor may at -9999 m.
std::optional<double> find_sentinel(const double* values, std::size_t count) {
  for (const double mark : sentinels) {
    bool found = false, near = false;
    for (std::size_t i = 0; i < count && !near; ++i) {
      found = found || values[i] == mark;
      near = values[i] != mark && std::abs(values[i] - mark) < near_sentinel;
    }
    if (found && !near) return mark;
  }
  return std::nullopt;
}

std::string lower(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

/// Metres a unit, or 0 when the word is unknown.
double metres_of(const std::string& word) {
  static const std::vector<std::pair<double, std::vector<const char*>>> units = {
      {1, {"", "m", "metre", "meter", "metres", "meters"}},
      {0.3048, {"ft", "foot", "feet", "international foot", "ift"}},
      {1200.0 / 3937,
       {"us survey foot", "us survey feet", "us-ft", "ftus", "us_survey_foot", "survey foot", "foot_us",
        "usft", "us ft", "sfoot"}},
      {0.01, {"cm", "centimetre", "centimeter", "centimetres", "centimeters"}},
      {0.1, {"dm", "decimetre", "decimeter"}},
      {0.001, {"mm", "millimetre", "millimeter"}},
      {1000, {"km", "kilometre", "kilometer"}}};
  for (const auto& [metres, words] : units)
    if (std::find(words.begin(), words.end(), lower(word)) != words.end()) return metres;
  return 0;
}

/// 16-bit heightmap pictures say nothing of heights; this is what game engines make of them by default.
constexpr double picture_step = 1.0 / 128;

void note_picture(DemSource& source) {
  source.scale = picture_step;
  source.notes.push_back(
      "a 16-bit heightmap says nothing of heights; taken as 1/128 m a unit, 512 m from black to white.");
}

class GdalSource final : public DemSource {
 public:
  GdalSource(const std::filesystem::path& path, int wanted)
      : dataset_(open_dataset(path, GDAL_OF_RASTER, "an elevation model")) {
    name = path.string();
    driver = dataset_->GetDriver()->GetMetadataItem(GDAL_DMD_LONGNAME);
    bands = dataset_->GetRasterCount();
    choose_band(wanted);
    GDALRasterBand* own = dataset_->GetRasterBand(band);
    type = GDALGetDataTypeName(own->GetRasterDataType());
    bytes = own->GetRasterDataType() == GDT_Byte;
    if (GDALDataTypeIsComplex(own->GetRasterDataType()))
      fail(ErrorKind::input, "{}: band {} holds complex numbers, not elevations.", name, band);
    int tagged = 0;
    nodata = own->GetNoDataValue(&tagged);
    has_nodata = tagged != 0;
    list_levels(own);
    nan_marks_missing = pairs_.front().mask != nullptr || (has_nodata && std::isnan(nodata));
    read_georeference();
    read_units(own);
  }

 private:
  struct Pair {
    GDALRasterBand* heights;
    GDALRasterBand* mask;  ///< null where nodata values say it all
  };

  void choose_band(int wanted) {
    if (bands == 0)
      fail(ErrorKind::input,
           "{} holds no raster of its own; name one of its subdatasets (gdalinfo lists them).", name);
    if (wanted < 0 || wanted > bands)
      fail(ErrorKind::usage, "{} has {} band{}; there is no band {}.", name, bands, bands == 1 ? "" : "s",
           wanted);
    band = std::max(wanted, 1);
    if (wanted > 0) return;
    const auto colour = [&](int b) { return dataset_->GetRasterBand(b)->GetColorInterpretation(); };
    int heights = 0, coloured = 0;
    for (int b = bands; b >= 1; --b) {
      if (colour(b) == GCI_AlphaBand) continue;
      heights = b;
      coloured += colour(b) == GCI_RedBand || colour(b) == GCI_GreenBand || colour(b) == GCI_BlueBand;
    }
    const bool all_bytes = dataset_->GetRasterBand(1)->GetRasterDataType() == GDT_Byte;
    if (coloured > 1 || colour(1) == GCI_PaletteIndex || (bands >= 3 && all_bytes))
      fail(ErrorKind::input,
           "{} is a picture ({} bands of colour), not an elevation model; give the elevations' own file, or "
           "say which band holds heights.",
           name, bands);
    if (heights == 0) fail(ErrorKind::input, "{} holds only a transparency band, no elevations.", name);
    band = heights;
    if (bands > 1 && colour(bands) != GCI_AlphaBand)
      notes.push_back(fmt::format("has {} bands; band {} is taken as the elevations.", bands, band));
  }

  void list_levels(GDALRasterBand* own) {
    const auto add = [&](GDALRasterBand* heights) {
      int block_width = 0, block_height = 0;
      heights->GetBlockSize(&block_width, &block_height);
      levels.push_back({heights->GetXSize(), heights->GetYSize(), std::max(block_height, 1)});
      const int flags = heights->GetMaskFlags();
      const bool masked = (flags & (GMF_ALL_VALID | GMF_NODATA)) == 0;
      pairs_.push_back({heights, masked ? heights->GetMaskBand() : nullptr});
    };
    add(own);
    std::vector<GDALRasterBand*> overviews;
    for (int i = 0; i < own->GetOverviewCount(); ++i)
      if (GDALRasterBand* overview = own->GetOverview(i)) overviews.push_back(overview);
    std::sort(overviews.begin(), overviews.end(),
              [](GDALRasterBand* a, GDALRasterBand* b) { return a->GetXSize() > b->GetXSize(); });
    for (GDALRasterBand* overview : overviews) add(overview);
  }

  void read_georeference() {
    georeferenced = dataset_->GetGeoTransform(transform.data()) == CE_None;
    const OGRSpatialReference* known = dataset_->GetSpatialRef();
    if (!georeferenced && dataset_->GetGCPCount() > 0) {
      georeferenced =
          GDALGCPsToGeoTransform(dataset_->GetGCPCount(), dataset_->GetGCPs(), transform.data(), TRUE) != 0;
      known = dataset_->GetGCPSpatialRef();
      if (georeferenced)
        notes.push_back("is placed by ground control points; an affine map through them is used.");
    }
    if (georeferenced && known != nullptr) {
      crs = *known;
      crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
    }
    const double along = std::hypot(transform[1], transform[4]),
                 across = std::hypot(transform[2], transform[5]);
    const double area = std::abs(transform[1] * transform[5] - transform[2] * transform[4]);
    const auto likely = [](double pixel) { return pixel > 1e-9 && pixel < 1e7; };
    const bool placed = std::abs(transform[0]) < 1e12 && std::abs(transform[3]) < 1e12;
    if (georeferenced && !(placed && likely(along) && likely(across) && area > 1e-6 * along * across))
      fail(ErrorKind::input, "{}: its georeference is broken (pixels of {:.3g} x {:.3g} at {:.3g}, {:.3g}).",
           name, along, across, transform[0], transform[3]);
  }

  void read_units(GDALRasterBand* own) {
    int given = 0;
    scale = own->GetScale(&given);
    if (!given || scale == 0 || !std::isfinite(scale)) scale = 1;
    offset = own->GetOffset(&given);
    if (!given || !std::isfinite(offset)) offset = 0;
    std::string word = own->GetUnitType();
    if (word.empty() && !crs.IsEmpty() && crs.IsVertical()) {
      const char* vertical = nullptr;
      unit = crs.GetTargetLinearUnits("VERT_CS", &vertical);
      height_unit = vertical != nullptr ? vertical : "metre";
      unit_stated = true;
    } else if (const double metres = metres_of(word); metres > 0) {
      unit = metres;
      unit_stated = !word.empty();
      if (!word.empty()) height_unit = metres == 1 ? "metre" : word;
    } else {
      notes.push_back(
          fmt::format("gives its heights in \"{}\", which is not a known unit; taken as metres.", word));
    }
    if (!crs.IsEmpty()) crs.StripVertical();
    const bool picture = std::strcmp(dataset_->GetDriver()->GetDescription(), "PNG") == 0;
    if (picture && !georeferenced && own->GetRasterDataType() == GDT_UInt16 && scale == 1)
      note_picture(*this);
  }

  void read_stored(std::size_t level, int x, int y, int w, int h, double* out) override {
    GdalMessages messages;
    const Pair& pair = pairs_[level];
    if (pair.heights->RasterIO(GF_Read, x, y, w, h, out, w, h, GDT_Float64, 0, 0) != CE_None)
      fail(ErrorKind::input, "{} cannot be read whole, it is cut short or damaged{}; fetch it again.", name,
           messages.because());
    if (pair.mask == nullptr) return;
    mask_.resize(std::int64_t{w} * h);
    if (pair.mask->RasterIO(GF_Read, x, y, w, h, mask_.data(), w, h, GDT_Byte, 0, 0) != CE_None)
      fail(ErrorKind::input, "{}: its mask cannot be read{}; fetch it again.", name, messages.because());
    for (std::size_t i = 0; i < mask_.size(); ++i)
      if (mask_[i] == 0) out[i] = std::numeric_limits<double>::quiet_NaN();
  }

  DatasetPtr dataset_;
  std::vector<Pair> pairs_;
  std::vector<std::uint8_t> mask_;
};

/// Headerless 16-bit heightmaps, little-endian and square, as game tools write them.
class RawSource final : public DemSource {
 public:
  explicit RawSource(const std::filesystem::path& path) : file_(path, std::ios::binary) {
    name = path.string();
    driver = "Headerless 16-bit heightmap";
    type = "UInt16";
    std::error_code error;
    const auto size = std::filesystem::file_size(path, error);
    const auto side = round_to<std::uintmax_t>(std::sqrt(static_cast<double>(size) / 2));
    if (error || !file_ || side * side * 2 != size || side > 1'000'000)
      fail(ErrorKind::input,
           "{} is no square 16-bit heightmap: {} bytes are not twice a square; convert it to PNG or TIFF.",
           name, error ? 0 : size);
    levels.push_back({static_cast<int>(side), static_cast<int>(side), 1});
    notes.push_back(fmt::format("has no header; taken as {0} x {0} little-endian 16-bit heights.", side));
    note_picture(*this);
  }

 private:
  void read_stored(std::size_t, int x, int y, int w, int h, double* out) override {
    std::vector<unsigned char> row(std::int64_t{w} * 2);
    for (int r = 0; r < h; ++r) {
      file_.seekg((std::streamoff{y + r} * width() + x) * 2);
      if (!file_.read(reinterpret_cast<char*>(row.data()), std::ssize(row)))
        fail(ErrorKind::input, "{} cannot be read whole; fetch it again.", name);
      for (std::size_t i = 0; i < row.size() / 2; ++i) *out++ = row[2 * i] | row[2 * i + 1] << 8;
    }
  }
  std::ifstream file_;
};

/// Spreads the rows of a level over the rows of the target, by area.
class Averager {
 public:
  Averager(raster::Grid<float>& out, double fx, double fy)
      : out_(out), fx_(fx), fy_(fy), sums_(2 * columns()), weights_(2 * columns()) {}

  /// A source row whose pixel i spans [left + i * wide, … + wide) and [top, bottom), in the file's pixels
  /// from the window's corner. Rows come from the top down.
  void add(const double* values, int count, double left, double wide, double top, double bottom) {
    top = std::max(top, 0.0);
    while (top < bottom && row_ < out_.height()) {
      const double end = (row_ + 1) * fy_;
      const double tall = std::min(bottom, end) - top;
      if (tall > 0) spread(values, count, left, wide, tall);
      if (bottom < end) return;
      finish_row();
      top = std::max(top, end);
    }
  }
  void finish() {
    while (row_ < out_.height()) finish_row();
  }

 private:
  int columns() const { return out_.width(); }
  void spread(const double* values, int count, double left, double wide, double tall) {
    for (int i = 0; i < count; ++i) {
      if (std::isnan(values[i])) continue;
      const double begin = std::max(left + i * wide, 0.0), end = left + (i + 1) * wide;
      for (int col = static_cast<int>(begin / fx_); col < out_.width() && col * fx_ < end; ++col) {
        const double weight = (std::min(end, (col + 1) * fx_) - std::max(begin, col * fx_)) * tall;
        if (weight <= 0) continue;
        sums_[col] += weight * values[i];
        weights_[col] += weight;
      }
    }
  }
  void finish_row() {
    for (int col = 0; col < out_.width(); ++col) {
      if (weights_[col] > known_share * fx_ * fy_ * (1 - known_rounding))
        out_.at(col, row_) = static_cast<float>(sums_[col] / weights_[col]);
    }
    std::fill(sums_.begin(), sums_.end(), 0.0);
    std::fill(weights_.begin(), weights_.end(), 0.0);
    ++row_;
  }

  raster::Grid<float>& out_;
  double fx_, fy_;
  std::vector<double> sums_, weights_;
  int row_ = 0;
};

}  // namespace

std::unique_ptr<DemSource> DemSource::open(const std::filesystem::path& path, int band, double height_scale) {
  std::unique_ptr<DemSource> source;
  const std::string extension = lower(path.extension().string());
  if (extension == ".r16" || extension == ".raw16") {
    checked_name(path, "an elevation model");
    source = std::make_unique<RawSource>(path);
  } else {
    GdalMessages messages;
    source = std::make_unique<GdalSource>(path, band);
  }
  if (height_scale != 0) {
    source->scale = height_scale;
    source->offset = 0;
    source->unit = 1;
    source->height_unit = "metre";
    source->unit_stated = true;
    std::erase_if(source->notes,
                  [](const std::string& note) { return note.find("1/128 m") != std::string::npos; });
  }
  return source;
}

bool DemSource::is_nodata(double stored) const {
  if (!has_nodata) return false;
  if (stored == nodata) return true;
  return std::abs(nodata) > long_tag && std::abs(stored - nodata) <= long_tag_error * std::abs(nodata);
}

void DemSource::read(std::size_t level, int x, int y, int w, int h, double* out) {
  read_stored(level, x, y, w, h, out);
  const std::size_t count = std::int64_t{w} * h;
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < count; ++i)
    if (is_nodata(out[i]) || (nan_marks_missing && std::isnan(out[i]))) {
      out[i] = missing;
      ++report.missing;
    } else if (!std::isfinite(out[i])) {
      out[i] = missing;
      ++report.missing;
      ++report.not_finite;
    }
  const std::optional<double> sentinel = find_sentinel(out, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(out[i])) continue;
    const double height = (out[i] * scale + offset) * unit;
    if (sentinel && out[i] == *sentinel) {
      report.sentinel_value = out[i];
      ++report.sentinel;
    } else if (std::abs(height) > absurd_height) {
      ++report.absurd;
    } else {
      out[i] = height;
      continue;
    }
    out[i] = missing;
    ++report.missing;
  }
  report.pixels += count;
}

raster::Grid<float> read_window(DemSource& source, const std::array<int, 4>& window, double fx, double fy,
                                int width, int height, Progress& progress) {
  raster::Grid<float> out(width, height, raster::no_data);
  std::size_t level = 0;
  for (std::size_t i = 1; i < source.levels.size(); ++i) {
    const Level& coarse = source.levels[i];
    if (coarse.width * fx >= source.width() * overview_share &&
        coarse.height * fy >= source.height() * overview_share)
      level = i;
  }
  const Level& from = source.levels[level];
  const double wide = 1.0 * source.width() / from.width;
  const double tall = 1.0 * source.height() / from.height;
  const auto [x, y, w, h] = window;
  const int left = floor_to(x / wide), top = floor_to(y / tall);
  const int right = std::min(from.width, ceil_to((x + w) / wide));
  const int bottom = std::min(from.height, ceil_to((y + h) / tall));
  const int columns = right - left;

  // A strip is whole blocks, or compressed ones would be unpacked again and again.
  const int blocks = std::max(1, strip_pixels / columns / from.block_height);
  const int most_rows = std::max(1, std::min(blocks * from.block_height, strip_pixels / columns));
  std::vector<double> strip;
  Averager averager(out, fx, fy);
  const bool plain = level == 0 && fx == 1 && fy == 1;
  progress.begin("read", bottom - top, "rows");
  for (int row = top; row < bottom;) {
    int rows = std::min(most_rows, bottom - row);
    if (most_rows >= from.block_height && (row + rows) % from.block_height != 0 && row + rows < bottom)
      rows -= (row + rows) % from.block_height;
    strip.resize(std::int64_t{columns} * rows);
    source.read(level, left, row, columns, rows, strip.data());
    for (int r = 0; r < rows; ++r) {
      const double* values = strip.data() + std::int64_t{r} * columns;
      if (plain) {
        std::transform(values, values + columns, out.row(row + r - top),
                       [](double v) { return static_cast<float>(v); });
      } else {
        averager.add(values, columns, left * wide - x, wide, (row + r) * tall - y,
                     std::min<double>((row + r + 1) * tall - y, h));
      }
    }
    progress.advance(rows);
    row += rows;
  }
  if (!plain) averager.finish();
  progress.end();
  return out;
}

}  // namespace tafoni::io::impl
