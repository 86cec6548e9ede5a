// What the readers make of files that other programs write.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/mesh/metrics.h"

namespace tafoni::io {
namespace {

using Triangle = std::array<std::uint32_t, 3>;
using testing::ElementsAre;
using testing::HasSubstr;

mesh::Mesh read_text(const char* format, std::string_view text) {
  mesh::Mesh mesh = find_format(format).read_mesh(std::as_bytes(std::span(text)), "test");
  impl::check_read(mesh, "test");
  return mesh;
}

/// The sentence that reading gives.
std::string says(const char* format, std::string_view text) {
  return error_of([&] { read_text(format, text); });
}

TEST(Obj, FansPolygonsAndCountsFromTheEnd) {
  const mesh::Mesh mesh = read_text("obj",
                                    "# made elsewhere\r\nmtllib x.mtl\r\nv 0 0 0\r\nv +1 0 0\r\nv 1 1 0\r\n"
                                    "v 0 1 1e-1\r\nvt 0 0\r\ng side\r\nf 1/1 2/1 3/1 4/1\r\nf -4 -3 -1");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}, Triangle{0, 1, 3}));
  EXPECT_EQ(mesh.positions[3], (Vec3f{0, 1, 0.1f}));
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(Obj, HardEdgesDropNormals) {
  const mesh::Mesh mesh = read_text(
      "obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nvn 0 0 1\nvn 1 0 0\nf 1//1 2//1 3//1\nf 1//2 3//2 4//2\n");
  EXPECT_EQ(mesh.triangles.size(), 2u);
  EXPECT_TRUE(mesh.normals.empty());
}

TEST(Obj, RefusesWhatIsNotDefined) {
  EXPECT_THAT(says("obj", "v 0 0 0\nv 1 0 0\nf 1 2 3\n"), HasSubstr("line 3: index 3 is not defined here"));
  EXPECT_THAT(says("obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 0 1 2\n"), HasSubstr("index 0 is not defined here"));
  EXPECT_THAT(says("obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1//1 2//1 3//1\n"),
              HasSubstr("line 4: index 1 is not defined here"));
  EXPECT_THAT(says("obj", "v 0 0 nan\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"), HasSubstr("'nan' is not a number"));
  EXPECT_THAT(says("obj", "v 0 0 1e99\nv 1 0 0\nv 1 1 0\nf 1 2 3\n"), HasSubstr("vertex 0 is not finite"));
}

TEST(Ply, ReadsTextAndBigEndian) {
  const mesh::Mesh text =
      read_text("ply",
                "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double "
                "y\nproperty double z\nproperty int extra\nelement face 1\nproperty list uchar "
                "int vertex_index\nend_header\n0 0 0 9\n1 0 0 9\n0 1 0.5 9\n3 0 1 2");
  EXPECT_THAT(text.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(text.positions[2], (Vec3f{0, 1, 0.5f}));

  std::string big =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\nproperty "
      "short "
      "z\nelement face 1\nproperty list uchar ushort vertex_indices\nend_header\n";
  for (const int v : {0, 0, 0, 1, 0, 0, 0, 1, 258}) {
    big += static_cast<char>(v >> 8);
    big += static_cast<char>(v & 255);
  }
  big += std::string("\x03\0\0\0\1\0\2", 7);
  const mesh::Mesh mesh = read_text("ply", big);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.positions[2], (Vec3f{0, 1, 258}));
}

TEST(Ply, WhatIsNotNeededMayBeNan) {
  const auto text = [](std::string_view first) {
    return fmt::format(
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
        "property float nx\nproperty float ny\nproperty float nz\nproperty float quality\nelement face 1\n"
        "property list uchar int vertex_indices\nend_header\n{}\n1 0 0 0 0 1 -inf\n0 1 0 0 0 1 2\n3 0 1 2\n",
        first);
  };
  EXPECT_EQ(read_text("ply", text("0 0 0 0 0 1 nan")).normals.size(), 3u);
  const mesh::Mesh plain = read_text("ply", text("0 0 0 nan -nan nan -nan(ind)"));
  EXPECT_EQ(plain.triangles.size(), 1u);
  EXPECT_TRUE(plain.normals.empty());
  EXPECT_THAT(says("ply", text("0 0 nan 0 0 1 0")), HasSubstr("line 14: 'nan' is not a number"));
  EXPECT_THAT(says("ply", text("0 0 0 0 0 up 0")), HasSubstr("'up' is not a number"));
}

