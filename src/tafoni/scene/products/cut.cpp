// The ground is meshed and clipped along the cut, and walls are put up along it and along the borders: a
// lattice of samples on each upright plane, whose solid part marching squares fill with triangles.
#include "tafoni/scene/products/cut.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/math/whole.h"
#include "tafoni/raster/resample.h"
#include "tafoni/render/inner/palette.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::scene {
namespace {

// Chosen by eye.
constexpr double wall_samples = 1000;  // along the longest wall: about one a pixel of a picture
// From the weakest rock to the hardest: linear reflectances of dark shale, brown and ochre sandstone, and
// pale limestone, so that a reader who knows cliffs sees which beds stand out.
constexpr std::array<Vec3f, 4> resistance_colours = {
    Vec3f{0.035f, 0.023f, 0.018f}, {0.125f, 0.070f, 0.042f}, {0.34f, 0.225f, 0.135f}, {0.56f, 0.50f, 0.40f}};

constexpr auto none = static_cast<std::uint32_t>(-1);  ///< in place of a vertex

/// What lies on the left of a line through `at` along the unit `along`.
struct HalfPlane {
  Vec2d at, along;
  double inside(double x, double y) const { return along.x * (y - at.y) - along.y * (x - at.x); }
};

using Ring = std::vector<Vec2d>;  ///< convex, counter-clockwise

Ring clip(const Ring& ring, const HalfPlane& half) {
  Ring out;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d a = ring[i], b = ring[(i + 1) % ring.size()];
    const double da = half.inside(a.x, a.y), db = half.inside(b.x, b.y);
    if (da >= 0) out.push_back(a);
    if ((da < 0) != (db < 0) && da != 0 && db != 0) out.push_back(a + (b - a) * (da / (da - db)));
  }
  return out;
}

/// Keeps the part of a mesh that lies on one side; triangles across are cut, so their new corners are not
/// shared.
void clip(mesh::Mesh& mesh, const HalfPlane& half) {
  std::vector<double> d(mesh.positions.size());
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = half.inside(mesh.positions[i].x, mesh.positions[i].y);
  const auto between = [&](std::uint32_t a, std::uint32_t b) {
    const auto t = static_cast<float>(d[a] / (d[a] - d[b]));
    mesh.positions.push_back(mesh.positions[a] + (mesh.positions[b] - mesh.positions[a]) * t);
    mesh.normals.push_back(normalized(mesh.normals[a] + (mesh.normals[b] - mesh.normals[a]) * t));
    return static_cast<std::uint32_t>(mesh.positions.size() - 1);
  };
  std::vector<std::array<std::uint32_t, 3>> kept;
  for (const auto& triangle : mesh.triangles) {
    std::array<std::uint32_t, 4> corner{};
    std::size_t n = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangle[i], b = triangle[(i + 1) % 3];
      if (d[a] >= 0) corner[n++] = a;
      if ((d[a] < 0) != (d[b] < 0)) corner[n++] = between(a, b);
    }
    for (std::size_t i = 2; i < n; ++i) kept.push_back({corner[0], corner[i - 1], corner[i]});
  }
  mesh.triangles = std::move(kept);
}

/// Drops the vertices that belong to no triangle.
void compact(mesh::Mesh& mesh) {
  std::vector<std::uint32_t> now(mesh.positions.size(), none);
  std::vector<Vec3f> positions, normals;
  for (auto& triangle : mesh.triangles)
    for (std::uint32_t& v : triangle) {
      if (now[v] == none) {
        now[v] = static_cast<std::uint32_t>(positions.size());
        positions.push_back(mesh.positions[v]);
        normals.push_back(mesh.normals[v]);
      }
      v = now[v];
    }
  mesh.positions = std::move(positions);
  mesh.normals = std::move(normals);
}

