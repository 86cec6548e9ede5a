#include "tafoni/surface/prism_mesher.h"

#include <map>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/test/errors.h"
#include "tafoni/core/test/rounds.h"
#include "tafoni/math/counts.h"
#include "tafoni/math/draw.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/volume/prism_convert.h"
#include "tafoni/volume/test/random_tools.h"

namespace tafoni::surface {
namespace {

using testing::ElementsAre;
using testing::ElementsAreArray;
using testing::IsEmpty;
using volume::ColumnBox;
using volume::ColumnFrame;
using volume::DeadPoints;
using volume::Edit;
using volume::Matter;
using volume::PrismFields;
using volume::Tool;

PrismFields box_of_rock(const ColumnFrame& frame, float bottom, float top) {
  PrismFields fields(frame);
  const Matter all{bottom, top};
  for (int j = 0; j < frame.ny; ++j)
    for (int i = 0; i < frame.nx; ++i) fields.set_column(i, j, {&all, 1});
  return fields;
}

void expect_sound(const mesh::Mesh& mesh, const std::string& what) {
  const mesh::MeshReport report = mesh::validate(mesh);
  ASSERT_THAT(mesh::defects(report), IsEmpty()) << what;
  ASSERT_EQ(report.boundary_edges, 0u) << what;
}

TEST(PrismMesh, BoxIsABox) {
  const ColumnFrame frame{{10, 20, 30}, 0.5, 0.25, 9, 13};
  for (const DeadPoints dead : {DeadPoints::triangles, DeadPoints::quads}) {
    const mesh::Mesh mesh = polygonize(box_of_rock(frame, -1, 2), {.dead = dead});
    expect_sound(mesh, "box");
    const mesh::MeshMetrics m = mesh::metrics(mesh);
    EXPECT_NEAR(m.volume, 4.0 * 3 * 3, 1e-6);
    EXPECT_EQ(m.components, 1u);
    EXPECT_EQ(m.bounds.lo, (Vec3d{10, 20, 29}));
    EXPECT_EQ(m.bounds.hi, (Vec3d{14, 23, 32}));
    EXPECT_EQ(m.triangles, 2u * (8 * 12 * 2) + 2u * 2 * (8 + 12));
  }
}

// [Boggus fig. 6]: 3 x 3 samples, the one in the middle or at a corner dead.
TEST(PrismMesh, DeadPointsAsInFigure6) {
  const ColumnFrame frame{{}, 1, 1, 3, 3};
  const auto area_of_top = [&](int i, int j, DeadPoints dead) {
    PrismFields fields = box_of_rock(frame, 0, 1);
    fields.set_column(i, j, {});
    std::vector<PrismSurface> surfaces;
    const mesh::Mesh mesh = polygonize(fields, {.dead = dead}, &surfaces);
    if (!mesh.triangles.empty()) expect_sound(mesh, "figure 6");
    double sum = 0;
    for (std::size_t t = 0; t < surfaces.size(); ++t)
      if (surfaces[t] == PrismSurface::upper) {
        const auto& v = mesh.triangles[t];
        sum += 0.5 * static_cast<double>(cross(mesh.positions[v[1]] - mesh.positions[v[0]],
                                               mesh.positions[v[2]] - mesh.positions[v[0]])
                                             .z);
      }
    return sum;
  };
  EXPECT_DOUBLE_EQ(area_of_top(1, 1, DeadPoints::quads), 0);
  EXPECT_DOUBLE_EQ(area_of_top(1, 1, DeadPoints::triangles), 2);
  EXPECT_DOUBLE_EQ(area_of_top(2, 2, DeadPoints::quads), 3);
  EXPECT_DOUBLE_EQ(area_of_top(2, 2, DeadPoints::triangles), 3.5);
}

// Figure 5: the tunnel is a hole through the box, its sides shut, both mouths open.
TEST(PrismMesh, TunnelIsAHandle) {
  const ColumnFrame frame{{}, 1, 1, 21, 21};
  PrismFields fields = box_of_rock(frame, 0, 10);
  fields.apply(Tool::capsule({-5, 10, 5}, {30, 10.3, 5}, 2.4), Edit::remove);
  for (const DeadPoints dead : {DeadPoints::triangles, DeadPoints::quads}) {
    const mesh::Mesh mesh = polygonize(fields, {.dead = dead});
    expect_sound(mesh, "tunnel");
    const mesh::MeshMetrics m = mesh::metrics(mesh);
    EXPECT_EQ(m.components, 1u);
    EXPECT_EQ(m.genus, 1);
    // Less the tunnel's volume, as far as a cell's size can tell.
    EXPECT_NEAR(m.volume, 20 * 20 * 10 - 20 * 18.1, 60);
  }
  // A closed hollow is a surface of its own inside.
  PrismFields hollow = box_of_rock(frame, 0, 10);
  hollow.apply(Tool::sphere({10, 10, 5}, 3.2), Edit::remove);
  const mesh::MeshMetrics m = mesh::metrics(polygonize(hollow));
  EXPECT_EQ(m.components, 2u);
  EXPECT_NEAR(m.volume, 20 * 20 * 10 - 4.0 / 3 * 3.14159 * 3.2 * 3.2 * 3.2, 20);
}

TEST(PrismMesh, StaysClosedAndManifoldOverRandomTools) {
  const ColumnFrame frame{{100, -50, 20}, 0.5, 0.75, 13, 10};
  const Box3d room{{100, -50, 18}, {106, -43.25, 24}};
  Random random(21);
  std::uint64_t triangles = 0;
  PrismFields fields = box_of_rock(frame, -2, 4);
  for (int n = 0; n < rounds(2400); ++n) {
    if (n % 300 == 0) fields = box_of_rock(frame, -2, 4);
    const bool remove = random.uniform() < (n / 100 % 2 ? 0.3 : 0.7);
    fields.apply(volume::random_tool(random, room), remove ? Edit::remove : Edit::add);
    std::vector<PrismSurface> surfaces;
    const DeadPoints dead = n % 3 ? DeadPoints::triangles : DeadPoints::quads;
    const mesh::Mesh mesh = polygonize(fields, {.dead = dead}, &surfaces);
    ASSERT_EQ(surfaces.size(), mesh.triangles.size());
    if (mesh.triangles.empty()) continue;
    ASSERT_NO_FATAL_FAILURE(expect_sound(mesh, "after " + std::to_string(n)));
    ASSERT_GT(mesh::metrics(mesh).volume, 0);
    triangles += mesh.triangles.size();
  }
  EXPECT_GT(triangles, static_cast<std::uint64_t>(rounds(1000000)));
}

// Contacts that a solid on a grid makes: two towers that share a column's edge, two roofs that meet in a
// line.
TEST(PrismMesh, ContactsAreSeparated) {
  const ColumnFrame frame{{}, 1, 1, 5, 5};
  PrismFields towers(frame);
  const Matter all{0, 3};
  for (int j = 0; j < 5; ++j)
    for (int i = 0; i < 5; ++i)
      if ((i <= 2 && j <= 2) || (i >= 2 && j >= 2)) towers.set_column(i, j, {&all, 1});
  const mesh::Mesh mesh = polygonize(towers, {.dead = DeadPoints::quads});
  expect_sound(mesh, "towers");
  EXPECT_EQ(mesh::metrics(mesh).components, 2u);
  EXPECT_NEAR(mesh::metrics(mesh).volume, 24, 1e-9);
}

// Many columns of several intervals: the mesh encloses what the columns say, but for what a cell's size
// hides.
TEST(PrismMesh, VolumeIsThatOfTheColumns) {
  const ColumnFrame frame{{}, 0.25, 0.25, 121, 121};
  PrismFields fields = box_of_rock(frame, 0, 15);
  Random random(22);
  for (int n = 0; n < 60; ++n) {
    const Vec3d c = volume::random_point(random, {{0, 0, 0}, {30, 30, 15}});
    fields.apply(Tool::sphere(c, random.uniform(1, 4)), Edit::remove);
  }
  double sum = 0;
  for (int j = 0; j < 121; ++j)
    for (int i = 0; i < 121; ++i) {
      const double weight = (i % 120 ? 1 : 0.5) * (j % 120 ? 1 : 0.5) * 0.0625;
      for (const Matter& m : fields.column(i, j)) sum += weight * (m.top - m.bottom);
    }
  const mesh::Mesh mesh = polygonize(fields);
  expect_sound(mesh, "cave");
  EXPECT_NEAR(mesh::metrics(mesh).volume, sum, 0.02 * sum);
}

bool same(const PrismChunkMesh& x, const PrismChunkMesh& y) {
  return x.positions == y.positions && x.normals == y.normals && x.surfaces == y.surfaces &&
         x.triangles == y.triangles;
}

/// Those with a cell from three columns below the changed ones to two above, of wide x high chunks. A
/// column's air makes the seams of the columns around it; the cells at these change, and normals a cell
/// further.
std::vector<Vec3i> chunks_near(const ColumnBox& changed, int wide, int high) {
  std::vector<Vec3i> out;
  for (int b = 0; b < high; ++b)
    for (int a = 0; a < wide; ++a)
      if (!changed.empty() && 16 * a <= changed.i1 + 2 && 16 * a + 15 >= changed.i0 - 3 &&
          16 * b <= changed.j1 + 2 && 16 * b + 15 >= changed.j0 - 3)
        out.push_back({a, b, 0});
  return out;
}

/// Every chunk of a mesher, by its name.
std::map<std::array<int, 2>, PrismChunkMesh> copy_chunks(const PrismMesher& mesher) {
  std::map<std::array<int, 2>, PrismChunkMesh> out;
  for (int b = 0; b < mesher.chunks_y(); ++b)
    for (int a = 0; a < mesher.chunks_x(); ++a) out[{b, a}] = mesher.chunk({a, b, 0});
  return out;
}

// That is the right reach: columns so far from a chunk change it, and none farther does.
TEST(PrismMesh, ColumnsReachThreeCellsDownAndTwoUp) {
  const ColumnFrame frame{{}, 0.5, 0.5, 33, 9};
  Random random(25);
  std::map<int, int> above, below;  // by how far the chunk's next cell is from the column
  for (int round = 0; round < 1000; ++round) {
    PrismFields fields = box_of_rock(frame, 0, 10);
    for (int n = 0; n < 60; ++n) {
      const Vec3d c{random.uniform(4, 12), random.uniform(0, 4), random.uniform(0, 10)};
      const double size = random.uniform(0.3, 2);
      fields.apply(n % 2 ? Tool::sphere(c, 0.7 * size) : Tool::box(c, {size, size, 0.15 * size}),
                   random.uniform() < 0.7 ? Edit::remove : Edit::add);
    }
    PrismMesher before, after;
    before.update(fields, {});
    const int i = 11 + draw_index(random, 10);
    const float cut = draw_float(random, 1, 9);
    const std::vector<Matter> now{{0, cut}, {cut + 0.5f, 10}};
    fields.set_column(i, draw_index(random, 9), std::span(now).first(random.below(3)));
    after.update(fields, {});
    above[16 - i] += !same(before.chunk({1, 0, 0}), after.chunk({1, 0, 0}));
    below[i - 15] += !same(before.chunk({0, 0, 0}), after.chunk({0, 0, 0}));
  }
  EXPECT_GT(above[2], 0);
  EXPECT_EQ(above[3] + above[4] + above[5], 0);
  EXPECT_GT(below[3], 0);
  EXPECT_EQ(below[4] + below[5], 0);
}

TEST(PrismMesh, ChunksAreWhatAFullUpdateMakes) {
  const ColumnFrame frame{{7, 8, 9}, 0.5, 0.5, 100, 70};
  const Box3d room{{7, 8, 9}, {57, 43, 19}};
  PrismFields fields = box_of_rock(frame, 0, 10);
  PrismMesher kept;
  EXPECT_EQ(kept.update(fields, {}).size(), 7u * 5);
  Random random(23);
  std::size_t unchanged = 0;
  for (int n = 0; n < 300; ++n) {
    const ColumnBox changed =
        fields.apply(volume::random_tool(random, room), n % 3 ? Edit::remove : Edit::add);
    const auto before = copy_chunks(kept);
    const auto changes = kept.update(fields, changed);
    // It names those that differ from before, in order, and they are near.
    const std::uint64_t version = 2 + n;
    std::vector<ChunkChange> differing;
    for (const auto& [name, was] : before) {
      const Vec3i at{name[1], name[0], 0};
      if (!same(was, kept.chunk(at))) differing.push_back({at, version});
      ASSERT_EQ(kept.chunk(at).version, same(was, kept.chunk(at)) ? was.version : version) << n;
    }
    ASSERT_EQ(changes, differing) << n;
    const std::vector<Vec3i> near = chunks_near(changed, 7, 5);
    for (const ChunkChange& change : changes) EXPECT_THAT(near, ::testing::Contains(change.chunk)) << n;
    unchanged += near.size() - changes.size();
    if (n % 20) continue;
    PrismMesher fresh;
    fresh.update(fields, {});
    for (int b = 0; b < fresh.chunks_y(); ++b)
      for (int a = 0; a < fresh.chunks_x(); ++a)
        ASSERT_TRUE(same(kept.chunk({a, b, 0}), fresh.chunk({a, b, 0}))) << n << ": " << a << ", " << b;
  }

  EXPECT_GT(unchanged, 0u);

  // Together the chunks are the surface: as many triangles, and on seams the same positions and normals.
  const mesh::Mesh whole = polygonize(fields);
  std::size_t triangles = 0;
  std::map<std::array<float, 3>, Vec3f> seen[3];
  for (int b = 0; b < kept.chunks_y(); ++b)
    for (int a = 0; a < kept.chunks_x(); ++a) {
      const PrismChunkMesh& c = kept.chunk({a, b, 0});
      triangles += c.triangles.size();
      for (std::size_t v = 0; v < c.positions.size(); ++v) {
        const Vec3f p = c.positions[v];
        const auto [at, first] =
            seen[static_cast<std::size_t>(c.surfaces[v])].emplace(std::array{p.x, p.y, p.z}, c.normals[v]);
        ASSERT_EQ(at->second, c.normals[v]) << p.x << ", " << p.y << ", " << p.z;
      }
    }
  // The whole divides triangles where matter touches itself.
  EXPECT_LE(triangles, whole.triangles.size());
  EXPECT_NEAR(ratio(triangles, whole.triangles.size()), 1, 0.01);
}

// The leaf of construction trees and the mesh have the same surface.
TEST(PrismMesh, IsTheZeroSetOfTheLeaf) {
  const ColumnFrame frame{{100, -50, 20}, 0.5, 0.75, 18, 14};
  const Box3d room{{100, -50, 18}, {108.5, -40.25, 24}};
  Random random(24);
  std::size_t triangles = 0, off = 0;
  for (int round = 0; round < 15; ++round) {
    PrismFields fields = box_of_rock(frame, -2, 4);
    for (int n = 0; n < 4 * round; ++n)
      fields.apply(volume::random_tool(random, room), random.uniform() < 0.7 ? Edit::remove : Edit::add);
    const mesh::Mesh mesh = polygonize(fields);
    const field::FunctionPtr leaf = volume::as_function(fields, {.reach = 3});
    for (const auto& t : mesh.triangles) {
      Vec3d p = mesh.origin;
      for (auto v : t) p += to_double(mesh.positions[v]) * (1.0 / 3);
      float value;
      leaf->values({&p, 1}, {&value, 1});
      ++triangles;
      off += std::abs(value) > 1e-3f;
    }
  }
  // Walls that matter covers from both sides are in the mesh alone.
  EXPECT_LT(ratio(off, triangles), 0.01);
}

// Sheets hold as long as they are thicker than spacing * sin(slope), and no longer.
TEST(PrismMesh, SteepSheetsHoldDownToTheirDrop) {
  const ColumnFrame frame{{}, 0.5, 0.5, 20, 10};
  for (const float drop : {0.2f, 1.0f, 3.0f})
    for (const float share : {0.9f, 1.1f}) {
      PrismFields fields(frame);
      for (int j = 0; j < frame.ny; ++j)
        for (int i = 0; i < frame.nx; ++i) {
          const float bottom = drop * static_cast<float>(i);
          const Matter sheet{bottom, bottom + share * drop};
          fields.set_column(i, j, {&sheet, 1});
        }
      const mesh::Mesh mesh = polygonize(fields);
      if (share < 1) {
        EXPECT_TRUE(mesh.triangles.empty()) << drop;
        continue;
      }
      expect_sound(mesh, "sheet");
      EXPECT_EQ(mesh::metrics(mesh).components, 1u);
      EXPECT_NEAR(mesh::metrics(mesh).volume, 9.5 * 4.5 * (share * drop), 1e-3) << drop;
    }
}

TEST(PrismMesh, ColoursByKindOfSurface) {
  PrismMeshSettings settings;
  settings.colors = {{{255, 0, 0, 255}, {0, 255, 0, 255}, {0, 0, 255, 255}}};
  const mesh::Mesh mesh = polygonize(box_of_rock({{}, 1, 1, 5, 5}, 0, 1), settings);
  ASSERT_EQ(mesh.colors.size(), mesh.positions.size());
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    const Vec3f p = mesh.positions[v];
    if (p.x > 0 && p.x < 4 && p.y > 0 && p.y < 4) {
      EXPECT_THAT(mesh.colors[v], p.z > 0 ? ElementsAre(255, 0, 0, 255) : ElementsAre(0, 255, 0, 255));
      EXPECT_EQ(mesh.normals[v], (Vec3f{0, 0, p.z > 0 ? 1.0f : -1.0f}));
    } else {
      EXPECT_GT(mesh.colors[v][2], 0);
    }
  }
}

TEST(PrismMesh, NamesTheChunksWithTrianglesAndShowsNoneBeyond) {
  const ColumnFrame frame{{}, 1, 1, 40, 20};
  PrismFields fields(frame);
  PrismMesher mesher;
  EXPECT_THAT(mesher.chunk({0, 0, 0}).triangles, ::testing::IsEmpty());  // before the first update, too
  EXPECT_TRUE(mesher.update(fields, {}).empty());
  const ColumnBox changed = fields.apply(Tool::sphere({36, 4, 0}, 2), Edit::add);
  EXPECT_THAT(mesher.update(fields, changed), ElementsAre(ChunkChange{{2, 0, 0}, 2}));
  EXPECT_THAT(mesher.chunks(), ElementsAre(Vec3i{2, 0, 0}));
  EXPECT_FALSE(mesher.chunk({2, 0, 0}).triangles.empty());
  for (const Vec3i at : {Vec3i{3, 0, 0}, Vec3i{0, 2, 0}, Vec3i{-1, 0, 0}, Vec3i{2, 0, 1}})
    EXPECT_TRUE(mesher.chunk(at).triangles.empty());
  // One that loses its last triangle is named once more.
  const ColumnBox gone = fields.apply(Tool::sphere({36, 4, 0}, 9), Edit::remove);
  EXPECT_THAT(mesher.update(fields, gone), ElementsAre(ChunkChange{{2, 0, 0}, 3}));
  EXPECT_THAT(mesher.chunks(), ElementsAre());
}

TEST(PrismMesh, RefusesAnotherFrame) {
  PrismMesher mesher;
  mesher.update(box_of_rock({{}, 1, 1, 5, 5}, 0, 1), {});
  EXPECT_THAT(error_of([&] {
                mesher.update(box_of_rock({{}, 1, 1, 6, 5}, 0, 1), {});
              }),
              ::testing::HasSubstr("another frame than before; use a new one"));
}

}  // namespace
}  // namespace tafoni::surface
