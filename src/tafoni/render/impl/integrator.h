#pragma once
// The light that comes along a ray: direct sun, one bounce of sky light, water, lamp, haze.

#include "tafoni/render/impl/light.h"
#include "tafoni/render/impl/sampler.h"
#include "tafoni/render/impl/world.h"

namespace tafoni::render::impl {

/// One ray's result: its colour, and what the denoiser needs to mend the noisy part of it.
struct Sample {
  Vec3f color;
  Vec3f sky_light;   ///< the noisy indirect light, before reflectance
  Vec3f sky_weight;  ///< color depends on it by this factor
  Vec3f normal;      ///< zero where the ray met no surface
  float t = far_away;
};

class Integrator {
 public:
  Integrator(const World& world, const Colors& colors, const Light& light)
      : world_(world), colors_(colors), light_(light) {}

  /// Light along a ray from the eye; `footprint` is the width of a pixel at unit distance.
  Sample eye_ray(Vec3f from, Vec3f direction, float footprint, const Sampler& sampler) const;

 private:
  struct Lit {
    Vec3f direct;  ///< before reflectance
    Vec3f indirect;
  };
  Lit light_on(const Surface& surface, const Sampler& sampler) const;
  Vec3f sun_on(const Surface& surface, Point2 random) const;
  Vec3f lamp_on(const Surface& surface, Point2 random) const;
  Vec3f sky_on(const Surface& surface, const Sampler& sampler) const;
  /// Reflected light that a bounce picks up, with its own sun and sky rays.
  Vec3f bounce(const Hit& hit, Vec3f from, Vec3f direction, const Sampler& sampler) const;
  Vec3f beyond(Vec3f direction) const;
  Vec3f under_sea(Vec3f light, Vec3f position) const;
  Sample water(Vec3f from, Vec3f direction, float t_sea, const Hit& hit, float footprint,
               const Sampler& sampler) const;
  /// How much more water seems to lie over the floor near and beyond the edge of the data, so that the edge
  /// is lost in the deep.
  float deepening(Vec3f position) const;
  /// The sea's floor where the data ends: it goes on from the data's own at the same depth.
  Sample floor_beyond(Vec3f from, Vec3f direction, const Sampler& sampler) const;
  /// The backdrop below the horizon, darkened by the mesh's shadow on a plane under it.
  Sample backdrop(Vec3f from, Vec3f direction, const Sampler& sampler) const;
  Sample solid(Vec3f from, Vec3f direction, const Hit& hit, float footprint, const Sampler& sampler) const;

  const World& world_;
  const Colors& colors_;
  const Light& light_;
};

}  // namespace tafoni::render::impl
