#include "tafoni/surface/sample_source.h"

#include <atomic>
#include <cstring>

#include <gmock/gmock.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/each_point.h"
#include "tafoni/field/function.h"
#include "tafoni/field/tree.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/mesh/validate.h"
#include "tafoni/raster/sampled.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface {
namespace {

using testing::IsEmpty;

/// Hills of 320 m by 320 m, riddled by spheres near their surface.
struct Hills {
  Hills() {
    heights = std::make_shared<raster::Raster>(
        raster::sampled(64, 64, {.west = -160, .north = 160, .dx = 5, .dy = 5}, height));
    field::CloudBuilder cloud{field::CloudSettings{}};
    Random random(3);
    for (int i = 0; i < 1500; ++i) {
      const double x = random.uniform(-150, 150), y = random.uniform(-150, 150);
      field::add_point(cloud, {x, y, height(x, y) - random.uniform(0, 12)}, random.uniform(5, 9), -9);
    }
    spheres = cloud.finish();
  }
  static double height(double x, double y) { return 15 * std::sin(x * 0.03) * std::cos(y * 0.04); }

  field::CompiledField open() const {
    return field::compile(field::blend({field::heightfield(heights, {}), spheres}));
  }
  field::CompiledField solid() const {
    const field::NodePtr ground =
        field::intersect({field::heightfield(heights, {}),
                          field::domain({.box = {{-155, -155, -50}, {155, 155, 0}}, .inside = {}}, {})});
    return field::compile(field::blend({ground, spheres}));
  }

  std::shared_ptr<raster::Raster> heights;
  field::NodePtr spheres;
};

bool same(const mesh::Mesh& a, const mesh::Mesh& b) {
  return a.positions == b.positions && a.normals == b.normals && a.triangles == b.triangles;
}

TEST(FieldSource, SolidTerrainIsClosedAtAnyThreadsAndTiles) {
  const field::CompiledField field = Hills().solid();
  PolygonizeSettings settings;
  settings.voxel = 1.3;
  settings.min_fragment_volume = 20;
  set_thread_count(1);
  PolygonizeStats stats;
  const mesh::Mesh one = polygonize(field, settings, silent(), &stats);
  EXPECT_THAT(mesh::defects(mesh::validate(one)), IsEmpty());
  EXPECT_TRUE(mesh::validate(one).closed());
  EXPECT_GT(stats.fragments_removed + stats.bubbles_removed, 0u);
  EXPECT_EQ(stats.triangles, one.triangles.size());
  const mesh::MeshMetrics m = mesh::metrics(one);
  EXPECT_GT(m.genus, 0);
  EXPECT_NEAR(m.volume, 310.0 * 310 * 50, 0.1 * m.volume);
  EXPECT_LE(mesh::validate(one).flipped_normals, one.triangles.size() / 10000);
  set_thread_count(2);
  settings.tiles_x = settings.tiles_y = 4;
  EXPECT_TRUE(same(one, polygonize(field, settings)));
  set_thread_count(0);
}

TEST(FieldSource, OpenTerrainEndsAtItsRegion) {
  const field::CompiledField field = Hills().open();
  PolygonizeSettings settings;
  settings.voxel = 1.0;
  settings.boundary = Boundary::open;
  settings.region = {{-140, -140, -100}, {140, 140, 100}};
  settings.inside = [](double x, double y) { return std::hypot(x, y) < 130; };
  settings.tiles_x = settings.tiles_y = 3;
  const mesh::Mesh whole = polygonize(field, settings);
  EXPECT_THAT(mesh::defects(mesh::validate(whole)), IsEmpty());
  EXPECT_GT(mesh::validate(whole).boundary_edges, 700u);
  std::size_t triangles = 0;
  double area = 0;
  polygonize_tiles(field, settings, [&](TileIndex, mesh::Mesh&& tile) {
    EXPECT_THAT(mesh::defects(mesh::validate(tile)), IsEmpty());
    triangles += tile.triangles.size();
    area += mesh::metrics(tile).area;
  });
  EXPECT_EQ(triangles, whole.triangles.size());
  EXPECT_NEAR(area, mesh::metrics(whole).area, 1e-6 * area);
}

TEST(FieldSource, VerticesLieOnTheSurface) {
  const Hills hills;
  const field::CompiledField field = hills.open();
  PolygonizeSettings settings;
  settings.voxel = 0.5;
  settings.boundary = Boundary::open;
  settings.region = {{-40, -40, -100}, {40, 40, 100}};
  const mesh::Mesh mesh = polygonize(field, settings);
  std::vector<Vec3d> points;
  for (const Vec3f& p : mesh.positions) points.push_back(to_double(p));
  std::vector<float> values(points.size());
  std::vector<Vec3f> gradients(points.size());
  field.gradients(points, values, gradients);
  std::size_t far = 0, turned = 0;
  for (std::size_t v = 0; v < points.size(); ++v) {
    far += std::abs(values[v]) > 0.1f * length(gradients[v]);
    turned += length(gradients[v]) > 0.1f && dot(normalized(gradients[v]), mesh.normals[v]) > -0.98f;
  }
  EXPECT_LT(far, points.size() / 200);
  // Along creases normals agree with the triangles instead.
  EXPECT_LT(turned, points.size() / 500);
}

/// A ball of rock of radius 8 m, 700 m above the hills.
class HighBall final : public field::Function {
 public:
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [](Vec3d p) { return 8 - length(p - center); });
  }
  Interval range(const Box3d& box) const override {
    const double reach = length(box.size()) / 2, middle = 8 - length(box.center() - center);
    return {static_cast<float>(middle - reach) - 0.1f, static_cast<float>(middle + reach) + 0.1f};
  }
  static constexpr Vec3d center{10, 20, 700};
};

