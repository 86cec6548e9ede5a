// The mesh made ready to be seen: its box, spacing, normals and colours, and the point, normal and start
// of further rays where a ray meets it.

#include "tafoni/render/impl/world.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/mesh/inner/traceable.h"
#include "tafoni/render/inner/palette.h"

namespace tafoni::render::impl {
namespace {

const mesh::Mesh& require_triangles(const mesh::Mesh& mesh) {
  if (mesh.triangles.empty())
    fail(ErrorKind::input, "The mesh has no triangles, so there is nothing to draw.");
  mesh::inner::check_traceable(mesh);
  return mesh;
}

Box3f box_of(const mesh::Mesh& mesh) {
  Box3f box;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) box.expand(mesh.positions[v]);
  return box;
}

float median_edge(const mesh::Mesh& mesh) {
  std::vector<float> lengths;
  const std::size_t step = mesh.triangles.size() / 1000 + 1;
  for (std::size_t t = 0; t < mesh.triangles.size(); t += step)
    lengths.push_back(length(mesh.positions[mesh.triangles[t][1]] - mesh.positions[mesh.triangles[t][0]]));
  std::nth_element(lengths.begin(), lengths.begin() + lengths.size() / 2, lengths.end());
  return lengths[lengths.size() / 2];
}

/// Area-weighted vertex normals. One thread, so that the sums do not depend on the number of threads.
std::vector<Vec3f> vertex_normals(const mesh::Mesh& mesh) {
  std::vector<Vec3f> normals(mesh.positions.size());
  for (const auto& t : mesh.triangles) {
    const Vec3f a = mesh.positions[t[0]];
    const Vec3f n = cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a);
    for (const std::uint32_t v : t) normals[v] += n;
  }
  for (Vec3f& n : normals) n = normalized(n);
  return normals;
}

}  // namespace

World::World(const mesh::Mesh& mesh, Progress& progress)
    : mesh_(require_triangles(mesh)),
      box_(box_of(mesh)),
      spacing_(median_edge(mesh)),
      own_normals_(mesh.normals.empty() ? vertex_normals(mesh) : std::vector<Vec3f>()),
      tracer_(mesh, progress) {
  float reach = 0;
  for (const float x : {box_.lo.x, box_.lo.y, box_.lo.z, box_.hi.x, box_.hi.y, box_.hi.z})
    reach = std::max(reach, std::abs(x));
  // Below the first a float position cannot tell the side; the second hides that smooth shading is not the
  // triangles' own.
  offset_ = std::max(4e-6f * reach, 0.02f * spacing_);
}

Colors World::colors(std::optional<float> sea, Progress& progress) const {
  if (!mesh_.colors.empty()) return {};
  const std::vector<Vec3f>& normals = own_normals_.empty() ? mesh_.normals : own_normals_;
  Colors colors(mesh_.positions.size());
  const auto n = std::ssize(colors);
  parallel_blocks(n, 4096, [&](std::int64_t begin, std::int64_t end) {
    progress.check();
    for (std::int64_t i = begin; i < end; ++i) {
      const Vec3f p = mesh_.positions[i];
      render::GroundLook point;
      point.position = to_double(p) + mesh_.origin;
      point.normal = normals[i];
      if (sea) point.height_above_sea = p.z - *sea;
      point.roofed = normals[i].z > 0.3f && tracer_.blocked(p + normals[i] * (4 * offset_), {0, 0, 1});
      point.spacing = spacing_;
      colors[i] = render::to_rgba8(render::rock_palette(point));
    }
  });
  return colors;
}

std::optional<float> World::floor_below(float sea) const {
  std::vector<float> heights;
  const std::size_t step = mesh_.triangles.size() / 20000 + 1;
  for (std::size_t t = 0; t < mesh_.triangles.size(); t += step) {
    const auto triangle = static_cast<std::uint32_t>(t);
    const Vec3f c = center(triangle);
    if (c.z >= sea || face_normal(triangle).z < 0.6f) continue;
    if (!tracer_.blocked(c + Vec3f{0, 0, offset_}, {0, 0, 1})) heights.push_back(c.z);
  }
  if (heights.size() < 100) return std::nullopt;
  const auto middle = heights.begin() + heights.size() / 2;
  std::nth_element(heights.begin(), middle, heights.end());
  return *middle;
}

Surface World::surface(const Hit& hit, Vec3f from, Vec3f direction, const Colors& colors) const {
  const auto& t = mesh_.triangles[hit.triangle];
  const float w[3] = {1 - hit.u - hit.v, hit.u, hit.v};
  const std::vector<Vec3f>& normals = own_normals_.empty() ? mesh_.normals : own_normals_;
  const Colors& rgba = mesh_.colors.empty() ? colors : mesh_.colors;
  Surface s;
  for (std::size_t k = 0; k < 3; ++k) {
    s.normal += normals[t[k]] * w[k];
    const auto& c = rgba[t[k]];
    s.albedo +=
        Vec3f{static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2])} * (w[k] / 255);
  }
  s.position = from + direction * hit.t;
  s.face = hit.face;
  s.normal = normalized(s.normal);
  // In creases a normal can point past its own triangle, or nowhere; light would come through the wall.
  const float along = dot(s.normal, s.face);
  if (along < 0.35f) s.normal = normalized(s.normal + s.face * (1.4f * (0.35f - along)));
  float lift = 0;
  bool smooth_here = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3f n = normals[t[k]];
    const float below = dot(s.position - mesh_.positions[t[k]], n), along_face = dot(n, s.face);
    lift -= w[k] * std::min(0.0f, below) * along_face;
    smooth_here &= along_face > 0.7f;
  }
  // Where normals turn sharply the lift could reach into the next wall.
  lift = smooth_here ? std::min(lift, 0.08f * spacing_) : 0.0f;
  if (dot(s.face, direction) > 0) {
    s.face = -s.face;
    s.normal = -s.normal;
    lift = 0;
  }
  s.start = s.position + s.face * (lift + offset_);
  // A smooth normal that turns from the viewer is bent back, or its side of a ridge would be black.
  const float away = dot(s.normal, direction);
  if (away > -0.02f) s.normal = normalized(s.normal - direction * (away + 0.02f));
  return s;
}

Vec3f World::face_normal(std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  const Vec3f a = mesh_.positions[t[0]];
  return normalized(cross(mesh_.positions[t[1]] - a, mesh_.positions[t[2]] - a));
}

Vec3f World::center(std::uint32_t triangle) const {
  const auto& t = mesh_.triangles[triangle];
  return (mesh_.positions[t[0]] + mesh_.positions[t[1]] + mesh_.positions[t[2]]) * (1.0f / 3);
}

bool World::is_border(Vec3f position, Vec3f face) const {
  return face.z < 0.3f && !tracer_.blocked(position + face * spacing_, {0, 0, -1});
}

}  // namespace tafoni::render::impl