/// A lattice of samples of the field on an upright plane, and the marching squares that fill what is solid.
class Wall {
 public:
  Wall(Vec2d from, Vec2d to, double bottom, double top, double step)
      : from_(from), to_(to), bottom_(bottom), top_(top) {
    const Vec2d d = to - from;
    nu_ = cells(std::hypot(d.x, d.y), step);
    nz_ = cells(top - bottom, step);
  }

  void add_to(mesh::Mesh& mesh, const BuiltScene& scene, const field::CompiledField& field) {
    sample(scene, field);
    vertices_.assign(3 * f_.size(), none);
    for (int k = 0; k < nz_; ++k)
      for (int i = 0; i < nu_; ++i) fill(mesh, i, k);
  }

 private:
  static int cells(double length, double step) { return std::max(1, ceil_to(length / step)); }
  std::ptrdiff_t index(int i, int k) const { return std::ptrdiff_t{k} * (nu_ + 1) + i; }
  Vec3d point(double i, double k) const {
    const Vec2d xy = from_ + (to_ - from_) * (i / nu_);
    return {xy.x, xy.y, bottom_ + (top_ - bottom_) * (k / nz_)};
  }

  void sample(const BuiltScene& scene, const field::CompiledField& field) {
    std::vector<Vec3d> points;
    for (int k = 0; k <= nz_; ++k)
      for (int i = 0; i <= nu_; ++i) points.push_back(point(i, k));
    f_.resize(points.size());
    field.values(points, f_);
    if (const auto& inside = scene.terrain.inside)
      for (std::size_t i = 0; i < f_.size(); ++i)
        f_[i] =
            std::min(f_[i], static_cast<float>(raster::sample_bilinear(*inside, points[i].x, points[i].y)));
  }

  /// The corner itself, or the place where the field is 0 on the way to the corner at `next`: to the right or
  /// above, as `way` says.
  std::uint32_t vertex(mesh::Mesh& mesh, int i, int k, int way) {
    std::uint32_t& id = vertices_[3 * index(i, k) + way];
    if (id != none) return id;
    double t = 0;
    if (way > 0) {
      const float a = f_[index(i, k)], b = f_[way == 1 ? index(i + 1, k) : index(i, k + 1)];
      t = a / (a - b);
    }
    id = static_cast<std::uint32_t>(mesh.positions.size());
    mesh.positions.push_back(to_float(point(i + (way == 1 ? t : 0), k + (way == 2 ? t : 0))));
    const Vec2d d = to_ - from_;
    mesh.normals.push_back(to_float(normalized(Vec3d{d.y, -d.x, 0})));
    return id;
  }

  /// The solid part of one cell as a fan about its first corner.
  void fill(mesh::Mesh& mesh, int i, int k) {
    const std::array<std::ptrdiff_t, 5> at = {index(i, k), index(i + 1, k), index(i + 1, k + 1),
                                              index(i, k + 1), index(i, k)};
    std::array<std::uint32_t, 8> corner{};
    std::size_t n = 0;
    for (std::size_t c = 0; c < 4; ++c) {
      const bool here = f_[at[c]] > 0, next = f_[at[c + 1]] > 0;
      if (here) corner[n++] = vertex(mesh, i + (c == 1 || c == 2), k + (c >= 2), 0);
      if (here == next) continue;
      // The sides: below, right, above, left.
      if (c == 0) corner[n++] = vertex(mesh, i, k, 1);
      if (c == 1) corner[n++] = vertex(mesh, i + 1, k, 2);
      if (c == 2) corner[n++] = vertex(mesh, i, k + 1, 1);
      if (c == 3) corner[n++] = vertex(mesh, i, k, 2);
    }
    for (std::size_t c = 2; c < n; ++c) mesh.triangles.push_back({corner[0], corner[c - 1], corner[c]});
  }

  Vec2d from_, to_;
  double bottom_, top_;
  int nu_ = 0, nz_ = 0;  ///< cells along the wall and up
  std::vector<float> f_;
  std::vector<std::uint32_t> vertices_;  ///< of each corner: itself, to its right, above it
};

