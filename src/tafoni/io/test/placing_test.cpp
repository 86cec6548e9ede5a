// The same solid near zero and in map coordinates, in every format that can hold the latter.

#include <cmath>
#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/format.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"

namespace tafoni::io {
namespace {

constexpr double radius = 5;
constexpr int around = 96, rings = 48;
constexpr Vec3d utm{447123.37, 5909876.54, 57.2};

/// Corners of a globe's facets: triangles at the poles, quads between.
struct Globe {
  std::vector<Vec3d> points;
  std::vector<std::vector<int>> faces;

  explicit Globe(Vec3d center) {
    const auto at = [](int ring, int a) { return 2 + (ring - 1) * around + a % around; };
    points = {center + Vec3d{0, 0, radius}, center - Vec3d{0, 0, radius}};
    for (int ring = 1; ring < rings; ++ring)
      for (int a = 0; a < around; ++a) {
        const double theta = ring * M_PI / rings, phi = a * 2 * M_PI / around;
        points.push_back(center + radius * Vec3d{std::sin(theta) * std::cos(phi),
                                                 std::sin(theta) * std::sin(phi), std::cos(theta)});
      }
    for (int a = 0; a < around; ++a) {
      faces.push_back({0, at(1, a), at(1, a + 1)});
      faces.push_back({1, at(rings - 1, a + 1), at(rings - 1, a)});
      for (int ring = 1; ring + 1 < rings; ++ring)
        faces.push_back({at(ring, a), at(ring + 1, a), at(ring + 1, a + 1), at(ring, a + 1)});
    }
  }
};

template <class T>
std::string raw(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

std::string obj(const Globe& globe) {
  std::string text;
  for (const Vec3d p : globe.points) text += fmt::format("v {:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
  for (const auto& face : globe.faces) {
    text += "f";
    for (const int v : face) text += fmt::format(" {}", v + 1);
    text += "\n";
  }
  return text;
}

std::string off(const Globe& globe) {
  std::string text = fmt::format("OFF\n{} {} 0\n", globe.points.size(), globe.faces.size());
  for (const Vec3d p : globe.points) text += fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
  for (const auto& face : globe.faces) {
    text += fmt::format("{}", face.size());
    for (const int v : face) text += fmt::format(" {}", v);
    text += "\n";
  }
  return text;
}

std::string ply(const Globe& globe, bool binary) {
  std::string text = fmt::format(
      "ply\nformat {} 1.0\nelement vertex {}\nproperty double x\nproperty double y\nproperty double z\n"
      "element face {}\nproperty list uchar int vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", globe.points.size(), globe.faces.size());
  for (const Vec3d p : globe.points)
    text += binary ? raw(p) : fmt::format("{:.6f} {:.6f} {:.6f}\n", p.x, p.y, p.z);
  for (const auto& face : globe.faces) {
    text += binary ? std::string(1, static_cast<char>(face.size())) : fmt::format("{}", face.size());
    for (const int v : face) text += binary ? raw(v) : fmt::format(" {}", v);
    if (!binary) text += "\n";
  }
  return text;
}

std::string stl(const Globe& globe) {
  std::string text = "solid globe\n";
  for (const auto& face : globe.faces)
    for (std::size_t c = 2; c < face.size(); ++c) {
      text += "facet normal 0 0 1\nouter loop\n";
      for (const int v : {face[0], face[c - 1], face[c]})
        text += fmt::format("vertex {:.6f} {:.6f} {:.6f}\n", globe.points[v].x, globe.points[v].y,
                            globe.points[v].z);
      text += "endloop\nendfacet\n";
    }
  return text + "endsolid globe\n";
}

std::string glb_of(std::string json, const std::string& binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t v) { return raw(static_cast<std::uint32_t>(v)); };
  return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

/// A globe about zero that nodes carry to its place, y up as glTF has it.
std::string glb_of_nodes(const std::string& nodes) {
  const Globe globe({});
  std::string positions, indices;
  for (const Vec3d p : globe.points) positions += raw(to_float({p.x, p.z, -p.y}));
  std::size_t corners = 0;
  for (const auto& face : globe.faces)
    for (std::size_t c = 2; c < face.size(); ++c, corners += 3)
      for (const int v : {face[0], face[c - 1], face[c]}) indices += raw(v);
  return glb_of(fmt::format(R"({{"asset":{{"version":"2.0"}},"nodes":[{}],"buffers":[{{"byteLength":{}}}],
      "bufferViews":[{{"buffer":0,"byteLength":{}}},{{"buffer":0,"byteOffset":{},"byteLength":{}}}],
      "accessors":[{{"bufferView":0,"componentType":5126,"type":"VEC3","count":{}}},
        {{"bufferView":1,"componentType":5125,"type":"SCALAR","count":{}}}],
      "scenes":[{{"nodes":[0]}}],
      "meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}},"indices":1}}]}}]}})",
                            nodes, positions.size() + indices.size(), positions.size(), positions.size(),
                            indices.size(), globe.points.size(), corners),
                positions + indices);
}

mesh::Mesh read(const std::string& name, const std::string& bytes) {
  const TestFolder folder;
  std::ofstream(folder.path / name, std::ios::binary) << bytes;
  return read_mesh(folder.path / name);
}

/// The globe's area and volume by its own doubles.
struct Truth {
  double area = 0, volume = 0;
  Truth() {
    const Globe globe({});
    for (const auto& face : globe.faces)
      for (std::size_t c = 2; c < face.size(); ++c) {
        const Vec3d a = globe.points[face[0]], b = globe.points[face[c - 1]], d = globe.points[face[c]];
        area += length(cross(b - a, d - a)) / 2;
        volume += dot(a, cross(b, d)) / 6;
      }
  }
};

void expect_globe(const mesh::Mesh& mesh, Vec3d center, const std::string& what) {
  static const Truth truth;
  const mesh::MeshMetrics m = mesh::metrics(mesh);
  EXPECT_NEAR(m.area, truth.area, 1e-4 * truth.area) << what;
  EXPECT_NEAR(m.volume, truth.volume, 1e-4 * truth.volume) << what;
  EXPECT_TRUE(m.closed) << what;
  EXPECT_THAT(mesh::defects(mesh::validate(mesh)), testing::IsEmpty()) << what;
  const Vec3d middle = (m.bounds.lo + m.bounds.hi) * 0.5;
  EXPECT_LT(length(middle - center), 2e-6) << what;
}

TEST(Placing, MapCoordinatesAreReadInDouble) {
  for (const Vec3d at : {Vec3d{}, utm, Vec3d{-2e7, 1.9e7, 8000}}) {
    const Globe globe(at);
    expect_globe(read("a.obj", obj(globe)), at, "obj");
    expect_globe(read("a.off", off(globe)), at, "off");
    expect_globe(read("a.stl", stl(globe)), at, "stl");
    expect_globe(read("a.ply", ply(globe, false)), at, "text ply");
    expect_globe(read("b.ply", ply(globe, true)), at, "binary ply");
    const std::string place = fmt::format("{},{},{}", at.x, at.z, -at.y);
    expect_globe(read("a.glb", glb_of_nodes(R"({"mesh":0,"translation":[)" + place + "]}")), at, "glb");
    expect_globe(read("b.glb", glb_of_nodes(R"({"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,)" + place +
                                            R"(,1],"children":[1]},{"mesh":0,"translation":[0,0,0]})")),
                 at, "glb matrix");
  }
}

TEST(Placing, AStrayPointThatNoTriangleUsesDoesNotCount) {
  Globe globe(utm);
  globe.points.push_back({});
  EXPECT_NEAR(mesh::metrics(read("a.obj", obj(globe))).area, Truth().area, 1e-4 * Truth().area);
}

TEST(Placing, MeshesNearZeroKeepTheirNumbers) {
  for (const Vec3d at : {Vec3d{}, Vec3d{4, -6, 9}}) {
    const mesh::Mesh mesh = read("a.obj", obj(Globe(at)));
    EXPECT_EQ(mesh.origin, Vec3d{});
    EXPECT_EQ(mesh.positions[0].z, static_cast<float>(at.z + radius));
  }
}

TEST(Placing, ExtrasOfAssetOrNodesAreTheOrigin) {
  const std::string extras = fmt::format(R"("extras":{{"world_origin":[{},{},{}]}})", utm.x, utm.y, utm.z);
  // A node by itself, and two nodes that state different origins, of which one stands for a globe further on.
  const mesh::Mesh one = read("a.glb", glb_of_nodes(R"({"mesh":0,)" + extras + "}"));
  EXPECT_EQ(one.origin, utm);
  expect_globe(one, utm, "node");
  std::string asset = glb_of_nodes(R"({"mesh":0})");
  const std::string version = R"("version":"2.0")";
  asset.replace(asset.find(version), version.size(), extras);
  // The JSON chunk has grown: its length and the file's are set anew.
  const std::size_t json = asset.find("BIN") - 4 - 20;
  std::string padded = asset.substr(20, json);
  asset = glb_of(padded, asset.substr(asset.find("BIN") + 4));
  expect_globe(read("b.glb", asset), utm, "asset");
  const mesh::Mesh two =
      read("c.glb", glb_of_nodes(R"({"children":[1,2]},{"mesh":0,)" + extras +
                                 fmt::format(R"(}},{{"mesh":0,"extras":{{"world_origin":[{},{},{}]}}}})",
                                             utm.x + 100, utm.y, utm.z)));
  EXPECT_NEAR(mesh::metrics(two).bounds.size().x, 100 + 2 * radius, 1e-3);
  EXPECT_NEAR(mesh::metrics(two).bounds.lo.x, utm.x - radius, 1e-3);
}

TEST(Placing, TilesReadBackMeetBitForBit) {
  // A tile far from its scene's origin, whose floats another tile has as well.
  mesh::Mesh tile;
  tile.origin = {447000, 5909000, 0};
  tile.positions = {
      {9000.125f, 9000.0625f, 7.3f}, {9001.126f, 9000.0625f, 7.1f}, {9000.125f, 9001.07f, 7.2f}};
  tile.triangles = {{0, 1, 2}};
  const TestFolder folder;
  for (const char* name : {"t.obj", "t.ply", "t.stl", "t.glb"}) {
    write_mesh(folder.path / name, tile);
    const mesh::Mesh back = read_mesh(folder.path / name);
    EXPECT_EQ(back.origin, tile.origin) << name;
    EXPECT_EQ(back.positions, tile.positions) << name;
  }
}

TEST(Placing, NumbersBeyondFloatsAreRefusedByTheirVertex) {
  EXPECT_THAT(error_of([] { read("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1e300 0\nf 1 2 3\n"); }),
              testing::HasSubstr("vertex 2"));
  // Far, but not wide: the origin takes it.
  const mesh::Mesh mesh = read("b.obj", "v 1e12 0 0\nv 1000000000004 0 0\nv 1e12 2 0\nf 1 2 3\n");
  EXPECT_EQ(mesh::metrics(mesh).area, 4);
}

}  // namespace
}  // namespace tafoni::io
