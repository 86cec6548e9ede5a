#include "tafoni/io/vector.h"

#include <cmath>
#include <fstream>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/test_folder.h"

namespace tafoni::io {
namespace {

namespace fs = std::filesystem;

class ReadPolygons : public testing::Test {
 protected:
  fs::path written(const std::string& name, const std::string& text) const {
    std::ofstream(folder_.path / name) << text;
    return folder_.path / name;
  }
  static std::string feature(const std::string& type, const std::string& coordinates,
                             const std::string& crs = "") {
    const std::string member =
        crs.empty() ? "" : R"("crs":{"type":"name","properties":{"name":")" + crs + R"("}},)";
    return R"({"type":"FeatureCollection",)" + member +
           R"("features":[{"type":"Feature","properties":{},"geometry":{"type":")" + type +
           R"(","coordinates":)" + coordinates + "}}]}";
  }
  static std::string error(const fs::path& path, const std::string& crs) {
    try {
      read_polygons(path, crs);
    } catch (const Error& e) {
      EXPECT_EQ(e.kind(), ErrorKind::input);
      return e.what();
    }
    ADD_FAILURE() << "nothing was thrown";
    return "";
  }
  const TestFolder folder_;
};

TEST_F(ReadPolygons, KeepsRingsAndHoles) {
  const auto path =
      written("a.geojson", feature("Polygon", "[[[0,0],[9,0],[9,9],[0,9],[0,0]],[[2,2],[4,2],[4,4],[2,2]]]"));
  const auto rings = read_polygons(path, "");
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_EQ(rings[0].size(), 4u);
  EXPECT_EQ(rings[1].size(), 3u);
  EXPECT_EQ(rings[1][1], (Vec2d{4, 2}));
}

/// Whether rings hold a place, by the even-odd rule.
bool holds(const std::vector<std::vector<Vec2d>>& rings, Vec2d p) {
  bool odd = false;
  for (const auto& ring : rings)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++) {
      const Vec2d a = ring[i], b = ring[j];
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)) odd = !odd;
    }
  return odd;
}

TEST_F(ReadPolygons, WhatOverlapsIsUnited) {
  const std::string ring = "[[[0,0],[9,0],[9,9],[0,9],[0,0]],[[1,1],[8,1],[8,8],[1,8],[1,1]]]";
  const std::string across = "[[[-1,4],[10,4],[10,6],[-1,6],[-1,4]]]";
  const std::string bow = "[[[2,5],[4,7],[4,5],[2,7],[2,5]]]";  // crosses itself in (3, 6)
  const auto many = [&](const std::string& more) {
    std::string text = feature("MultiPolygon", "[" + ring + "," + across + "]");
    text.resize(text.size() - 2);
    return text + "," + R"({"type":"Feature","properties":{},"geometry":{"type":"Polygon","coordinates":)" +
           more + "}}]}";
  };
  const auto rings = read_polygons(written("many.geojson", many(bow)), "");
  const auto inside = [](Vec2d p) {
    const bool square = std::max(std::abs(p.x - 4.5), std::abs(p.y - 4.5)) < 4.5 &&
                        std::max(std::abs(p.x - 4.5), std::abs(p.y - 4.5)) > 3.5;
    const bool bar = p.x > -1 && p.x < 10 && p.y > 4 && p.y < 6;
    const bool wings = std::abs(p.x - 3) < 1 && std::abs(p.y - 6) < std::abs(p.x - 3);
    return square || bar || wings;
  };
  for (double y = -1.97; y < 11; y += 0.1)
    for (double x = -1.93; x < 11; x += 0.1) ASSERT_EQ(holds(rings, {x, y}), inside({x, y})) << x << ' ' << y;
  // Neighbours with a border in common have none within.
  const auto two = read_polygons(written("two.geojson", feature("MultiPolygon",
                                                                "[[[[0,0],[5,0],[5,5],[0,5],[0,0]]],"
                                                                "[[[5,0],[9,0],[9,5],[5,5],[5,0]]]]")),
                                 "");
  ASSERT_EQ(two.size(), 1u);
  EXPECT_TRUE(holds(two, {5, 2}));
}

