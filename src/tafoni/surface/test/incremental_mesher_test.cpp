// After any sequence of edits the mesh is the one that polygonize() makes, byte for byte.

#include "tafoni/surface/incremental_mesher.h"

#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <tuple>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/core/test/errors.h"
#include "tafoni/field/chunks.h"

namespace tafoni::surface {
namespace {

template <class T>
bool equal_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

bool same_mesh(const mesh::Mesh& a, const mesh::Mesh& b) {
  return equal_bytes(a.positions, b.positions) && equal_bytes(a.normals, b.normals) &&
         equal_bytes(a.triangles, b.triangles);
}

field::NodePtr hills() {
  auto heights = std::make_shared<raster::Raster>();
  heights->values = raster::Grid<float>(24, 24);
  heights->placement = {-60, 60, 5, 5};
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      heights->values.at(x, y) = static_cast<float>(6 * std::sin(0.5 * x) * std::cos(0.4 * y));
  return field::heightfield(heights, {9, 5, true, true});
}

/// Hills that are eroded, warped and set with copies of a rock, each in a part of them.
field::NodePtr rough_hills() {
  Random random(3);
  const auto spots = [&](double energy) {
    field::CloudBuilder cloud({"sphere", 8, {}});
    for (int i = 0; i < 6; ++i)
      field::add_point(cloud, {random.uniform(-40, 40), random.uniform(-40, 40), 0}, 6, energy);
    return field::as_function(cloud.finish());
  };
  const field::NodePtr eroded = field::erode(hills(), spots(1), spots(0.7), 3);
  const field::NodePtr warped = field::warp(eroded, spots(1), {{1.5, 1.5, 1}, 9, 7, 2, 5});
  field::CloudBuilder rock({"box", 1, {}});
  rock.add({0, 0, 0}, 9, std::vector<float>{0.3f, 2, 1, 2, 20});
  std::vector<field::Placement> places;
  for (int i = 0; i < 12; ++i)
    places.push_back({{random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-4, 4)},
                      random.uniform(0, 6),
                      random.uniform(0, 1),
                      random.uniform(0.5, 1.5)});
  return field::blend({warped, field::instances(rock.finish(), places)});
}

struct Cloud {
  field::NodePtr node;
  Box3d support;
};

/// A few primitives near one spot, of a kind chosen at random.
Cloud some_cloud(Random& random) {
  const bool noisy = random.below(3) == 0, balls = random.below(2) == 0;
  const Vec3d at{random.uniform(-40, 40), random.uniform(-40, 40), random.uniform(-8, 8)};
  field::CloudBuilder cloud({balls ? "sphere" : "point", 2, {noisy ? 0.7 : 0.0, 2, 2, random.below(100)}});
  Cloud out;
  const auto count = 1 + random.below(4);
  for (std::uint64_t i = 0; i < count; ++i) {
    const Vec3d p = at + Vec3d{random.uniform(-4, 4), random.uniform(-4, 4), random.uniform(-4, 4)};
    const double radius = random.uniform(1, 5);
    field::add_point(cloud, p, radius, random.uniform(-9, 7));
    out.support.expand(Box3d{p, p}.grown(radius + 2 + 0.7 + 0.1));
  }
  out.node = cloud.finish();
  return out;
}

/// A scene that is edited at random.
class Edited {
 public:
  explicit Edited(std::uint64_t seed, field::NodePtr ground = hills())
      : random_(seed), ground_(std::move(ground)) {
    for (int i = 0; i < 5; ++i) clouds_.push_back(some_cloud(random_));
  }

  field::CompiledField field() const {
    std::vector<field::NodePtr> parts{ground_};
    for (const Cloud& c : clouds_) parts.push_back(c.node);
    field::NodePtr tree = field::blend(parts);
    if (cut_) tree = field::combine(cut_ == 1 ? "difference" : "union", {tree, tool_.node});
    if (prism_) tree = field::intersect({tree, prism_});
    return field::compile(tree);
  }
  void close() { prism_ = field::domain({{{-50, -50, -20}, {50, 50, 0}}, nullptr}, {9, 5, true, true}); }

  /// Changes something; the boxes outside of which nothing has changed.
  std::vector<Box3d> edit() {
    const auto what = random_.below(10);
    if (what < 4 || clouds_.empty()) {
      clouds_.push_back(some_cloud(random_));
      return {clouds_.back().support};
    }
    if (what < 6) {
      const std::ptrdiff_t at = random_.below(clouds_.size());
      const Box3d box = clouds_[at].support;
      clouds_.erase(clouds_.begin() + at);
      return {box};
    }
    if (what < 8) {
      // Two at once, far from one another perhaps.
      const auto at = random_.below(clouds_.size());
      const Box3d old = clouds_[at].support;
      clouds_[at] = some_cloud(random_);
      return {old, clouds_[at].support};
    }
    // Another operator over a ball that stands alone, in air below anything that the clouds sum up to.
    const Box3d old = cut_ ? tool_.support : Box3d{};
    cut_ = (cut_ + 1) % 3;
    if (cut_ == 0) return {old};
    const Vec3d at{random_.uniform(-40, 40), random_.uniform(-40, 40), random_.uniform(-8, 8)};
    field::CloudBuilder ball({"sphere", 3, {}});
    field::add_point(ball, at, 3, 206);
    tool_ = {field::blend({field::constant(-200.f), ball.finish()}), Box3d{at, at}.grown(6.1)};
    return {old, tool_.support};
  }