TEST(Meshes, WithoutTrianglesAreRefused) {
  EXPECT_THAT(says("ply",
                   "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                   "property float z\nend_header\n0 0 0\n"),
              HasSubstr("test: holds 1 vertices and no triangles"));
  EXPECT_THAT(says("off", "OFF 2 1 0\n0 0 0\n1 0 0\n2 0 1\n"), HasSubstr("2 vertices and no triangles"));
}

TEST(Ply, HugeCountsAreRefusedBeforeAnyAllocation) {
  for (const char* count : {"4000000000", "9223372036854775807", "-1"})
    EXPECT_THAT(says("ply", fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty "
                                        "float x\nproperty float y\nproperty float z\nend_header\n",
                                        count)),
                testing::AnyOf(HasSubstr("elements 'vertex' do not fit in the file"),
                               HasSubstr("an element's count is negative")));
}

TEST(Ply, ManyElementsThatFitOneByOneAreRefused) {
  std::string header = "ply\nformat binary_little_endian 1.0\n";
  for (int i = 0; i < 200; ++i) header += "element nothing 90000\n";
  header += "end_header\n" + std::string(100000, '\0');
  EXPECT_THAT(says("ply", header), HasSubstr("90000 elements 'nothing' do not fit in the file"));
}

TEST(Stl, ReadsTextAndWeldsVertices) {
  const mesh::Mesh mesh =
      read_text("stl",
                "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 "
                "1 0\nendloop\nendfacet\nfacet normal 0 0 1\nouter loop\nvertex 1 0 -0\nvertex "
                "1 1 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid x\n");
  EXPECT_EQ(mesh.positions.size(), 4u);
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
}

TEST(Stl, ReadsCapitals) {
  EXPECT_EQ(read_text("stl",
                      "SOLID X\r\n  FACET NORMAL 0 0 1\r\n OUTER LOOP\r\nVERTEX 0 0 0\r\nVertex 1.0E0 0 0\r\n"
                      "VERTEX 0 1 0\r\nENDLOOP\r\nENDFACET\r\nENDSOLID X\r\n")
                .triangles.size(),
            1u);
}

TEST(Off, ReadsAKnownCave) {
  const std::filesystem::path path = TAFONI_SOURCE_DIR "/tests/data/ring_cave.off";
  const mesh::Mesh mesh = read_mesh(path);
  double volume = 0;
  for (const auto& t : mesh.triangles)
    volume += dot(to_double(mesh.positions[t[0]]),
                  cross(to_double(mesh.positions[t[1]]), to_double(mesh.positions[t[2]]))) /
              6;
  EXPECT_NEAR(volume, 21144.719, 0.1);
}

TEST(Off, PolygonsCommentsAndColours) {
  const mesh::Mesh mesh = read_text(
      "off",
      "OFF # a square\n# and a comment\n4 1 0\n0 0 0\n1 0 0 # corner\n1 1 0\n0 1 0\n4 0 1 2 3 255 0 0\n");
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
  EXPECT_THAT(says("off", "OFF 999999999 9 0\n0 0 0\n"),
              HasSubstr("more vertices or faces are announced than the file can hold"));
  EXPECT_THAT(says("off", "OFF BINARY\n"), HasSubstr("binary OFF is not read"));
  EXPECT_THAT(says("off", "OFF 1 1 0\n0 0 0\n3 0 0 1\n"),
              HasSubstr("a face names a vertex that is not there"));
}

