#pragma once
// Sun, sky, haze, water and lamp: what light there is, in units where a white wall square to the sun has a
// radiance of about 3.

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/math/vec.h"

namespace tafoni::render::impl {

inline Vec3f mix(Vec3f a, Vec3f b, float t) {
  return a + (b - a) * t;
}
inline Vec3f times(Vec3f a, Vec3f b) {
  return {a.x * b.x, a.y * b.y, a.z * b.z};
}
inline float smooth(float from, float to, float x) {
  const float t = std::clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
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

  static constexpr Vec3f sun{3.40f, 2.95f, 2.35f};
  static constexpr Vec3f zenith{0.28f, 0.43f, 0.74f}, horizon{0.70f, 0.79f, 0.90f};
  static constexpr Vec3f ground{0.46f, 0.45f, 0.43f};
  /// What water scatters back, and how fast it takes light away, per metre.
  static constexpr Vec3f water{0.018f, 0.085f, 0.105f}, absorption{0.30f, 0.10f, 0.075f};

  /// Light that open level ground gets from sun and sky.
  Vec3f open_ground{1, 1, 1};

  /// What the eye sees behind everything: a pale backdrop below the horizon.
  Vec3f backdrop(Vec3f d) const {
    return d.z >= 0 ? sky(d) : mix(sky({d.x, d.y, 0}), {1.02f, 1.0f, 0.97f}, smooth(0, 0.5f, -d.z));
  }
  /// Radiance that lights the scene from a direction.
  Vec3f sky(Vec3f d) const {
    const float up = std::clamp(d.z, 0.0f, 1.0f);
    const Vec3f clear = mix(horizon, zenith, 1 - std::exp(-3.2f * up));
    const float glow = std::pow(std::max(0.0f, dot(d, to_sun)), 12.0f);
    const Vec3f above = clear + sun * (0.10f * glow);
    return d.z >= 0 ? above : mix(above, ground, smooth(0, 0.35f, -d.z));
  }
  /// Light left after `metres` of water.
  static Vec3f through_water(float metres) {
    const float m = std::max(metres, 0.0f);
    return {std::exp(-absorption.x * m), std::exp(-absorption.y * m), std::exp(-absorption.z * m)};
  }
  Vec3f hazy(Vec3f color, float t) const {
    const float clear = std::exp(-haze_per_metre * std::max(0.0f, t - haze_begin));
    return mix(horizon * 0.93f, color, clear);
  }
};

}  // namespace tafoni::render::impl
