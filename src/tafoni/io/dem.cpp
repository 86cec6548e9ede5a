// An elevation model from a file: the window is read at the resolution wanted, brought to metres and
// north, cleared of steps, and its holes are filled; inspect_dem() says the same of a file without
// keeping it.

#include "tafoni/io/dem.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <new>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/impl/dem_frame.h"
#include "tafoni/io/impl/dem_levels.h"
#include "tafoni/io/impl/dem_source.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/collar.h"
#include "tafoni/raster/fill.h"
#include "tafoni/raster/jumps.h"
#include "tafoni/raster/resample.h"
#include "tafoni/raster/steps.h"

namespace tafoni::io {
namespace {

/// Pixels a side that are read without a window: a larger file is a mosaic of which nobody wants all.
constexpr int most_side = 1'000'000;
/// Grids as large as the one asked for that are alive together while holes are filled and steps taken out.
constexpr double copies_while_mending = 4;
/// Holes are filled up to so many pixels from data unless the user says: what lies farther in would be made
/// up rather than mended.
constexpr double fill_pixels = 8;
/// A resolution that differs from the file's by less is the file's own: rounding of a georeference.
constexpr double same_resolution = 1.0001;
/// A resolution below this share of the file's pixel is said to add nothing.
constexpr double finer = 0.99;
/// Metres: the earth's axis, and by how much that of another planet or moon differs at least.
constexpr double earth_axis = 6'378'137, other_planet = 1e5;
/// Neighbouring pixels of a steep cliff differ by some times their size, and by a hundred metres at most
/// where pixels are a few metres.
constexpr double jump_slope = 8, least_jump = 100;
/// Degrees: beyond half of the earth no map in metres is near one.
constexpr double widest_map = 180;
/// Pixels that are surveyed at once, and that are kept to look for terraces in: 16 MB of doubles.
constexpr int survey_pixels = 1 << 21;
/// Pixels that are surveyed at once where a row of blocks has more than those above: 128 MB of doubles.
constexpr int most_survey_pixels = 1 << 24;
/// Pixels that a survey decodes at most: some seconds. A mosaic of few bytes can claim a thousand times more.
constexpr double most_surveyed = 1e9;

std::array<int, 4> check_window(const impl::DemSource& source, const DemOptions& options) {
  if (source.width() < 2 || source.height() < 2)
    fail(ErrorKind::input, "{} is {} x {} pixels; a terrain needs at least 2 x 2.", source.name,
         source.width(), source.height());
  if (!options.window && std::max(source.width(), source.height()) > most_side)
    fail(ErrorKind::input, "{} is {} x {} pixels; cut a window of at most a million pixels a side from it.",
         source.name, source.width(), source.height());
  if (!options.window) return {0, 0, source.width(), source.height()};
  const auto [x, y, w, h] = *options.window;
  if (w < 2 || h < 2)
    fail(ErrorKind::usage, "window {},{},{},{}: its width and height must be at least 2 pixels.", x, y, w, h);
  if (x < 0 || y < 0 || w > source.width() - x || h > source.height() - y)
    fail(ErrorKind::usage, "window {},{},{},{} reaches outside {}, which is {} x {} pixels.", x, y, w, h,
         source.name, source.width(), source.height());
  return *options.window;
}

void check_options(const DemOptions& options) {
  const auto check = [](double value, const char* name) {
    if (!std::isfinite(value) || value < 0)
      fail(ErrorKind::usage, "{} = {} is not a positive number of metres.", name, value);
  };
  check(options.resolution, "resolution");
  check(options.pixel_size, "pixel size");
  if (!std::isfinite(options.height_scale) || !std::isfinite(options.height_offset))
    fail(ErrorKind::usage, "height scale and offset must be finite numbers.");
  const auto [columns, rows] = options.raw_size;
  if ((columns != 0 || rows != 0) && (columns < 2 || rows < 2))
    fail(ErrorKind::usage, "raw_size = {}, {} must be at least 2 columns and 2 rows.", columns, rows);
  if (std::isnan(options.fill_distance)) fail(ErrorKind::usage, "fill distance must be a number of metres.");
}

/// What was taken for missing beyond what the file itself marks.
void note_oddities(const impl::ReadReport& report, std::vector<std::string>& notes) {
  if (report.not_finite > 0)
    notes.push_back(fmt::format("{} pixels are NaN or infinite; taken as missing.", report.not_finite));
  if (report.sentinel > 0)
    notes.push_back(fmt::format("{} pixels hold {} without a tag that says so; taken as missing.",
                                report.sentinel, report.sentinel_value));
  if (report.absurd > 0)
    notes.push_back(fmt::format("{} pixels hold heights beyond 100 km, such as {:.6g}; taken as missing.",
                                report.absurd, report.absurd_value));
}

/// Heights that the earth does not have, and steps that no ground has: told, as only the user knows what they
/// mean.
void note_heights(const impl::DemSource& source, double lowest, double highest,
                  std::vector<std::string>& notes) {
  const double axis = source.crs.IsEmpty() ? earth_axis : source.crs.GetSemiMajor();
  if (std::abs(axis - earth_axis) > other_planet) return;
  const bool high = highest > impl::earth_highest;
  if (high || lowest < impl::earth_lowest)
    notes.push_back(fmt::format(
        "heights reach {:.6g} m, which is {} than anything on earth; if they are in another unit, give the "
        "height scale (metres a unit).",
        high ? highest : lowest, high ? "higher" : "deeper"));
}

/// `pixel` in metres.
double jump_limit(double pixel) {
  return std::max(least_jump, jump_slope * pixel);
}

/// Pixel (0, 0) of the rows looked at is pixel (x, y) of the file, and covers fx by fy of its pixels.
void note_jumps(const raster::Jumps& jumps, std::array<double, 4> place, std::vector<std::string>& notes) {
  if (jumps.count == 0) return;
  const auto [x, y, fx, fy] = place;
  notes.push_back(fmt::format(
      "heights jump from one pixel to the next in {} places, by up to {:.6g} m at column {}, row {}, as no "
      "ground does; look there for spikes, or for missing data that is not marked as such.",
      jumps.count, jumps.height, floor_to(x + (jumps.col + 0.5) * fx), floor_to(y + (jumps.row + 0.5) * fy)));
}

void note_step(const impl::DemSource& source, double step, bool smoothed, std::vector<std::string>& notes) {
  if (step > 0 && smoothed)
    notes.push_back(fmt::format("heights come in steps of {:.4g} m; smoothed within half a step.", step));
  else if (step > 0)
    notes.push_back(
        fmt::format("heights come in steps of {:.4g} m and will show as terraces; ask for smoothing.", step));
  else if (source.bytes)
    notes.push_back("heights are 8-bit; at most 256 different ones.");
}

/// The transform of a grid whose pixels cover fx by fy of the file's, from the window's corner.
std::array<double, 6> transform_of(const std::array<double, 6>& t, const std::array<int, 4>& window,
                                   double fx, double fy) {
  return {t[0] + window[0] * t[1] + window[1] * t[2], t[1] * fx, t[2] * fy,
          t[3] + window[0] * t[4] + window[1] * t[5], t[4] * fx, t[5] * fy};
}

/// The warped grid's pixel: the finer of the two directions, but not less than half the coarser, which near
/// the poles would only invent pixels.
double warped_pixel(double resolution, double px, double py) {
  if (resolution > 0) return resolution;
  return std::max(std::min(px, py), std::max(px, py) / 2);
}

std::size_t count_missing(const raster::Grid<float>& grid) {
  return std::count_if(grid.values().begin(), grid.values().end(), [](float v) { return std::isnan(v); });
}

double share(std::size_t part, std::size_t whole) {
  return static_cast<double>(part) / static_cast<double>(whole);
}

class Reader {
 public:
  Reader(const std::filesystem::path& path, const DemOptions& options, Progress& progress)
      : options_(options),
        progress_(progress),
        source_(impl::DemSource::open(path, options)),
        window_(check_window(*source_, options)),
        frame_(impl::metric_frame(*source_, window_, options)) {}

