#pragma once
// Low-discrepancy points in the unit square, spread over the picture so that what noise remains is fine and
// even: Owen-scrambled Sobol points walked along a space-filling curve of pixels [Ahmed20], with the
// hash of [Laine11] in the form of [Burley20].

#include <cstdint>

#include "tafoni/math/vec.h"

namespace tafoni::render::impl {

struct Point2 {
  float u, v;  ///< in [0, 1)
};

/// Each use of random numbers in a path has a stream of its own.
enum class Stream : std::uint32_t { pixel = 1, sun, sky, lamp, bounce_sun, bounce_sky, bounce_lamp, mirror };

class Sampler {
 public:
  /// Sample `sample` of `samples`, a power of two, in pixel (x, y).
  Sampler(std::uint32_t x, std::uint32_t y, std::uint32_t sample, std::uint32_t samples)
      : index_(interleave(x, y) * samples + sample) {}

  Point2 get(Stream stream) const {
    const auto s = static_cast<std::uint32_t>(stream);
    const std::uint32_t i = scramble(index_, mix(s));
    return {unit(scramble(reverse(i), mix(s + 77))), unit(scramble(sobol2(i), mix(s + 177)))};
  }

 private:
  static std::uint32_t reverse(std::uint32_t v) {
    v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
    v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
    v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
    return __builtin_bswap32(v);
  }
  /// A nested uniform scramble: permutes the halves, quarters … of [0, 2^32).
  static std::uint32_t scramble(std::uint32_t v, std::uint32_t seed) {
    v = reverse(v);
    v ^= v * 0x3d20adeau;
    v += seed;
    v *= (seed >> 16) | 1u;
    v ^= v * 0x05526c56u;
    v ^= v * 0x53a22864u;
    return reverse(v);
  }
  static std::uint32_t sobol2(std::uint32_t i) {
    std::uint32_t result = 0;
    for (std::uint32_t direction = 0x80000000u; i != 0; i >>= 1, direction ^= direction >> 1)
      if (i & 1u) result ^= direction;
    return result;
  }
  static std::uint32_t mix(std::uint32_t v) {
    v ^= v >> 16;
    v *= 0x7feb352du;
    v ^= v >> 15;
    v *= 0x846ca68bu;
    return v ^ (v >> 16);
  }
  static std::uint32_t spread(std::uint32_t v) {
    v &= 0xffffu;
    v = (v | (v << 8)) & 0x00ff00ffu;
    v = (v | (v << 4)) & 0x0f0f0f0fu;
    v = (v | (v << 2)) & 0x33333333u;
    return (v | (v << 1)) & 0x55555555u;
  }
  static std::uint32_t interleave(std::uint32_t x, std::uint32_t y) { return spread(x) | (spread(y) << 1); }
  static float unit(std::uint32_t v) { return static_cast<float>(v >> 8) * 0x1p-24f; }

  std::uint32_t index_;
};

/// Two unit vectors that make a right-handed frame with unit n [Duff17].
struct Frame {
  explicit Frame(Vec3f n) : z(n) {
    const float sign = std::copysign(1.0f, n.z);
    const float a = -1.0f / (sign + n.z), b = n.x * n.y * a;
    x = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    y = {b, sign + n.y * n.y * a, -n.y};
  }
  Vec3f at(float lx, float ly, float lz) const { return x * lx + y * ly + z * lz; }
  Vec3f x, y, z;
};

/// Cosine-weighted direction about n.
inline Vec3f cosine_direction(Vec3f n, Point2 p) {
  const float r = std::sqrt(p.u), phi = 6.2831853f * p.v;
  return Frame(n).at(r * std::cos(phi), r * std::sin(phi), std::sqrt(std::max(0.0f, 1 - p.u)));
}

/// A direction within a cone of small angle `radius` about unit d.
inline Vec3f cone_direction(Vec3f d, float radius, Point2 p) {
  const float r = radius * std::sqrt(p.u), phi = 6.2831853f * p.v;
  return normalized(Frame(d).at(r * std::cos(phi), r * std::sin(phi), 1));
}

}  // namespace tafoni::render::impl
