// The forms that meshes can be written in, by what the bytes say and by reading them back.

#include "tafoni/io/mesh_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <ogr_spatialref.h>
#include <tiny_gltf.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/format.h"
#include "tafoni/mesh/metrics.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;
using testing::Not;

/// A tetrahedron, far from the CRS's zero.
mesh::Mesh peak() {
  mesh::Mesh mesh;
  mesh.origin = {447123.25, 5909876.5, 57.125};
  mesh.positions = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}, {0.1f, 0.2f, 5}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  for (const Vec3f& p : mesh.positions) {
    mesh.normals.push_back(normalized(p - Vec3f{0.75f, 1, 1.25f}));
    mesh.colors.push_back({10, 128, 250, 255});
  }
  return mesh;
}

std::string wkt_of(int epsg) {
  OGRSpatialReference crs;
  EXPECT_EQ(crs.importFromEPSG(epsg), OGRERR_NONE);
  const char* const options[] = {"FORMAT=WKT2_2019", nullptr};
  char* text = nullptr;
  crs.exportToWkt(&text, options);
  const std::string out = text;
  CPLFree(text);
  return out;
}

struct Written {
  TestFolder folder;
  std::string bytes;
  mesh::Mesh back;

  Written(const std::string& name, const MeshMetadata& metadata, const MeshForm& form = {},
          const mesh::Mesh& mesh = peak()) {
    write_mesh(folder.path / name, mesh, metadata, silent(), form);
    std::ifstream in(folder.path / name, std::ios::binary);
    bytes.assign(std::istreambuf_iterator<char>(in), {});
    back = read_mesh(folder.path / name);
  }
  std::string header() const { return bytes.substr(0, bytes.find("end_header")); }
};

TEST(PlyHeader, IsAsciiAndNamesTheCrsAsQgisReadsIt) {
  for (const int epsg : {32631, 27700, 25832, 3035, 2154}) {
    const std::string wkt = wkt_of(epsg);
    const Written ply("p.ply",
                      {.name = "d\xc3\xa9nivel\xe9", .crs = wkt, .generator = {{"note", "\xc2\xb0"}}});
    const std::string header = ply.header();
    EXPECT_THAT(header, HasSubstr(fmt::format("\ncomment crs: EPSG:{}\n", epsg)));
    EXPECT_THAT(header, HasSubstr("\ncomment name d?nivel?\n"));
    EXPECT_TRUE(std::all_of(header.begin(), header.end(), [](char c) {
      return c == '\n' || (c >= ' ' && c < 127);
    })) << header;
  }
  // A CRS of no code, whose name is not ASCII, and text that is no CRS.
  std::string own = wkt_of(32631);
  own = own.substr(0, own.rfind(",ID[")) + "]";
  own.replace(own.find("WGS 84 / UTM"), 12, "d\xc3\xa9nivel\xc3\xa9");
  for (const std::string& crs : {own, std::string("\xff not a CRS")}) {
    const std::string header = Written("p.ply", {.crs = crs}).header();
    EXPECT_TRUE(std::all_of(header.begin(), header.end(), [](char c) {
      return c == '\n' || (c >= ' ' && c < 127);
    })) << header;
    EXPECT_THAT(header, Not(HasSubstr("EPSG:32631\n")));
  }
}

TEST(MeshForm, WorldCoordinatesAreDoubles) {
  const mesh::Mesh mesh = peak();
  const Written ply("p.ply", {}, {.world = true});
  EXPECT_THAT(ply.header(), HasSubstr("property double x\nproperty double y\nproperty double z\n"));
  EXPECT_THAT(ply.header(), Not(HasSubstr("world origin")));
  double first[6] = {};
  std::memcpy(first, ply.bytes.data() + ply.bytes.find("end_header") + 11, 24);
  EXPECT_EQ((Vec3d{first[0], first[1], first[2]}), mesh.origin);
  const Written obj("p.obj", {}, {.up = 'z', .world = true});
  EXPECT_THAT(obj.bytes, HasSubstr("\nv 447126.25 5909876.5 57.125 "));
  for (const Written* written : {&ply, &obj}) {
    ASSERT_EQ(written->back.positions.size(), mesh.positions.size());
    for (std::size_t v = 0; v < mesh.positions.size(); ++v)
      EXPECT_LT(length(to_double(written->back.positions[v]) + written->back.origin -
                       to_double(mesh.positions[v]) - mesh.origin),
                1e-6);
    EXPECT_EQ(written->back.normals, mesh.normals);
  }
}

