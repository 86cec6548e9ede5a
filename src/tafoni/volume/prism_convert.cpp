// Prism-fields from boxes, heightfields, grids and fields. Of grids and fields each column's tops and
// bottoms are the changes of sign along it; for fields their places are then refined by halving.

#include "tafoni/volume/prism_convert.h"

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/volume/sample.h"

namespace tafoni::volume {

namespace {

/// Columns of a grid: where along z the sign changes, sample by sample.
class Crossings {
 public:
  explicit Crossings(const ScalarGrid& grid) : grid_(grid), size_(grid.frame().size) {}

  /// Crossing k lies between samples k and k + 1 of its column.
  struct Crossing {
    int i, k;
    double z;  ///< samples up
    bool bottom;
  };
  /// Of row j, by i, then k. Zero is air.
  std::vector<Crossing> row(int j) const {
    const std::size_t nx = size_.x, nz = size_.z;
    std::vector<float> values(nx * nz);
    grid_.read({{0, j, 0}, {size_.x - 1, j, size_.z - 1}}, values.data());
    std::vector<Crossing> out;
    for (int i = 0; i < size_.x; ++i)
      for (int k = -1; k < size_.z; ++k) {
        const auto at = [&](int z) -> double { return values[z * nx + i]; };
        const bool below = k >= 0 && at(k) > 0, above = k + 1 < size_.z && at(k + 1) > 0;
        if (below == above) continue;
        double z = k < 0 ? 0 : k;
        if (k >= 0 && k + 1 < size_.z) z += at(k) / (at(k) - at(k + 1));
        out.push_back({i, k, z, above});
      }
    return out;
  }
  bool cut(const Crossing& c) const { return c.k < 0 || c.k + 1 == size_.z; }

 private:
  const ScalarGrid& grid_;
  Vec3i size_;
};

ColumnFrame columns_of(const GridFrame& frame) {
  return {frame.origin, frame.spacing, frame.spacing, frame.size.x, frame.size.y};
}

/// Halves the brackets of the roots, all of a row at once.
void refine(const field::CompiledField& field, const GridFrame& frame, const Crossings& crossings, int j,
            std::vector<Crossings::Crossing>& row) {
  constexpr int halvings = 10;
  std::vector<double> lo, hi;
  std::vector<std::size_t> open;
  for (std::size_t n = 0; n < row.size(); ++n) {
    if (crossings.cut(row[n])) continue;
    open.push_back(n);
    lo.push_back(row[n].k);
    hi.push_back(row[n].k + 1);
  }
  std::vector<Vec3d> points(open.size());
  std::vector<float> values(open.size());
  for (int step = 0; step < halvings && !open.empty(); ++step) {
    for (std::size_t n = 0; n < open.size(); ++n)
      points[n] = frame.origin + Vec3d{1.0 * row[open[n]].i, 1.0 * j, 0.5 * (lo[n] + hi[n])} * frame.spacing;
    field.values(points, values);
    for (std::size_t n = 0; n < open.size(); ++n) {
      const double middle = 0.5 * (lo[n] + hi[n]);
      ((values[n] > 0) == row[open[n]].bottom ? hi[n] : lo[n]) = middle;
    }
  }
  for (std::size_t n = 0; n < open.size(); ++n) row[open[n]].z = 0.5 * (lo[n] + hi[n]);
}

PrismFields from_rows(const ScalarGrid& grid, const field::CompiledField* field, Progress& progress) {
  const GridFrame& frame = grid.frame();
  const Crossings crossings(grid);
  std::vector<std::vector<Crossings::Crossing>> rows(frame.size.y);
  progress.begin("finding tops and bottoms", rows.size(), "rows");
  parallel_for(
      frame.size.y,
      [&](int j) {
        auto& row = rows[j];
        row = crossings.row(j);
        if (field) refine(*field, frame, crossings, j, row);
      },
      progress);
  progress.end();
  PrismFields out(columns_of(frame));
  std::vector<Matter> matter;
  for (int j = 0; j < frame.size.y; ++j) {
    const auto& row = rows[j];
    for (std::size_t n = 0; n < row.size();) {
      matter.clear();
      const int i = row[n].i;
      for (; n < row.size() && row[n].i == i; n += 2) {
        const Matter m{static_cast<float>(row[n].z * frame.spacing),
                       static_cast<float>(row[n + 1].z * frame.spacing)};
        if (!matter.empty() && m.bottom <= matter.back().top)
          matter.back().top = m.top;
        else
          matter.push_back(m);
      }
      out.set_column(i, j, matter);
    }
  }
  return out;
}

}  // namespace

PrismFields prism_box(const ColumnFrame& frame, double bottom, double top) {
  PrismFields out(frame);
  const Matter all{static_cast<float>(bottom - frame.origin.z), static_cast<float>(top - frame.origin.z)};
  for (int j = 0; j < frame.ny; ++j)
    for (int i = 0; i < frame.nx; ++i) out.set_column(i, j, {&all, 1});
  return out;
}

PrismFields prism_from(const raster::Raster& heights, double base) {
  if (heights.width() < 2 || heights.height() < 2)
    fail(ErrorKind::usage, "a prism-field needs 2 x 2 pixels of ground; this has {} x {}", heights.width(),
         heights.height());
  const Vec2d corner = heights.placement.center(0, heights.height() - 1);
  PrismFields out({{corner.x, corner.y, base},
                   heights.placement.dx,
                   heights.placement.dy,
                   heights.width(),
                   heights.height()});
  for (int j = 0; j < heights.height(); ++j)
    for (int i = 0; i < heights.width(); ++i) {
      const double top = heights.values.at(i, heights.height() - 1 - j) - base;
      if (!(top > 0)) continue;
      const Matter all{0, static_cast<float>(top)};
      out.set_column(i, j, {&all, 1});
    }
  return out;
}

PrismFields prism_from(const ScalarGrid& grid) {
  return from_rows(grid, nullptr, silent());
}

PrismFields prism_from(const field::CompiledField& field, const Box3d& box, double spacing,
                       Progress& progress) {
  SampleSettings settings;
  settings.band = 4 * spacing;
  return from_rows(sample(field, frame_over(box, spacing), settings, progress), &field, progress);
}

}  // namespace tafoni::volume
