// Counts the cubes of a lattice that lie inside: of a field by its values, whole blocks at once where its
// interval allows, of a mesh by sorting where lines along z cross it.

#include "tafoni/mesh/cubes.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/math/whole.h"

namespace tafoni::mesh {
namespace {

Vec3d to_vec(std::int64_t i, std::int64_t j, std::int64_t k) {
  return {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
}

/// Samples along an axis are counted by 31 bits, as the header promises.
constexpr double greatest_index = 2147483647.0;

/// Lattice indices of the samples in a range.
struct Span {
  std::int64_t first, last;
  Span(double lo, double hi, double edge) {
    const double a = std::floor(lo / edge), b = std::ceil(hi / edge);
    if (!(a > -greatest_index && b < greatest_index))
      fail(ErrorKind::usage, "cubes of {} m are too small for the solid; count larger ones", edge);
    first = static_cast<std::int64_t>(a);
    last = static_cast<std::int64_t>(b);
  }
  std::int64_t cubes() const { return last - first; }
};

/// Cubes a side that are judged at once by the interval of the field over them.
constexpr std::int64_t block = 8;

/// Cubes of one block all of whose corners are positive.
std::uint64_t count_block(const field::CompiledField& field, const Vec3d& low, const std::int64_t (&n)[3],
                          double edge, std::vector<Vec3d>& points, std::vector<float>& values) {
  points.clear();
  for (std::int64_t k = 0; k <= n[2]; ++k)
    for (std::int64_t j = 0; j <= n[1]; ++j)
      for (std::int64_t i = 0; i <= n[0]; ++i) points.push_back(low + to_vec(i, j, k) * edge);
  values.resize(points.size());
  field.values(points, values);
  const auto inside = [&](std::int64_t i, std::int64_t j, std::int64_t k) {
    return values[(k * (n[1] + 1) + j) * (n[0] + 1) + i] > 0;
  };
  std::uint64_t count = 0;
  for (std::int64_t k = 0; k < n[2]; ++k)
    for (std::int64_t j = 0; j < n[1]; ++j)
      for (std::int64_t i = 0; i < n[0]; ++i) {
        bool all = true;
        for (int c = 0; c < 8 && all; ++c) all = inside(i + (c & 1), j + (c >> 1 & 1), k + (c >> 2));
        count += all;
      }
  return count;
}

/// Crossings of the lines through lattice columns with the mesh: one list a column.
struct Columns {
  Span x, y;
  std::vector<std::vector<float>> crossings;
  std::vector<float>& at(std::int64_t i, std::int64_t j) {
    return crossings[(j - y.first) * (x.last - x.first + 1) + i - x.first];
  }
};

/// Where the lattice stands, in cubes: 2 - golden ratio, sqrt(2) - 1, sqrt(5) - 2, which no mesh on a lattice
/// meets.
constexpr Vec3d off{0.3819660113, 0.4142135624, 0.2360679775};

void cross_triangle(const Vec3d (&p)[3], Columns& columns, const Progress& progress) {
  const double lo_x = std::min({p[0].x, p[1].x, p[2].x}), hi_x = std::max({p[0].x, p[1].x, p[2].x});
  const double lo_y = std::min({p[0].y, p[1].y, p[2].y}), hi_y = std::max({p[0].y, p[1].y, p[2].y});
  const Vec3d n = cross(p[1] - p[0], p[2] - p[0]);
  if (n.z == 0) return;
  for (auto j = ceil_to<std::int64_t>(lo_y); static_cast<double>(j) <= hi_y; ++j) {
    progress.check();
    for (auto i = ceil_to<std::int64_t>(lo_x); static_cast<double>(i) <= hi_x; ++i) {
      const Vec3d q = to_vec(i, j, 0);
      bool within = true;
      for (std::size_t c = 0; c < 3 && within; ++c) {
        // Both triangles of an edge judge it by the same numbers, in the same order.
        const Vec3d &a = p[c], &b = p[(c + 1) % 3];
        const bool turned = a.y > b.y || (a.y == b.y && a.x > b.x);
        const Vec3d &low = turned ? b : a, &high = turned ? a : b;
        const double side = (high.x - low.x) * (q.y - low.y) - (high.y - low.y) * (q.x - low.x);
        within = (side > 0) == ((n.z > 0) != turned);
      }
      if (!within) continue;
      columns.at(i, j).push_back(
          static_cast<float>(p[0].z - (n.x * (q.x - p[0].x) + n.y * (q.y - p[0].y)) / n.z));
    }
  }
}

}  // namespace

Cubes inside_cubes(const field::CompiledField& field, const Box3d& box, double edge, Progress& progress) {
  Cubes out{edge, 0};
  if (box.empty()) return out;
  const Span x(box.lo.x, box.hi.x, edge), y(box.lo.y, box.hi.y, edge), z(box.lo.z, box.hi.z, edge);
  const auto blocks = [](const Span& s) { return (s.cubes() + block - 1) / block; };
  const std::int64_t rows = blocks(y) * blocks(z);
  std::vector<std::uint64_t> counts(rows, 0);
  progress.begin("counting cubes", rows, "rows");
  parallel_for(
      rows,
      [&](std::int64_t row) {
        std::vector<Vec3d> points;
        std::vector<float> values;
        const std::int64_t j = y.first + row % blocks(y) * block, k = z.first + row / blocks(y) * block;
        for (std::int64_t i = x.first; i < x.last; i += block) {
          const std::int64_t n[3] = {std::min(block, x.last - i), std::min(block, y.last - j),
                                     std::min(block, z.last - k)};
          const Vec3d low = to_vec(i, j, k) * edge;
          const Vec3d high = low + to_vec(n[0], n[1], n[2]) * edge;
          const Interval range = field.interval({low, high});
          auto& count = counts[row];
          if (range.hi <= 0) continue;
          count += range.lo > 0 ? static_cast<std::uint64_t>(n[0] * n[1] * n[2])
                                : count_block(field, low, n, edge, points, values);
        }
      },
      progress);
  progress.end();
  progress.check();
  for (const std::uint64_t count : counts) out.count += count;
  return out;
}

Cubes inside_cubes(const Mesh& mesh, double edge, Progress& progress) {
  Cubes out{edge, 0};
  Box3d box;
  for (const Vec3f& p : mesh.positions) box.expand(to_double(p));
  if (box.empty()) return out;
  box = box.grown(2 * edge);
  Columns columns{{box.lo.x, box.hi.x, edge}, {box.lo.y, box.hi.y, edge}, {}};
  const Span z(box.lo.z, box.hi.z, edge);
  const std::int64_t width = columns.x.cubes() + 1, height = columns.y.cubes() + 1, layers = z.cubes() + 1;
  constexpr std::int64_t most_columns = 1 << 24, most_in_row = 1 << 29, most_cubes = 1ll << 36;
  if (width > most_columns / height || width > most_in_row / layers || width * height > most_cubes / layers)
    fail(ErrorKind::usage, "cubes of {} m are too small for the mesh; count larger ones", edge);
  columns.crossings.resize(width * height);
  progress.begin("crossing triangles", mesh.triangles.size(), "triangles");
  for (const auto& t : mesh.triangles) {
    progress.advance();
    if (std::max({t[0], t[1], t[2]}) >= mesh.positions.size()) continue;
    Vec3d p[3];
    for (std::size_t c = 0; c < 3; ++c) p[c] = to_double(mesh.positions[t[c]]) * (1 / edge) - off;
    cross_triangle(p, columns, progress);
  }
  for (auto& list : columns.crossings) std::sort(list.begin(), list.end());
  progress.end();

  // Two rows of columns at a time, inside or not at each layer.
  std::vector<std::uint8_t> before, here;
  const auto fill = [&](std::int64_t j, std::vector<std::uint8_t>& row) {
    row.assign(width * layers, 0);
    for (std::int64_t i = 0; i < width; ++i) {
      const auto& list = columns.at(columns.x.first + i, columns.y.first + j);
      std::size_t next = 0;
      for (std::int64_t k = 0; k < layers; ++k) {
        while (next < list.size() && list[next] < static_cast<float>(z.first + k)) ++next;
        row[i * layers + k] = next % 2;
      }
    }
  };
  progress.begin("counting cubes", height, "rows");
  fill(0, here);
  for (std::int64_t j = 1; j < height; ++j) {
    progress.check();
    std::swap(before, here);
    fill(j, here);
    for (std::int64_t i = 0; i + 1 < width; ++i)
      for (std::int64_t k = 0; k + 1 < layers; ++k) {
        const std::int64_t a = i * layers + k, b = a + layers;
        out.count += (before[a] & before[a + 1] & before[b] & before[b + 1] & here[a] & here[a + 1] &
                      here[b] & here[b + 1]);
      }
    progress.advance();
  }
  progress.end();
  return out;
}

}  // namespace tafoni::mesh
