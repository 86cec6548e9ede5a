#include "tafoni/scene/build/impl/region.h"

#include <cmath>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/io/mask.h"
#include "tafoni/io/vector.h"

namespace tafoni::scene::impl {
namespace {

std::vector<landforms::Ring> to_local(std::vector<landforms::Ring> rings, Vec3d origin) {
  for (auto& ring : rings)
    for (Vec2d& p : ring) p = p - Vec2d{origin.x, origin.y};
  return rings;
}

/// Pixels of a mask that says not where it lies may be so far from those of a terrain in shape.
constexpr double same_shape = 0.02;

/// Lays a mask over the terrain as a painting program shows it: corner on corner.
void lay_over(raster::Raster& mask, const std::vector<double>& outline, const std::string& name,
              Progress& progress) {
  const double across = outline[2] - outline[0], along = outline[3] - outline[1];
  if (std::abs(across / along * mask.height() / mask.width() - 1) > same_shape)
    fail(ErrorKind::input,
         "mask {} does not say where it lies, and its {} x {} pixels are no picture of the terrain, which is "
         "{:g} by {:g} "
         "m; give it the terrain's shape, or a georeference",
         name, mask.width(), mask.height(), across, along);
  mask.placement = {outline[0], outline[3], across / mask.width(), along / mask.height()};
  progress.warn(fmt::format("mask {} does not say where it lies; it is laid over the whole terrain", name));
}

std::shared_ptr<const raster::Raster> read_mask(const File& file, const Limits& limits, Progress& progress) {
  io::MaskFile mask = io::read_mask(file.path, limits.crs, progress);
  auto raster = std::make_shared<raster::Raster>(std::move(mask.raster));
  if (mask.placed) {
    raster->placement.west -= limits.origin.x;
    raster->placement.north -= limits.origin.y;
  } else {
    lay_over(*raster, limits.outline, file.path, progress);
  }
  return raster;
}

}  // namespace

RegionPtr make_region(const Limits& limits, Progress& progress) {
  const auto& [altitude, box, polygons, mask, painted, o, outline, crs] = limits;
  auto region = std::make_shared<landforms::Region>();
  if (!altitude.empty()) region->limit_altitude(altitude[0] - o.z, altitude[1] - o.z);
  if (!box.empty()) region->limit_box({Vec3d{box[0], box[1], box[2]} - o, Vec3d{box[3], box[4], box[5]} - o});
  if (polygons) region->limit_polygon(to_local(io::read_polygons(polygons->path, crs), o));
  if (painted)
    region->limit_mask(std::make_shared<raster::Raster>(paint_mask(painted->paint, *painted->like.value, o)));
  else if (mask)
    region->limit_mask(read_mask(*mask, limits, progress));
  return region;
}

}  // namespace tafoni::scene::impl
