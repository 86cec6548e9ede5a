// A prism-field as a leaf of construction trees. Each cell's slabs give first-order distances up and
// down; walls, the slabs' sides that no neighbour continues, give distances sideways within a cell. Tiles
// remember their highest top, so that air above all ground is told at once.

#include <algorithm>
#include <cmath>
#include <optional>

#include "tafoni/field/each_point.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/inner/prism_cells.h"
#include "tafoni/volume/prism_convert.h"

namespace tafoni::volume {

namespace {

/// The lower side of what has no bottom: a thousand kilometres down.
constexpr float endless = -1e6f;
/// What least and greatest heights begin with: beyond any of a terrain, yet far from a float's limits.
constexpr double beyond_all = 1e30;
/// Columns between the points that a gradient is taken from: it smooths over the edges between slabs without
/// reaching the next column.
constexpr double step_share = 0.35;
/// Rows of cells that are read and made slabs of at once.
constexpr int rows_at_once = 32;
/// Parts by which bounds are drawn outwards, as rounding in value() must not step out of them: more over
/// ground, where slopes come in, than beside the frame, where all is one distance.
constexpr double slack_share = 1e-5, slack_beside = 1e-6;

/// Elevations of a slab over its corners, metres above the frame's origin.
struct Slab {
  std::array<float, 4> bottom, top;
  std::uint8_t corners;
  bool cut_0_to_2;
};

/// An upright face, of cell `cell`, between two of its corners.
struct Wall {
  Vec2d from, to;  ///< in metres from the frame's origin; the cell lies to the left
  float bottom[2], top[2];
  std::int32_t beyond;  ///< cell on the other side, its own for a hypotenuse, -1 outside of the frame
};

class PrismFunction final : public field::Function {
 public:
  PrismFunction(const PrismFields& fields, const PrismLeafSettings& settings)
      : frame_(fields.frame()),
        reach_(settings.reach),
        cells_x_(frame_.nx - 1),
        cells_y_(frame_.ny - 1),
        step_(step_share * std::min(frame_.dx, frame_.dy)) {
    const float floor = static_cast<float>(settings.floor - frame_.origin.z);
    ColumnBlock block;
    PrismCells cells;
    starts_.push_back(0);
    for (int j0 = 0; j0 < cells_y_; j0 += rows_at_once) {
      const int j1 = std::min(j0 + rows_at_once, cells_y_) - 1;
      fields.read({-1, j0 - 1, frame_.nx, j1 + 2}, block);
      cells.build(block);
      for (int j = j0; j <= j1; ++j)
        for (int i = 0; i < cells_x_; ++i) {
          const auto all = cells.slabs(i, j, DeadPoints::triangles);
          const bool cut = cells.cut_0_to_2(all);
          for (const PrismCells::Slab& s : all) slabs_.push_back(make_slab(cells, s, cut, floor));
          starts_.push_back(end_of(slabs_));
        }
    }
    find_walls();
    summarize();
  }

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [this](Vec3d p) { return value(p); });
  }

  double step() const override { return step_; }

  Interval range(const Box3d& box) const override;

 private:
  static constexpr int tile_cells = 8;

