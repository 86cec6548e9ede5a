// Makes the caps of a cell's slabs and, along each of its sides, the walls where it is solid and the cell
// beyond is not.

#include "tafoni/surface/impl/prism_faces.h"

#include <algorithm>

#include "tafoni/mesh/inner/size32.h"

namespace tafoni::surface::impl {

using volume::ColumnBox;

namespace {

constexpr int across[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};

}  // namespace

const std::vector<PrismFace>& PrismFaces::run(const volume::PrismFields& fields, const ColumnBox& box,
                                              bool ring, volume::DeadPoints dead) {
  const int r = ring ? 1 : 0;
  // One further cell around, whose slabs the outermost walls depend on, and a column, for its seams.
  known_ = {box.i0 - r - 1, box.j0 - r - 1, box.i1 + r + 1, box.j1 + r + 1};
  fields.read({known_.i0 - 1, known_.j0 - 1, known_.i1 + 2, known_.j1 + 2}, block_);
  cells_.build(block_);
  slabs_.clear(), starts_.clear(), cuts_.clear();
  for (int j = known_.j0; j <= known_.j1; ++j)
    for (int i = known_.i0; i <= known_.i1; ++i) {
      const auto all = cells_.slabs(i, j, dead);
      starts_.push_back(mesh::inner::size32(slabs_));
      cuts_.push_back(cells_.cut_0_to_2(all));
      slabs_.insert(slabs_.end(), all.begin(), all.end());
    }
  starts_.push_back(mesh::inner::size32(slabs_));
  faces_.clear(), face_starts_.clear();
  meshed_ = {box.i0 - r, box.j0 - r, box.i1 + r, box.j1 + r};
  for (int j = meshed_.j0; j <= meshed_.j1; ++j)
    for (int i = meshed_.i0; i <= meshed_.i1; ++i) {
      face_starts_.push_back(faces_.size());
      const auto all = slabs(i, j);
      if (all.empty()) continue;
      for (std::size_t k = 0; k < 4; ++k)
        columns_[k] = static_cast<std::int32_t>(
            block_.column(i + volume::cell_corners[k][0], j + volume::cell_corners[k][1]));
      caps(i, j, all);
      for (int side = 0; side < 4; ++side) walls(i, j, side, all);
    }
  face_starts_.push_back(faces_.size());
  return faces_;
}

std::span<const PrismFaces::Slab> PrismFaces::slabs(int i, int j) const {
  const std::ptrdiff_t c = cell(i, j);
  return {slabs_.begin() + starts_[c], slabs_.begin() + starts_[c + 1]};
}

void PrismFaces::face(std::int32_t ca, std::int32_t la, std::int32_t cb, std::int32_t lb, std::int32_t cc,
                      std::int32_t lc, PrismSurface surface) {
  faces_.push_back({{ca, cb, cc}, {la, lb, lc}, surface});
}

void PrismFaces::caps(int i, int j, std::span<const Slab> all) {
  const std::ptrdiff_t c = cell(i, j);
  for (std::size_t from = 0, to = 0; from < all.size(); from = to) {
    while (to < all.size() && all[to].piece == all[from].piece) ++to;
    const auto piece = all.subspan(from, to - from);
    if (piece[0].corners == 15) {
      const std::array<int, 3> halves[2][2] = {{{0, 1, 3}, {1, 2, 3}}, {{0, 1, 2}, {0, 2, 3}}};
      for (const auto& half : halves[cuts_[c]]) caps_of_triangle(piece, half);
      continue;
    }
    int dead = 0;
    while (piece[0].corners >> dead & 1) ++dead;
    const std::array<int, 3> corners{(dead + 1) % 4, (dead + 2) % 4, (dead + 3) % 4};
    caps_of_triangle(piece, corners);
    // The hypotenuse is a wall of its own.
    const int a = corners[2], b = corners[0];
    here_.clear();
    side_of(piece, a, b, here_);
    for (const Quad& quad : here_) wall(columns_[a], columns_[b], quad);
  }
}

/// Where a slab lies on the next at all corners, neither shows.
void PrismFaces::caps_of_triangle(std::span<const Slab> piece, const std::array<int, 3>& corners) {
  std::int32_t column[3];
  for (std::size_t k = 0; k < 3; ++k) column[k] = columns_[corners[k]];
  const Slab* below = nullptr;
  const auto top = [&] {
    std::int32_t z[3];
    for (std::size_t k = 0; k < 3; ++k) z[k] = below->at[corners[k]].last;
    face(column[0], z[0], column[1], z[1], column[2], z[2], PrismSurface::upper);
  };
  for (const Slab& slab : piece) {
    bool flat = true, glued = below != nullptr;
    std::int32_t z[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t at = corners[k];
      z[k] = slab.at[at].first;
      flat = flat && z[k] == slab.at[at].last;
      glued = glued && below->at[at].last == z[k];
    }
    if (flat) continue;
    if (!glued) {
      if (below) top();
      face(column[2], z[2], column[1], z[1], column[0], z[0], PrismSurface::lower);
    }
    below = &slab;
  }
  if (below) top();
}

void PrismFaces::side_of(std::span<const Slab> all, int a, int b, std::vector<Quad>& out) const {
  const int both = (1 << a) | (1 << b);
  for (const Slab& slab : all) {
    if ((slab.corners & both) != both) continue;
    const Quad quad{slab.at[a], slab.at[b]};
    if (quad.a.first == quad.a.last && quad.b.first == quad.b.last) continue;
    if (!out.empty() && out.back().a.last == quad.a.first && out.back().b.last == quad.b.first) {
      out.back().a.last = quad.a.last;
      out.back().b.last = quad.b.last;
    } else {
      out.push_back(quad);
    }
  }
}

void PrismFaces::walls(int i, int j, int side, std::span<const Slab> all) {
  const auto other = slabs(i + across[side][0], j + across[side][1]);
  const int a = side, b = (side + 1) % 4, c = (side + 3) % 4, d = (side + 2) % 4;
  const auto at = [](const Slab& slab, int k) { return slab.at[k]; };
  if (all.size() == 1 && other.size() == 1 && all[0].corners == 15 && other[0].corners == 15 &&
      at(all[0], a) == at(other[0], c) && at(all[0], b) == at(other[0], d))
    return;
  here_.clear(), there_.clear();
  side_of(all, a, b, here_);
  side_of(other, c, d, there_);
  for (const Quad& quad : here_)
    if (std::find(there_.begin(), there_.end(), quad) == there_.end()) wall(columns_[a], columns_[b], quad);
}

/// Triangles between the levels of two columns, b to the right seen from outside.
void PrismFaces::wall(std::int32_t a, std::int32_t b, const Quad& quad) {
  std::int32_t p = quad.a.first, q = quad.b.first;
  while (p < quad.a.last || q < quad.b.last) {
    if (p == quad.a.last || (q < quad.b.last && cells_.level(q + 1) <= cells_.level(p + 1))) {
      face(a, p, b, q, b, q + 1, PrismSurface::middle);
      ++q;
    } else {
      face(a, p, b, q, a, p + 1, PrismSurface::middle);
      ++p;
    }
  }
}

}  // namespace tafoni::surface::impl
