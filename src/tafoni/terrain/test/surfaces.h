#pragma once
// Small terrains for tests.

#include <cstdint>
#include <functional>

#include "tafoni/core/random.h"
#include "tafoni/raster/sampled.h"

namespace tafoni::terrain {

/// h(x, y) at the pixel centres, x east and y north of the south-west corner.
inline raster::Raster surface(int width, int height, double dx, double dy,
                              const std::function<double(double, double)>& h) {
  return raster::sampled(width, height, {0, height * dy, dx, dy}, h);
}

/// Random heights; `steps` > 0 rounds them so that flats and ties occur. A share of cells is missing.
inline raster::Raster rough(int width, int height, std::uint64_t seed, int steps = 0, double holes = 0) {
  Random random(seed);
  return surface(width, height, 1, 1, [&](double x, double y) {
    double h = 10 * random.uniform() + 0.1 * x + 0.05 * y;
    if (steps > 0) h = std::trunc(h * steps / 10) * 10 / steps;
    return random.uniform() < holes ? raster::no_data : h;
  });
}

}  // namespace tafoni::terrain