mesh::Mesh triangle() {
  mesh::Mesh mesh;
  mesh.origin = {500000.25, 4000000.5, 3};
  mesh.positions = {{0, 0, 0}, {2, 0, 0}, {0, 3, 1}};
  const Vec3f n = normalized(cross(mesh.positions[1], mesh.positions[2]));
  mesh.normals = {n, n, n};
  mesh.colors = {{10, 20, 30, 255}, {40, 50, 60, 255}, {70, 80, 90, 255}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

TEST(Glb, AnIndependentReaderSeesYUpAndTheOrigin) {
  const auto path = std::filesystem::temp_directory_path() / fmt::format("tafoni_peer_{}.glb", ::getpid());
  const mesh::Mesh mesh = triangle();
  write_mesh(path, mesh, {.name = "peer", .crs = "EPSG:32610", .generator = {{"voxel", 0.5}}});
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string errors, warnings;
  ASSERT_TRUE(loader.LoadBinaryFromFile(&model, &errors, &warnings, path.string())) << errors;
  std::filesystem::remove(path);
  EXPECT_EQ(errors + warnings, "");
  const auto& extras = model.nodes.at(0).extras;
  EXPECT_EQ(extras.Get("world_origin").Get(1).GetNumberAsDouble(), 4000000.5);
  EXPECT_EQ(extras.Get("crs").Get<std::string>(), "EPSG:32610");
  EXPECT_EQ(extras.Get("generator").Get("voxel").GetNumberAsDouble(), 0.5);
  const auto& primitive = model.meshes.at(0).primitives.at(0);
  const auto floats = [&](const char* name) {
    const auto& accessor = model.accessors.at(primitive.attributes.at(name));
    const auto& view = model.bufferViews.at(accessor.bufferView);
    return reinterpret_cast<const float*>(model.buffers[0].data.data() + view.byteOffset +
                                          accessor.byteOffset);
  };
  const float* p = floats("POSITION") + 6;
  EXPECT_THAT(std::vector(p, p + 3), ElementsAre(0, 1, -3));  // north is -z, up is y
  EXPECT_THAT(model.accessors.at(primitive.attributes.at("POSITION")).minValues, ElementsAre(0, 0, -3));
  const auto& color = model.accessors.at(primitive.attributes.at("COLOR_0"));
  EXPECT_TRUE(color.normalized);
  EXPECT_EQ(color.componentType, TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE);
}

/// A GLB around `json` and `binary`, as another exporter might write it.
std::string glb(std::string json, const std::string& binary) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const auto word = [](std::size_t v) {
    const auto w = static_cast<std::uint32_t>(v);
    return std::string(reinterpret_cast<const char*>(&w), 4);
  };
  return "glTF" + word(2) + word(28 + json.size() + binary.size()) + word(json.size()) + "JSON" + json +
         word(binary.size()) + std::string("BIN\0", 4) + binary;
}

std::string floats(std::initializer_list<float> values) {
  return {reinterpret_cast<const char*>(values.begin()), values.size() * 4};
}

constexpr const char* points_json =
    R"("buffers":[{"byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}])";

TEST(Glb, NodesMoveAndTurnWithoutIndices) {
  const std::string json =
      std::string(R"({"scenes":[{"nodes":[0]}],"nodes":[{"translation":[0,10,0],"children":[1]},
      {"mesh":0,"scale":[2,2,2]}],)") +
      points_json + "}";
  const mesh::Mesh mesh = read_text("glb", glb(json, floats({0, 0, 0, 1, 0, 0, 0, 0, 1})));
  EXPECT_THAT(mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.positions[1], (Vec3f{2, 0, 10}));
  EXPECT_EQ(mesh.positions[2], (Vec3f{0, -2, 10}));
}

TEST(Glb, MirroredNodesKeepTheirInside) {
  // A tetrahedron of 1/6 m³.
  const std::string solid = floats({0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1});
  const std::string corners("\0\2\1\0\1\3\1\2\3\2\0\3", 12);
  const auto volume = [&](const std::string& nodes) {
    const std::string json = R"({"nodes":[)" + nodes + R"(],"buffers":[{"byteLength":60}],
    "bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":4},
      {"bufferView":1,"componentType":5121,"type":"SCALAR","count":12}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"indices":1}]}]})";
    return mesh::metrics(read_text("glb", glb(json, solid + corners))).volume;
  };
  EXPECT_NEAR(volume(R"({"mesh":0})"), 1 / 6.0, 1e-6);
  EXPECT_NEAR(volume(R"({"mesh":0},{"mesh":0,"scale":[-1,1,1],"translation":[-3,0,0]})"), 2 / 6.0, 1e-6);
  EXPECT_NEAR(volume(R"({"mesh":0,"scale":[1,-2,1]})"), 2 / 6.0, 1e-6);
  EXPECT_NEAR(volume(R"({"mesh":0,"scale":[-1,-1,1]})"), 1 / 6.0, 1e-6);
  EXPECT_NEAR(volume(R"({"mesh":0,"matrix":[0,1,0,0,1,0,0,0,0,0,1,0,0,0,0,1]})"), 1 / 6.0, 1e-6);
}