  Dem read() {
    if (frame_.degrees_wide > widest_map)
      fail(ErrorKind::input, "{} {}", source_->name, impl::why_too_wide(*source_, frame_.degrees_wide));
    take(source_->notes);
    take(frame_.notes);
    const auto [x, y, w, h] = window_;
    const double fx = options_.resolution > 0 ? std::max(1.0, options_.resolution / frame_.pixel_x) : 1.0;
    const double fy = options_.resolution > 0 ? std::max(1.0, options_.resolution / frame_.pixel_y) : 1.0;
    const int width = std::max(1, round_to(w / fx));
    const int height = std::max(1, round_to(h / fy));
    if (width < 2 || height < 2)
      fail(ErrorKind::usage, "{}: a resolution of {} m leaves {} x {} pixels; choose a finer one.",
           source_->name, options_.resolution, width, height);
    impl::check_memory(1.0 * width * height, copies_while_mending, source_->name);
    impl::Reading reading = impl::read_window(*source_, window_, fx, fy, width, height, progress_);
    if (reading.overviews_off > 0)
      dem_.notes.push_back(fmt::format(
          "its overviews are no averages of its pixels, by up to {:.4g} m; the pixels are averaged instead.",
          reading.overviews_off));
    raster::Raster raster{std::move(reading.heights), {0, 0, frame_.pixel_x * fx, frame_.pixel_y * fy}, ""};
    note_oddities(source_->report, dem_.notes);
    const double limit = jump_limit(std::max(raster.placement.dx, raster.placement.dy));
    if (!source_->marks_missing()) take_off_collar(raster.values, limit);
    raster::JumpSearch search(limit);
    for (int row = 0; row < height; ++row)
      search.add({raster.values.row(row), static_cast<std::size_t>(width)});
    note_jumps(search.jumps(), {1.0 * x, 1.0 * y, fx, fy}, dem_.notes);
    mend(raster);
    place(std::move(raster), transform_of(frame_.transform, window_, fx, fy));
    dem_.missing = share(count_missing(dem_.raster.values), dem_.raster.values.size());
    if (dem_.missing == 1) fail_empty();
    for (std::string& note : dem_.notes) {
      note = source_->name + ": " + note;
      progress_.warn(note);
    }
    return std::move(dem_);
  }

