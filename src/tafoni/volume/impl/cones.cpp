// The least distance to a tunnel's segments, rounded cones, at the 8^3 samples of a brick, over SIMD
// lanes; and the same at one point in double.

#include "tafoni/volume/impl/cones.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <hwy/highway.h>

#include "tafoni/math/simd.h"

#ifndef TAFONI_VOLUME_CONES_ONCE
#define TAFONI_VOLUME_CONES_ONCE
namespace tafoni::volume::impl {

/// A cone seen from a brick, in floats.
struct NearCone {
  float x, y, z;     ///< from the cone's first end to the brick's first sample
  float ux, uy, uz;  ///< along
  float length, radius, grow;
  float lean;    ///< how much further along the nearest sphere is, per metre from the axis
  float floor;   ///< metres
  float ground;  ///< height of the axis's first end above the brick's first sample
};

}  // namespace tafoni::volume::impl
#endif

HWY_BEFORE_NAMESPACE();
namespace tafoni::volume::impl {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

void least_of_cones(const NearCone* cones, std::size_t n, float spacing, float* out) {
  constexpr int plane = brick_side * brick_side;
  const hn::CappedTag<float, plane> f;
  using Vec = hn::Vec<decltype(f)>;
  const int lanes = static_cast<int>(hn::Lanes(f));
  const Vec zero = hn::Zero(f);
  const auto round = static_cast<float>(round_floor);
  const Vec ramp = hn::Set(f, static_cast<float>(floor_ramp));
  // A vector may hold more than a row.
  HWY_ALIGN float across[plane], up[plane];
  for (int i = 0; i < plane; ++i) {
    across[i] = spacing * static_cast<float>(i % brick_side);
    up[i] = spacing * static_cast<float>(i / brick_side);
  }
  std::fill_n(out, brick_side * plane, std::numeric_limits<float>::max());
  for (std::size_t i = 0; i < n; ++i) {
    const NearCone& c = cones[i];
    const Vec ux = hn::Set(f, c.ux), uy = hn::Set(f, c.uy), uz = hn::Set(f, c.uz), end = hn::Set(f, c.length);
    float* at = out;
    for (int z = 0; z < brick_side; ++z) {
      const float rise = spacing * static_cast<float>(z);
      const Vec wz = hn::Set(f, c.z + rise);
      const Vec lowest = hn::Set(f, c.ground - rise);
      for (int k = 0; k < plane; k += lanes, at += lanes) {
        const Vec wx = hn::Add(hn::Set(f, c.x), hn::Load(f, across + k));
        const Vec wy = hn::Add(hn::Set(f, c.y), hn::Load(f, up + k));
        const Vec s0 = hn::Add(hn::Mul(wx, ux), hn::Add(hn::Mul(wy, uy), hn::Mul(wz, uz)));
        const Vec qx = hn::Sub(wx, hn::Mul(s0, ux)), qy = hn::Sub(wy, hn::Mul(s0, uy)),
                  qz = hn::Sub(wz, hn::Mul(s0, uz));
        const Vec h2 = hn::Add(hn::Add(hn::Mul(qx, qx), hn::Mul(qy, qy)), hn::Mul(qz, qz));
        const Vec lean = hn::Mul(hn::Sqrt(h2), hn::Set(f, c.lean));
        const Vec s = hn::Min(hn::Max(hn::Add(s0, lean), zero), end);
        const Vec off = hn::Sub(s, s0);
        Vec value = hn::Sub(hn::Sqrt(hn::Add(h2, hn::Mul(off, off))),
                            hn::Add(hn::Set(f, c.radius), hn::Mul(s, hn::Set(f, c.grow))));
        if (c.floor < round) {
          const Vec t = hn::Min(hn::Max(s0, zero), end);
          value = hn::Max(
              value, hn::Sub(hn::Add(hn::Add(lowest, hn::Mul(t, uz)), hn::Mul(hn::Abs(hn::Sub(s0, t)), ramp)),
                             hn::Set(f, c.floor)));
        }
        hn::StoreU(hn::Min(value, hn::LoadU(f, at)), f, at);
      }
    }
  }
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::volume::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::volume::impl {
namespace {

HWY_EXPORT(least_of_cones);

/// Of two spheres whose centres are at most this times the difference of their radii apart, the larger counts
/// as holding the other: the cone about both would be so blunt that lean_of() divided by almost 0.
constexpr double one_holds_other = 1.0001;

/// The sphere nearest to p is not the one abreast of it where the radius grows.
double lean_of(const Cone& c) {
  return c.grow / std::sqrt(1 - c.grow * c.grow);
}

}  // namespace

Cone cone_between(Vec3d a, double radius_a, Vec3d b, double radius_b, double floor) {
  const double l = length(b - a);
  if (l <= std::abs(radius_b - radius_a) * one_holds_other)
    return radius_a > radius_b ? Cone{a, {1, 0, 0}, 0, radius_a, 0, floor}
                               : Cone{b, {1, 0, 0}, 0, radius_b, 0, floor};
  return {a, (b - a) * (1 / l), l, radius_a, (radius_b - radius_a) / l, floor};
}

double Cone::round(Vec3d p) const {
  const Vec3d w = p - from;
  const double s0 = dot(w, along);
  const double h = tafoni::length(w - along * s0);
  const double s = std::clamp(s0 + h * lean_of(*this), 0.0, length);
  return std::sqrt(h * h + (s - s0) * (s - s0)) - (radius + grow * s);
}

double Cone::value(Vec3d p) const {
  const double own = round(p);
  if (floor >= round_floor) return own;
  const double s0 = dot(p - from, along), s = std::clamp(s0, 0.0, length);
  return std::max(own, from.z + along.z * s + floor_ramp * std::abs(s0 - s) - floor - p.z);
}

void least_values(std::span<const Cone* const> cones, Vec3d first, double spacing, float* out) {
  limit_simd();
  thread_local std::vector<NearCone> near;
  near.clear();
  const auto small = [](double v) { return static_cast<float>(v); };
  for (const Cone* c : cones) {
    const Vec3d w = first - c->from;
    near.push_back({small(w.x), small(w.y), small(w.z), small(c->along.x), small(c->along.y),
                    small(c->along.z), small(c->length), small(c->radius), small(c->grow), small(lean_of(*c)),
                    small(c->floor), small(-w.z)});
  }
  HWY_DYNAMIC_DISPATCH(least_of_cones)(near.data(), near.size(), small(spacing), out);
}

}  // namespace tafoni::volume::impl
#endif
