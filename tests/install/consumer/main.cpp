// A program of a stranger, built against what is installed: a hollow ball of rock, made by hand, is asked,
// met by rays, written as a mesh and dug open. What it checks against is worked out on paper.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tafoni/core/error.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/mesh/metrics.h"
#include "tafoni/query/field_collider.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/surface/polygonize.h"
#include "tafoni/volume/sample.h"
#include "tafoni/volume/tool.h"

using namespace tafoni;

namespace {

int failures = 0;

void expect_near(const char* what, double value, double expected, double tolerance) {
  const bool good = std::abs(value - expected) <= tolerance;
  std::printf("%s: %g, expected %g%s\n", what, value, expected, good ? "" : "  <- wrong");
  if (!good) ++failures;
}

void expect(const char* what, bool good) {
  expect_near(what, good ? 1 : 0, 1, 0);
}

/// -1 in the air and `energy` more at the middle, from which a primitive falls off as (1 - (r / radius)^2)^3.
struct Ball {
  double radius, energy;

  field::NodePtr node() const {
    field::CloudBuilder cloud({});
    field::add_point(cloud, {0, 0, 0}, radius, energy);
    return field::blend({field::constant(-1), cloud.finish()});
  }
  double value(double r) const { return energy * std::pow(1 - r * r / (radius * radius), 3) - 1; }
  double slope(double r) const {
    return -6 * energy * r / (radius * radius) * std::pow(1 - r * r / (radius * radius), 2);
  }
  double surface() const { return radius * std::sqrt(1 - std::cbrt(1 / energy)); }  // where the value is 0
};

constexpr Ball ball{10, 4}, hole{5, 3};
constexpr double voxel = 0.25;

field::CompiledField hollow_ball() {
  return field::compile(field::subtract(ball.node(), hole.node()));
}

void ask(const field::CompiledField& rock) {
  expect_near("value in the hollow", rock.value({0, 0, 0}), -hole.value(0), 1e-6);
  expect_near("value in the rock", rock.value({0, 4, 0}), std::min(ball.value(4), -hole.value(4)), 1e-5);
  expect_near("value far away", rock.value({20, 0, 0}), -1, 0);
  const Vec3d at{6, 0, 0};
  float value = 0;
  Vec3f gradient;
  rock.gradients({&at, 1}, {&value, 1}, {&gradient, 1});
  expect_near("gradient", gradient.x, ball.slope(6), 1e-5);
  expect_near("gradient, sideways", std::hypot(gradient.y, gradient.z), 0, 1e-6);
}

void shoot(const field::CompiledField& rock) {
  const query::FieldCollider collider(rock, {.voxel = voxel});
  const auto outer = collider.ray({20, 0.1, 0.1}, {-1, 0, 0}, 100);
  expect_near("ray from outside", outer ? outer->point.x : 0, ball.surface(), 0.02);
  const auto inner = collider.ray({0.1, 0.1, 0}, {0, 0, 1}, 100);
  expect_near("ray from the hollow", inner ? inner->point.z : 0, hole.surface(), 0.02);
  expect("a ray beside it meets nothing", !collider.ray({20, 8, 0}, {-1, 0, 0}, 100));
}

void write(const field::CompiledField& rock) {
  const mesh::Mesh made = surface::polygonize(rock, {.voxel = voxel});
  const double outside = ball.surface(), inside = hole.surface();
  const double volume = 4 * M_PI / 3 * (std::pow(outside, 3) - std::pow(inside, 3));
  const auto measured = mesh::metrics(made);
  expect_near("volume of the mesh", measured.volume, volume, 0.005 * volume);
  expect_near("its surfaces", double(measured.components), 2, 0);
  for (const char* name : {"ball.glb", "ball.ply", "ball.obj"}) {
    io::write_mesh(name, made, {.name = "ball"});
    expect(name, io::read_mesh(name).triangles.size() == made.triangles.size());
  }
  try {
    io::write_mesh("ball.xyz", made);
    expect("an unknown extension is refused", false);
  } catch (const Error& error) {
    expect("an unknown extension is refused", error.kind() == ErrorKind::usage);
  }
}

void dig(const field::CompiledField& rock) {
  runtime::DestructibleTerrain ground(volume::sample(rock, volume::frame_over(rock.bounds(), voxel)));
  const Vec3d from{0, 0, 20}, down{0, 0, -1};
  const auto before = ground.snapshot()->ray(from, down, 100);
  expect_near("the ground before", before ? before->point.z : 0, ball.surface(), 0.02);
  const std::uint64_t version = ground.apply(volume::Tool::capsule({0, 0, 3}, {0, 0, 9}, 1),
                                             volume::Edit::remove);  // a shaft into the hollow
  const auto after = ground.snapshot()->ray(from, down, 100);
  expect_near("the ground after", after ? after->point.z : 0, -hole.surface(), 0.02);
  expect("there was rock", rock.value({0, 0, 4}) > 0);
  expect("there is none now", !ground.snapshot()->solid({0, 0, 4}));
  expect("chunks changed", !ground.changes_since(version - 1).chunks.empty());
  expect_near("the shaft makes one surface of two", double(mesh::metrics(ground.mesh()).components), 1, 0);
}

}  // namespace

int main() try {
  const field::CompiledField rock = hollow_ball();
  ask(rock);
  shoot(rock);
  write(rock);
  dig(rock);
  return failures;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