  Slab make_slab(const PrismCells& cells, const PrismCells::Slab& s, bool cut, float floor) const {
    Slab out{{}, {}, s.corners, cut};
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(s.corners >> k & 1)) continue;
      out.bottom[k] = cells.level(s.at[k].first);
      out.top[k] = cells.level(s.at[k].last);
      if (out.bottom[k] <= floor) out.bottom[k] = endless;
    }
    return out;
  }

  std::span<const Slab> slabs(std::int32_t cell) const {
    return std::span(slabs_).subspan(starts_[cell], starts_[cell + 1] - starts_[cell]);
  }
  std::int32_t cell(int i, int j) const { return j * cells_x_ + i; }
  std::int32_t tile_of(int ti, int tj) const { return tj * tiles_x_ + ti; }

  /// Which corners hold the triangle of `slab` over (u, v), both in [0, 1]; none where it has no matter.
  static std::optional<std::array<std::size_t, 3>> triangle(const Slab& slab, double u, double v) {
    using Corners = std::array<std::size_t, 3>;
    switch (slab.corners) {
      case 15:
        if (slab.cut_0_to_2) return u >= v ? Corners{0, 1, 2} : Corners{0, 2, 3};
        return u + v <= 1 ? Corners{0, 1, 3} : Corners{1, 2, 3};
      case 14:
        return u + v >= 1 ? std::optional(Corners{1, 2, 3}) : std::nullopt;
      case 13:
        return v >= u ? std::optional(Corners{0, 2, 3}) : std::nullopt;
      case 11:
        return u + v <= 1 ? std::optional(Corners{0, 1, 3}) : std::nullopt;
      default:
        return u >= v ? std::optional(Corners{0, 1, 2}) : std::nullopt;
    }
  }

  /// The elevation at (u, v) of the plane through three corners, and one over the secant of its slope.
  std::pair<double, double> plane(const std::array<float, 4>& z, const std::array<std::size_t, 3>& at,
                                  double u, double v) const {
    const auto height = [&](std::size_t k) -> double { return z[at[k]]; };
    double du = 0, dv = 0;
    // In every triangle two corners differ along u alone, and two along v alone.
    for (std::size_t a = 0; a < 3; ++a)
      for (std::size_t b = 0; b < 3; ++b) {
        const auto& from = cell_corners[at[a]];
        const auto& to = cell_corners[at[b]];
        if (from[1] == to[1] && from[0] < to[0]) du = height(b) - height(a);
        if (from[0] == to[0] && from[1] < to[1]) dv = height(b) - height(a);
      }
    const double base = height(0) - du * cell_corners[at[0]][0] - dv * cell_corners[at[0]][1];
    const double sx = du / frame_.dx, sy = dv / frame_.dy;
    return {base + du * u + dv * v, 1 / std::sqrt(1 + sx * sx + sy * sy)};
  }

  /// The value that the cell's own slabs alone give; -reach where there are none.
  double upright(std::int32_t cell, double u, double v, double z) const {
    double most = -reach_;
    for (const Slab& slab : slabs(cell)) {
      const auto at = triangle(slab, u, v);
      if (!at) continue;
      const auto [top, flat_top] = plane(slab.top, *at, u, v);
      double inside = (top - z) * flat_top;
      bool sunk = true;
      for (std::size_t k : *at) sunk = sunk && slab.bottom[k] == endless;
      if (!sunk) {
        const auto [bottom, flat_bottom] = plane(slab.bottom, *at, u, v);
        inside = std::min(inside, (z - bottom) * flat_bottom);
      }
      most = std::max(most, inside);
    }
    return most;
  }

  /// Beyond the frame the value is that of the nearest place within, less the way there.
  double value(Vec3d p) const {
    const double gx = p.x - frame_.origin.x, gy = p.y - frame_.origin.y, z = p.z - frame_.origin.z;
    const double x = std::clamp(gx, 0.0, cells_x_ * frame_.dx), y = std::clamp(gy, 0.0, cells_y_ * frame_.dy);
    const int i = std::min(static_cast<int>(x / frame_.dx), cells_x_ - 1);
    const int j = std::min(static_cast<int>(y / frame_.dy), cells_y_ - 1);
    const double beyond = std::hypot(gx - x, gy - y);
    double f = upright(cell(i, j), x / frame_.dx - i, y / frame_.dy - j, z);
    if (near_walls_[cell(i, j)]) {
      if (beyond > 0)
        f = -wall_distance(i, j, gx, gy, z, reach_);
      else
        f = f > 0 ? wall_distance(i, j, gx, gy, z, f) : -wall_distance(i, j, gx, gy, z, -f);
    }
    if (beyond > 0) f = std::min(f, -beyond);
    return std::clamp(f, -reach_, reach_);
  }

  /// The distance to the nearest of the walls around the cell if that is less than `least`, else `least`.
  double wall_distance(int i, int j, double x, double y, double z, double least) const {
    for (int b = std::max(0, j - 1); b <= std::min(j + 1, cells_y_ - 1); ++b)
      for (int a = std::max(0, i - 1); a <= std::min(i + 1, cells_x_ - 1); ++a) {
        const std::int32_t c = cell(a, b);
        for (std::int32_t w = wall_starts_[c]; w < wall_starts_[c + 1]; ++w)
          least = distance(walls_[w], x, y, z, least);
      }
    return least;
  }

  double distance(const Wall& wall, double x, double y, double z, double least) const {
    const double ex = wall.to.x - wall.from.x, ey = wall.to.y - wall.from.y;
    const double t =
        std::clamp(((x - wall.from.x) * ex + (y - wall.from.y) * ey) / (ex * ex + ey * ey), 0.0, 1.0);
    const double qx = wall.from.x + t * ex, qy = wall.from.y + t * ey;
    const auto between = [t](const float(&v)[2]) { return v[0] + t * (double{v[1]} - v[0]); };
    const double bottom = between(wall.bottom), top = between(wall.top);
    if (!(bottom < top)) return least;
    const double at = std::clamp(z, bottom, top);
    const double d = std::sqrt((x - qx) * (x - qx) + (y - qy) * (y - qy) + (z - at) * (z - at));
    if (!(d < least)) return least;
    // Where matter stands on both sides there is no wall: cells that divide a column's matter unlike are one
    // body all the same.
    if (wall.beyond >= 0) {
      const double u = qx / frame_.dx - wall.beyond % cells_x_, v = qy / frame_.dy - wall.beyond / cells_x_;
      if (upright(wall.beyond, std::clamp(u, 0.0, 1.0), std::clamp(v, 0.0, 1.0), at) > 1e-4) return least;
    }
    return d;
  }

  Interval range(std::int32_t at, double lo, double hi) const;
  double clear_of_walls(std::int32_t at, double lo, double hi) const;
  /// One over the secant of a slope that rises by `rise` over a cell at most.
  double flatness(double rise) const {
    return 1 / std::sqrt(1 + rise * rise * (1 / (frame_.dx * frame_.dx) + 1 / (frame_.dy * frame_.dy)));
  }
  void find_walls();
  void add_wall(int i, int j, const Slab& slab, std::size_t a, std::size_t b, std::int32_t beyond);
  void summarize();

  ColumnFrame frame_;
  double reach_;
  int cells_x_, cells_y_;
  double step_;
  std::vector<Slab> slabs_;
  std::vector<std::int32_t> starts_;  ///< by cell
  std::vector<Wall> walls_;
  std::vector<std::int32_t> wall_starts_;  ///< by cell
  std::vector<bool> near_walls_;           ///< by cell: it or one around has walls
  std::vector<float> highest_;             ///< top of each tile of tile_cells x tile_cells cells
  int tiles_x_ = 0;
  double flattest_ = 1;  ///< no plane of a top or bottom is steeper
};

