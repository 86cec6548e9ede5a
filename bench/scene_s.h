#pragma once
// Scene S(N), which several benchmarks measure: 512 x 512 heights at 10 m made of eight octaves of sines, and
// N point primitives that carve tunnels of 20 points near the surface.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <memory>
#include <numbers>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/field/tree.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::bench {

inline constexpr int pixels = 512;
inline constexpr double pixel = 10, extent = pixels * pixel;
inline constexpr double influence = 15, amplitude = 7.5;
inline constexpr int points_a_tunnel = 20;
inline constexpr double step = 8;

inline double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

inline double elevation(double x, double y) {
  double h = 0;
  for (int k = 0; k < 8; ++k) {
    const double turn = 0.7 * k, w = 2 * std::numbers::pi * std::exp2(k) / extent;
    const double u = x * std::cos(turn) - y * std::sin(turn), v = x * std::sin(turn) + y * std::cos(turn);
    h += 250 * std::exp2(-k) * std::sin(w * u + 1.3 * k) * std::sin(w * v + 2.1 * k);
  }
  return h;
}

struct Sphere {
  Vec3d center;
  double radius, energy;
};

inline std::vector<Sphere> tunnels(int count) {
  std::vector<Sphere> spheres;
  spheres.reserve(static_cast<std::size_t>(count));
  Random random(7);
  while (static_cast<int>(spheres.size()) < count) {
    double x = random.uniform(40, extent - 40), y = random.uniform(40, extent - 40);
    double depth = 0, heading = random.uniform(0, 2 * std::numbers::pi);
    Vec3d p{x, y, elevation(x, y)};
    for (int i = 0; i < points_a_tunnel && static_cast<int>(spheres.size()) < count; ++i) {
      spheres.push_back({p, random.uniform(5, 6), random.uniform(-8, -7)});
      heading += random.uniform(-0.6, 0.6);
      depth = std::min(20.0, std::max(0.0, depth + random.uniform(-2, 3)));
      x = p.x + step * std::cos(heading);
      y = p.y + step * std::sin(heading);
      p += normalized(Vec3d{x, y, elevation(x, y) - depth} - p) * step;
    }
  }
  return spheres;
}

struct Ground {
  std::shared_ptr<raster::Raster> heights;
  Box3d region;
};

inline Ground make_ground() {
  Ground ground{std::make_shared<raster::Raster>(), {{0, 0, 1e9}, {extent, extent, -1e9}}};
  ground.heights->values = raster::Grid<float>(pixels, pixels);
  ground.heights->placement = {.west = 0, .north = extent, .dx = pixel, .dy = pixel};
  for (int row = 0; row < pixels; ++row)
    for (int col = 0; col < pixels; ++col) {
      const Vec2d c = ground.heights->placement.center(col, row);
      const float h = ground.heights->values.at(col, row) = static_cast<float>(elevation(c.x, c.y));
      ground.region.lo.z = std::min(ground.region.lo.z, h - 60.0);
      ground.region.hi.z = std::max(ground.region.hi.z, h + 60.0);
    }
  return ground;
}

inline std::uint64_t hash(const void* data, std::size_t bytes, std::uint64_t h = 0xcbf29ce484222325u) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (std::size_t i = 0; i < bytes; ++i) h = (h ^ p[i]) * 0x100000001b3u;
  return h;
}

inline std::uint64_t hash_of(const mesh::Mesh& mesh) {
  std::uint64_t h = hash(mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  h = hash(mesh.normals.data(), mesh.normals.size() * sizeof(Vec3f), h);
  return hash(mesh.triangles.data(), mesh.triangles.size() * sizeof(mesh.triangles[0]), h);
}

/// [Paris19]'s terrain: bilinear heights and vertical distance; else bicubic heights and first-order
/// distance.
inline field::NodePtr ground_node(const Ground& ground, bool paper) {
  return field::heightfield(
      ground.heights,
      {.influence = influence, .amplitude = amplitude, .bicubic = !paper, .first_order = !paper});
}

inline field::NodePtr cloud_of(const std::vector<Sphere>& spheres) {
  field::CloudBuilder cloud(field::CloudSettings{});
  for (const Sphere& s : spheres) field::add_point(cloud, s.center, s.radius, s.energy);
  return cloud.finish();
}

}  // namespace tafoni::bench
