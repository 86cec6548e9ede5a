// Polygons by OGR: every layer's rings, flattened and brought to the CRS wanted. Rings are told apart from
// holes by counting crossings later, so polygons that overlap are united here.

#include "tafoni/io/vector.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <string_view>

#include <ogrsf_frmts.h>

#include "tafoni/core/error.h"
#include "tafoni/io/impl/gdal.h"

namespace tafoni::io {
namespace {

using Rings = std::vector<std::vector<Vec2d>>;

/// The rings of one polygon, the outer one first, to which the even-odd rule applies.
struct Polygon {
  Rings rings;
  OGREnvelope hull;
};
using Polygons = std::vector<Polygon>;

/// Pairs of hulls that are compared before polygons are united anyway, which takes less time then.
constexpr std::size_t most_looks = 10'000'000;

/// False where a ring has no three corners.
bool add_ring(const OGRLinearRing& ring, Rings& out) {
  std::vector<Vec2d> points;
  for (int i = 0; i < ring.getNumPoints(); ++i) {
    const Vec2d p{ring.getX(i), ring.getY(i)};
    if (points.empty() || !(points.back() == p)) points.push_back(p);
  }
  while (points.size() > 1 && points.front() == points.back()) points.pop_back();
  if (points.size() < 3) return false;
  out.push_back(std::move(points));
  return true;
}

void add_polygons(const OGRGeometry& geometry, Polygons& out) {
  const auto type = wkbFlatten(geometry.getGeometryType());
  if (type == wkbPolygon) {
    const OGRPolygon& polygon = *geometry.toPolygon();
    Polygon added;
    if (polygon.getExteriorRing() == nullptr || !add_ring(*polygon.getExteriorRing(), added.rings)) return;
    for (int i = 0; i < polygon.getNumInteriorRings(); ++i)
      add_ring(*polygon.getInteriorRing(i), added.rings);
    polygon.getEnvelope(&added.hull);
    out.push_back(std::move(added));
  } else if (OGR_GT_IsSubClassOf(type, wkbGeometryCollection)) {
    const OGRGeometryCollection& parts = *geometry.toGeometryCollection();
    for (int i = 0; i < parts.getNumGeometries(); ++i) add_polygons(*parts.getGeometryRef(i), out);
  }
}

/// Whether the hulls of two of them meet, as far as that is quickly told.
bool may_overlap(const Polygons& polygons) {
  std::vector<const OGREnvelope*> hulls;
  for (const Polygon& polygon : polygons) hulls.push_back(&polygon.hull);
  std::sort(hulls.begin(), hulls.end(),
            [](const OGREnvelope* a, const OGREnvelope* b) { return a->MinX < b->MinX; });
  std::size_t looks = 0;
  for (std::size_t i = 0; i < hulls.size(); ++i)
    for (std::size_t k = i + 1; k < hulls.size() && hulls[k]->MinX <= hulls[i]->MaxX; ++k)
      if (hulls[i]->Intersects(*hulls[k]) || ++looks > most_looks) return true;
  return false;
}

std::unique_ptr<OGRPolygon> to_ogr(const Polygon& polygon) {
  auto out = std::make_unique<OGRPolygon>();
  for (const auto& points : polygon.rings) {
    OGRLinearRing ring;
    for (const Vec2d p : points) ring.addPoint(p.x, p.y);
    ring.closeRings();
    out->addRing(&ring);
  }
  return out;
}

/// What any of the polygons covers. A polygon that crosses itself is taken apart by the even-odd rule first,
/// as GEOS unites none.
Polygons united(const Polygons& polygons, const std::string& name) {
  Polygons simple, out;
  for (const Polygon& polygon : polygons) {
    std::unique_ptr<OGRGeometry> made = to_ogr(polygon);
    if (!made->IsValid()) made.reset(made->MakeValid());
    if (made == nullptr)
      fail(ErrorKind::input, "{} holds a polygon that crosses itself and cannot be mended; draw it anew.",
           name);
    add_polygons(*made, simple);
  }
  OGRMultiPolygon parts;
  for (const Polygon& polygon : simple) parts.addGeometryDirectly(to_ogr(polygon).release());
  const std::unique_ptr<OGRGeometry> sum(parts.UnionCascaded());
  if (sum == nullptr)
    fail(ErrorKind::input, "{} holds polygons that overlap and cannot be united; unite them in a GIS.", name);
  add_polygons(*sum, out);
  return out;
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
               Polygons& out) {
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
  Polygons polygons;
  for (int i = 0; i < dataset->GetLayerCount(); ++i)
    add_layer(*dataset->GetLayer(i), crs.empty() ? nullptr : &target, geojson, path.string(), polygons);
  if (messages.failed())
    fail(ErrorKind::input, "{} cannot be read whole{}.", path.string(), messages.because());
  for (const Polygon& polygon : polygons)
    for (const auto& ring : polygon.rings)
      for (const Vec2d p : ring)
        if (!std::isfinite(p.x) || !std::isfinite(p.y))
          fail(ErrorKind::input, "{} holds a point that is not finite.", path.string());
  if (may_overlap(polygons)) polygons = united(polygons, path.string());
  Rings out;
  for (Polygon& polygon : polygons)
    std::move(polygon.rings.begin(), polygon.rings.end(), std::back_inserter(out));
  if (out.empty()) fail(ErrorKind::input, "{} holds no polygons; draw at least one.", path.string());
  return out;
}

}  // namespace tafoni::io
