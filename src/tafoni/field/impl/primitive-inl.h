// Every kernel of a primitive kind, from the one template it declares. See math/lanes-inl.h for the toggle.
//
// A kind is a struct K in a file of primitives/, made once a primitive from its extras, with
//   static constexpr bool volumetric, has_extras;
//   K(const float* extras, std::uint32_t count);
//   template <class N> Vec3N<N> offset(const Vec3N<N>& p) const;
// where p is relative to the anchor and the result leads from the nearest skeleton point to p. Its length
// must grow no faster than p moves (1-Lipschitz) and never be below the distance: intervals and supports rely
// on that.
#if defined(TAFONI_FIELD_IMPL_PRIMITIVE_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_FIELD_IMPL_PRIMITIVE_INL_H_
#undef TAFONI_FIELD_IMPL_PRIMITIVE_INL_H_
#else
#define TAFONI_FIELD_IMPL_PRIMITIVE_INL_H_
#endif

#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/impl/primitive_entry.h"
#include "tafoni/field/impl/skeleton-inl.h"
#include "tafoni/math/noise-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

TAFONI_LANES_INLINE Lanes along(Ints sample, Lanes rest, std::int32_t anchor) {
  return mul_add(to_lanes(sample - Ints(anchor)), Lanes(static_cast<float>(unit)), rest);
}

/// t(v) in metres at v, metres relative to the anchor: the anchor's own place in the noise is found in
/// double.
struct LocalNoise {
  Noise noise;
  NoiseCell cell;
  Vec3f base;  ///< the anchor, in wavelengths, modulo the translation in `cell`

  TAFONI_LANES_INLINE LocalNoise(const Noise& n, std::int32_t x, std::int32_t y, std::int32_t z)
      : noise(n), cell{Ints(0), Ints(0), Ints(0)} {
    if (n.amplitude == 0) return;
    const double scale = unit * n.inv_wavelength;
    const double q[3] = {x * scale, y * scale, z * scale};
    std::int32_t m[3];
    float rest[3];
    for (int c = 0; c < 3; ++c) {
      const double whole = std::floor(q[c] / 3);
      m[c] = static_cast<std::int32_t>(whole);
      rest[c] = static_cast<float>(q[c] - 3 * whole);
    }
    cell = noise_cell(Ints(m[0]), Ints(m[1]), Ints(m[2]));
    base = {rest[0], rest[1], rest[2]};
  }

  TAFONI_LANES_INLINE Lanes operator()(const Vec3N<Lanes>& v) const {
    return fbm_lanes(place(v), cell, noise.octaves, noise.seed, nullptr) * Lanes(noise.amplitude);
  }
  TAFONI_LANES_INLINE Dual operator()(const Vec3N<Dual>& v) const {
    Vec3N<Lanes> g{Lanes(0.f), Lanes(0.f), Lanes(0.f)};
    const Lanes t = fbm_lanes(place({v.x.v, v.y.v, v.z.v}), cell, noise.octaves, noise.seed, &g);
    const Lanes k(noise.amplitude * noise.inv_wavelength);
    const Lanes gx = g.x * k, gy = g.y * k, gz = g.z * k;
    return {t * Lanes(noise.amplitude), mul_add(gx, v.x.x, mul_add(gy, v.y.x, gz * v.z.x)),
            mul_add(gx, v.x.y, mul_add(gy, v.y.y, gz * v.z.y)),
            mul_add(gx, v.x.z, mul_add(gy, v.y.z, gz * v.z.z))};
  }

 private:
  TAFONI_LANES_INLINE Vec3N<Lanes> place(const Vec3N<Lanes>& v) const {
    const Lanes k(noise.inv_wavelength);
    return {mul_add(v.x, k, Lanes(base.x)), mul_add(v.y, k, Lanes(base.y)), mul_add(v.z, k, Lanes(base.z))};
  }
};

/// The shape of one primitive, with what its kernel would divide by.
template <class K>
struct Shape {
  K kind;
  float radius, inverse;  ///< inverse: 1 / radius^2 of a thin kind, 1 / falloff of a volumetric one
};

