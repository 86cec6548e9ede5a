// Any text as polygons in GeoJSON, taken as they are and brought to a CRS, and as the region of a landform.

#include <algorithm>

#include "fuzz.h"

#include "tafoni/io/vector.h"
#include "tafoni/landforms/site/region.h"

using namespace tafoni;

std::vector<std::string> fuzz_seeds() {
  return {
      R"({"type":"Polygon","coordinates":[[[8.5,47.25],[8.75,47.25],[8.75,47.5],[8.5,47.25]],)"
      R"([[8.6,47.3],[8.7,47.3],[8.7,47.4],[8.6,47.3]]]})",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","properties":{"a":1},"geometry":)"
      R"({"type":"MultiPolygon","coordinates":[[[[447123.4,5909876.5],[447124,5909876],[447123,5909877,57]]],)"
      R"([[[0,0],[1e3,0],[1e3,1e3],[0,1e3],[0,0]]]]}},{"type":"Feature","geometry":null,"properties":{}}]})",
      R"({"type":"GeometryCollection","crs":{"type":"name","properties":{"name":"EPSG:25832"}},"geometries":)"
      R"([{"type":"Point","coordinates":[1,2]},{"type":"Polygon","coordinates":[[[4e5,5e6],[4.1e5,5e6],)"
      R"([4e5,5.1e6],[4e5,5e6]]]},{"type":"LineString","coordinates":[[1,2],[3,4]]}]})"};
}

namespace {

void check_polygons(const std::filesystem::path& file, const std::string& crs) {
  std::vector<std::vector<Vec2d>> rings;
  if (!accepts([&] { rings = io::read_polygons(file, crs); })) return;
  require(!rings.empty());
  for (const auto& ring : rings) {
    require(ring.size() >= 3 && !(ring.front() == ring.back()));
    for (const Vec2d p : ring) require(std::isfinite(p.x) && std::isfinite(p.y));
  }
  landforms::Region region;
  region.limit_polygon(rings);
  const Box3d box = region.bounds();
  const field::FunctionPtr control = landforms::as_function(&region, 5);
  for (const Vec2d p : {rings[0][0], rings[0][1], (rings[0][0] + rings[0][2]) * 0.5, Vec2d{0, 0}}) {
    const Vec3d at{p.x, p.y, 0};
    const double weight = region.weight(at);
    require(weight >= 0 && weight <= 1);
    require(weight == 0 || (p.x >= box.lo.x && p.x <= box.hi.x && p.y >= box.lo.y && p.y <= box.hi.y));
    float value = 0;
    control->values({&at, 1}, {&value, 1});
    const Interval range = control->range({at, at});
    require(value >= 0 && value <= 1 && (weight > 0 || value == 0) && range.lo <= value && value <= range.hi);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  const std::filesystem::path file = folder.write("a.geojson", as_text(data, size));
  check_polygons(file, size % 2 != 0 ? "" : "EPSG:25832");
  return 0;
}
