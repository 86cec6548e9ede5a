// Distances to the border of a mask, exactly: along columns, then along rows by the lower envelope of
// parabolas; and distances to rings, stamped edge by edge.

#include "tafoni/raster/distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tafoni/core/parallel.h"
#include "tafoni/math/whole.h"

namespace tafoni::raster {
namespace {

constexpr double infinity = std::numeric_limits<double>::infinity();

/// Vertical distance from each pixel's centre to the nearest box of the other kind in its column.
Grid<float> column_distances(const Grid<std::uint8_t>& mask, double dy, bool inside) {
  const int width = mask.width(), height = mask.height();
  Grid<float> out(width, height, std::numeric_limits<float>::infinity());
  const auto far = [&](int col, int row) { return (mask.at(col, row) != 0) == inside; };
  parallel_blocks(width, 64, [&](int first, int last) {
    std::vector<float> gap(last - first, std::numeric_limits<float>::infinity());
    const auto sweep = [&](int row) {
      for (int col = first; col < last; ++col) {
        float& rows = gap[col - first];
        rows = far(col, row) ? rows + 1 : 0;
        const float distance = rows > 0 ? (rows - 0.5f) * static_cast<float>(dy) : 0.0f;
        out.at(col, row) = std::min(out.at(col, row), distance);
      }
    };
    for (int row = 0; row < height; ++row) sweep(row);
    std::fill(gap.begin(), gap.end(), std::numeric_limits<float>::infinity());
    for (int row = height - 1; row >= 0; --row) sweep(row);
  });
  return out;
}

/// Lower envelope of parabolas along a row. A box reaches half a pixel to either side of its centre, so the
/// parabolas stand on the edges between pixels: edge e lies at e - 0.5.
class RowEnvelope {
 public:
  explicit RowEnvelope(int width) : edge_height_(width + 1), apex_(width + 1), from_(width + 2) {}

  void distances(const float* column, int width, double dx, float* out) {
    build(column, width, dx);
    std::size_t k = 0;
    for (int x = 0; x < width; ++x) {
      const double own = column[x];
      double best = own * own;
      if (count_ > 0) {
        while (k + 1 < count_ && from_[k + 1] < x) ++k;
        const double across = (x - apex_[k] + 0.5) * dx;
        best = std::min(best, across * across + edge_height_[apex_[k]]);
      }
      out[x] = static_cast<float>(std::sqrt(best));
    }
  }

 private:
  void build(const float* column, int width, double dx) {
    count_ = 0;
    for (int e = 0; e <= width; ++e) {
      double g = infinity;
      if (e > 0) g = column[e - 1];
      if (e < width) g = std::min<double>(g, column[e]);
      edge_height_[e] = g * g;
      if (g == infinity) continue;
      double start = -infinity;
      while (count_ > 0) {
        start = crossing(apex_[count_ - 1], e, dx);
        if (start > from_[count_ - 1]) break;
        --count_;
        start = -infinity;
      }
      apex_[count_] = e;
      from_[count_] = start;
      ++count_;
    }
  }
  /// Where the parabola of edge b comes below that of edge a < b, in pixels.
  double crossing(int a, int b, double dx) const {
    const double ha = edge_height_[a] / (dx * dx);
    const double hb = edge_height_[b] / (dx * dx);
    const double xa = a - 0.5, xb = b - 0.5;
    return ((hb + xb * xb) - (ha + xa * xa)) / (2 * (xb - xa));
  }