 private:
  Random random_;
  field::NodePtr ground_, prism_;
  std::vector<Cloud> clouds_;
  int cut_ = 0;  ///< 0 none, 1 difference, 2 union
  Cloud tool_;
};

bool touches(Vec3i chunk, const Box3d& box, double voxel) {
  const double side = field::chunk_cells * voxel;
  const Vec3d lo{chunk.x * side, chunk.y * side, chunk.z * side};
  const Box3d grown = box.grown(1.02 * voxel);
  return grown.lo.x <= lo.x + side && grown.hi.x >= lo.x && grown.lo.y <= lo.y + side && grown.hi.y >= lo.y &&
         grown.lo.z <= lo.z + side && grown.hi.z >= lo.z;
}

void compare(const PolygonizeSettings& settings, Edited scene, int edits) {
  IncrementalMesher mesher(settings);
  mesher.update(scene.field(), {});
  ASSERT_TRUE(same_mesh(mesher.assemble(), polygonize(scene.field(), settings)));
  EXPECT_GT(mesher.chunks().size(), 3u);
  std::uint64_t partial = 0;
  for (int i = 0; i < edits; ++i) {
    const auto boxes = scene.edit();
    const field::CompiledField field = scene.field();
    const auto before = mesher.chunks();
    const auto changes = mesher.update(field, boxes);
    ASSERT_TRUE(same_mesh(mesher.assemble(), polygonize(field, settings))) << "edit " << i;
    const bool all = mesher.stats().chunks >= before.size();
    partial += !all;
    for (const auto& change : changes) {
      EXPECT_EQ(change.version, i + 2u);
      const bool near = std::any_of(boxes.begin(), boxes.end(),
                                    [&](const Box3d& b) { return touches(change.chunk, b, settings.voxel); });
      EXPECT_TRUE(near || all);
    }
  }
  // Only an edit that moves the bounds of the field may look at everything.
  EXPECT_GE(partial, edits * 7u / 10);
}

TEST(Incremental, EqualsMeshingAnewInAnOpenRegion) {
  PolygonizeSettings settings;
  settings.voxel = 0.45;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -37, -60}, {43, 45, 60}};
  settings.inside = [](double x, double y) { return x + y < 60; };
  compare(settings, Edited(1), 100);
}

TEST(Incremental, EqualsMeshingAnewWithFragmentsRemoved) {
  PolygonizeSettings settings;
  settings.voxel = 0.4;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  settings.min_fragment_volume = 300;
  compare(settings, Edited(2), 50);
}

TEST(Incremental, EqualsMeshingAnewOfAClosedSolidWithoutRegion) {
  PolygonizeSettings settings;
  settings.voxel = 0.5;
  settings.min_fragment_volume = 20;
  Edited scene(3);
  scene.close();
  compare(settings, std::move(scene), 40);
}

TEST(Incremental, ARegionMayCutTheSurface) {
  PolygonizeSettings settings;
  settings.voxel = 0.3;
  settings.boundary = Boundary::open;
  settings.region = {{-20, -22, -2}, {21, 20, 3}};
  compare(settings, Edited(4), 40);
}

TEST(Incremental, FollowsEditsOverErosionWarpAndInstances) {
  PolygonizeSettings settings;
  settings.voxel = 0.5;
  settings.boundary = Boundary::open;
  settings.region = {{-30, -30, -60}, {30, 30, 60}};
  compare(settings, Edited(6, rough_hills()), 8);
}

TEST(Incremental, ThreadsDoNotMatter) {
  PolygonizeSettings settings;
  settings.voxel = 0.4;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  const int threads = thread_count();
  std::vector<mesh::Mesh> last;
  std::vector<std::vector<Vec3i>> changed;
  for (int count : {1, 2, 5}) {
    set_thread_count(count);
    Edited scene(9);
    IncrementalMesher mesher(settings);
    mesher.update(scene.field(), {});
    changed.emplace_back();
    for (int i = 0; i < 12; ++i) {
      const auto boxes = scene.edit();
      for (const auto& change : mesher.update(scene.field(), boxes)) changed.back().push_back(change.chunk);
    }
    last.push_back(mesher.assemble());
  }
  set_thread_count(threads);
  for (std::size_t i = 1; i < last.size(); ++i) {
    EXPECT_TRUE(same_mesh(last[0], last[i]));
    EXPECT_EQ(changed[0], changed[i]);
  }
}