TEST(MeshForm, EveryAxisThatAFormatCanHaveReadsBack) {
  const mesh::Mesh mesh = peak();
  for (const FormatType* format : all_formats()) {
    if (!format->write_mesh) continue;
    for (const char up : format->ups)
      for (const bool world : {false, true}) {
        if (world && !format->world) continue;
        const Written written("p." + format->extensions[0], {}, {.up = up, .world = world});
        const auto a = mesh::metrics(mesh), b = mesh::metrics(written.back);
        EXPECT_NEAR(b.volume, a.volume, 1e-4) << format->about.name << up;
        EXPECT_LT(length(b.bounds.lo - a.bounds.lo) + length(b.bounds.hi - a.bounds.hi), 1e-5)
            << format->about.name << up;
        if (format->about.name != "stl") {
          EXPECT_EQ(written.back.normals, mesh.normals);
        }
      }
  }
}

TEST(MeshForm, ObjHasYUpUnlessAsked) {
  EXPECT_THAT(Written("p.obj", {}).bytes, HasSubstr("\nv 0 0 -4 "));
  EXPECT_THAT(Written("p.obj", {}, {.up = 'z'}).bytes, HasSubstr("\nv 0 4 0 "));
  EXPECT_THAT(Written("p.obj", {}).bytes, testing::StartsWith("# tafoni: metres, y up\n"));
}

TEST(MeshForm, WhatAFormatLacksIsRefused) {
  const TestFolder folder;
  const auto says = [&](const char* name, const MeshForm& form) {
    return error_of([&] { write_mesh(folder.path / name, peak(), {}, silent(), form); });
  };
  EXPECT_THAT(says("p.glb", {.up = 'z'}), HasSubstr("A glb file has no z up"));
  EXPECT_THAT(says("p.stl", {.world = true}), HasSubstr("A stl file has no world coordinates"));
  EXPECT_THAT(says("p.ply", {.float_colors = true}), HasSubstr("A ply file has no colours as floats"));
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(GlbForm, BothExtrasHaveTheOriginAndTheMaterialTheScenesName) {
  const MeshMetadata metadata{.name = "peak", .crs = "EPSG:32631"};
  for (const bool floats : {false, true}) {
    const Written written("p.glb", metadata, {.float_colors = floats});
    tinygltf::TinyGLTF loader;
    tinygltf::Model model;
    std::string errors, warnings;
    ASSERT_TRUE(loader.LoadBinaryFromMemory(&model, &errors, &warnings,
                                            reinterpret_cast<const unsigned char*>(written.bytes.data()),
                                            static_cast<unsigned>(written.bytes.size())))
        << errors;
    for (const tinygltf::Value& extras : {model.asset.extras, model.nodes.at(0).extras}) {
      EXPECT_EQ(extras.Get("world_origin").Get(0).GetNumberAsDouble(), 447123.25);
      EXPECT_EQ(extras.Get("crs").Get<std::string>(), "EPSG:32631");
    }
    EXPECT_EQ(model.materials.at(0).name, "peak_rock");
    const auto& color = model.accessors.at(model.meshes.at(0).primitives.at(0).attributes.at("COLOR_0"));
    EXPECT_EQ(color.componentType,
              floats ? TINYGLTF_COMPONENT_TYPE_FLOAT : TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE);
    EXPECT_EQ(written.back.colors, peak().colors);
    EXPECT_EQ(written.back.origin, peak().origin);
  }
}

}  // namespace
}  // namespace tafoni::io
