#pragma once
// The colours of rock, grass and sand, from what is known of a point of the surface.

#include <array>
#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::render {

/// What a point of the surface looks like depends on these.
struct GroundLook {
  Vec3d position;                    ///< world or local metres; only moves the texture
  Vec3f normal{0, 0, 1};             ///< unit, outward
  float resistance = 0.5f;           ///< rho in [0, 1]: soft ochre to hard grey
  float height_above_sea = 1000.0f;  ///< metres; far above the sea when there is none
  float plants = 1;                  ///< how much grows in the open; 0 is a desert, whose rock is redder
  bool roofed = false;               ///< under an overhang or in a cave: no plants grow
  float spacing = 0.5f;              ///< metres between vertices; finer texture is left out
};

/// Linear RGB reflectance, each in [0, 1].
Vec3f rock_palette(const GroundLook& point);

/// Linear [0, 1] to 8-bit linear RGBA, as Mesh::colors and glTF's COLOR_0 hold it.
std::array<std::uint8_t, 4> to_rgba8(Vec3f linear);

}  // namespace tafoni::render