 private:
  void take(const std::vector<std::string>& notes) {
    dem_.notes.insert(dem_.notes.end(), notes.begin(), notes.end());
  }

  [[noreturn]] void fail_empty() const {
    fail(ErrorKind::input, "{} holds no elevations{}: every pixel is marked as missing.", source_->name,
         options_.window ? " in this window" : "");
  }

  void take_off_collar(raster::Grid<float>& heights, double limit) {
    const double zero = source_->offset * source_->unit;
    const raster::Collar collar = raster::remove_collar(heights, static_cast<float>(zero), limit);
    if (collar.pixels > 0)
      dem_.notes.push_back(fmt::format(
          "{} pixels at its border hold exactly {:g} m, while all ground beside them lies {:.4g} m or more "
          "from that; taken as missing.",
          collar.pixels, zero, collar.lowest_beside));
  }

  void note_range(const raster::Grid<float>& heights) {
    float lowest = std::numeric_limits<float>::infinity(), highest = -lowest;
    for (const float v : heights.values()) {
      lowest = v < lowest ? v : lowest;
      highest = v > highest ? v : highest;
    }
    note_heights(*source_, lowest, highest, dem_.notes);
  }

  void mend(raster::Raster& raster) {
    const std::size_t missing = count_missing(raster.values);
    if (missing == raster.values.size()) fail_empty();
    note_range(raster.values);
    dem_.step = raster::detect_step(raster.values);
    note_step(*source_, dem_.step, options_.smooth, dem_.notes);
    if (options_.smooth && dem_.step > 0) raster::remove_steps(raster, dem_.step, progress_);
    if (missing == 0) return;
    const double largest = std::max(raster.placement.dx, raster.placement.dy);
    const double distance = options_.fill_distance < 0 ? fill_pixels * largest : options_.fill_distance;
    const raster::FillReport report = raster::fill_holes(raster, distance, progress_);
    dem_.filled = report.filled;
    dem_.notes.push_back(
        fmt::format("{} of {} pixels have no data: {} in small holes (up to {:.4g} m from data) are filled, "
                    "{} are left out.",
                    missing, raster.values.size(), report.filled, distance, report.left));
  }

  void place(raster::Raster&& raster, const std::array<double, 6>& transform) {
    const double px = raster.placement.dx, py = raster.placement.dy;
    if (frame_.reproject || frame_.rotated) {
      dem_.raster = impl::warp(raster.values, transform, frame_, warped_pixel(options_.resolution, px, py),
                               source_->name, progress_);
    } else {
      dem_.raster = impl::upright(std::move(raster.values), transform);
      const raster::Placement& p = dem_.raster.placement;
      const double wanted = options_.resolution;
      if (wanted > 0 && (p.dx > wanted * same_resolution || p.dy > wanted * same_resolution)) {
        impl::check_memory(dem_.raster.width() * p.dx / wanted * dem_.raster.height() * p.dy / wanted, 1.5,
                           source_->name);
        dem_.raster = raster::at_resolution(dem_.raster, wanted, progress_);
      }
    }
    if (options_.resolution > 0 && options_.resolution < finer * std::min(frame_.pixel_x, frame_.pixel_y))
      dem_.notes.push_back(fmt::format("{:.4g} m is finer than its own pixels; interpolation adds no detail.",
                                       options_.resolution));
    if (!frame_.target.IsEmpty()) dem_.raster.crs = impl::to_wkt(frame_.target);
  }

