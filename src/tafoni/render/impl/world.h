#pragma once
// The mesh as the renderer sees it: traceable, with a normal and a colour everywhere.

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "tafoni/render/impl/tracer.h"

namespace tafoni::render::impl {

/// A point of the mesh as seen along a ray. Both normals are turned towards the viewer.
struct Surface {
  Vec3f position, normal, face;
  Vec3f albedo;  ///< linear RGB reflectance
  Vec3f start;  ///< where rays towards the light begin: lifted onto the smooth surface, so that facets do not
                ///< shadow themselves (J. Hanika, Hacking the shadow terminator, 2021)
};

using Colors = std::vector<std::array<std::uint8_t, 4>>;

class World {
 public:
  World(const mesh::Mesh& mesh, Progress& progress);

  const mesh::Mesh& mesh() const { return mesh_; }
  const Tracer& tracer() const { return tracer_; }
  const Box3f& box() const { return box_; }
  /// Median length of an edge, metres.
  float spacing() const { return spacing_; }
  /// How far off the surface a ray starts, so that it does not meet where it comes from.
  float offset() const { return offset_; }

  /// The mesh's own colours, or those that inner/palette.h gives for slope and height above `sea` (local z).
  Colors colors(std::optional<float> sea, Progress& progress) const;
  /// The usual height of ground below `sea` that is seen from above; nothing where there is too little.
  std::optional<float> floor_below(float sea) const;
  Surface surface(const Hit& hit, Vec3f from, Vec3f direction, const Colors& colors) const;
  /// A wall or the base that closes the mesh at the edge of the data: below the air before it lies nothing.
  bool is_border(Vec3f position, Vec3f face) const;
  Vec3f face_normal(std::uint32_t triangle) const;
  Vec3f center(std::uint32_t triangle) const;

 private:
  const mesh::Mesh& mesh_;
  Box3f box_;
  float spacing_, offset_;
  std::vector<Vec3f> own_normals_;  ///< when the mesh has none
  Tracer tracer_;
};

}  // namespace tafoni::render::impl
