// Turns a region into a box of cells, and a predicate over columns into bits; drops columns that touch others
// only across a corner.

#include "tafoni/surface/impl/lattice.h"

#include <bit>
#include <cmath>

#include "tafoni/core/error.h"

namespace tafoni::surface::impl {
namespace {

constexpr double most_cells = 1 << 30;

struct Range {
  std::int32_t lo, hi;
};

std::int32_t clamp_cell(double cell) {
  return static_cast<std::int32_t>(std::min(std::max(cell, -most_cells), most_cells));
}

Range cells_of(double lo, double hi, double voxel, Boundary boundary) {
  if (boundary == Boundary::open)
    return {clamp_cell(std::ceil(lo / voxel - 0.5)), clamp_cell(std::floor(hi / voxel - 0.5) + 1)};
  constexpr double n = field::chunk_cells;
  return {clamp_cell(std::floor((lo / voxel - 1) / n) * n), clamp_cell(std::ceil((hi / voxel + 1) / n) * n)};
}

}  // namespace

float margin_for(std::int64_t cells) {
  // Two floats near `cells` lie cells * 2^-23 apart; twice that keeps distinct vertices distinct.
  const double needed =
      static_cast<double>(std::bit_ceil(static_cast<std::uint64_t>(std::max<std::int64_t>(cells, 1)))) *
      0x1p-22;
  if (needed > 0.125)
    fail(ErrorKind::usage,
         "the region reaches {} cells from the origin, too far for single precision: use a larger voxel or a "
         "smaller region",
         cells);
  return static_cast<float>(std::max(needed, 0x1p-7));
}

CellSet::Limits CellSet::limits(const Box3d& bounds, const PolygonizeSettings& settings) {
  const double voxel = settings.voxel;
  if (!(voxel > 0) || !std::isfinite(voxel))
    fail(ErrorKind::usage, "a voxel of {} m cannot be used: give a size above 0", voxel);
  const Box3d region = settings.region.empty() ? bounds : settings.region;
  if (region.empty()) return {};
  const double sides[] = {region.lo.x, region.lo.y, region.hi.x, region.hi.y};
  for (double limit : sides)
    if (!(std::abs(limit / voxel) < most_cells))
      fail(ErrorKind::usage,
           "the region to mesh has no end or is too large for a voxel of {} m: give a region", voxel);
  const Range x = cells_of(region.lo.x, region.hi.x, voxel, settings.boundary);
  const Range y = cells_of(region.lo.y, region.hi.y, voxel, settings.boundary);
  // The field's bounds do not know how high or deep a function has surface.
  const Box3d all = Box3d::everything();
  const Box3d& ends = settings.region.empty() ? all : settings.region;
  const Range z = cells_of(ends.lo.z, ends.hi.z, voxel, settings.boundary);
  return {{x.lo, y.lo, z.lo}, {x.hi, y.hi, z.hi}};
}

CellSet::CellSet(const Box3d& bounds, const PolygonizeSettings& settings) {
  const Limits box = limits(bounds, settings);
  lo_ = box.lo;
  hi_ = box.hi;
  if (!empty() && settings.boundary == Boundary::open && settings.inside) choose_columns(settings);
}

std::int64_t CellSet::reach() const {
  std::int64_t most = 0;
  for (std::int32_t v : {lo_.x, lo_.y, hi_.x, hi_.y})
    most = std::max<std::int64_t>(most, std::abs(std::int64_t{v}));
  return most;
}

void CellSet::choose_columns(const PolygonizeSettings& settings) {
  words_ = (std::int64_t{hi_.x} - lo_.x + 63) / 64;
  columns_.assign(words_ * (std::int64_t{hi_.y} - lo_.y), 0);
  for (int j = lo_.y; j < hi_.y; ++j)
    for (int i = lo_.x; i < hi_.x; ++i)
      if (settings.inside((i + 0.5) * settings.voxel, (j + 0.5) * settings.voxel))
        columns_[word(i, j)] |= std::uint64_t{1} << ((i - lo_.x) & 63);
  while (drop_corner_contacts()) continue;
}

/// Two columns that share only a vertical line would make its vertices belong to two sheets.
bool CellSet::drop_corner_contacts() {
  bool changed = false;
  const auto drop = [&](int i, int j) {
    columns_[word(i, j)] &= ~(std::uint64_t{1} << ((i - lo_.x) & 63));
    changed = true;
  };
  for (int j = lo_.y; j + 1 < hi_.y; ++j)
    for (int i = lo_.x; i < hi_.x; i += 64) {
      const std::uint64_t a = row(i, j), b = row(i, j + 1);
      const std::uint64_t a1 = row(i + 1, j), b1 = row(i + 1, j + 1);
      for (std::uint64_t bits = (a & b1 & ~b & ~a1) | (b & a1 & ~a & ~b1); bits; bits &= bits - 1) {
        const int at = i + std::countr_zero(bits);
        if (column(at, j) && column(at + 1, j + 1) && !column(at, j + 1) && !column(at + 1, j))
          drop(at + 1, j + 1);
        if (column(at, j + 1) && column(at + 1, j) && !column(at, j) && !column(at + 1, j + 1))
          drop(at, j + 1);
      }
    }
  return changed;
}

std::uint64_t CellSet::row(int i, int j) const {
  if (j < lo_.y || j >= hi_.y || i + 63 < lo_.x || i >= hi_.x) return 0;
  std::uint64_t bits = ~std::uint64_t{0};
  if (i < lo_.x) bits &= ~std::uint64_t{0} << (lo_.x - i);
  if (i + 64 > hi_.x) bits &= ~std::uint64_t{0} >> (i + 64 - hi_.x);
  if (columns_.empty()) return bits;
  const std::uint64_t* words = columns_.data() + (j - lo_.y) * words_;
  const auto word_at = [&](std::int64_t w) { return w >= 0 && w < words_ ? words[w] : 0; };
  const std::int64_t offset = std::int64_t{i} - lo_.x;
  const std::int64_t w = offset >> 6;
  const std::int64_t shift = offset & 63;
  bits &= shift == 0 ? word_at(w) : (word_at(w) >> shift) | (word_at(w + 1) << (64 - shift));
  return bits;
}

bool CellSet::whole_chunk(Vec3i first) const {
  constexpr int n = field::chunk_cells;
  if (first.x - 1 < lo_.x || first.x + n >= hi_.x || first.y - 1 < lo_.y || first.y + n >= hi_.y ||
      first.z - 1 < lo_.z || first.z + n >= hi_.z)
    return false;
  if (columns_.empty()) return true;
  for (int j = first.y - 1; j <= first.y + n; ++j)
    if (~row(first.x, j) || !column(first.x - 1, j) || !column(first.x + n, j)) return false;
  return true;
}

}  // namespace tafoni::surface::impl