  const DemOptions& options_;
  Progress& progress_;
  std::unique_ptr<impl::DemSource> source_;
  std::array<int, 4> window_;
  impl::Frame frame_;
  Dem dem_;
};

/// The strips of rows of which a survey reads all, or some that are spread evenly over the file.
struct Strips {
  explicit Strips(const impl::DemSource& source) : height(source.height()) {
    const int width = source.width(), block = source.levels.front().block_height;
    const int blocks = survey_pixels / width / block;
    rows = std::clamp(blocks > 0 ? blocks * block : std::min(block, most_survey_pixels / width), 1, height);
    all = (height - 1) / rows + 1;
    // To read a part of a block decodes all of it.
    const double decoded = 1.0 * width * std::max(rows, std::min(block, height));
    const bool few = 1.0 * width * height <= most_surveyed;
    count = few ? all : floor_to(std::clamp(most_surveyed / decoded, 1.0, 1.0 * all));
  }
  int first_row(int strip) const { return static_cast<int>(std::int64_t{strip} * all / count) * rows; }

  int height, rows = 1, all = 1, count = 1;
};

/// Range, steps and jumps from one pass over a file's own pixels of so many metres.
raster::Jumps survey(impl::DemSource& source, double pixel, DemInfo& info, Progress& progress) {
  const int width = source.width(), height = source.height();
  const Strips strips(source);
  const bool some = strips.count < strips.all;
  std::vector<double> strip(std::int64_t{width} * strips.rows);
  // Terraces show in any part of a file, so one strip's worth of rows spread over it is kept for them.
  const std::int64_t rows = some ? std::int64_t{strips.count} * strips.rows : height;
  const int keep_every = std::max(1, static_cast<int>(width * rows / survey_pixels));
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  raster::Grid<float> sample(width, std::min(height, std::max(2, survey_pixels / width)), raster::no_data);
  int kept = 0, seen = 0, next = 0;
  raster::JumpSearch jumps(jump_limit(pixel));
  std::vector<float> line(width);
  progress.begin("survey", rows, "rows");
  for (int k = 0; k < strips.count; ++k) {
    const int row = strips.first_row(k), count = std::min(strips.rows, height - row);
    if (row > next) jumps.skip(row - next);
    next = row + count;
    source.read(0, 0, row, width, count, strip.data());
    for (int r = 0; r < count; ++r, ++seen) {
      const double* values = strip.data() + std::int64_t{r} * width;
      for (int col = 0; col < width; ++col) {
        if (std::isnan(values[col])) continue;
        lowest = std::min(lowest, values[col]);
        highest = std::max(highest, values[col]);
      }
      std::transform(values, values + width, line.begin(), [](double v) { return static_cast<float>(v); });
      jumps.add(line);
      // Rows are kept in pairs, as steps show between neighbours.
      if (seen / 2 % keep_every == 0 && kept < sample.height())
        std::copy(line.begin(), line.end(), sample.row(kept++));
    }
    progress.advance(count);
  }
  progress.end();
  if (some)
    info.notes.push_back(
        fmt::format("{:.3g} million pixels are too many to look at each: what is said of heights and missing "
                    "data is judged from {} of {} rows, spread over the file.",
                    1e-6 * width * height, seen, height));
  info.missing = share(source.report.missing, source.report.pixels);
  if (info.missing == 1)
    fail(ErrorKind::input, "{} holds no elevations: every pixel{} is marked as missing.", source.name,
         some ? " that was looked at" : "");
  info.lowest = lowest;
  info.highest = highest;
  info.step = raster::detect_step(sample);
  return jumps.jumps();
}

void describe(const impl::DemSource& source, DemInfo& info) {
  info.driver = source.driver;
  info.type = source.type;
  info.width = source.width();
  info.height = source.height();
  info.bands = source.bands;
  info.band = source.band;
  info.height_unit = source.height_unit;
  info.scale = source.scale;
  info.offset = source.offset;
  info.unit = source.georeferenced ? "metre" : "pixel";
  if (!source.crs.IsEmpty()) {
    const char* name = source.crs.GetName();
    info.crs = name != nullptr ? name : "";
    info.crs_wkt = impl::to_wkt(source.crs);
    const char* unit = nullptr;
    if (source.crs.IsGeographic())
      source.crs.GetAngularUnits(&unit);
    else
      source.crs.GetLinearUnits(&unit);
    if (unit != nullptr) info.unit = unit;
  }
  auto t = source.transform;
  if (!source.georeferenced) t = {0, 1, 0, 1.0 * source.height(), 0, -1};
  info.dx = std::hypot(t[1], t[4]);
  info.dy = std::hypot(t[2], t[5]);
  info.angle = std::atan2(t[4], t[1]);
  info.north_up =
      t[1] > 0 && t[5] < 0 && std::abs(t[2]) <= 1e-7 * info.dy && std::abs(t[4]) <= 1e-7 * info.dx;
  info.west = info.south = std::numeric_limits<double>::infinity();
  info.east = info.north = -info.west;
  for (const int col : {0, source.width()})
    for (const int row : {0, source.height()}) {
      const double x = t[0] + col * t[1] + row * t[2], y = t[3] + col * t[4] + row * t[5];
      info.west = std::min(info.west, x);
      info.east = std::max(info.east, x);
      info.south = std::min(info.south, y);
      info.north = std::max(info.north, y);
    }
}

}  // namespace

Dem read_dem(const std::filesystem::path& path, const DemOptions& options, Progress& progress) {
  check_options(options);
  try {
    return Reader(path, options, progress).read();
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::input, "{} does not fit into memory; choose a window or a coarser resolution.",
         path.string());
  }
}