/// 1 - (distance / support)^2, cut at 0.
template <class K, bool perturbed, class N>
TAFONI_LANES_INLINE N closeness(const Vec3N<N>& p, const Shape<K>& shape, const LocalNoise& noise) {
  const Vec3N<N> o = shape.kind.offset(p);
  const N d2 = dot(o, o);
  if constexpr (!K::volumetric && !perturbed) {
    return max(neg_mul_add(d2, N(shape.inverse), N(1.f)), N(0.f));
  } else {
    const N d = sqrt(d2);
    N body = N(shape.radius);
    // On the skeleton itself the direction is undefined; any will do, since d is 0 there.
    if constexpr (perturbed) body = noise((p - o) + o * (N(shape.radius) / max(d, N(1e-12f)))) + body;
    const N q = K::volumetric ? max(d - body, N(0.f)) * N(shape.inverse) : d / body;
    return max(neg_mul_add(q, q, N(1.f)), N(0.f));
  }
}

template <class K>
TAFONI_LANES_INLINE Shape<K> shape_of(const CloudView& cloud, std::uint32_t i) {
  const Primitives& prims = *cloud.primitives;
  const float radius = prims.radius[i],
              inverse = K::volumetric ? 1.f / cloud.falloff : 1.f / (radius * radius);
  if constexpr (K::has_extras)
    return {K(cloud.pool + prims.extra[i], prims.extra_count[i]), radius, inverse};
  else
    return {K(nullptr, 0), radius, inverse};
}

/// Distances of a block's rows or planes from an anchor, with the lanes' own arithmetic: a scalar fused
/// multiply-add would differ on a machine without one.
TAFONI_LANES_INLINE void distances(const std::int32_t* sample, const float* rest, std::int32_t anchor,
                                   float* out) {
  for (std::size_t l = 0; l < 8; l += lane_count())
    along(Ints::load(sample + l), Lanes::load(rest + l), anchor).store(out + l);
}

template <class K, bool perturbed>
TAFONI_LANES_INLINE void add_one_to_block(const CloudView& cloud, std::uint32_t i, const Block& block) {
  const Primitives& prims = *cloud.primitives;
  const std::size_t width = lane_count();
  alignas(32) float dx[8], dy[8], dz[8];
  distances(block.x, block.xr, prims.x[i], dx);
  distances(block.y, block.yr, prims.y[i], dy);
  distances(block.z, block.zr, prims.z[i], dz);
  const Shape<K> shape = shape_of<K>(cloud, i);
  const LocalNoise noise(cloud.noise, prims.x[i], prims.y[i], prims.z[i]);
  const float reach2 = prims.reach[i] * prims.reach[i];
  const Lanes energy(prims.energy[i]);
  for (int k = 0; k < block.nz; ++k) {
    const float z2 = dz[k] * dz[k];
    if (z2 > reach2) continue;
    for (int j = 0; j < block.ny; ++j) {
      const float yz2 = z2 + dy[j] * dy[j];
      if (yz2 > reach2) continue;
      float* f = block.f + k * block.plane + j * block.row;
      for (std::size_t l = 0; l < 8; l += width) {
        const Lanes x = Lanes::load(dx + l);
        if constexpr (perturbed)
          if (hn::AllFalse(float_tag, x * x <= Lanes(reach2 - yz2))) continue;
        const Lanes t = closeness<K, perturbed, Lanes>({x, Lanes(dy[j]), Lanes(dz[k])}, shape, noise);
        mul_add(energy, t * t * t, Lanes::load(f + l)).store(f + l);
      }
    }
  }
}

template <class K>
void add_block(const CloudView& cloud, const std::uint32_t* list, std::size_t n, const Block& block) {
  if (cloud.noise.amplitude == 0)
    for (std::size_t m = 0; m < n; ++m) add_one_to_block<K, false>(cloud, list[m], block);
  else
    for (std::size_t m = 0; m < n; ++m) add_one_to_block<K, true>(cloud, list[m], block);
}