void colour_by_resistance(mesh::Mesh& mesh, const geology::Geology& rock) {
  std::vector<Vec3d> points;
  for (const Vec3f& p : mesh.positions) points.push_back(to_double(p));
  std::vector<float> rho(points.size());
  rock.resistances(points, rho);
  mesh.colors.resize(points.size());
  for (std::size_t i = 0; i < rho.size(); ++i) mesh.colors[i] = render::to_rgba8(resistance_ramp(rho[i]));
}

}  // namespace

Cut middle_cut(const BuiltScene& scene) {
  const Box3d& box = scene.terrain.box;
  const Vec3d middle = scene.terrain.to_world(box.center());
  return {{middle.x - box.size().x / 2, middle.y}, {middle.x + box.size().x / 2, middle.y}};
}

Vec3f resistance_ramp(float resistance) {
  constexpr auto& stops = resistance_colours;
  const float at = std::clamp(resistance, 0.0f, 1.0f) * (stops.size() - 1);
  const auto i = std::min(static_cast<std::size_t>(at), stops.size() - 2);
  const float t = at - static_cast<float>(i);
  return stops[i] * (1 - t) + stops[i + 1] * t;
}

mesh::Mesh cut_mesh(const BuiltScene& scene, const Cut& cut, Progress& progress) {
  const Vec2d along = cut.to - cut.from;
  const double length = std::hypot(along.x, along.y);
  if (!(length > 0)) fail(ErrorKind::usage, "The line of the cut has no length; give two places on the map.");
  const Vec2d origin{scene.terrain.origin.x, scene.terrain.origin.y};
  const Box3d& box = scene.terrain.box;
  const Ring whole = {{box.lo.x, box.lo.y}, {box.hi.x, box.lo.y}, {box.hi.x, box.hi.y}, {box.lo.x, box.hi.y}};
  const Ring ring = clip(whole, {cut.from - origin, along * (1 / length)});
  if (ring.size() < 3)
    fail(ErrorKind::usage,
         "Nothing of the terrain lies to the left of the cut; swap its ends or move it into {:.10g},{:.10g} "
         "to "
         "{:.10g},{:.10g}.",
         box.lo.x + origin.x, box.lo.y + origin.y, box.hi.x + origin.x, box.hi.y + origin.y);

  if (clip(whole, {cut.from - origin, along * (-1 / length)}).size() < 3)
    progress.warn(
        fmt::format("the cut passes beside the terrain and removes nothing; move it into "
                    "{:.10g},{:.10g} to {:.10g},{:.10g}",
                    box.lo.x + origin.x, box.lo.y + origin.y, box.hi.x + origin.x, box.hi.y + origin.y));

  BuiltScene open = scene;
  open.document.scene.boundary = "open";
  const field::CompiledField field = open.field_for(surface::Boundary::open);
  auto settings = polygonize_settings(open, scene.voxel);
  // Whole cells overlap the border, where the sheet is cut exactly.
  settings.region = settings.region.grown(scene.voxel);
  mesh::Mesh out = surface::polygonize(field, settings, progress);
  const double base = box.lo.z, top = std::max(box.lo.z + scene.voxel, field.bounds().hi.z);
  double longest = top - base;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d d = ring[(i + 1) % ring.size()] - ring[i];
    longest = std::max(longest, std::hypot(d.x, d.y));
  }
  progress.begin("walls", ring.size());
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Vec2d a = ring[i], b = ring[(i + 1) % ring.size()], d = b - a;
    if (const double side = std::hypot(d.x, d.y); side > 0) clip(out, {a, d * (1 / side)});
  }
  compact(out);
  for (std::size_t i = 0; i < ring.size(); ++i) {
    Wall(ring[i], ring[(i + 1) % ring.size()], base, top, longest / wall_samples).add_to(out, scene, field);
    progress.advance();
  }
  progress.end();
  out.origin = scene.terrain.origin;
  colour_by_resistance(out, *scene.geology);
  return out;
}

}  // namespace tafoni::scene
