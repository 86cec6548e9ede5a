#pragma once
// Sun, sky, haze, water and lamp: what light there is, in units where a white wall square to the sun has a
// radiance of about 3.

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/math/smoothstep.h"
#include "tafoni/math/vec.h"

namespace tafoni::render::impl {

inline Vec3f mix(Vec3f a, Vec3f b, float t) {
  return a + (b - a) * t;
}
inline Vec3f times(Vec3f a, Vec3f b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline float luminance(Vec3f c) {
  return 0.2126f * c.x + 0.7152f * c.y + 0.0722f * c.z;
}

/// A lamp near the eye, for cave interiors.
struct Lamp {
  Vec3f position;
  float reach = 1;   ///< the distance, metres, at which a wall is well lit
  float radius = 0;  ///< metres, the softness of its shadows
};

struct Light {
  Vec3f to_sun{0, 0, 1};
  float sun_radius = 0;            ///< radians
  std::optional<float> sea;        ///< local z of the water surface
  std::optional<float> sea_floor;  ///< local z of the floor around the data, where the data shows one
  Vec3f floor_albedo{0.2f, 0.16f, 0.11f};
  std::optional<Lamp> lamp;
  float haze_per_metre = 0;
  float haze_begin = 0;  ///< metres from the eye that are clear

  // What follows is chosen by eye, after photographs of coasts at a clear afternoon: a warm sun against a
  // blue zenith, a pale horizon, and greenish water in which a few metres hide the floor.
  static constexpr Vec3f sun{3.40f, 2.95f, 2.35f};
  static constexpr Vec3f zenith{0.28f, 0.43f, 0.74f}, horizon{0.70f, 0.79f, 0.90f};
  static constexpr Vec3f ground{0.46f, 0.45f, 0.43f};
  /// What water scatters back, and how fast it takes light away, per metre.
  static constexpr Vec3f water{0.018f, 0.085f, 0.105f}, absorption{0.30f, 0.10f, 0.075f};
  /// The backdrop's floor, nearly white, and how far below the horizon it is reached, as the sine of the
  /// angle.
  static constexpr Vec3f studio{1.02f, 1.0f, 0.97f};
  static constexpr float studio_below = 0.5f, ground_below = 0.35f;
  /// How fast the sky turns from horizon to zenith; how bright and how narrow the glow around the sun is.
  static constexpr float sky_gradient = 3.2f, glow_strength = 0.10f, glow_power = 12.0f;
  static constexpr float haze_whiteness = 0.93f;  ///< haze is the horizon's light, a little darker

  /// Light that open level ground gets from sun and sky.
  Vec3f open_ground{1, 1, 1};

  /// What the eye sees behind everything: a pale backdrop below the horizon.
  Vec3f backdrop(Vec3f d) const {
    return d.z >= 0 ? sky(d) : mix(sky({d.x, d.y, 0}), studio, smoothstep(0.0f, studio_below, -d.z));
  }
  /// Radiance that lights the scene from a direction.
  Vec3f sky(Vec3f d) const {
    const float up = std::clamp(d.z, 0.0f, 1.0f);
    const Vec3f clear = mix(horizon, zenith, 1 - std::exp(-sky_gradient * up));
    const float glow = std::pow(std::max(0.0f, dot(d, to_sun)), glow_power);
    const Vec3f above = clear + sun * (glow_strength * glow);
    return d.z >= 0 ? above : mix(above, ground, smoothstep(0.0f, ground_below, -d.z));
  }
  /// Light left after `metres` of water.
  static Vec3f through_water(float metres) {
    const float m = std::max(metres, 0.0f);
    return {std::exp(-absorption.x * m), std::exp(-absorption.y * m), std::exp(-absorption.z * m)};
  }
  Vec3f hazy(Vec3f color, float t) const {
    const float clear = std::exp(-haze_per_metre * std::max(0.0f, t - haze_begin));
    return mix(horizon * haze_whiteness, color, clear);
  }
};

}  // namespace tafoni::render::impl
