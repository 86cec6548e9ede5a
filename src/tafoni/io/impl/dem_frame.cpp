// How an elevation file's own frame becomes metric and north-up: from the georeference, from degrees to a
// UTM zone, by flips and quarter turns where those are all, else by GDAL's warper.

#include "tafoni/io/impl/dem_frame.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include <gdal_alg.h>
#include <gdalwarper.h>

#include "tafoni/io/inner/pixel_memory.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/whole.h"

namespace tafoni::io::impl {
namespace {

using Transform = std::array<double, 6>;

/// Parts of a pixel: what a transform turns by less is the rounding of a north-up one.
constexpr double straight_to = 1e-7;
/// A map on which a metre is off by more on the ground is not taken for metric. UTM is off by 0.001 at
/// most, web Mercator by 0.01 already at eight degrees of latitude.
constexpr double scale_off = 0.01;
/// Metres over which a map's scale is measured: short beside the Earth, long beside rounding.
constexpr double scale_step = 100;
/// Pixels, in coordinates without a system, that are likely degrees: from a metre to eleven kilometres. A
/// metric grid as fine as that would be a table top, and one at most 5 units from zero may well be.
constexpr double degrees_from = 1e-5, degrees_to = 0.1, degrees_beyond = 5;
/// Pixels by which the warper's interpolated places may be off: none that shows.
constexpr double warp_error = 0.02;
/// Bytes that the warper takes for itself.
constexpr double warp_memory = 64e6;

Vec2d apply(const Transform& t, double col, double row) {
  return {t[0] + col * t[1] + row * t[2], t[3] + col * t[4] + row * t[5]};
}

/// Metres a degree of longitude and of latitude on the CRS's ellipsoid.
Vec2d metres_per_degree(const OGRSpatialReference& crs, double latitude) {
  const double a = crs.GetSemiMajor(), flattening = crs.GetInvFlattening();
  const double f = flattening > 0 ? 1 / flattening : 0, e2 = f * (2 - f);
  const double phi = latitude * std::numbers::pi / 180, s = std::sin(phi);
  const double w = 1 - e2 * s * s;
  return {degree * a * std::cos(phi) / std::sqrt(w), degree * a * (1 - e2) / (w * std::sqrt(w))};
}

/// The CRS's own degrees, on its own datum, so that no datum shift comes in.
OGRSpatialReference geographic_of(const OGRSpatialReference& crs) {
  OGRSpatialReference out;
  out.CopyGeogCSFrom(&crs);
  out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return out;
}

/// How many metres on the ground one metre of the map is, east and north, at a place.
std::optional<Vec2d> ground_scale(const OGRSpatialReference& crs, Vec2d place, double metre) {
  const OGRSpatialReference geographic = geographic_of(crs);
  const TransformationPtr to_degrees = transformation(crs, geographic);
  if (!to_degrees) return std::nullopt;
  GdalMessages messages;
  const double step = scale_step / metre;
  double x[3] = {place.x, place.x + step, place.x}, y[3] = {place.y, place.y, place.y + step};
  if (!to_degrees->Transform(3, x, y)) return std::nullopt;
  const Vec2d ground = metres_per_degree(geographic, y[0]);
  return Vec2d{std::hypot((x[1] - x[0]) * ground.x, (y[1] - y[0]) * ground.y) / scale_step,
               std::hypot((x[2] - x[0]) * ground.x, (y[2] - y[0]) * ground.y) / scale_step};
}

/// The UTM zone of a place, or the polar plane beyond UTM's reach, on the datum of `crs`.
OGRSpatialReference metric_crs(const OGRSpatialReference& crs, double longitude, double latitude) {
  const OGRSpatialReference geographic = geographic_of(crs);
  const char* datum = geographic.GetAttrValue("DATUM");
  const bool wgs84 = datum != nullptr && std::string(datum).rfind("WGS_1984", 0) == 0;
  const bool north = latitude >= 0;
  longitude = std::remainder(longitude, 360);
  const int zone = std::clamp(floor_to((longitude + 180) / 6) + 1, 1, 60);
  OGRSpatialReference out;
  if (std::abs(latitude) > 84) {
    if (out.importFromEPSG(north ? 32661 : 32761) == OGRERR_NONE) {
      out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      return out;
    }
  } else if (!wgs84 || out.importFromEPSG((north ? 32600 : 32700) + zone) != OGRERR_NONE) {
    out.Clear();
    const char* name = geographic.GetName();
    out.SetProjCS(
        fmt::format("{} / UTM zone {}{}", name != nullptr ? name : "unnamed", zone, north ? 'N' : 'S')
            .c_str());
    out.CopyGeogCSFrom(&geographic);
    out.SetUTM(zone, north);
  }
  out.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  return out;
}

class FrameMaker {
 public:
  FrameMaker(const DemSource& source, const std::array<int, 4>& window) : source_(source), window_(window) {
    middle_col_ = window[0] + window[2] / 2.0;
    middle_row_ = window[1] + window[3] / 2.0;
    frame_.transform = source.transform;
    frame_.crs = source.crs;
  }