TEST(Glb, CyclesAndBombsAreRefused) {
  const std::string binary = floats({0, 0, 0, 1, 0, 0, 0, 0, 1});
  const std::string cycle = std::string(R"({"scenes":[{"nodes":[0]}],"nodes":[{"children":[1]},
      {"children":[0]}],)") +
                            points_json + "}";
  EXPECT_THAT(says("glb", glb(cycle, binary)), HasSubstr("stands below itself or in two places"));
  std::string many = R"({"nodes":[{"mesh":0})";
  for (int i = 0; i < 100000; ++i) many += R"(,{"mesh":0})";
  EXPECT_NO_THROW(read_text("glb", glb(many + "]," + points_json + "}", binary)));
  std::string repeated = R"({"nodes":[{"mesh":0}],"buffers":[{"byteLength":120000}],
    "bufferViews":[{"buffer":0,"byteLength":120000}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":10000}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}})";
  for (int i = 0; i < 10000; ++i) repeated += R"(,{"attributes":{"POSITION":0}})";
  EXPECT_THAT(says("glb", glb(repeated + "]}]}", std::string(120000, '\0'))),
              HasSubstr("1 nodes repeat its meshes to more than"));
  // A chain of nodes of which each names the next one twice: 2^40 instances by 40 nodes.
  std::string chain = R"({"scenes":[{"nodes":[0]}],"nodes":[)";
  for (int i = 1; i < 40; ++i) chain += fmt::format(R"({{"children":[{},{}]}},)", i, i);
  EXPECT_THAT(says("glb", glb(chain + R"({"mesh":0}],)" + points_json + "}", binary)),
              HasSubstr("in two places"));
  // Nodes that are sound and repeat one large mesh are counted before any of them is made.
  std::string instances =
      R"({"buffers":[{"byteLength":120000}],"bufferViews":[{"buffer":0,"byteLength":120000}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":10000}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"nodes":[{"mesh":0})";
  for (int i = 0; i < 1000; ++i) instances += R"(,{"mesh":0})";
  EXPECT_THAT(says("glb", glb(instances + "]}", std::string(120000, '\0'))),
              HasSubstr("1001 nodes repeat its meshes to more than"));
  // Primitives of a few vertices cost work, too.
  std::string small = R"({"nodes":[{"mesh":0})";
  for (int i = 0; i < 2000; ++i) small += R"(,{"mesh":0})";
  small += "]," + std::string(points_json);
  small.resize(small.size() - 3);
  for (int i = 0; i < 2000; ++i) small += R"(,{"attributes":{"POSITION":0}})";
  EXPECT_THAT(says("glb", glb(small + "]}]}", binary)), HasSubstr("2001 nodes repeat its meshes"));
  // So do those that are no triangles.
  std::string points = small.substr(0, small.find(R"(,{"attributes")"));
  for (int i = 0; i < 2000; ++i) points += R"(,{"mode":0})";
  EXPECT_THAT(says("glb", glb(points + "]}]}", binary)), HasSubstr("2001 nodes repeat its meshes"));
  const std::string deep(100000, '[');
  EXPECT_THAT(says("glb", glb(deep, binary)), HasSubstr("its JSON cannot be parsed"));
}

TEST(Glb, RequiredExtensionsThatMayChangeTheGeometryAreNamed) {
  const auto requiring = [](const std::string& names) {
    return glb(
        std::string(R"({"nodes":[{"mesh":0}],"extensionsRequired":[)") + names + "]," + points_json + "}",
        floats({0, 0, 0, 1, 0, 0, 0, 0, 1}));
  };
  for (const std::string name :
       {"EXT_meshopt_compression", "KHR_draco_mesh_compression", "KHR_gaussian_splatting_compression"})
    EXPECT_THAT(says("glb", requiring('"' + name + '"')), HasSubstr("it is compressed by " + name));
  for (const std::string name : {"EXT_mesh_gpu_instancing", "KHR_node_visibility", "MAXAR_mesh_variants"})
    EXPECT_THAT(says("glb", requiring(R"("KHR_mesh_quantization",")" + name + '"')),
                HasSubstr("it cannot be read without the extension " + name));
  EXPECT_THAT(says("glb", requiring("7")), HasSubstr("extensionsRequired holds what is not a name"));
  EXPECT_EQ(read_text("glb", requiring(R"("KHR_materials_unlit","KHR_texture_transform","EXT_texture_webp",
      "KHR_lights_punctual","KHR_texture_basisu","KHR_mesh_quantization")"))
                .triangles.size(),
            1u);
}

TEST(Glb, ExternalBuffersAreNotOpened) {
  const std::string json =
      R"({"nodes":[{"mesh":0}],"buffers":[{"byteLength":36,"uri":"/etc/passwd"}],
      "bufferViews":[{"buffer":0,"byteLength":36}],
      "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3}],
      "meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}]})";
  EXPECT_THAT(says("glb", glb(json, floats({0, 0, 0, 1, 0, 0, 0, 0, 1}))),
              HasSubstr("its data is in another file, and only GLB with one buffer is read"));
}

}  // namespace
}  // namespace tafoni::io
