#include "tafoni/scene/build/impl/outside.h"

#include <cmath>

#include <fmt/core.h>

#include "tafoni/raster/resample.h"

namespace tafoni::scene::impl {

bool over_domain(const terrain::Terrain& terrain, const Box3d& box) {
  const Box3d& all = terrain.box;
  if (box.empty() || box.lo.x > all.hi.x || box.hi.x < all.lo.x || box.lo.y > all.hi.y || box.hi.y < all.lo.y)
    return false;
  if (!terrain.inside || !box.bounded()) return true;
  // The raster holds distances to the border, which change by no more than the way, but for a rounding of the
  // border over two pixels; they are cut at a greatest distance, beyond which a larger box may lie over it.
  const Vec3d center = box.center();
  const double half = 0.5 * std::hypot(box.size().x, box.size().y);
  const double rounding = 2 * std::hypot(terrain.inside->placement.dx, terrain.inside->placement.dy);
  return raster::sample_bilinear(*terrain.inside, center.x, center.y) + half + rounding > 0;
}

std::string terrain_place(const terrain::Terrain& terrain) {
  const Vec3d lo = terrain.to_world(terrain.box.lo), hi = terrain.to_world(terrain.box.hi);
  return fmt::format("the terrain (x {:.10g} to {:.10g}, y {:.10g} to {:.10g})", lo.x, hi.x, lo.y, hi.y);
}

Box3d columns_of(const terrain::Terrain& terrain) {
  Box3d out = Box3d::everything();
  out.lo.x = terrain.box.lo.x, out.lo.y = terrain.box.lo.y;
  out.hi.x = terrain.box.hi.x, out.hi.y = terrain.box.hi.y;
  return out;
}

void warn_of_beside(const terrain::Terrain& terrain, std::string_view of, std::string_view things,
                    std::uint64_t count, std::uint64_t all, Progress& progress) {
  if (count == 0) return;
  progress.warn(fmt::format("{}: {} of {} {} lie outside of {} and change nothing; check their positions", of,
                            count == all ? "all" : fmt::format("{}", count), all, things,
                            terrain_place(terrain)));
}

void warn_of_layer_beside(const terrain::Terrain& terrain, std::string_view layer,
                          const landforms::Result& made, const landforms::Region* region,
                          Progress& progress) {
  if (region && !over_domain(terrain, region->bounds())) {
    progress.warn(
        fmt::format("layer {}: its region lies outside of {}, so that it makes nothing; check its CRS", layer,
                    terrain_place(terrain)));
    return;
  }
  Box3d box = made.reshape ? made.reshaped : Box3d{};
  for (const field::NodePtr& node : made.nodes) box.expand(field::support(node));
  if (box.empty() || over_domain(terrain, box)) return;
  progress.warn(
      fmt::format("layer {}: all that it makes lies outside of {} and changes nothing; check its positions",
                  layer, terrain_place(terrain)));
}

}  // namespace tafoni::scene::impl