  Frame make(const DemOptions& options) {
    const double pixel_size = options.pixel_size;
    const std::string& wanted = options.crs;
    if (source_.georeferenced && pixel_size != 0)
      fail(ErrorKind::usage, "{} has a georeference; a pixel size is only for files without one.",
           source_.name);
    if (!options.own_crs.empty()) take_crs(crs_from_wkt(options.own_crs));
    if (!source_.georeferenced)
      place_at_zero(pixel_size);
    else if (frame_.crs.IsEmpty())
      guess_crs();
    else if (frame_.crs.IsGeocentric())
      fail(ErrorKind::input, "{} is in geocentric coordinates, which no map is drawn in; project it first.",
           source_.name);
    if (!frame_.crs.IsEmpty() && frame_.crs.IsGeographic())
      from_degrees();
    else
      from_plane();
    if (!wanted.empty()) bring_to(crs_from_wkt(wanted));
    const Transform& t = frame_.transform;
    const double along = std::hypot(t[1], t[4]), across = std::hypot(t[2], t[5]);
    const auto none = [](double v, double of) { return std::abs(v) <= straight_to * of; };
    const bool straight = none(t[2], across) && none(t[4], along),
               quarter = none(t[1], along) && none(t[5], across);
    frame_.rotated = !straight && !quarter;
    if (!frame_.reproject) {
      frame_.pixel_x = along;
      frame_.pixel_y = across;
      frame_.target = frame_.crs;
      note_orientation(straight);
    }
    return std::move(frame_);
  }

 private:
  void place_at_zero(double pixel_size) {
    const double pixel = pixel_size > 0 ? pixel_size : 1;
    frame_.transform = {0, pixel, 0, source_.height() * pixel, 0, -pixel};
    if (pixel_size == 0)
      frame_.notes.push_back(
          "has no georeference; pixels are taken as 1 m and the south-west corner as (0, 0).");
  }

  /// What the user says of coordinates that name no system, or a local one.
  void take_crs(OGRSpatialReference own) {
    own.StripVertical();
    if (!source_.georeferenced)
      fail(
          ErrorKind::usage,
          "{} has no georeference, so a coordinate system does not place it; leave out terrain.crs, or put a "
          "world file beside it.",
          source_.name);
    if (frame_.crs.IsEmpty() || frame_.crs.IsLocal()) {
      frame_.crs = own;
      frame_.notes.push_back(fmt::format("is taken to be in {}, as terrain.crs says.", name_of(own)));
    } else if (!frame_.crs.IsSame(&own)) {
      fail(ErrorKind::usage, "{} says itself that it is in {}; leave out terrain.crs = {}.", source_.name,
           name_of(frame_.crs), name_of(own));
    }
  }

  void guess_crs() {
    const Transform& t = frame_.transform;
    const Vec2d a = apply(t, 0, 0), b = apply(t, source_.width(), source_.height());
    const auto within = [](Vec2d p) { return std::abs(p.x) <= 360 && std::abs(p.y) <= 90; };
    if (within(a) && within(b) && std::abs(t[1]) <= degrees_to && std::hypot(a.x, a.y) > degrees_beyond &&
        std::abs(t[1]) > degrees_from) {
      frame_.crs.SetWellKnownGeogCS("WGS84");
      frame_.crs.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
      frame_.notes.push_back("names no coordinate system; its coordinates read as degrees, taken as WGS 84.");
    } else {
      frame_.notes.push_back("names no coordinate system; its coordinates are taken as metres.");
    }
  }

  void from_degrees() {
    const Vec2d middle = apply(frame_.transform, middle_col_, middle_row_);
    const double to_degree = frame_.crs.GetAngularUnits() * 180 / std::numbers::pi;
    const double longitude = middle.x * to_degree, latitude = middle.y * to_degree;
    if (std::abs(latitude) > 90.1)
      fail(ErrorKind::input, "{}: its middle lies at latitude {:.1f}; the georeference is broken.",
           source_.name, latitude);
    const Transform& t = frame_.transform;
    frame_.degrees_wide = (std::abs(t[1]) * window_[2] + std::abs(t[2]) * window_[3]) * to_degree;
    const Vec2d ground = metres_per_degree(frame_.crs, latitude);
    measure(ground * to_degree);
    to_metric(longitude, latitude, fmt::format("is in degrees ({})", name_of(frame_.crs)));
  }