TEST(Incremental, LooksAtTouchedBricksOnly) {
  PolygonizeSettings settings;
  settings.voxel = 0.2;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  const field::NodePtr ground = hills();
  IncrementalMesher mesher(settings);
  mesher.update(field::compile(ground), {});
  const auto whole = mesher.stats();
  field::CloudBuilder cloud(field::CloudSettings{});
  field::add_point(cloud, {10.1, 7.3, 0}, 2, -7);
  const field::NodePtr dab = cloud.finish();
  const Box3d box = Box3d{{10.1, 7.3, 0}, {10.1, 7.3, 0}}.grown(2.01);
  const auto changes = mesher.update(field::compile(field::blend({ground, dab})), {&box, 1});
  EXPECT_GE(changes.size(), 1u);
  EXPECT_LE(mesher.stats().chunks, 8u);
  // A ball of 10 cells' radius cuts some 700 cells of a million.
  EXPECT_LT(mesher.stats().evaluated, whole.evaluated / 100);
  EXPECT_LT(mesher.stats().vertices, whole.vertices / 50);
  EXPECT_GT(mesher.stats().vertices, 300u);
  // Nothing changes where the field does not, however large the box.
  const Box3d wide{{-30, -30, -30}, {30, 30, 30}};
  EXPECT_TRUE(mesher.update(field::compile(field::blend({ground, dab})), {&wide, 1}).empty());
}

TEST(Incremental, AChunkIsAMeshOfItsOwn) {
  PolygonizeSettings settings;
  settings.voxel = 0.4;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  IncrementalMesher mesher(settings);
  EXPECT_TRUE(mesher.chunks().empty());
  EXPECT_TRUE(mesher.chunk({0, 0, 0}).triangles.empty());
  EXPECT_THAT(error_of([&] { mesher.assemble(); }),
              ::testing::HasSubstr("cannot be assembled before an update()"));
  mesher.update(field::compile(hills()), {});
  std::size_t triangles = 0;
  for (Vec3i at : mesher.chunks()) {
    const ChunkView mesh = mesher.chunk(at);
    EXPECT_EQ(mesh.version, 1u);
    EXPECT_EQ(mesh.normals.size(), mesh.positions.size());
    const double side = settings.voxel * field::chunk_cells;
    const Vec3d lo{at.x * side, at.y * side, at.z * side};
    const Box3d box = Box3d{lo, lo + Vec3d{side, side, side}}.grown(1e-4);
    for (Vec3f p : mesh.positions) EXPECT_TRUE(box.contains(to_double(p)));
    for (const auto& t : mesh.triangles)
      for (auto v : t) EXPECT_LT(v, mesh.positions.size());
    triangles += mesh.triangles.size();
  }
  EXPECT_EQ(triangles, mesher.assemble().triangles.size());
}

TEST(Incremental, AChunkHasTheNormalsOfTheWholeInside) {
  PolygonizeSettings settings;
  settings.voxel = 0.7;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  // Facets agree with the field on hills, and do not at the rim of a ball that is cut out of them.
  field::CloudBuilder ball({"sphere", 3, {}});
  const Vec3d at{0, 0, 0};
  field::add_point(ball, at, 9, 206);
  IncrementalMesher mesher(settings);
  mesher.update(field::compile(hills()), {});
  const Box3d box = Box3d{at, at}.grown(18);
  const field::CompiledField cut = field::compile(
      field::combine("difference", {hills(), field::blend({field::constant(-200.f), ball.finish()})}));
  mesher.update(cut, {&box, 1});
  std::map<std::tuple<float, float, float>, Vec3f> whole;
  const mesh::Mesh all = mesher.assemble();
  for (std::size_t v = 0; v < all.positions.size(); ++v)
    whole[{all.positions[v].x, all.positions[v].y, all.positions[v].z}] = all.normals[v];
  int changed = 0;
  for (Vec3i chunk : mesher.chunks()) {
    const ChunkView mesh = mesher.chunk(chunk);
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      const Vec3f p = mesh.positions[v];
      const auto on_border = [&](double x) {
        return std::abs(std::remainder(x, settings.voxel * field::chunk_cells)) < 1e-4;
      };
      if (on_border(p.x) || on_border(p.y) || on_border(p.z)) continue;
      EXPECT_EQ(mesh.normals[v], whole.at({p.x, p.y, p.z}));
      const Vec3d at = to_double(p);
      float value = 0;
      Vec3f gradient;
      cut.gradients({&at, 1}, {&value, 1}, {&gradient, 1});
      changed += dot(mesh.normals[v], normalized(gradient)) > -0.98f;
    }
  }
  EXPECT_GT(changed, 20);
}

TEST(Incremental, AfterACancelTheNextUpdateLooksAtEverything) {
  PolygonizeSettings settings;
  settings.voxel = 0.4;
  settings.boundary = Boundary::open;
  settings.region = {{-45, -45, -60}, {45, 45, 60}};
  Edited scene(5);
  IncrementalMesher mesher(settings);
  mesher.update(scene.field(), {});
  const auto boxes = scene.edit();
  Progress cancelled;
  cancelled.cancel();
  EXPECT_THAT(error_of([&] { mesher.update(scene.field(), boxes, cancelled); }),
              ::testing::HasSubstr("cancelled"));
  mesher.update(scene.field(), {});
  EXPECT_TRUE(same_mesh(mesher.assemble(), polygonize(scene.field(), settings)));
}

}  // namespace
}  // namespace tafoni::surface