void PrismFunction::add_wall(int i, int j, const Slab& slab, std::size_t a, std::size_t b,
                             std::int32_t beyond) {
  const auto place = [&](std::size_t k) {
    return Vec2d{(i + cell_corners[k][0]) * frame_.dx, (j + cell_corners[k][1]) * frame_.dy};
  };
  walls_.push_back(
      {place(a), place(b), {slab.bottom[a], slab.bottom[b]}, {slab.top[a], slab.top[b]}, beyond});
}

/// A slab's side is a wall unless a slab of the next cell has the same.
void PrismFunction::find_walls() {
  constexpr int across[4][2] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  for (int j = 0; j < cells_y_; ++j)
    for (int i = 0; i < cells_x_; ++i) {
      wall_starts_.push_back(end_of(walls_));
      for (const Slab& slab : slabs(cell(i, j))) {
        for (std::size_t a = 0; a < 4; ++a) {
          const std::size_t b = (a + 1) % 4, c = (a + 3) % 4, d = (a + 2) % 4;
          if (!(slab.corners >> a & 1) || !(slab.corners >> b & 1)) continue;
          const int x = i + across[a][0], y = j + across[a][1];
          const bool in = x >= 0 && y >= 0 && x < cells_x_ && y < cells_y_;
          bool same = false;
          if (in)
            for (const Slab& other : slabs(cell(x, y)))
              same = same || ((other.corners >> c & 1) && (other.corners >> d & 1) &&
                              other.bottom[c] == slab.bottom[a] && other.top[c] == slab.top[a] &&
                              other.bottom[d] == slab.bottom[b] && other.top[d] == slab.top[b]);
          if (!same) add_wall(i, j, slab, a, b, in ? cell(x, y) : -1);
        }
        if (slab.corners == 15) continue;
        std::size_t dead = 0;
        while (slab.corners >> dead & 1) ++dead;
        add_wall(i, j, slab, (dead + 3) % 4, (dead + 1) % 4, -1);
      }
    }
  wall_starts_.push_back(end_of(walls_));
  near_walls_.assign(std::int64_t{cells_x_} * cells_y_, false);
  for (int j = 0; j < cells_y_; ++j)
    for (int i = 0; i < cells_x_; ++i) {
      const std::int32_t at = cell(i, j);
      if (wall_starts_[at] == wall_starts_[at + 1]) continue;
      for (int b = std::max(0, j - 1); b <= std::min(j + 1, cells_y_ - 1); ++b)
        for (int a = std::max(0, i - 1); a <= std::min(i + 1, cells_x_ - 1); ++a)
          near_walls_[cell(a, b)] = true;
    }
}

