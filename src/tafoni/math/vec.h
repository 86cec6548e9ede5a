#pragma once
// Small fixed vectors and boxes. Metres; z up, x east, y north, right-handed.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace tafoni {

template <class T>
struct Vec2 {
  T x{}, y{};
  friend constexpr Vec2 operator+(Vec2 a, Vec2 b) { return {a.x + b.x, a.y + b.y}; }
  friend constexpr Vec2 operator-(Vec2 a, Vec2 b) { return {a.x - b.x, a.y - b.y}; }
  friend constexpr Vec2 operator*(Vec2 a, T s) { return {a.x * s, a.y * s}; }
  friend constexpr bool operator==(Vec2, Vec2) = default;
};

template <class T>
struct Vec3 {
  T x{}, y{}, z{};
  friend constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
  friend constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
  friend constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
  friend constexpr Vec3 operator*(Vec3 a, T s) { return {a.x * s, a.y * s, a.z * s}; }
  friend constexpr Vec3 operator*(T s, Vec3 a) { return a * s; }
  friend constexpr bool operator==(Vec3, Vec3) = default;
  Vec3& operator+=(Vec3 b) { return *this = *this + b; }
  Vec3& operator-=(Vec3 b) { return *this = *this - b; }
};

using Vec2d = Vec2<double>;
using Vec3d = Vec3<double>;
using Vec3f = Vec3<float>;
using Vec3i = Vec3<std::int32_t>;

template <class T>
constexpr T dot(Vec3<T> a, Vec3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
constexpr Vec3<T> cross(Vec3<T> a, Vec3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
inline T length(Vec3<T> a) {
  return std::sqrt(dot(a, a));
}
/// Zero stays zero.
template <class T>
inline Vec3<T> normalized(Vec3<T> a) {
  const T l = length(a);
  return l > T(0) ? a * (T(1) / l) : a;
}
inline Vec3f to_float(Vec3d a) {
  return {static_cast<float>(a.x), static_cast<float>(a.y), static_cast<float>(a.z)};
}
inline Vec3d to_double(Vec3f a) {
  return {a.x, a.y, a.z};
}
constexpr Vec3d to_double(Vec3i a) {
  return {static_cast<double>(a.x), static_cast<double>(a.y), static_cast<double>(a.z)};
}

/// How many samples a lattice of n.x by n.y by n.z has.
constexpr std::size_t sample_count(Vec3i n) {
  return static_cast<std::size_t>(n.x) * n.y * n.z;
}
/// Where sample `at` of such a lattice lies in an array of all: x runs fastest, then y.
constexpr std::size_t sample_index(Vec3i n, Vec3i at) {
  return (static_cast<std::size_t>(at.z) * n.y + at.y) * n.x + at.x;
}

/// Axis-aligned closed box; the default is empty and absorbs points by expand().
template <class T>
struct Box3 {
  Vec3<T> lo{std::numeric_limits<T>::max(), std::numeric_limits<T>::max(), std::numeric_limits<T>::max()};
  Vec3<T> hi{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::lowest(),
             std::numeric_limits<T>::lowest()};

  static constexpr Box3 everything() {
    constexpr T far = std::numeric_limits<T>::infinity();
    return {{-far, -far, -far}, {far, far, far}};
  }
  constexpr bool empty() const { return lo.x > hi.x || lo.y > hi.y || lo.z > hi.z; }
  /// No side at infinity.
  bool bounded() const {
    return std::isfinite(lo.x) && std::isfinite(lo.y) && std::isfinite(lo.z) && std::isfinite(hi.x) &&
           std::isfinite(hi.y) && std::isfinite(hi.z);
  }
  constexpr bool contains(Vec3<T> p) const {
    return p.x >= lo.x && p.x <= hi.x && p.y >= lo.y && p.y <= hi.y && p.z >= lo.z && p.z <= hi.z;
  }
  constexpr bool overlaps(const Box3& b) const {
    return lo.x <= b.hi.x && b.lo.x <= hi.x && lo.y <= b.hi.y && b.lo.y <= hi.y && lo.z <= b.hi.z &&
           b.lo.z <= hi.z;
  }
  constexpr void expand(Vec3<T> p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  constexpr void expand(const Box3& b) {
    if (b.empty()) return;
    expand(b.lo);
    expand(b.hi);
  }
  constexpr Box3 grown(T by) const {
    return {{lo.x - by, lo.y - by, lo.z - by}, {hi.x + by, hi.y + by, hi.z + by}};
  }
  constexpr Vec3<T> center() const { return (lo + hi) * T(0.5); }
  constexpr Vec3<T> size() const { return hi - lo; }
};
using Box3d = Box3<double>;
using Box3f = Box3<float>;

/// A closed range of values that encloses what it bounds.
struct Interval {
  float lo = 0, hi = 0;
  bool contains(float v) const { return lo <= v && v <= hi; }
  friend Interval operator+(Interval a, Interval b) { return {a.lo + b.lo, a.hi + b.hi}; }
};

}  // namespace tafoni
