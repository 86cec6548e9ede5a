// From light to picture: an edge-avoiding filter calms the noisy part of the light, then a filmic curve
// and sRGB make bytes of it.

#include "tafoni/render/impl/film.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/render/impl/light.h"

namespace tafoni::render::impl {
namespace {

/// One pass of the filter with holes of `step` pixels between its 5 x 5 taps.
void filter_pass(const Film& film, const View& view, const std::vector<Vec3f>& in, std::vector<Vec3f>& out,
                 int step) {
  static constexpr float kernel[3] = {0.375f, 0.25f, 0.0625f};
  const float pixel = 2 * length(view.up) / static_cast<float>(view.height);
  parallel_for(film.height(), [&](int y) {
    for (int x = 0; x < film.width(); ++x) {
      const Pixel& here = film.at(x, y);
      const std::size_t at = film.index(x, y);
      if (here.depth <= 0) {
        out[at] = in[at];
        continue;
      }
      const auto point = [&](int c, int r) { return view.through(c, r) * film.at(c, r).depth; };
      const Vec3f p = point(x, y), n = normalized(here.normal);
      const float reach = pixel * here.depth * static_cast<float>(step);
      Vec3f sum;
      float total = 0;
      for (int dy = -2; dy <= 2; ++dy)
        for (int dx = -2; dx <= 2; ++dx) {
          const int c = x + dx * step, r = y + dy * step;
          if (!film.inside(c, r) || film.at(c, r).depth <= 0) continue;
          const float facing = std::max(0.0f, dot(n, normalized(film.at(c, r).normal)));
          const float off_plane = dot(n, point(c, r) - p) / reach;
          const float f2 = facing * facing, f8 = f2 * f2 * f2 * f2;
          const float w = kernel[std::abs(dx)] * kernel[std::abs(dy)] * f8 * f8 / (1 + off_plane * off_plane);
          sum += in[film.index(c, r)] * w;
          total += w;
        }
      out[at] = total > 1e-6f ? sum * (1 / total) : in[at];
    }
  });
}

/// Chosen by eye: at an exposure of 1 sunlit rock comes out a little above middle grey.
constexpr float mid_grey_gain = 0.49f;

/// The ACES curve as K. Narkowicz fitted it (2015).
float filmic(float x) {
  return std::clamp(x * (2.51f * x + 0.03f) / (x * (2.43f * x + 0.59f) + 0.14f), 0.0f, 1.0f);
}

std::uint8_t srgb8(float linear) {
  const float s = linear <= 0.0031308f ? 12.92f * linear : 1.055f * std::pow(linear, 1 / 2.4f) - 0.055f;
  return static_cast<std::uint8_t>(std::clamp(s, 0.0f, 1.0f) * 255 + 0.5f);
}

}  // namespace

void denoise(Film& film, const View& view) {
  std::vector<Vec3f> a(film.size()), b(film.size());
  for (std::size_t i = 0; i < film.size(); ++i) a[i] = film.values()[i].light;
  filter_pass(film, view, a, b, 1);
  filter_pass(film, view, b, a, 2);
  for (std::size_t i = 0; i < film.size(); ++i) {
    Pixel& pixel = film.values()[i];
    const Vec3f mended = pixel.color + times(pixel.weight, a[i] - pixel.light);
    pixel.color = {std::max(mended.x, 0.0f), std::max(mended.y, 0.0f), std::max(mended.z, 0.0f)};
  }
}

raster::Image develop(const Film& film, double exposure) {
  raster::Image image(film.width(), film.height());
  const float gain = mid_grey_gain * static_cast<float>(exposure);
  parallel_blocks(std::ssize(film), 16384, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const Vec3f c = film.values()[i].color * gain;
      image.values()[i] = {srgb8(filmic(c.x)), srgb8(filmic(c.y)), srgb8(filmic(c.z)), 255};
    }
  });
  return image;
}

}  // namespace tafoni::render::impl