void PrismFunction::summarize() {
  tiles_x_ = (cells_x_ + tile_cells - 1) / tile_cells;
  const int tiles_y = (cells_y_ + tile_cells - 1) / tile_cells;
  highest_.assign(std::int64_t{tiles_x_} * tiles_y, -1e30f);
  for (int j = 0; j < cells_y_; ++j)
    for (int i = 0; i < cells_x_; ++i)
      for (const Slab& slab : slabs(cell(i, j))) {
        for (const auto* side : {&slab.top, &slab.bottom}) {
          double low = beyond_all, top = -beyond_all;
          for (std::size_t k = 0; k < 4; ++k) {
            if (!(slab.corners >> k & 1) || (*side)[k] == endless) continue;
            low = std::min<double>(low, (*side)[k]);
            top = std::max<double>(top, (*side)[k]);
          }
          if (low < top) flattest_ = std::min(flattest_, flatness(top - low));
        }
        for (std::size_t k = 0; k < 4; ++k) {
          float& high = highest_[tile_of(i / tile_cells, j / tile_cells)];
          if (slab.corners >> k & 1) high = std::max(high, slab.top[k]);
        }
      }
}

/// Cell by cell: matter that fills the box there, or air that does; else both.
Interval PrismFunction::range(const Box3d& box) const {
  const Interval all = rounded(-reach_, reach_);
  const double lo = box.lo.z - frame_.origin.z, hi = box.hi.z - frame_.origin.z;
  const double x0 = box.lo.x - frame_.origin.x, x1 = box.hi.x - frame_.origin.x;
  const double y0 = box.lo.y - frame_.origin.y, y1 = box.hi.y - frame_.origin.y;
  const auto index = [](double v, double d, int cells) {
    return floor_to(std::clamp<double>(v / d, 0.0, cells - 1));
  };
  const double off = std::max({-x1, -y1, x0 - cells_x_ * frame_.dx, y0 - cells_y_ * frame_.dy});
  if (off > 0) return rounded(-reach_, -std::min(off, reach_) * (1 - slack_beside));
  const bool beyond = x0 < 0 || y0 < 0 || x1 > cells_x_ * frame_.dx || y1 > cells_y_ * frame_.dy;
  const int i0 = index(x0, frame_.dx, cells_x_), i1 = index(x1, frame_.dx, cells_x_);
  const int j0 = index(y0, frame_.dy, cells_y_), j1 = index(y1, frame_.dy, cells_y_);
  // Above all ground of the tiles no cell need be asked.
  double highest = -beyond_all;
  for (int tj = j0 / tile_cells; tj <= j1 / tile_cells; ++tj)
    for (int ti = i0 / tile_cells; ti <= i1 / tile_cells; ++ti)
      highest = std::max<double>(highest, highest_[tile_of(ti, tj)]);
  if (lo > highest + reach_)
    return rounded(-reach_, -std::min(reach_, (lo - highest) * flattest_) * (1 - slack_share));
  double least = reach_, most = -reach_;
  for (int j = j0; j <= j1; ++j)
    for (int i = i0; i <= i1; ++i) {
      const Interval here = range(cell(i, j), lo, hi);
      least = std::min<double>(least, here.lo);
      most = std::max<double>(most, here.hi);
      if (least < 0 && most > 0) return all;
    }
  if (beyond && most > 0) return all;
  const double slack = slack_share * reach_;
  return rounded(least > 0 ? std::max(0.0, least - slack) : -reach_,
                 most > 0 ? reach_ : std::min(0.0, most + slack));
}

