#include <cmath>

#include "tafoni/core/parallel.h"
#include "tafoni/terrain/analysis.h"
#include "tafoni/terrain/impl/stencil.h"

namespace tafoni::terrain {

raster::Grid<float> slope(const raster::Raster& heights, Progress& progress) {
  const int width = heights.width(), height = heights.height();
  raster::Grid<float> out(width, height, raster::no_data);
  progress.begin("slope", height, "rows");
  parallel_for(
      height,
      [&](int row) {
        for (int col = 0; col < width; ++col) {
          if (impl::missing(heights.values.at(col, row))) continue;
          const Vec2d g = impl::gradient(heights, col, row);
          out.at(col, row) = static_cast<float>(std::sqrt(g.x * g.x + g.y * g.y));
        }
      },
      progress);
  progress.end();
  return out;
}

}  // namespace tafoni::terrain
