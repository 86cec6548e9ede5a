#pragma once
// Where to stand.

#include <optional>

#include "tafoni/render/impl/world.h"
#include "tafoni/render/render.h"

namespace tafoni::render::impl {

/// The nearest eye from which every vertex not below `sea` lies in the picture, looking towards `azimuth` and
/// down by `elevation` (radians); positions local to the mesh.
Camera fit(const World& world, double azimuth, double elevation, double fov, double aspect,
           std::optional<float> sea);

/// The same camera moved sideways and up, without leaving what fit() allows, until opposite margins are
/// alike.
Camera center(const World& world, Camera camera, double aspect, std::optional<float> sea);

/// The three-quarter view that shows most; see Scene::frame.
Camera best_outside(const World& world, const RenderSettings& settings, std::optional<float> sea);

/// See Scene::frame_inside; positions local to the mesh.
Camera best_inside(const World& world, std::optional<Vec3f> eye, std::optional<float> sea);

}  // namespace tafoni::render::impl