TEST_F(ReadPolygons, BringsDegreesToTheScene) {
  // The central meridian of UTM zone 30 has easting 500 km; 53 N lies 5872 km from the equator.
  const auto path = written(
      "b.geojson",
      feature("MultiPolygon",
              "[[[[-3,53],[-2.99,53],[-3,53.01],[-3,53]]],[[[-3.1,53],[-3.1,53.1],[-3.2,53],[-3.1,53]]]]"));
  const auto rings = read_polygons(path, "EPSG:32630");
  ASSERT_EQ(rings.size(), 2u);
  EXPECT_NEAR(rings[0][0].x, 500'000, 1e-3);
  EXPECT_NEAR(rings[0][0].y, 5'872'000, 1500);
  EXPECT_NEAR(std::hypot(rings[0][1].x - rings[0][0].x, rings[0][1].y - rings[0][0].y), 671, 2);
}

TEST_F(ReadPolygons, TakesMetresForMetres) {
  const std::string square = "[[[411000,383000],[412000,383000],[412000,384000],[411000,383000]]]";
  for (const std::string crs : {"", "urn:ogc:def:crs:EPSG::27700"}) {
    const auto rings = read_polygons(written("c.geojson", feature("Polygon", square, crs)), "EPSG:27700");
    ASSERT_EQ(rings.size(), 1u);
    EXPECT_NEAR(rings[0][1].x, 412000, 1e-6);
    EXPECT_NEAR(rings[0][1].y, 383000, 1e-6);
  }
}

TEST_F(ReadPolygons, LocalCoordinatesMeetGeoJson) {
  // A drawing over a model in local coordinates: GeoJSON cannot but say that it is in degrees.
  const std::string local =
      R"x(ENGCRS["Local Coordinates (m)",EDATUM[""],CS[Cartesian,2],AXIS["(E)",east],AXIS["(N)",north],)x"
      R"x(LENGTHUNIT["metre",1]])x";
  const std::string square = "[[[-20,-15],[10,-15],[10,15],[-20,-15]]]";
  for (const std::string crs : {"", "urn:ogc:def:crs:OGC:1.3:CRS84", "urn:ogc:def:crs:EPSG::4326"})
    for (const std::string& scene : {local, std::string()}) {
      const auto rings = read_polygons(written("local.geojson", feature("Polygon", square, crs)), scene);
      ASSERT_EQ(rings.size(), 1u);
      EXPECT_EQ(rings[0][0], (Vec2d{-20, -15})) << crs << scene;
      EXPECT_EQ(rings[0][1], (Vec2d{10, -15})) << crs << scene;
    }
  // What is truly somewhere on Earth has no way there.
  EXPECT_THAT(error(written("utm.geojson", feature("Polygon", square, "urn:ogc:def:crs:EPSG::32631")), local),
              testing::HasSubstr("from which nothing leads to Local Coordinates (m)"));
}

TEST_F(ReadPolygons, RefusesInOneSentence) {
  EXPECT_THAT(error(folder_.path / "none.geojson", ""), testing::HasSubstr("no such file"));
  EXPECT_THAT(error(written("d.geojson", ""), ""), testing::HasSubstr("is empty"));
  EXPECT_THAT(error(written("e.geojson", "{\"type\":\"Feat"), ""), testing::HasSubstr("e.geojson"));
  EXPECT_THAT(error(written("f.geojson", feature("Point", "[1,2]")), ""), testing::HasSubstr("no polygons"));
  EXPECT_THAT(error(written("g.geojson", feature("Polygon", "[[[0,0],[1,0],[0,0]]]")), ""),
              testing::HasSubstr("no polygons"));
  EXPECT_THAT(error(written("h.geojson", feature("Polygon", "[[[0,0],[9,0],[9,9],[0,0]]]")), "nonsense"),
              testing::HasSubstr("not understood"));
}

}  // namespace
}  // namespace tafoni::io