  void from_plane() {
    double metre = 1;
    const char* unit = nullptr;
    if (!frame_.crs.IsEmpty()) metre = frame_.crs.GetLinearUnits(&unit);
    if (!(metre > 0) || !std::isfinite(metre)) metre = 1;
    const Vec2d middle = apply(frame_.transform, middle_col_, middle_row_);
    if (!frame_.crs.IsEmpty() && frame_.crs.IsProjected()) {
      const auto scale = ground_scale(frame_.crs, middle, metre);
      if (scale && std::max(std::abs(scale->x - 1), std::abs(scale->y - 1)) > scale_off) {
        measure(*scale * metre);
        const OGRSpatialReference geographic = geographic_of(frame_.crs);
        double x = middle.x, y = middle.y;
        transformation(frame_.crs, geographic)->Transform(1, &x, &y);
        to_metric(x, y,
                  fmt::format(
                      "is in {}, where a metre on the map is {:.3f} m east and {:.3f} m north on the ground",
                      name_of(frame_.crs), scale->x, scale->y));
        return;
      }
    }
    if (std::abs(metre - 1) < 1e-9) return;
    for (double& v : frame_.transform) v *= metre;
    frame_.notes.push_back(fmt::format("is in {} ({}); coordinates are brought to metres.",
                                       unit != nullptr ? unit : "feet", name_of(frame_.crs)));
    if (!source_.unit_stated)
      frame_.notes.push_back("names no unit of height; taken as metres, although its coordinates are not.");
    frame_.crs.SetLinearUnitsAndUpdateParameters("metre", 1.0);
    frame_.crs.SetNode(frame_.crs.IsProjected() ? "PROJCS" : "LOCAL_CS",
                       (name_of(frame_.crs) + " in metres").c_str());
  }

  void bring_to(const OGRSpatialReference& wanted) {
    if (wanted.IsGeographic() || wanted.IsGeocentric() || std::abs(wanted.GetLinearUnits() - 1) > 1e-9)
      fail(ErrorKind::usage, "{} is not a map in metres; choose one, such as a UTM zone.", name_of(wanted));
    if (frame_.crs.IsEmpty() || (frame_.crs.IsLocal() && !frame_.crs.IsSame(&wanted))) {
      frame_.crs = wanted;
      frame_.notes.push_back(fmt::format("is taken to be in {}.", name_of(wanted)));
    } else if (wanted.IsLocal() && !frame_.crs.IsLocal()) {
      fail(ErrorKind::input, "{} is in {}, from which nothing leads to {}, the terrain's.", source_.name,
           name_of(frame_.crs), name_of(wanted));
    } else if (frame_.reproject) {
      frame_.notes.back() = fmt::format("is in {}; reprojected to {}.", name_of(frame_.crs), name_of(wanted));
      frame_.target = wanted;
    } else if (!frame_.crs.IsSame(&wanted)) {
      measure({1, 1});
      frame_.reproject = true;
      frame_.notes.push_back(
          fmt::format("is in {}; reprojected to {}.", name_of(frame_.crs), name_of(wanted)));
      frame_.target = wanted;
    }
  }

  void measure(Vec2d metres_per_unit) {
    const Transform& t = frame_.transform;
    frame_.pixel_x = std::hypot(t[1] * metres_per_unit.x, t[4] * metres_per_unit.y);
    frame_.pixel_y = std::hypot(t[2] * metres_per_unit.x, t[5] * metres_per_unit.y);
  }

  void to_metric(double longitude, double latitude, const std::string& why) {
    frame_.reproject = true;
    frame_.target = metric_crs(frame_.crs, longitude, latitude);
    frame_.notes.push_back(fmt::format("{}; reprojected to {}.", why, name_of(frame_.target)));
  }

  void note_orientation(bool straight) {
    const Transform& t = frame_.transform;
    if (frame_.rotated) {
      frame_.notes.push_back(fmt::format("is rotated by {:.1f} degrees; resampled north up.",
                                         std::atan2(t[4], t[1]) * 180 / std::numbers::pi));
    } else if (!straight) {
      frame_.notes.push_back("is turned by a quarter; put upright.");
    } else if (t[5] > 0 || t[1] < 0) {
      frame_.notes.push_back(t[5] > 0 ? "is stored south up; put upright."
                                      : "is stored east to west; put upright.");
    }
  }

