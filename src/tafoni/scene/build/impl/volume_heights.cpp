// A volume's columns of samples are walked from the top down, a column of chunks at a time, to the first
// rock; between the last air and the first rock the surface is found by linear interpolation. A pixel stands
// for a column of cells and takes the highest of its four corners.
#include "tafoni/scene/build/impl/volume_heights.h"

#include <algorithm>
#include <vector>

#include "tafoni/core/parallel.h"
#include "tafoni/io/inner/pixel_memory.h"
#include "tafoni/io/volume_file.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::scene::impl {
namespace {

using volume::ScalarGrid;

/// Grids of heights that are alive together until there is a terrain: of the columns, of the pixels made of
/// them, and two of the terrain's own.
constexpr double grids_at_once = 4;

/// Elevations of the highest surface along columns of samples, from the top down.
class Tops {
 public:
  explicit Tops(const ScalarGrid& grid) : grid_(grid), frame_(grid.frame()) {}

  /// For the columns of samples of chunk column (a, b), out[y * nx + x]: local z, the floor where there is
  /// none.
  void find(int a, int b, std::vector<double>& out) {
    constexpr int side = ScalarGrid::chunk_samples;
    const Vec3i n = frame_.size;
    volume::SampleBox box{{a * side, b * side, 0},
                          {std::min(a * side + side, n.x) - 1, std::min(b * side + side, n.y) - 1, 0}};
    const std::ptrdiff_t columns = std::ptrdiff_t{box.size().x} * box.size().y;
    out.assign(columns, frame_.origin.z);
    above_.assign(columns, -1);
    found_.assign(columns, 0);
    std::ptrdiff_t left = columns;
    for (int c = grid_.chunks().z - 1; c >= 0 && left > 0; --c) {
      float same = 0;
      if (grid_.uniform({a, b, c}, &same) && same <= 0) {
        above_.assign(columns, same);
        continue;
      }
      box.lo.z = c * side, box.hi.z = std::min(c * side + side, n.z) - 1;
      samples_.resize(columns * box.size().z);
      grid_.read(box, samples_.data());
      for (int z = box.hi.z; z >= box.lo.z && left > 0; --z)
        left -= level(z, samples_.data() + columns * (z - box.lo.z), out);
    }
  }

 private:
  /// Finds the columns whose first rock is at this level, and returns how many they are.
  std::ptrdiff_t level(int z, const float* samples, std::vector<double>& out) {
    std::ptrdiff_t found = 0;
    for (std::size_t i = 0; i < out.size(); ++i) {
      const float v = samples[i];
      if (!found_[i] && v > 0) {
        const double t = z == frame_.size.z - 1 ? 0 : double{v} / (v - above_[i]);
        out[i] = frame_.origin.z + frame_.spacing * (z + t);
        found_[i] = 1;
        ++found;
      }
      above_[i] = v;
    }
    return found;
  }

  const ScalarGrid& grid_;
  volume::GridFrame frame_;
  std::vector<float> samples_, above_;
  std::vector<std::uint8_t> found_;
};

}  // namespace

raster::Raster heights_of(const io::Volume& volume, std::string_view file) {
  const ScalarGrid& grid = volume.grid;
  const volume::GridFrame& frame = grid.frame();
  const Vec3i n = frame.size;
  io::inner::check_pixels(1.0 * n.x * n.y, grids_at_once, file,
                          "make the volume at a larger spacing or cut a part from it");
  raster::Grid<float> columns(n.x, n.y);
  const Vec3i chunks = grid.chunks();
  parallel_for(std::int64_t{chunks.x} * chunks.y, [&](std::int64_t index) {
    const int a = static_cast<int>(index % chunks.x), b = static_cast<int>(index / chunks.x);
    std::vector<double> tops;
    Tops(grid).find(a, b, tops);
    constexpr int side = ScalarGrid::chunk_samples;
    const int width = std::min(side, n.x - a * side);
    for (int i = 0; i < std::ssize(tops); ++i)
      columns.at(a * side + i % width, b * side + i / width) = static_cast<float>(tops[i] + volume.origin.z);
  });
  raster::Raster out;
  out.crs = volume.metadata.crs;
  const Vec3d west_south = volume.origin + frame.origin;
  out.placement = {west_south.x, west_south.y + frame.spacing * (n.y - 1), frame.spacing, frame.spacing};
  out.values = raster::Grid<float>(n.x - 1, n.y - 1);
  for (int row = 0; row < n.y - 1; ++row)
    for (int col = 0; col < n.x - 1; ++col) {
      const int y = n.y - 2 - row;
      out.values.at(col, row) = std::max(std::max(columns.at(col, y), columns.at(col + 1, y)),
                                         std::max(columns.at(col, y + 1), columns.at(col + 1, y + 1)));
    }
  return out;
}

}  // namespace tafoni::scene::impl
