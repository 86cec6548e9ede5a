#pragma once
// Still pictures of a mesh: sun with soft shadow, sky light with occlusion, or a lamp inside a cave.

#include <memory>
#include <optional>

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/raster/image.h"

namespace tafoni::render {

/// A pinhole camera. Positions are world (scene CRS), metres.
struct Camera {
  Vec3d eye, target;
  Vec3d up{0, 0, 1};
  double fov = 0.61;  ///< vertical angle of view, radians
};

struct RenderSettings {
  int width = 1280, height = 720;
  int samples = 8;                    ///< rays through each pixel; each also asks for sun and sky
  std::optional<double> sun_azimuth;  ///< radians clockwise from north; default: from the camera's left
  double sun_elevation = 0.60;        ///< radians above the horizon
  double sun_radius = 0.015;          ///< radians, the softness of shadows (the real sun: 0.0047)
  bool inside = false;                ///< adds a lamp at the eye and wide eyes: for cave interiors
  std::optional<double> sea_level;    ///< world elevation; draws a translucent water surface
  double exposure = 1.0;              ///< factor on the light before tone mapping
  double haze = 1.0;                  ///< strength of aerial perspective; 0 switches it off
  std::optional<double> azimuth;      ///< frame(): direction of view, radians clockwise from north
  std::optional<double> elevation;    ///< frame(): how far the camera looks down, radians
};

/// A mesh made ready for tracing, so that several pictures share the work. Keeps a reference to the mesh.
class Scene {
 public:
  /// Throws Error{input} for a mesh without triangles, with wrong indices, or with vertices that are not
  /// finite or farther than 1e9 m from its origin.
  explicit Scene(const mesh::Mesh& mesh, Progress& progress = silent());
  ~Scene();
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;

  /// A three-quarter view from outside that holds the whole mesh, above the sea level if one is given; where
  /// azimuth and elevation are not given, they are those that show most of cliffs and undercuts.
  Camera frame(const RenderSettings& settings) const;

  /// A view inside a cave: from `eye`, or from a place found in the roomiest roofed part; the target lies
  /// along the longest view. Throws Error{input} when nothing is roofed.
  Camera frame_inside(const RenderSettings& settings, std::optional<Vec3d> eye = {}) const;

  /// The picture; the same bytes at any thread count. Colours come from the mesh, or from inner/palette.h by
  /// slope and height when it has none. Throws Error{usage} for a camera or size that makes no picture.
  raster::Image render(const Camera& camera, const RenderSettings& settings,
                       Progress& progress = silent()) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// One picture: `camera`, or else frame() or, when settings.inside, frame_inside().
raster::Image render(const mesh::Mesh& mesh, const std::optional<Camera>& camera,
                     const RenderSettings& settings, Progress& progress = silent());

}  // namespace tafoni::render
