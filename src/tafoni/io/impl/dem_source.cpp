// Elevation files as windows of heights, through GDAL; those without a header are read in raw_heights.cpp.
// Marks of missing data that no tag admits to are found here.

#include "tafoni/io/impl/dem_source.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "tafoni/io/impl/colour_heights.h"
#include "tafoni/io/impl/grass_text.h"
#include "tafoni/io/impl/grid_text.h"
#include "tafoni/io/impl/pixel_runs.h"
#include "tafoni/io/impl/raw_heights.h"
#include "tafoni/io/impl/stored_heights.h"
#include "tafoni/io/impl/xyz_text.h"
#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

/// Metres; beyond it a height is a mark for missing data, whatever the tags say.
constexpr double absurd_height = 1e5;

/// Values that stand for missing data when no tag says so …
constexpr double marks_below[] = {-9999, -32768, -32767, -99999, -9998, -999};
/// … and those that do where the height would be beyond all on earth, or where they mark depths.
constexpr double marks_above[] = {9999, 32767, 32768, 65535, 99999};
/// Metres: other heights this near to a mark make it a height as well.
constexpr double near_mark = 200;

/// Units that differ by less, as the feet do, are not told apart in a note.
constexpr double same_unit = 1e-5;

/// A tag this large or larger is compared to so many parts of itself, as it is often written with fewer
/// digits than the value it means (-3.402823e+38); smaller ones are exact.
constexpr double long_tag = 1e6, long_tag_error = 1e-6;