  std::vector<double> edge_height_;  ///< squared metres
  std::vector<int> apex_;
  std::vector<double> from_;
  std::size_t count_ = 0;
};

struct Edge {
  Vec2d a, b;
};

std::vector<Edge> edges_of(const std::vector<std::vector<Vec2d>>& rings) {
  std::vector<Edge> edges;
  for (const auto& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) edges.push_back({ring[i], ring[(i + 1) % ring.size()]});
  return edges;
}

/// 1 where the pixel's centre is inside by the even-odd rule.
Grid<std::uint8_t> even_odd(const std::vector<Edge>& edges, const Placement& placement, int width,
                            int height) {
  std::vector<std::vector<double>> crossings(height);
  for (const Edge& edge : edges) {
    const double top = placement.pixel(0, std::max(edge.a.y, edge.b.y)).y;
    const double bottom = placement.pixel(0, std::min(edge.a.y, edge.b.y)).y;
    const int first = std::max(ceil_to(std::clamp(top, 0.0, height + 1.0)) - 1, 0);
    const int last = std::min(floor_to(std::clamp(bottom, -2.0, 1.0 * height)) + 1, height - 1);
    for (int row = first; row <= last; ++row) {
      const double y = placement.center(0, row).y;
      if ((edge.a.y > y) == (edge.b.y > y)) continue;
      crossings[row].push_back(edge.a.x + (y - edge.a.y) / (edge.b.y - edge.a.y) * (edge.b.x - edge.a.x));
    }
  }
  Grid<std::uint8_t> mask(width, height);
  for (int row = 0; row < height; ++row) {
    auto& xs = crossings[row];
    std::sort(xs.begin(), xs.end());
    std::size_t passed = 0;
    for (int col = 0; col < width; ++col) {
      const double x = placement.center(col, row).x;
      while (passed < xs.size() && xs[passed] < x) ++passed;
      mask.at(col, row) = passed % 2;
    }
  }
  return mask;
}

double distance_to(const Edge& edge, Vec2d p) {
  const Vec2d along = edge.b - edge.a, to = p - edge.a;
  const double length2 = along.x * along.x + along.y * along.y;
  const double t = length2 > 0 ? std::clamp((to.x * along.x + to.y * along.y) / length2, 0.0, 1.0) : 0.0;
  const Vec2d off = to - along * t;
  return std::hypot(off.x, off.y);
}

/// Lowers `nearest` to the distance from `edge` at every pixel within `band` metres of it. Long edges are
/// walked in pieces so that a diagonal does not visit its whole bounding box.
void stamp(const Edge& edge, const Placement& placement, double band, Grid<float>& nearest) {
  const double length = std::hypot(edge.b.x - edge.a.x, edge.b.y - edge.a.y);
  const double piece = std::max(2 * band, 8 * std::max(placement.dx, placement.dy));
  const int pieces = ceil_to(std::clamp(length / piece, 1.0, 1e6));
  for (int i = 0; i < pieces; ++i) {
    const Edge part{edge.a + (edge.b - edge.a) * (1.0 * i / pieces),
                    edge.a + (edge.b - edge.a) * ((i + 1.0) / pieces)};
    const Vec2d lo =
        placement.pixel(std::min(part.a.x, part.b.x) - band, std::max(part.a.y, part.b.y) + band);
    const Vec2d hi =
        placement.pixel(std::max(part.a.x, part.b.x) + band, std::min(part.a.y, part.b.y) - band);
    const int left = ceil_to(std::clamp<double>(lo.x, 0, nearest.width()));
    const int right = floor_to(std::clamp<double>(hi.x, -1, nearest.width() - 1));
    const int top = ceil_to(std::clamp<double>(lo.y, 0, nearest.height()));
    const int bottom = floor_to(std::clamp<double>(hi.y, -1, nearest.height() - 1));
    for (int row = top; row <= bottom; ++row)
      for (int col = left; col <= right; ++col) {
        const auto d = static_cast<float>(distance_to(part, placement.center(col, row)));
        if (d <= static_cast<float>(band)) nearest.at(col, row) = std::min(nearest.at(col, row), d);
      }
  }
}

}  // namespace

Grid<float> signed_distance(const Grid<std::uint8_t>& mask, double dx, double dy, Progress& progress) {
  Grid<float> out(mask.width(), mask.height());
  progress.begin("distance", 2 * mask.height(), "rows");
  for (const bool inside : {true, false}) {
    const Grid<float> columns = column_distances(mask, dy, inside);
    constexpr std::int64_t rows_a_block = 16;
    parallel_blocks(mask.height(), rows_a_block, [&](int first, int last) {
      RowEnvelope envelope(mask.width());
      std::vector<float> distances(mask.width());
      for (int row = first; row < last; ++row) {
        envelope.distances(columns.row(row), mask.width(), dx, distances.data());
        for (int col = 0; col < mask.width(); ++col)
          if ((mask.at(col, row) != 0) == inside)
            out.at(col, row) = inside ? distances[col] : -distances[col];
        progress.advance();
      }
    });
  }
  progress.end();
  return out;
}

Grid<float> signed_distance(const std::vector<std::vector<Vec2d>>& rings, const Placement& placement,
                            int width, int height, double band, Progress& progress) {
  const std::vector<Edge> edges = edges_of(rings);
  const Grid<std::uint8_t> mask = even_odd(edges, placement, width, height);
  Grid<float> nearest(width, height, std::numeric_limits<float>::infinity());
  progress.begin("polygon distance", edges.size(), "edges");
  for (const Edge& edge : edges) {
    stamp(edge, placement, band, nearest);
    progress.advance();
  }
  progress.end();
  Grid<float> far = signed_distance(mask, placement.dx, placement.dy, progress);
  const auto beyond = static_cast<float>(band);
  for (std::size_t i = 0; i < far.size(); ++i) {
    const float d = nearest.values()[i];
    const float magnitude = std::isinf(d) ? std::max(std::abs(far.values()[i]), beyond) : d;
    far.values()[i] = mask.values()[i] ? magnitude : -magnitude;
  }
  return far;
}

}  // namespace tafoni::raster
