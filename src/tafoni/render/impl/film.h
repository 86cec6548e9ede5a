#pragma once
// The picture before it is one: linear light and what the denoiser needs.

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"
#include "tafoni/raster/image.h"

namespace tafoni::render::impl {

struct Pixel {
  Vec3f color;      ///< mean radiance
  Vec3f light;      ///< mean noisy indirect light
  Vec3f weight;     ///< mean factor of that light in the colour
  Vec3f normal;     ///< mean normal; short where surfaces mix
  float depth = 0;  ///< mean distance along the ray; 0 where nothing was met
};
using Film = raster::Grid<Pixel>;

/// The pixel's ray at unit distance along the view: right, up and forward per pixel step.
struct View {
  Vec3f eye, forward, right, up;  ///< right and up reach the picture's edge at unit distance
  int width = 0, height = 0;

  /// Direction, unit, of the point (u, v) of a pixel, in [0, 1] each; (0.5, 0.5) is its middle.
  Vec3f through(int x, int y, float u = 0.5f, float v = 0.5f) const {
    return direction(static_cast<float>(x) + u, static_cast<float>(y) + v);
  }
  /// Direction, unit, of a point of the picture in pixels; (0, 0) is the top left corner.
  Vec3f direction(float x, float y) const {
    const float u = 2 * x / static_cast<float>(width) - 1, v = 1 - 2 * y / static_cast<float>(height);
    return normalized(forward + right * u + up * v);
  }
};

/// Replaces the noisy indirect light by a mean over neighbours on the same surface (the edge-avoiding
/// a-trous filter of [Dammertz10]). What the sun and the texture draw stays sharp.
void denoise(Film& film, const View& view);

/// Filmic tone curve and sRGB.
raster::Image develop(const Film& film, double exposure);

}  // namespace tafoni::render::impl