TEST(FieldSource, RockHighAboveAnOpenTerrainIsMeshed) {
  const Hills hills;
  const field::CompiledField field = field::compile(
      field::unite({field::heightfield(hills.heights, {}), field::function(std::make_shared<HighBall>())}));
  PolygonizeSettings settings;
  settings.boundary = Boundary::open;
  settings.region = {{-155, -155, -50}, {155, 155, 800}};
  const mesh::MeshMetrics m = mesh::metrics(polygonize(field, settings));
  EXPECT_EQ(m.components, 2u);
  EXPECT_NEAR(m.bounds.hi.z, HighBall::center.z + 8, 0.5);
  // The region ends where it says.
  settings.region.hi.z = 100;
  EXPECT_EQ(mesh::metrics(polygonize(field, settings)).components, 1u);
}

/// A ball that fills a chunk with bricks to look at, and cancels when it is first asked.
class Cancelling final : public field::Function {
 public:
  explicit Cancelling(Progress& progress) : progress_(progress) {}
  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    asked += points.size();
    progress_.cancel();
    field::each_point(points, out, [](Vec3d p) { return 8 - length(p); });
  }
  Interval range(const Box3d&) const override { return {-100, 100}; }
  mutable std::atomic<std::size_t> asked = 0;

 private:
  Progress& progress_;
};

TEST(FieldSource, CancellingEndsAChunkThatIsUnderWay) {
  Progress progress;
  const auto slow = std::make_shared<Cancelling>(progress);
  const field::CompiledField field = field::compile(field::function(slow));
  PolygonizeSettings settings;
  settings.region = {{-10, -10, -10}, {10, 10, 10}};
  EXPECT_THAT(error_of([&] { polygonize(field, settings, progress); }), ::testing::HasSubstr("cancelled"));
  // A brick for each thread, of 512 in a chunk.
  EXPECT_LE(slow->asked, std::size_t{2 * 729} * thread_count());
  EXPECT_GT(slow->asked, 0u);
}

}  // namespace
}  // namespace tafoni::surface