TAFONI_LANES_INLINE Vec3N<Lanes> relative(const PointLanes& p, std::size_t l, const Primitives& prims,
                                          std::uint32_t i) {
  return {along(Ints::load(p.x + l), Lanes::load(p.xr + l), prims.x[i]),
          along(Ints::load(p.y + l), Lanes::load(p.yr + l), prims.y[i]),
          along(Ints::load(p.z + l), Lanes::load(p.zr + l), prims.z[i])};
}

template <class K, bool perturbed>
TAFONI_LANES_INLINE void add_points_if(const CloudView& cloud, const std::uint32_t* list, std::size_t n,
                                       const PointLanes& p, float* f) {
  const Primitives& prims = *cloud.primitives;
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    Lanes sum = Lanes::load(f + l);
    for (std::size_t m = 0; m < n; ++m) {
      const std::uint32_t i = list[m];
      const LocalNoise noise(cloud.noise, prims.x[i], prims.y[i], prims.z[i]);
      const Lanes t = closeness<K, perturbed, Lanes>(relative(p, l, prims, i), shape_of<K>(cloud, i), noise);
      sum = mul_add(Lanes(prims.energy[i]), t * t * t, sum);
    }
    sum.store(f + l);
  }
}

template <class K>
void add_points(const CloudView& cloud, const std::uint32_t* list, std::size_t n, const PointLanes& p,
                float* f) {
  if (cloud.noise.amplitude == 0)
    add_points_if<K, false>(cloud, list, n, p, f);
  else
    add_points_if<K, true>(cloud, list, n, p, f);
}

template <class K, bool perturbed>
TAFONI_LANES_INLINE void add_gradients_if(const CloudView& cloud, const std::uint32_t* list, std::size_t n,
                                          const PointLanes& p, PointValues& out) {
  const Primitives& prims = *cloud.primitives;
  const Lanes one(1.f), zero(0.f);
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    Lanes v = Lanes::load(out.v + l), gx = Lanes::load(out.gx + l), gy = Lanes::load(out.gy + l),
          gz = Lanes::load(out.gz + l);
    for (std::size_t m = 0; m < n; ++m) {
      const std::uint32_t i = list[m];
      const LocalNoise noise(cloud.noise, prims.x[i], prims.y[i], prims.z[i]);
      const Vec3N<Lanes> d = relative(p, l, prims, i);
      const Vec3N<Dual> q{Dual(d.x, one, zero, zero), Dual(d.y, zero, one, zero), Dual(d.z, zero, zero, one)};
      const Dual t = closeness<K, perturbed, Dual>(q, shape_of<K>(cloud, i), noise);
      const Lanes energy(prims.energy[i]);
      v = mul_add(energy, t.v * t.v * t.v, v);
      const Lanes slope = energy * Lanes(3.f) * t.v * t.v;
      gx = mul_add(slope, t.x, gx);
      gy = mul_add(slope, t.y, gy);
      gz = mul_add(slope, t.z, gz);
    }
    v.store(out.v + l);
    gx.store(out.gx + l);
    gy.store(out.gy + l);
    gz.store(out.gz + l);
  }
}

template <class K>
void add_gradients(const CloudView& cloud, const std::uint32_t* list, std::size_t n, const PointLanes& p,
                   PointValues& out) {
  if (cloud.noise.amplitude == 0)
    add_gradients_if<K, false>(cloud, list, n, p, out);
  else
    add_gradients_if<K, true>(cloud, list, n, p, out);
}

template <class K>
void distance(const CloudView& cloud, std::uint32_t i, const PointLanes& p, float* out) {
  const Shape<K> shape = shape_of<K>(cloud, i);
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Vec3N<Lanes> o = shape.kind.offset(relative(p, l, *cloud.primitives, i));
    sqrt(dot(o, o)).store(out + l);
  }
}

template <class K>
PrimitiveKernels make_kernels() {
  return {&add_block<K>, &add_points<K>, &add_gradients<K>, &distance<K>};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#endif
