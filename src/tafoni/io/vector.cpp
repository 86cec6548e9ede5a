// Polygons by OGR: every layer's rings, flattened and brought to the CRS wanted.

#include "tafoni/io/vector.h"

#include <algorithm>
#include <cmath>
#include <string_view>

#include <ogrsf_frmts.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/gdal.h"

namespace tafoni::io {
namespace {

using Rings = std::vector<std::vector<Vec2d>>;

void add_ring(const OGRLinearRing& ring, Rings& out) {
  std::vector<Vec2d> points;
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    const Vec2d p{ring.getX(i), ring.getY(i)};
    if (points.empty() || !(points.back() == p)) points.push_back(p);
  }
  while (points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() >= 3) out.push_back(std::move(points));
}

void add_polygons(const OGRGeometry& geometry, Rings& out) {
  const auto type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    const OGRPolygon& polygon = *geometry.toPolygon();
    if (polygon.getExteriorRing() != nullptr) add_ring(*polygon.getExteriorRing(), out);
    for (int i = 0; i < polygon.getNumInteriorRings(); ++i) add_ring(*polygon.getInteriorRing(i), out);
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    const OGRGeometryCollection& parts = *geometry.toGeometryCollection();
    for (int i = 0; i < parts.getNumGeometries(); ++i) add_polygons(*parts.getGeometryRef(i), out);
  }
}

/// GeoJSON without a "crs" member says WGS 84 by its standard, but many programs write metres into it.
bool cannot_be_degrees(OGRLayer& layer) {
  OGREnvelope hull;
  if (layer.GetExtent(&hull, TRUE) != OGRERR_NONE) return false;
  return std::max({std::abs(hull.MinX), std::abs(hull.MaxX)}) > 360 ||
         std::max(std::abs(hull.MinY), std::abs(hull.MaxY)) > 90;
}

/// How to bring a layer to `target`; null where its coordinates are taken as they are.
impl::TransformationPtr way_to(OGRLayer& layer, const OGRSpatialReference& target, bool geojson,
                               const std::string& name) {
  const OGRSpatialReference* own = layer.GetSpatialRef();
  if (own == nullptr || own->IsLocal()) return nullptr;
  if (own->IsGeographic() && (cannot_be_degrees(layer) || (geojson && target.IsLocal()))) return nullptr;
  OGRSpatialReference from = *own;
  from.SetAxisMappingStrategy(OAMS_TRADITIONAL_GIS_ORDER);
  if (from.IsSame(&target)) return nullptr;
  impl::TransformationPtr way = impl::transformation(from, target);
  if (way) return way;
  fail(ErrorKind::input,
       "{} is in {}, from which nothing leads to {}, the terrain's; draw it over the terrain, or say where "
       "that "
       "lies with terrain.crs.",
       name, impl::name_of(from), impl::name_of(target));
}

void add_layer(OGRLayer& layer, const OGRSpatialReference* target, bool geojson, const std::string& name,
               Rings& out) {
  const impl::TransformationPtr to_target =
      target != nullptr ? way_to(layer, *target, geojson, name) : nullptr;
  layer.ResetReading();
  while (OGRFeatureUniquePtr feature{layer.GetNextFeature()}) {
    const OGRGeometry* geometry = feature->GetGeometryRef();
    if (geometry == nullptr) continue;
    const std::unique_ptr<OGRGeometry> flat(geometry->getLinearGeometry());
    if (flat == nullptr) continue;
    if (to_target && flat->transform(to_target.get()) != OGRERR_NONE)
      fail(ErrorKind::input, "{} holds points that cannot be brought to the scene's coordinate system.",
           name);
    add_polygons(*flat, out);
  }
}

}  // namespace

Rings read_polygons(const std::filesystem::path& path, const std::string& crs) {
  const impl::DatasetPtr dataset = impl::open_dataset(path, GDAL_OF_VECTOR, "a file of polygons");
  impl::GdalMessages messages;
  OGRSpatialReference target;
  if (!crs.empty()) target = impl::crs_from_wkt(crs);
  const bool geojson = std::string_view(dataset->GetDriver()->GetDescription()).starts_with("GeoJSON");
  Rings out;
  for (int i = 0; i < dataset->GetLayerCount(); ++i)
    add_layer(*dataset->GetLayer(i), crs.empty() ? nullptr : &target, geojson, path.string(), out);
  if (messages.failed())
    fail(ErrorKind::input, "{} cannot be read whole{}.", path.string(), messages.because());
  if (out.empty()) fail(ErrorKind::input, "{} holds no polygons; draw at least one.", path.string());
  for (const auto& ring : out)
    for (const Vec2d p : ring)
      if (!std::isfinite(p.x) || !std::isfinite(p.y))
        fail(ErrorKind::input, "{} holds a point that is not finite.", path.string());
  return out;
}

}  // namespace tafoni::io