bool is_one_of_marks(double value) {
  const auto among = [&](const auto& marks) {
    return std::find(std::begin(marks), std::end(marks), value) != std::end(marks);
  };
  return among(marks_below) || among(marks_above);
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

class GdalSource final : public DemSource {
 public:
  GdalSource(const std::filesystem::path& path, const DemOptions& options)
      : dataset_(open_dataset(path, GDAL_OF_RASTER, "an elevation model")) {
    name = path.string();
    driver = dataset_->GetDriver()->GetMetadataItem(GDAL_DMD_LONGNAME);
    bands = dataset_->GetRasterCount();
    if (options.raw_size[0] > 0 || options.byte_order != ByteOrder::automatic)
      fail(ErrorKind::usage,
           "{} is a file of the format {}, which says its own size and order of bytes; leave out "
           "terrain.raw_size and terrain.byte_order.",
           name, driver);
    choose_band(options);
    GDALRasterBand* own = dataset_->GetRasterBand(band);
    stored_type = own->GetRasterDataType();
    type = GDALGetDataTypeName(stored_type);
    bytes = stored_type == GDT_Byte && !decoded;
    whole = GDALDataTypeIsInteger(stored_type) != 0 && !decoded;
    if (GDALDataTypeIsComplex(own->GetRasterDataType()))
      fail(ErrorKind::input, "{}: band {} holds complex numbers, not elevations.", name, band);
    int tagged = 0;
    nodata = own->GetNoDataValue(&tagged);
    has_nodata = tagged != 0 && !decoded;
    // Pixels of a Float32 band hold the tag's value rounded to theirs.
    if (stored_type == GDT_Float32 && std::abs(nodata) <= std::numeric_limits<float>::max())
      nodata = static_cast<float>(nodata);
    list_levels(own);
    nan_marks_missing = pairs_.front().mask != nullptr || (has_nodata && std::isnan(nodata));
    const std::string kind = dataset_->GetDriver()->GetDescription();
    if (kind == "GRASSASCIIGrid") read_grass();
    read_georeference();
    depths = depths_of(*dataset_, *own);
    read_units(own);
    says_of_heights = unit_stated || scale != 1 || offset != 0 || has_nodata;
    if (kind == "AAIGrid") {
      check_grid_text(dataset_->GetDescription(), name);
      place_grid_text();
    }
    if (kind == "XYZ")
      leave_out(check_xyz_text(dataset_->GetDescription(), name, transform, width(), height()));
  }

 private:
  struct Pair {
    GDALRasterBand* heights;
    GDALRasterBand* mask;  ///< null where nodata values say it all; there is data where it is positive
  };

  void choose_band(const DemOptions& options) {
    const int wanted = options.band;
    if (bands == 0)
      fail(ErrorKind::input,
           "{} holds no raster of its own; name one of its subdatasets (gdalinfo lists them).", name);
    if (wanted < 0 || wanted > bands)
      fail(ErrorKind::usage, "{} has {} band{}; there is no band {}.", name, bands, bands == 1 ? "" : "s",
           wanted);
    band = std::max(wanted, 1);
    if (options.encoding == HeightEncoding::terrain_rgb || options.encoding == HeightEncoding::terrarium)
      return decode(options.encoding);
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
      return choose_colours(options.encoding);
    if (heights == 0) fail(ErrorKind::input, "{} holds only a transparency band, no elevations.", name);
    band = heights;
    if (bands > 1 && colour(bands) != GCI_AlphaBand)
      notes.push_back(fmt::format("has {} bands; band {} is taken as the elevations.", bands, band));
  }

  /// GDAL takes an alpha band for a mask only where it is of 8 bits or of 16 without a sign.
  GDALRasterBand* alpha_band() {
    for (int b = 1; b <= bands; ++b)
      if (b != band && dataset_->GetRasterBand(b)->GetColorInterpretation() == GCI_AlphaBand)
        return dataset_->GetRasterBand(b);
    return nullptr;
  }

  /// Colours that hold heights after all.
  void choose_colours(HeightEncoding encoding) {
    const ColourBands colours = colour_bands(*dataset_);
    const Colours found = colours[0] == nullptr ? Colours::picture : look_at_colours(colours);
    const bool automatic = encoding == HeightEncoding::automatic;
    if (found == Colours::grey) {
      band = colours[0]->GetBand();
      notes.push_back(fmt::format("has three colours that are equal; band {} is taken.", band));
    } else if (found == Colours::terrain_rgb && automatic) {
      decode(HeightEncoding::terrain_rgb);
    } else if (found == Colours::terrarium && automatic) {
      decode(HeightEncoding::terrarium);
    } else {
      fail(ErrorKind::input,
           "{} is a picture ({} bands of colour), not an elevation model; give the elevations' own file, or "
           "say how its colours hold heights (terrain.encoding) or which band does (terrain.band).",
           name, bands);
    }
  }

  void decode(HeightEncoding encoding) {
    const char* word = encoding == HeightEncoding::terrarium ? "terrarium" : "terrain-rgb";
    colours_ = colour_bands(*dataset_);
    for (GDALRasterBand* colour : colours_)
      if (colour == nullptr || colour->GetRasterDataType() != GDT_Byte)
        fail(ErrorKind::usage, "{} is no picture of three 8-bit colours, as the encoding {} has them.", name,
             word);
    decoded = true;
    encoding_ = encoding;
    band = colours_[0]->GetBand();
    notes.push_back(
        fmt::format("its colours are heights in the encoding {} ({}); terrain.encoding says otherwise.", word,
                    encoding == HeightEncoding::terrarium ? "Mapzen's, 1/256 m from -32768 m"
                                                          : "Mapbox's, 0.1 m from -10000 m"));
  }

  void list_levels(GDALRasterBand* own) {
    const auto add = [&](GDALRasterBand* heights, GDALRasterBand* alpha) {
      int block_width = 0, block_height = 0;
      heights->GetBlockSize(&block_width, &block_height);
      levels.push_back({heights->GetXSize(), heights->GetYSize(), std::max(block_height, 1)});
      const bool masked = (heights->GetMaskFlags() & (GMF_ALL_VALID | GMF_NODATA)) == 0;
      pairs_.push_back({heights, masked ? heights->GetMaskBand() : alpha});
    };
    GDALRasterBand* const alpha = alpha_band();
    add(own, alpha);
    if (decoded) return;  // an average of colours is no height
    std::vector<std::pair<GDALRasterBand*, GDALRasterBand*>> overviews;
    for (int i = 0; i < own->GetOverviewCount(); ++i) {
      GDALRasterBand* const overview = own->GetOverview(i);
      GDALRasterBand* const seen =
          alpha != nullptr && i < alpha->GetOverviewCount() ? alpha->GetOverview(i) : nullptr;
      if (overview == nullptr || (alpha != nullptr && seen == nullptr)) continue;
      if (seen != nullptr &&
          (seen->GetXSize() != overview->GetXSize() || seen->GetYSize() != overview->GetYSize()))
        continue;
      overviews.emplace_back(overview, seen);
    }
    std::sort(overviews.begin(), overviews.end(),
              [](const auto& a, const auto& b) { return a.first->GetXSize() > b.first->GetXSize(); });
    for (const auto& [overview, seen] : overviews) add(overview, seen);
  }

  void read_georeference() {
    georeferenced = dataset_->GetGeoTransform(transform.data()) == CE_None;
    if (grass_transform_) transform = *grass_transform_;
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

  void place_grid_text() {
    const GridPlace place = grid_place(dataset_->GetDescription(), height());
    if (place.mixed) transform = place.transform;
    if (place.missing) {
      transform = place.transform;
      notes.push_back("names no corner; its south-west corner is taken as (0, 0).");
    }
  }

  /// Coarser levels would have been made with what GDAL reads there.
  void leave_out(PixelRuns missing) {
    gaps_ = std::move(missing);
    if (gaps_.empty()) return;
    levels.resize(1);
    pairs_.resize(1);
    nan_marks_missing = true;
  }

  void read_grass() {
    GrassGrid grid = read_grass_text(dataset_->GetDescription(), name, width(), height(), whole);
    grass_transform_ = grid.transform;
    has_nodata = has_nodata && !grid.null_is_word;
    leave_out(std::move(grid.missing));
  }

  void read_units(GDALRasterBand* own) {
    int given = 0;
    scale = own->GetScale(&given);
    if (!given || scale == 0 || !std::isfinite(scale)) scale = 1;
    offset = own->GetOffset(&given);
    if (!given || !std::isfinite(offset)) offset = 0;
    read_height_unit(own->GetUnitType());
    if (!crs.IsEmpty()) crs.StripVertical();
  }

  /// A file may name the unit twice. Who reprojects a file, or gives it a CRS, writes the CRS anew and leaves
  /// the tag as it was, so the CRS is believed.
  void read_height_unit(const std::string& tag) {
    const double tagged = metres_of(tag);
    if (!crs.IsEmpty() && crs.IsVertical() != 0) {
      const char* word = nullptr;
      const double metres = crs.GetTargetLinearUnits("VERT_CS", &word);
      unit = metres > 0 && std::isfinite(metres) ? metres : 1;
      height_unit = word != nullptr ? word : "metre";
      unit_stated = true;
      if (!tag.empty() && std::abs(tagged - unit) > same_unit * unit)
        notes.push_back(fmt::format(
            "gives its heights in \"{}\" by a tag and in {} by its coordinate system, which is believed.",
            tag, height_unit));
    } else if (tagged > 0) {
      unit = tagged;
      unit_stated = !tag.empty();
      if (!tag.empty()) height_unit = tagged == 1 ? "metre" : tag;
    } else {
      notes.push_back(
          fmt::format("gives its heights in \"{}\", which is not a known unit; taken as metres.", tag));
    }
  }

  void read_stored(std::size_t level, int x, int y, int w, int h, double* out) override {
    GdalMessages messages;
    const Pair& pair = pairs_[level];
    const bool read =
        decoded ? read_colour_heights(colours_, encoding_, x, y, w, h, out)
                : pair.heights->RasterIO(GF_Read, x, y, w, h, out, w, h, GDT_Float64, 0, 0) == CE_None;
    if (!read)
      fail(ErrorKind::input, "{} cannot be read whole, it is cut short or damaged{}; fetch it again.", name,
           messages.because());
    if (!gaps_.empty())
      for (int r = 0; r < h; ++r)
        gaps_.clear(static_cast<std::uint64_t>(y + r) * width() + x, w, out + std::int64_t{r} * w);
    if (pair.mask == nullptr) return;
    mask_.resize(std::int64_t{w} * h);
    if (pair.mask->RasterIO(GF_Read, x, y, w, h, mask_.data(), w, h, GDT_Float32, 0, 0) != CE_None)
      fail(ErrorKind::input, "{}: its mask cannot be read{}; fetch it again.", name, messages.because());
    for (std::size_t i = 0; i < mask_.size(); ++i)
      if (!(mask_[i] > 0)) out[i] = std::numeric_limits<double>::quiet_NaN();
  }

  DatasetPtr dataset_;
  ColourBands colours_{};
  HeightEncoding encoding_ = HeightEncoding::heights;  ///< of the colours, where `decoded`
  std::vector<Pair> pairs_;
  std::optional<std::array<double, 6>> grass_transform_;
  PixelRuns gaps_;  ///< where text has no heights, of the finest level
  std::vector<float> mask_;
};

}  // namespace

std::unique_ptr<DemSource> DemSource::open(const std::filesystem::path& path, const DemOptions& options) {
  std::unique_ptr<DemSource> source = open_raw(path, options);
  if (!source) {
    GdalMessages messages;
    source = std::make_unique<GdalSource>(path, options);
  }
  interpret(*source, options);
  return source;
}

bool DemSource::is_nodata(double stored) const {
  if (!has_nodata) return false;
  if (stored == nodata) return true;
  return std::abs(nodata) > long_tag && std::abs(stored - nodata) <= long_tag_error * std::abs(nodata);
}

std::vector<double> DemSource::undeclared_marks(const double* values, std::size_t count) {
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (std::size_t i = 0; i < count; ++i) {
    lowest = values[i] < lowest ? values[i] : lowest;
    highest = values[i] > highest ? values[i] : highest;
  }
  std::vector<double> out;
  const auto look_for = [&](double mark) {
    if (mark < lowest || mark > highest) return;
    if (std::find(heights_after_all_.begin(), heights_after_all_.end(), mark) != heights_after_all_.end())
      return;
    bool found = false, near = false;
    for (std::size_t i = 0; i < count && !near; ++i) {
      found = found || values[i] == mark;
      near = values[i] != mark && std::abs(values[i] - mark) < near_mark && !is_one_of_marks(values[i]);
    }
    if (near) heights_after_all_.push_back(mark);
    if (found && !near) out.push_back(mark);
  };
  for (const double mark : marks_below) look_for(mark);
  for (const double mark : marks_above)
    if (scale < 0 || (mark * scale + offset) * unit > earth_highest) look_for(mark);
  return out;
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
  const std::vector<double> marks = guess_marks ? undeclared_marks(out, count) : std::vector<double>();
  for (std::size_t i = 0; i < count; ++i) {
    if (std::isnan(out[i])) continue;
    const double height = (out[i] * scale + offset) * unit;
    if (std::find(marks.begin(), marks.end(), out[i]) != marks.end()) {
      report.sentinel_value = out[i];
      ++report.sentinel;
    } else if (std::abs(height) > absurd_height) {
      report.absurd_value = out[i];
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

}  // namespace tafoni::io::impl
