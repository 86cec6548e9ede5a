// Pieces that several kinds' skeletons are made of. See math/lanes-inl.h for the toggle.
#if defined(TAFONI_FIELD_IMPL_SKELETON_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef TAFONI_FIELD_IMPL_SKELETON_INL_H_
#undef TAFONI_FIELD_IMPL_SKELETON_INL_H_
#else
#define TAFONI_FIELD_IMPL_SKELETON_INL_H_
#endif

#include <cmath>
#include <numbers>

#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

/// Below this a length has no direction, metres.
inline constexpr float no_length = 1e-10f;

/// From the nearest point of the segment that leads from the origin to `end`, to p.
template <class N>
TAFONI_LANES_INLINE Vec3N<N> from_segment(const Vec3N<N>& p, Vec3f end) {
  const float length2 = end.x * end.x + end.y * end.y + end.z * end.z;
  const Vec3N<N> axis = broadcast<N>(end);
  const N along = dot(p, axis) * N(1.f / std::max(length2, no_length * no_length));
  return p - axis * min(max(along, N(0.f)), N(1.f));
}

template <class N>
TAFONI_LANES_INLINE Vec3N<N> select(Mask m, const Vec3N<N>& a, const Vec3N<N>& b) {
  return {select(m, a.x, b.x), select(m, a.y, b.y), select(m, a.z, b.z)};
}

/// The shortest of several offsets.
template <class N>
struct Shortest {
  Vec3N<N> offset;
  N length2;
  TAFONI_LANES_INLINE explicit Shortest(const Vec3N<N>& first) : offset(first), length2(dot(first, first)) {}
  TAFONI_LANES_INLINE void offer(const Vec3N<N>& other) {
    const N other2 = dot(other, other);
    const Mask shorter = other2 < length2;
    offset = select(shorter, other, offset);
    length2 = select(shorter, other2, length2);
  }
};

/// The axis of a body of revolution, from the anchor along `unit`; upwards where no direction is given.
struct Axis {
  Vec3f unit{0, 0, 1};
  float length = 0;
  explicit Axis(const float* to) : length(std::sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2])) {
    if (length > no_length) unit = Vec3f{to[0], to[1], to[2]} * (1 / length);
  }
};

/// p in the cylindrical coordinates of an axis.
template <class N>
struct Cylindrical {
  Vec3N<N> axis, across;  ///< across leads from the axis to p
  N along, radius;
  TAFONI_LANES_INLINE Cylindrical(const Vec3N<N>& p, const Axis& a)
      : axis(broadcast<N>(a.unit)), across(p), along(dot(p, axis)), radius(0.f) {
    across = p - axis * along;
    radius = sqrt(dot(across, across));
  }
  /// The vector with these components; outwards is away from the axis.
  TAFONI_LANES_INLINE Vec3N<N> vector(const N& outwards, const N& upwards) const {
    return across * (outwards / max(radius, N(no_length))) + axis * upwards;
  }
};

/// A turn about z, counter-clockwise from above.
struct Turn {
  float cosine, sine;
  explicit Turn(float degrees)
      : cosine(std::cos(degrees * std::numbers::pi_v<float> / 180)),
        sine(std::sin(degrees * std::numbers::pi_v<float> / 180)) {}
  /// From the scene's axes to the body's, and back.
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> to_body(const Vec3N<N>& p) const {
    return {p.x * N(cosine) + p.y * N(sine), p.y * N(cosine) - p.x * N(sine), p.z};
  }
  template <class N>
  TAFONI_LANES_INLINE Vec3N<N> to_scene(const Vec3N<N>& p) const {
    return {p.x * N(cosine) - p.y * N(sine), p.y * N(cosine) + p.x * N(sine), p.z};
  }
};

template <class N>
TAFONI_LANES_INLINE N clamp(const N& v, const N& lo, const N& hi) {
  return min(max(v, lo), hi);
}
template <class N>
TAFONI_LANES_INLINE N magnitude(const N& v) {
  return max(v, -v);
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#endif