  const DemSource& source_;
  const std::array<int, 4>& window_;
  Frame frame_;
  double middle_col_ = 0, middle_row_ = 0;
};

struct DestroyTransformer {
  void operator()(void* t) const { GDALDestroyTransformer(t); }
};
using Transformer = std::unique_ptr<void, DestroyTransformer>;

struct WarpOptions {
  GDALWarpOptions* get = GDALCreateWarpOptions();
  WarpOptions() = default;
  WarpOptions(const WarpOptions&) = delete;
  WarpOptions& operator=(const WarpOptions&) = delete;
  ~WarpOptions() { GDALDestroyWarpOptions(get); }
};

/// A dataset over a grid's own memory.
DatasetPtr over_memory(raster::Grid<float>& grid, const Transform& transform,
                       const OGRSpatialReference& crs) {
  DatasetPtr out(memory_driver().Create("", grid.width(), grid.height(), 0, GDT_Float32, nullptr));
  const std::string pointer = fmt::format("{}", reinterpret_cast<std::uintptr_t>(grid.data()));
  char** options = CSLSetNameValue(nullptr, "DATAPOINTER", pointer.c_str());
  const CPLErr error = out->AddBand(GDT_Float32, options);
  CSLDestroy(options);
  if (error != CE_None) fail(ErrorKind::internal, "GDAL could not wrap a grid in memory.");
  out->GetRasterBand(1)->SetNoDataValue(std::numeric_limits<double>::quiet_NaN());
  Transform t = transform;
  out->SetGeoTransform(t.data());
  if (!crs.IsEmpty()) out->SetSpatialRef(&crs);
  return out;
}

struct Hull {
  double west, south, east, north;
};

int CPL_STDCALL forward_progress(double, const char*, void* progress) {
  return static_cast<Progress*>(progress)->cancelled() ? FALSE : TRUE;
}

Hull suggested_hull(GDALDataset* source, void* transformer, const std::string& name) {
  Transform t{};
  int width = 0, height = 0;
  double extent[4] = {};
  if (GDALSuggestedWarpOutput2(source, GDALGenImgProjTransform, transformer, t.data(), &width, &height,
                               extent, 0) != CE_None)
    fail(ErrorKind::input, "{} cannot be brought to a metric grid; cut it with a window.", name);
  return {extent[0], extent[1], extent[2], extent[3]};
}

/// Rows that are looked at for columns without data.
constexpr int gap_rows = 200;

/// Where the columns of a file are empty between two parts that are not, in its middle: begin and end.
std::pair<int, int> widest_gap(DemSource& source) {
  const int width = source.width(), step = std::max(1, source.height() / gap_rows);
  std::vector<double> line(width);
  std::vector<bool> known(width, false);
  const ReadReport before = source.report;
  for (int row = 0; row < source.height(); row += step) {
    source.read(0, 0, row, width, 1, line.data());
    for (int col = 0; col < width; ++col)
      if (!std::isnan(line[col])) known[col] = true;
  }
  source.report = before;
  std::pair<int, int> widest{0, 0};
  int last = -1;
  for (int col = 0; col < width; ++col) {
    if (!known[col]) continue;
    if (last >= 0 && col - last - 1 > widest.second - widest.first) widest = {last + 1, col};
    last = col;
  }
  return widest;
}

}  // namespace

Frame metric_frame(const DemSource& source, const std::array<int, 4>& window, const DemOptions& options) {
  GdalMessages messages;
  return FrameMaker(source, window).make(options);
}

void check_memory(double pixels, double copies, const std::string& name) {
  inner::check_pixels(pixels, copies, name, "choose a window or a coarser resolution");
}

raster::Raster upright(raster::Grid<float>&& grid, const std::array<double, 6>& transform) {
  Transform t = transform;
  if (std::abs(t[1]) < std::abs(t[2])) {
    raster::Grid<float> turned(grid.height(), grid.width());
    for (int row = 0; row < grid.height(); ++row)
      for (int col = 0; col < grid.width(); ++col) turned.at(row, col) = grid.at(col, row);
    grid = std::move(turned);
    std::swap(t[1], t[2]);
    std::swap(t[4], t[5]);
  }
  if (t[1] < 0) {
    for (int row = 0; row < grid.height(); ++row) std::reverse(grid.row(row), grid.row(row) + grid.width());
    t[0] += t[1] * grid.width();
    t[1] = -t[1];
  }
  if (t[5] > 0) {
    for (int row = 0; row < grid.height() / 2; ++row)
      std::swap_ranges(grid.row(row), grid.row(row) + grid.width(), grid.row(grid.height() - 1 - row));
    t[3] += t[5] * grid.height();
    t[5] = -t[5];
  }
  return {std::move(grid), {t[0], t[3], t[1], -t[5]}, ""};
}

raster::Raster warp(raster::Grid<float>& grid, const std::array<double, 6>& transform, const Frame& frame,
                    double pixel, const std::string& name, Progress& progress) {
  GdalMessages messages;
  progress.begin("reproject");
  const DatasetPtr source = over_memory(grid, transform, frame.crs);
  const std::string from = to_wkt(frame.crs), to = to_wkt(frame.target);
  Transformer suggest(GDALCreateGenImgProjTransformer(source.get(), frame.reproject ? from.c_str() : nullptr,
                                                      nullptr, frame.reproject ? to.c_str() : nullptr, FALSE,
                                                      0, 0));
  if (!suggest) fail(ErrorKind::input, "{} cannot be reprojected{}.", name, messages.because());
  const Hull hull = suggested_hull(source.get(), suggest.get(), name);
  const double width = std::max(1.0, std::ceil((hull.east - hull.west) / pixel - 1e-6));
  const double height = std::max(1.0, std::ceil((hull.north - hull.south) / pixel - 1e-6));
  if (!(width * height > 0)) fail(ErrorKind::input, "{}: its georeference is broken.", name);
  check_memory(width * height, 1.2, name);

  raster::Raster out;
  out.values = raster::Grid<float>(static_cast<int>(width), static_cast<int>(height), raster::no_data);
  out.placement = {hull.west, hull.north, pixel, pixel};
  const DatasetPtr target =
      over_memory(out.values, {hull.west, pixel, 0, hull.north, 0, -pixel}, frame.target);
  Transformer exact(GDALCreateGenImgProjTransformer(source.get(), frame.reproject ? from.c_str() : nullptr,
                                                    target.get(), frame.reproject ? to.c_str() : nullptr,
                                                    FALSE, 0, 0));
  if (!exact) fail(ErrorKind::input, "{} cannot be reprojected{}.", name, messages.because());
  Transformer approximate(GDALCreateApproxTransformer(GDALGenImgProjTransform, exact.get(), warp_error));

  WarpOptions options;
  options.get->hSrcDS = source.get();
  options.get->hDstDS = target.get();
  options.get->eResampleAlg = GRA_Cubic;
  options.get->dfWarpMemoryLimit = warp_memory;
  options.get->pfnTransformer = GDALApproxTransform;
  options.get->pTransformerArg = approximate.get();
  options.get->pfnProgress = forward_progress;
  options.get->pProgressArg = &progress;
  GDALWarpInitDefaultBandMapping(options.get, 1);
  GDALWarpInitSrcNoDataReal(options.get, std::numeric_limits<double>::quiet_NaN());
  GDALWarpInitDstNoDataReal(options.get, std::numeric_limits<double>::quiet_NaN());
  options.get->papszWarpOptions = CSLSetNameValue(options.get->papszWarpOptions, "INIT_DEST", "NO_DATA");
  GDALWarpOperation operation;
  if (operation.Initialize(options.get) != CE_None ||
      operation.ChunkAndWarpImage(0, 0, out.width(), out.height()) != CE_None) {
    progress.check();
    fail(ErrorKind::input, "{} cannot be reprojected{}.", name, messages.because());
  }
  target->FlushCache();
  progress.end();
  return out;
}

std::string why_too_wide(DemSource& source, double degrees) {
  const auto& t = source.transform;
  const auto [begin, end] = widest_gap(source);
  if (t[1] <= 0 || t[2] != 0 || (end - begin) * t[1] < degrees / 2)
    return fmt::format(
        "spans {:.4g} degrees of longitude, more than a map in metres can; choose a window of it.", degrees);
  const double seam = std::remainder(t[0], 360) <= -180 ? 180 : std::remainder(t[0], 360);
  double west = t[0] + end * t[1], east = t[0] + begin * t[1] + 360;
  const double turns = 360 * std::round(((west + east) / 2 - seam) / 360);
  west -= turns;
  east -= turns;
  const double y0 = t[3], y1 = t[3] + source.height() * t[5];
  return fmt::format(
      "spans {:.4g} degrees of longitude, with data at both ends and nothing between: it is cut along the "
      "meridian of {:g} degrees; join it there first, as gdalwarp -t_srs \"+proj=longlat +datum=WGS84 "
      "+lon_wrap={:g}\" -te {:.9g} {:.9g} {:.9g} {:.9g} does.",
      degrees, seam, seam, west, std::min(y0, y1), east, std::max(y0, y1));
}

}  // namespace tafoni::io::impl