/// Over one cell from elevation lo to hi; only the ends towards 0 are tight.
Interval PrismFunction::range(std::int32_t at, double lo, double hi) const {
  bool filled = false;
  double depth = 0, most = -reach_;
  for (const Slab& slab : slabs(at)) {
    double top_lo = beyond_all, top_hi = -beyond_all, bottom_lo = beyond_all, bottom_hi = -beyond_all;
    for (std::size_t k = 0; k < 4; ++k) {
      if (!(slab.corners >> k & 1)) continue;
      top_lo = std::min<double>(top_lo, slab.top[k]);
      top_hi = std::max<double>(top_hi, slab.top[k]);
      bottom_lo = std::min<double>(bottom_lo, slab.bottom[k]);
      bottom_hi = std::max<double>(bottom_hi, slab.bottom[k]);
    }
    const double flat_top = flatness(top_hi - top_lo), flat_bottom = flatness(bottom_hi - bottom_lo);
    if (lo > top_hi)
      most = std::max(most, -(lo - top_hi) * flat_top);
    else if (hi < bottom_lo)
      most = std::max(most, -(bottom_lo - hi) * flat_bottom);
    else if (slab.corners == 15 && hi < top_lo && lo > bottom_hi) {
      filled = true;
      depth = std::max(depth, std::min((top_lo - hi) * flat_top, (lo - bottom_hi) * flat_bottom));
    } else {
      return rounded(-reach_, reach_);
    }
  }
  const bool walls = near_walls_[at];
  if (!filled && walls) return rounded(-reach_, -clear_of_walls(at, lo, hi));
  if (filled) return rounded(walls ? 0 : std::min(depth, reach_), reach_);
  return rounded(-reach_, most);
}

/// At least so far above or below all slabs of the cell and those around it, and no farther than the cell's
/// own slabs make it seem.
double PrismFunction::clear_of_walls(std::int32_t at, double lo, double hi) const {
  double lowest = beyond_all, highest = -beyond_all;
  const int i = at % cells_x_, j = at / cells_x_;
  for (int b = std::max(0, j - 1); b <= std::min(j + 1, cells_y_ - 1); ++b)
    for (int a = std::max(0, i - 1); a <= std::min(i + 1, cells_x_ - 1); ++a)
      for (const Slab& slab : slabs(cell(a, b)))
        for (std::size_t k = 0; k < 4; ++k) {
          if (!(slab.corners >> k & 1)) continue;
          lowest = std::min<double>(lowest, slab.bottom[k]);
          highest = std::max<double>(highest, slab.top[k]);
        }
  return std::min(reach_, std::max({0.0, lo - highest, lowest - hi}) * flattest_);
}

/// Near its zero set the mean of a function over nine places beside each other, weighed 1 2 1 each way.
class Rounded final : public field::Function {
 public:
  Rounded(field::FunctionPtr raw, Vec2d offset, double spacing)
      : raw_(std::move(raw)), offset_(offset), spacing_(static_cast<float>(spacing)) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    raw_->values(points, out);
    std::vector<std::size_t> near;
    for (std::size_t n = 0; n < points.size(); ++n)
      if (share(out[n]) > 0) near.push_back(n);
    std::vector<Vec3d> places(near.size());
    std::vector<float> sums(near.size()), more(near.size());
    for (int b = -1; b <= 1; ++b)
      for (int a = -1; a <= 1; ++a) {
        for (std::size_t k = 0; k < near.size(); ++k)
          places[k] = points[near[k]] + Vec3d{a * offset_.x, b * offset_.y, 0};
        raw_->values(places, more);
        const float weight = static_cast<float>((2 - std::abs(a)) * (2 - std::abs(b))) / 16;
        for (std::size_t k = 0; k < near.size(); ++k) sums[k] += weight * more[k];
      }
    for (std::size_t k = 0; k < near.size(); ++k) {
      float& own = out[near[k]];
      own += share(own) * (sums[k] - own);
    }
  }

  double step() const override { return raw_->step(); }

  Interval range(const Box3d& box) const override {
    const Vec3d more{offset_.x, offset_.y, 0};
    const Interval r = raw_->range({box.lo - more, box.hi + more});
    const float slack = 1e-5f * std::max(std::abs(r.lo), std::abs(r.hi));
    return {r.lo > 0 ? std::max(0.0f, r.lo - slack) : r.lo - slack,
            r.hi < 0 ? std::min(0.0f, r.hi + slack) : r.hi + slack};
  }

 private:
  /// How much of the mean is taken: 1 within a column of the surface, 0 beyond two.
  float share(float v) const { return std::clamp(2 - std::abs(v) / spacing_, 0.0f, 1.0f); }

  field::FunctionPtr raw_;
  Vec2d offset_;
  float spacing_;
};

}  // namespace

field::FunctionPtr as_function(const PrismFields& fields, const PrismLeafSettings& settings) {
  auto raw = std::make_shared<PrismFunction>(fields, settings);
  if (!(settings.rounding > 0)) return raw;
  const ColumnFrame& frame = fields.frame();
  return std::make_shared<Rounded>(std::move(raw), Vec2d{frame.dx, frame.dy} * settings.rounding,
                                   std::max(frame.dx, frame.dy));
}

}  // namespace tafoni::volume