DemInfo inspect_dem(const std::filesystem::path& path, const DemOptions& options, Progress& progress) {
  check_options(options);
  const auto source = impl::DemSource::open(path, options);
  const auto window = check_window(*source, {});
  DemInfo info;
  describe(*source, info);
  const impl::Frame frame = impl::metric_frame(*source, window, options);
  info.notes = source->notes;
  if (frame.degrees_wide > widest_map)
    info.notes.push_back(impl::why_too_wide(*source, frame.degrees_wide));
  else
    info.notes.insert(info.notes.end(), frame.notes.begin(), frame.notes.end());
  const raster::Jumps jumps = survey(*source, std::max(frame.pixel_x, frame.pixel_y), info, progress);
  note_oddities(source->report, info.notes);
  note_heights(*source, info.lowest, info.highest, info.notes);
  note_jumps(jumps, {0, 0, 1, 1}, info.notes);
  note_step(*source, info.step, false, info.notes);
  if (info.missing > 0)
    info.notes.push_back(
        "pixels without data in holes up to eight pixels deep would be filled, the others left out.");
  return info;
}

void check_crs(const std::string& crs) {
  impl::ensure_gdal();
  impl::crs_from_wkt(crs);
}

void write_geotiff(const std::filesystem::path& path, const raster::Raster& raster) {
  impl::ensure_gdal();
  AtomicFile file(path);
  impl::GdalMessages messages;
  const auto give_up = [&] {
    fail(ErrorKind::output, "cannot write {}: {}.", path.string(),
         messages.failed() ? messages.reason() : "the disk may be full");
  };
  // What a GeoTIFF cannot hold would go to a file beside it.
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", "NO");
  const char* const options[] = {"COMPRESS=DEFLATE", "PREDICTOR=3", "TILED=YES", "BIGTIFF=IF_SAFER", nullptr};
  impl::DatasetPtr dataset(GetGDALDriverManager()->GetDriverByName("GTiff")->Create(
      file.path().c_str(), raster.width(), raster.height(), 1, GDT_Float32, const_cast<char**>(options)));
  CPLSetThreadLocalConfigOption("GDAL_PAM_ENABLED", nullptr);
  if (!dataset) give_up();
  const raster::Placement& p = raster.placement;
  double transform[6] = {p.west, p.dx, 0, p.north, 0, -p.dy};
  dataset->SetGeoTransform(transform);
  if (!raster.crs.empty()) {
    const OGRSpatialReference crs = impl::crs_from_wkt(raster.crs);
    dataset->SetSpatialRef(&crs);
  }
  GDALRasterBand* band = dataset->GetRasterBand(1);
  band->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  band->SetUnitType("metre");
  const CPLErr error = band->RasterIO(GF_Write, 0, 0, raster.width(), raster.height(),
                                      const_cast<float*>(raster.values.data()), raster.width(),
                                      raster.height(), GDT_Float32, 0, 0);
  dataset.reset();
  if (error != CE_None || messages.failed()) give_up();
  file.commit();
}

}  // namespace tafoni::io
