#include "tafoni/io/format.h"

#include <cmath>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/image_file.h"
#include "tafoni/io/impl/reading.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/io/test/volumes.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/mesh/texture.h"

namespace tafoni::io {
namespace {

using testing::HasSubstr;

std::filesystem::path in_temporary_folder(const std::string& name) {
  static const TestFolder folder;
  return folder.path / name;
}

/// A bumpy sphere: closed, with every attribute, far from the CRS origin.
mesh::Mesh bumpy_sphere(int rings = 12, int around = 18) {
  mesh::Mesh mesh;
  mesh.origin = {434567.125, 5123456.7890123, -12.5};
  Random random(5);
  const auto add = [&](double theta, double phi) {
    const Vec3d n{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
    mesh.positions.push_back(to_float(n * random.uniform(9, 11)));
    mesh.normals.push_back(to_float(n));
    mesh.colors.push_back({static_cast<std::uint8_t>(random.below(256)),
                           static_cast<std::uint8_t>(random.below(256)),
                           static_cast<std::uint8_t>(random.below(256)), 255});
  };
  const auto at = [&](int r, int a) { return static_cast<std::uint32_t>(1 + r * around + a % around); };
  add(0, 0);
  for (int r = 0; r < rings; ++r)
    for (int a = 0; a < around; ++a) add((r + 1) * M_PI / (rings + 1), a * 2 * M_PI / around);
  add(M_PI, 0);
  const auto last = static_cast<std::uint32_t>(mesh.positions.size() - 1);
  for (int a = 0; a < around; ++a) {
    mesh.triangles.push_back({0, at(0, a), at(0, a + 1)});
    mesh.triangles.push_back({last, at(rings - 1, a + 1), at(rings - 1, a)});
    for (int r = 0; r + 1 < rings; ++r) {
      mesh.triangles.push_back({at(r, a), at(r + 1, a), at(r + 1, a + 1)});
      mesh.triangles.push_back({at(r, a), at(r + 1, a + 1), at(r, a + 1)});
    }
  }
  return mesh;
}

std::string bytes_of(const std::filesystem::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

mesh::Mesh read_bytes(const FormatType& format, const std::string& bytes) {
  // A heap copy of the exact size lets AddressSanitizer see any step beyond it.
  const std::vector<char> copy(bytes.begin(), bytes.end());
  mesh::Mesh mesh = format.read_mesh(std::as_bytes(std::span(copy)), "test");
  impl::check_read(mesh, "test");
  return mesh;
}

std::string error_as(const std::function<void()>& act, ErrorKind kind) {
  try {
    act();
  } catch (const Error& error) {
    EXPECT_TRUE(error.kind() == kind) << error.what();
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

class EveryMeshFormat : public testing::TestWithParam<const FormatType*> {};

std::vector<const FormatType*> writable() {
  std::vector<const FormatType*> list;
  for (const FormatType* format : all_formats())
    if (format->write_mesh && format->read_mesh) list.push_back(format);
  return list;
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryMeshFormat, testing::ValuesIn(writable()),
                         [](const auto& instance) { return instance.param->about.name; });

TEST_P(EveryMeshFormat, RoundTripKeepsGeometryToTheBit) {
  const mesh::Mesh mesh = bumpy_sphere();
  const auto path = in_temporary_folder("round." + GetParam()->extensions.front());
  write_mesh(path, mesh,
             {.name = "bumpy\nsphere", .crs = "EPSG:26910", .generator = {{"seed", std::int64_t{7}}}});
  const mesh::Mesh back = read_mesh(path);
  EXPECT_EQ(back.origin, mesh.origin);
  ASSERT_EQ(back.triangles.size(), mesh.triangles.size());
  ASSERT_EQ(back.positions.size(), mesh.positions.size());
  // STL numbers its vertices anew, so corners are compared, not indices.
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(back.positions[back.triangles[t][k]], mesh.positions[mesh.triangles[t][k]]);
  if (GetParam()->about.name == "stl") return;
  EXPECT_EQ(back.normals, mesh.normals);
  ASSERT_EQ(back.colors.size(), mesh.colors.size());
  // Only PLY rounds colours, to 8-bit sRGB; the curve's slope at white makes that at most 1.2 linear steps.
  const int tolerance = GetParam()->about.name == "ply" ? 2 : 0;
  for (std::size_t i = 0; i < mesh.colors.size(); ++i)
    for (std::size_t k = 0; k < 4; ++k) ASSERT_NEAR(back.colors[i][k], mesh.colors[i][k], tolerance) << i;
}

TEST_P(EveryMeshFormat, WritesBareGeometry) {
  mesh::Mesh mesh = bumpy_sphere();
  mesh.normals.clear();
  mesh.colors.clear();
  const auto path = in_temporary_folder("bare." + GetParam()->extensions.front());
  write_mesh(path, mesh);
  const mesh::Mesh back = read_mesh(path);
  EXPECT_EQ(back.triangles.size(), mesh.triangles.size());
  EXPECT_TRUE(back.normals.empty());
  EXPECT_TRUE(back.colors.empty());
}

TEST_P(EveryMeshFormat, TruncatedAnywhereIsRefusedOrReadsLess) {
  mesh::Mesh mesh = bumpy_sphere(2, 4);
  const auto path = in_temporary_folder("short." + GetParam()->extensions.front());
  write_mesh(path, mesh);
  const std::string bytes = bytes_of(path);
  int refused = 0;
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    try {
      EXPECT_LE(read_bytes(*GetParam(), bytes.substr(0, length)).triangles.size(), mesh.triangles.size());
    } catch (const Error& error) {
      EXPECT_TRUE(error.kind() == ErrorKind::input);
      EXPECT_THAT(error.what(), HasSubstr("test"));
      ++refused;
    }
  }
  // OBJ has no count, so a shorter file can be whole; the binary formats always know.
  EXPECT_GE(refused, GetParam()->about.name == "obj" ? 1 : std::ssize(bytes) - 1);
}

TEST_P(EveryMeshFormat, MutatedBytesNeverCrash) {
  const auto path = in_temporary_folder("mutant." + GetParam()->extensions.front());
  write_mesh(path, bumpy_sphere(2, 4));
  const std::string bytes = bytes_of(path);
  Random random(11);
  int refused = 0;
  for (int round = 0; round < 4000; ++round) {
    std::string mutant = bytes;
    for (std::uint64_t n = 1 + random.below(4); n > 0; --n) {
      // Half of the hits go to the first bytes, where the headers are.
      const std::size_t at =
          random.below(random.below(2) ? mutant.size() : std::min<std::size_t>(mutant.size(), 600));
      switch (random.below(4)) {
        case 0:
          mutant[at] = static_cast<char>(random.below(256));
          break;
        case 1:
          mutant[at] = static_cast<char>(mutant[at] ^ (1 << random.below(8)));
          break;
        case 2:
          mutant.erase(at, 1 + random.below(3));
          break;
        default:
          mutant.insert(at, 1 + random.below(3), "0-9{\xff}"[random.below(6)]);
      }
    }
    try {
      const mesh::Mesh mesh = read_bytes(*GetParam(), mutant);
      for (const auto& triangle : mesh.triangles)
        for (const std::uint32_t v : triangle) ASSERT_LT(v, mesh.positions.size());
    } catch (const Error&) {
      ++refused;
    }
  }
  EXPECT_GT(refused, 100);
}

TEST_P(EveryMeshFormat, CancelledWritingLeavesNothing) {
  struct Stopping : Progress {
    void on_advance(std::uint64_t) override { cancel(); }
  } progress;
  const auto path = in_temporary_folder("cancelled." + GetParam()->extensions.front());
  error_as([&] { write_mesh(path, bumpy_sphere(), {}, progress); }, ErrorKind::cancelled);
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(Format, DeclaresItself) {
  std::vector<std::string> seen;
  for (const FormatType* format : all_formats()) {
    EXPECT_FALSE(format->about.doc.empty());
    EXPECT_FALSE(format->about.source.empty());
    for (const std::string& extension : format->extensions) {
      EXPECT_THAT(seen, testing::Not(testing::Contains(extension)));
      seen.push_back(extension);
    }
    EXPECT_EQ(&find_format(format->about.name), format);
  }
  EXPECT_THAT(error_as([] { find_format("pyl"); }, ErrorKind::usage), HasSubstr("did you mean \"ply\"?"));
}

TEST(Format, UnknownExtensionListsTheKnownOnes) {
  const std::string text = error_as([] { format_of("a.olb", Ability::write_mesh); }, ErrorKind::usage);
  EXPECT_THAT(text, HasSubstr(".glb"));
  EXPECT_THAT(text, HasSubstr(".stl"));
  EXPECT_THAT(text, testing::Not(HasSubstr(".off")));  // read only
  EXPECT_EQ(format_of("A.GLB", Ability::read_mesh).about.name, "glb");
  EXPECT_THAT(error_as([] { format_of("noext", Ability::write_image); }, ErrorKind::usage),
              HasSubstr("no extension"));
}

TEST(Format, UnwritablePathsAndEmptyMeshesGiveOneSentence) {
  error_as([] { write_mesh("/nonexistent/folder/a.glb", bumpy_sphere()); }, ErrorKind::output);
  error_as([] { write_mesh(in_temporary_folder("empty.glb"), {}); }, ErrorKind::output);
  error_as([] { write_image("/nonexistent/folder/a.png", raster::Image(2, 2)); }, ErrorKind::output);
  error_as([] { write_image(in_temporary_folder("empty.png"), {}); }, ErrorKind::output);
  EXPECT_THAT(error_as([] { read_mesh("/nonexistent.ply"); }, ErrorKind::input), HasSubstr("nonexistent"));
  error_as([] { read_mesh(std::filesystem::temp_directory_path().string() + "/."); }, ErrorKind::usage);
  std::ofstream(in_temporary_folder("zero.ply")).close();
  EXPECT_THAT(error_as([] { read_mesh(in_temporary_folder("zero.ply")); }, ErrorKind::input),
              HasSubstr("empty"));
}

TEST(Format, FullDiskGivesOneSentenceAndLeavesNothing) {
  const mesh::Mesh mesh = bumpy_sphere(40, 60);
  const Volume volume = hollow_ball(volume::Precision::single);
  // A limit on file size fails a write as a full disk does.
  rlimit before{};
  ::getrlimit(RLIMIT_FSIZE, &before);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit tight{4096, before.rlim_max};
  for (const FormatType* format : all_formats()) {
    const std::string name = "full." + format->extensions.front();
    const auto path = in_temporary_folder(name);
    const auto expect_failure = [&](const auto& write) {
      ::setrlimit(RLIMIT_FSIZE, &tight);
      std::string text = "no error";
      try {
        write();
      } catch (const Error& error) {
        text = error.what();
        EXPECT_EQ(error.kind(), ErrorKind::output) << name;
      }
      ::setrlimit(RLIMIT_FSIZE, &before);
      EXPECT_THAT(text, HasSubstr(name));
      EXPECT_FALSE(std::filesystem::exists(path)) << name;
    };
    if (format->write_mesh) expect_failure([&] { write_mesh(path, mesh); });
    if (format->write_volume) expect_failure([&] { write_volume(path, volume); });
  }
  std::signal(SIGXFSZ, handler);
}

TEST(Glb, KhronosValidatorFindsNothing) {
  const auto path = in_temporary_folder("valid.glb");
  mesh::Mesh mesh = bumpy_sphere();
  write_mesh(path, mesh, {.name = "valid", .crs = "EPSG:26910", .generator = {{"seed", std::int64_t{7}}}});
  const auto bare = in_temporary_folder("bare_valid.glb");
  mesh.normals.clear();
  mesh.colors.clear();
  write_mesh(bare, mesh);
  const std::string command =
      fmt::format("'" TAFONI_SOURCE_DIR "/tests/gltf_validate.sh' '{}' '{}'", path.string(), bare.string());
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "gltf-validator is not installed";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST(Formats, KeepTextureCoordinatesAndSharedVertices) {
  mesh::Mesh full = bumpy_sphere();
  mesh::box_texture(full, 3);
  mesh::Mesh bare = full;
  bare.normals.clear();
  bare.colors.clear();
  for (const FormatType* format : all_formats()) {
    if (!format->write_mesh || !format->read_mesh) continue;
    for (const mesh::Mesh* mesh : {&full, &bare}) {
      const auto path = in_temporary_folder("textured." + format->extensions[0]);
      write_mesh(path, *mesh);
      const mesh::Mesh back = read_mesh(path);
      if (!format->texture) {
        EXPECT_TRUE(back.texture.empty()) << format->about.name;
        continue;
      }
      EXPECT_EQ(back.positions, mesh->positions) << format->about.name;
      EXPECT_EQ(back.triangles, mesh->triangles) << format->about.name;
      EXPECT_EQ(back.normals.size(), mesh->normals.size()) << format->about.name;
      EXPECT_EQ(back.colors, mesh->colors) << format->about.name;
      ASSERT_EQ(back.texture.size(), mesh->texture.size()) << format->about.name;
      for (std::size_t t = 0; t < back.texture.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
          ASSERT_EQ(back.texture[t][c].x, mesh->texture[t][c].x) << format->about.name;
          ASSERT_NEAR(back.texture[t][c].y, mesh->texture[t][c].y, 1e-6) << format->about.name;
        }
    }
  }
}

TEST(Obj, ReadsCornersWithAndWithoutTexture) {
  const auto read = [](const std::string& text) {
    std::ofstream(in_temporary_folder("corners.obj")) << text;
    return read_mesh(in_temporary_folder("corners.obj"));
  };
  const std::string points = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0.5 0.25\nvt 1\n";
  const mesh::Mesh quad = read(points + "f 1/1 2/2 3/1 4/2\n");
  ASSERT_EQ(quad.texture.size(), 2u);
  EXPECT_EQ(quad.texture[1][2], (Vec2<float>{1, 0}));
  EXPECT_TRUE(read(points + "f 1/1 2/2 3/1\nf 1 3 4\n").texture.empty());
  EXPECT_THAT(error_as([&] { read(points + "f 1/1 2/3 3/1\n"); }, ErrorKind::input),
              HasSubstr("index 3 is not defined here"));
}

}  // namespace
}  // namespace tafoni::io
