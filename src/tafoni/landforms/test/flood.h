#pragma once
// Connected pieces of rock or of air on a lattice: brute force, for small sites.

#include <vector>

#include "tafoni/landforms/test/site.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::test {

struct Piece {
  std::size_t cells = 0;
  bool at_rim = false;  ///< reaches the side of the box
  Vec3d first;          ///< one of its cells
};

/// 6-connected pieces of lattice points that are solid (or air).
inline std::vector<Piece> pieces(const field::CompiledField& field, const Box3d& box, double step,
                                 bool solid) {
  const auto count = [&](double lo, double hi) { return floor_to((hi - lo) / step) + 1; };
  const int nx = count(box.lo.x, box.hi.x), ny = count(box.lo.y, box.hi.y), nz = count(box.lo.z, box.hi.z);
  std::vector<Vec3d> points;
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i) points.push_back(box.lo + to_double(Vec3i{i, j, k}) * step);
  const auto f = values(field, points);
  std::vector<bool> open(points.size());
  for (std::size_t n = 0; n < open.size(); ++n) open[n] = (f[n] > 0) == solid;
  std::vector<Piece> found;
  std::vector<std::size_t> stack;
  for (std::size_t start = 0; start < open.size(); ++start) {
    if (!open[start]) continue;
    Piece piece;
    piece.first = points[start];
    stack.push_back(start);
    open[start] = false;
    while (!stack.empty()) {
      const std::size_t n = stack.back();
      stack.pop_back();
      ++piece.cells;
      const auto [i, j, k] = sample_at({nx, ny, nz}, n);
      piece.at_rim |= i == 0 || j == 0 || k == 0 || i + 1 == nx || j + 1 == ny || k + 1 == nz;
      const auto visit = [&](bool within, std::size_t to) {
        if (!within || !open[to]) return;
        open[to] = false;
        stack.push_back(to);
      };
      visit(i > 0, n - 1);
      visit(i + 1 < nx, n + 1);
      visit(j > 0, n - nx);
      visit(j + 1 < ny, n + nx);
      visit(k > 0, n - nx * ny);
      visit(k + 1 < nz, n + nx * ny);
    }
    found.push_back(piece);
  }
  return found;
}

}  // namespace tafoni::landforms::test
