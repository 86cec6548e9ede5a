#pragma once
// Skeletal primitives that change resistance about a skeleton [Paris19 §4.2, §5.2].

#include <string>
#include <utility>

#include "tafoni/core/params.h"
#include "tafoni/geology/impl/rock.h"

namespace tafoni::geology::impl {

struct LocalParams {
  double radius = 30;
  double core = 0;
  double strength = 0.6;
  double roughness = 0.3;
  double wavelength = 15;
  std::int64_t octaves = 3;
};

template <class P>
void declare_local(ParamTable<P>& table) {
  table.real("radius", &P::radius, "m", 0.01, 1e6, "Distance from the skeleton at which the effect ends")
      .real("core", &P::core, "m", 0, 1e6,
            "Distance within which the effect is full; 0 for one that falls off at once")
      .real("strength", &P::strength, "", -2, 2, "Resistance added at the skeleton; negative for weak rock")
      .real("roughness", &P::roughness, "", 0, 0.9,
            "Share by which noise varies the radius: 0 for a smooth border, 0.9 for a ragged one")
      .real("wavelength", &P::wavelength, "m", 0.1, 1e5, "Size of the coarsest bulges of the border")
      .only("where roughness is above 0")
      .integer("octaves", &P::octaves, "", 1, 12,
               "Levels of detail of the border, each half as large as the one before")
      .only("where roughness is above 0");
}

/// strength g((d - core) / (reach - core)) of the distance d from the skeleton; reach is the radius perturbed
/// by noise at the skeleton's offset surface. Skeleton has `Vec3d nearest(Vec3d p) const` and `Box3d bounds()
/// const`.
template <class Skeleton>
class Local final : public BatchGeology {
 public:
  Local(const LocalParams& p, Skeleton skeleton, std::uint64_t seed) : p_(p), skeleton_(std::move(skeleton)) {
    const double f = 1 / p.wavelength;
    noise_ = {{f, f, f}, p.octaves, seed, Stream::local};
    farthest_ = std::max(p.radius * (1 + p.roughness), p.core);
    bounds_ = skeleton_.bounds().grown(farthest_);
  }

  void raws(std::span<const Vec3d> points, std::span<double> out) const override {
    for_blocks(points.size(), [&](std::size_t begin, std::size_t n) {
      std::array<Vec3d, noise_block> on_surface;
      std::array<double, noise_block> distance;
      std::array<std::size_t, noise_block> index;
      std::size_t near = 0;
      for (std::size_t i = begin; i < begin + n; ++i) {
        out[i] = 0;
        if (!bounds_.contains(points[i])) continue;
        const Vec3d s = skeleton_.nearest(points[i]), away = points[i] - s;
        const double d = length(away);
        if (d >= farthest_) continue;
        on_surface[near] = d > 0 ? s + away * (p_.radius / d) : s;
        distance[near] = d;
        index[near++] = i;
      }
      std::array<float, noise_block> t;
      t.fill(0.5f);
      if (p_.roughness > 0) noise_.sample(std::span(on_surface).first(near), std::span(t).first(near));
      for (std::size_t k = 0; k < near; ++k) out[index[k]] = p_.strength * effect(distance[k], t[k]);
    });
  }

 private:
  double effect(double d, float t) const {
    if (d <= p_.core) return 1;
    const double reach = p_.radius * (1 + p_.roughness * (2.0 * t - 1));
    return d < reach ? falloff((d - p_.core) / (reach - p_.core)) : 0;
  }

  LocalParams p_;
  Skeleton skeleton_;
  Turbulence noise_;
  double farthest_ = 0;
  Box3d bounds_;
};

/// x, y, z triples; `least` of them or more. Throws Error{usage} that begins with `where`.
std::vector<Vec3d> triples(const std::vector<double>& numbers, std::size_t least, std::string_view where);

}  // namespace tafoni::geology::impl
