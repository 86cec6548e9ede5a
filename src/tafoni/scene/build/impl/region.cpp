#include "tafoni/scene/build/impl/region.h"

#include <utility>

#include "tafoni/io/dem.h"
#include "tafoni/io/vector.h"

namespace tafoni::scene::impl {
namespace {

std::vector<landforms::Ring> to_local(std::vector<landforms::Ring> rings, Vec3d origin) {
  for (auto& ring : rings)
    for (Vec2d& p : ring) p = p - Vec2d{origin.x, origin.y};
  return rings;
}

std::shared_ptr<const raster::Raster> read_mask(const File& file, const std::string& crs, Vec3d origin) {
  io::DemOptions options;
  options.encoding = io::HeightEncoding::heights;
  options.fill_distance = 0;
  options.crs = crs;
  auto mask = std::make_shared<raster::Raster>(io::read_dem(file.path, options).raster);
  mask->placement.west -= origin.x;
  mask->placement.north -= origin.y;
  return mask;
}

}  // namespace

RegionPtr make_region(const Limits& limits, Progress&) {
  const auto& [altitude, box, polygons, mask, painted, o, crs] = limits;
  auto region = std::make_shared<landforms::Region>();
  if (!altitude.empty()) region->limit_altitude(altitude[0] - o.z, altitude[1] - o.z);
  if (!box.empty()) region->limit_box({Vec3d{box[0], box[1], box[2]} - o, Vec3d{box[3], box[4], box[5]} - o});
  if (polygons) region->limit_polygon(to_local(io::read_polygons(polygons->path, crs), o));
  if (painted)
    region->limit_mask(std::make_shared<raster::Raster>(paint_mask(painted->paint, *painted->like.value, o)));
  else if (mask)
    region->limit_mask(read_mask(*mask, crs, o));
  return region;
}

}  // namespace tafoni::scene::impl
