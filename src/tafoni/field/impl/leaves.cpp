// The kernels of heightfields and domains. On a lattice their parts in x and y are computed once a column and
// used for all its samples; at points the 4 x 4 pixels under each are gathered. Both use one arithmetic.

#include "tafoni/field/impl/leaves.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace tafoni::field::impl {
namespace HWY_NAMESPACE {
using namespace tafoni::HWY_NAMESPACE;

TAFONI_LANES_INLINE Lanes sigma_lanes(const Sigma& s, Lanes x) {
  const Lanes a = abs(x);
  const Lanes poly = a * mul_add(a, mul_add(a, Lanes(s.k3), Lanes(s.k2)), Lanes(1.f));
  return hn::CopySign(select(a < Lanes(s.influence), poly, Lanes(s.amplitude)).v, x.v);
}
TAFONI_LANES_INLINE Lanes sigma_slope(const Sigma& s, Lanes x) {
  const Lanes a = abs(x);
  const Lanes slope = mul_add(a, mul_add(a, Lanes(3 * s.k3), Lanes(2 * s.k2)), Lanes(1.f));
  return select(a < Lanes(s.influence), slope, Lanes(0.f));
}
TAFONI_LANES_INLINE Lanes metres_of(const std::int32_t* units, const float* rest) {
  return mul_add(to_lanes(Ints::load(units)), Lanes(static_cast<float>(unit)), Lanes::load(rest));
}

/// a0 w0 + a1 w1 + a2 w2 + a3 w3, in this order everywhere, so that columns and points agree.
TAFONI_LANES_INLINE Lanes weigh(Lanes a0, Lanes a1, Lanes a2, Lanes a3, Lanes w0, Lanes w1, Lanes w2,
                                Lanes w3) {
  return mul_add(a3, w3, mul_add(a2, w2, mul_add(a1, w1, a0 * w0)));
}

/// Weights of four taps for value, slope and curvature at eight places, [tap][place].
struct Weights {
  alignas(32) float w[4][8], d[4][8], dd[4][8];
};

/// Catmull-Rom or bilinear weights for `derivatives` orders (0 to 2).
TAFONI_LANES_INLINE void weigh(bool bicubic, const float* places, const float* live, int derivatives,
                               Weights& out) {
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Lanes t = Lanes::load(places + l), on = Lanes::load(live + l), half(0.5f), zero(0.f), one(1.f);
    const auto store = [&](float(&to)[4][8], Lanes a, Lanes b, Lanes c, Lanes d) {
      a.store(to[0] + l), b.store(to[1] + l), c.store(to[2] + l), d.store(to[3] + l);
    };
    if (!bicubic) {
      store(out.w, zero, one - t, t, zero);
      if (derivatives >= 1) store(out.d, zero, zero - on, on, zero);
      if (derivatives >= 2) store(out.dd, zero, zero, zero, zero);
      continue;
    }
    const Lanes two(2.f), three(3.f), four(4.f), five(5.f), eight(8.f), nine(9.f), ten(10.f), t2 = t * t,
                                                                                              t3 = t2 * t;
    store(out.w, half * (two * t2 - t3 - t), half * (three * t3 - five * t2 + two),
          half * (four * t2 - three * t3 + t), half * (t3 - t2));
    const Lanes slope = half * on;
    if (derivatives >= 1)
      store(out.d, slope * (four * t - three * t2 - one), slope * (nine * t2 - ten * t),
            slope * (eight * t - nine * t2 + one), slope * (three * t2 - two * t));
    if (derivatives >= 2)
      store(out.dd, on * (two - three * t), on * (nine * t - five), on * (four - nine * t),
            on * (three * t - one));
  }
}

/// Four raster rows joined by vertical weights, over pixels [first, first + n); clamped at the borders.
TAFONI_LANES_INLINE void join_rows(const raster::Grid<float>& grid, int row, const float (&w)[4][8],
                                   int place, int first, int n, float* out) {
  const float* rows[4];
  for (int r = 0; r < 4; ++r) rows[r] = grid.row(std::clamp(row + r, 0, grid.height() - 1));
  const Lanes w0(w[0][place]), w1(w[1][place]), w2(w[2][place]), w3(w[3][place]);
  const int lo = std::clamp(-first, 0, n), hi = std::clamp(grid.width() - first, lo, n);
  const int width = static_cast<int>(lane_count());
  const auto one = [&](int i) {
    const int c = std::clamp(first + i, 0, grid.width() - 1);
    alignas(32) float lanes[8];
    weigh(Lanes(rows[0][c]), Lanes(rows[1][c]), Lanes(rows[2][c]), Lanes(rows[3][c]), w0, w1, w2, w3)
        .store(lanes);
    out[i] = lanes[0];
  };
  int i = 0;
  for (; i < lo; ++i) one(i);
  for (; i + width <= hi; i += width) {
    const int c = first + i;
    weigh(Lanes::load(rows[0] + c), Lanes::load(rows[1] + c), Lanes::load(rows[2] + c),
          Lanes::load(rows[3] + c), w0, w1, w2, w3)
        .store(out + i);
  }
  for (; i < n; ++i) one(i);
}

TAFONI_LANES_INLINE Lanes gather(const float* base, const std::int32_t* index, int tap) {
  return hn::GatherIndex(float_tag, base + tap, Ints::load(index).v);
}

TAFONI_LANES_INLINE void sample_columns(const Sampler& sampler, const Axis& x, const Axis& y, bool slopes,
                                        float* value, float* gx, float* gy) {
  constexpr int groups = Axis::size / 8;
  Weights wx[groups], wy[groups];
  alignas(32) float tx[Axis::size], ty[Axis::size], live_x[Axis::size], live_y[Axis::size];
  alignas(32) std::int32_t col[Axis::size], row[Axis::size];
  std::int32_t first = INT32_MAX, last = INT32_MIN;
  for (int i = 0; i < Axis::size; ++i) {
    const Place px = sampler.place_x(x.metres[i]), py = sampler.place_y(y.metres[i]);
    tx[i] = px.t, ty[i] = py.t, live_x[i] = px.live, live_y[i] = py.live;
    col[i] = px.first, row[i] = py.first;
    first = std::min(first, px.first), last = std::max(last, px.first + 3);
  }
  for (auto& c : col) c -= first;
  for (int g = 0; g < groups; ++g) {
    weigh(sampler.bicubic(), tx + 8 * g, live_x + 8 * g, slopes ? 1 : 0, wx[g]);
    weigh(sampler.bicubic(), ty + 8 * g, live_y + 8 * g, slopes ? 1 : 0, wy[g]);
  }
  const int n = last - first + 1;
  std::vector<float> rows(2 * n);
  float* v = rows.data();
  float* vy = v + n;
  for (int j = 0; j < Columns::rows; ++j) {
    join_rows(sampler.raster().values, row[j], wy[j / 8].w, j % 8, first, n, v);
    if (slopes) join_rows(sampler.raster().values, row[j], wy[j / 8].d, j % 8, first, n, vy);
    for (int i = 0; i < Axis::size; i += static_cast<int>(lane_count())) {
      const Weights& w = wx[i / 8];
      const int l = i % 8;
      const Lanes a0 = gather(v, col + i, 0), a1 = gather(v, col + i, 1), a2 = gather(v, col + i, 2),
                  a3 = gather(v, col + i, 3);
      const Lanes w0 = Lanes::load(w.w[0] + l), w1 = Lanes::load(w.w[1] + l), w2 = Lanes::load(w.w[2] + l),
                  w3 = Lanes::load(w.w[3] + l);
      weigh(a0, a1, a2, a3, w0, w1, w2, w3).store(value + j * Columns::stride + i);
      if (!slopes) continue;
      weigh(a0, a1, a2, a3, Lanes::load(w.d[0] + l), Lanes::load(w.d[1] + l), Lanes::load(w.d[2] + l),
            Lanes::load(w.d[3] + l))
          .store(gx + j * Columns::stride + i);
      weigh(gather(vy, col + i, 0), gather(vy, col + i, 1), gather(vy, col + i, 2), gather(vy, col + i, 3),
            w0, w1, w2, w3)
          .store(gy + j * Columns::stride + i);
    }
  }
}

/// 1 / sqrt(1 + |grad h|^2): turns the vertical distance into the first-order distance.
TAFONI_LANES_INLINE Lanes first_order_scale(Lanes gx, Lanes gy) {
  return Lanes(1.f) / sqrt(mul_add(gy, gy, mul_add(gx, gx, Lanes(1.f))));
}

void height_columns(const HeightLeaf& leaf, const Axis& x, const Axis& y, Columns& out) {
  constexpr std::size_t n = Columns::rows * Columns::stride;
  out.value.resize(n);
  out.scale.resize(n);
  if (!leaf.first_order) {
    sample_columns(leaf.sampler, x, y, false, out.value.data(), nullptr, nullptr);
    std::fill(out.scale.begin(), out.scale.end(), 1.f);
    return;
  }
  std::vector<float> gy(n);
  sample_columns(leaf.sampler, x, y, true, out.value.data(), out.scale.data(), gy.data());
  const Lanes sx(leaf.sampler.slope_x()), sy(leaf.sampler.slope_y());
  for (std::size_t i = 0; i < n; i += lane_count())
    first_order_scale(Lanes::load(&out.scale[i]) * sx, Lanes::load(&gy[i]) * sy).store(&out.scale[i]);
}

/// corner_distance() of lanes.
TAFONI_LANES_INLINE Lanes corner_lanes(Lanes a, Lanes b) {
  return select(max(a, b) < Lanes(0.f), -sqrt(mul_add(a, a, b * b)), min(a, b));
}
/// Signed distance to the rectangle's border in the plane, positive inside.
TAFONI_LANES_INLINE float rectangle_distance(const Box3d& box, double x, double y) {
  return static_cast<float>(
      corner_distance(std::min(x - box.lo.x, box.hi.x - x), std::min(y - box.lo.y, box.hi.y - y)));
}

void domain_columns(const DomainLeaf& leaf, const Axis& x, const Axis& y, Columns& out) {
  constexpr std::size_t n = Columns::rows * Columns::stride;
  out.value.resize(n);
  if (leaf.inside) sample_columns(*leaf.inside, x, y, false, out.value.data(), nullptr, nullptr);
  for (int j = 0; j < Columns::rows; ++j)
    for (int i = 0; i < Columns::stride; ++i) {
      float& v = out.value[j * Columns::stride + i];
      const float r = rectangle_distance(leaf.domain.box, x.metres[i], y.metres[j]);
      v = leaf.inside ? std::min(v, r) : r;
    }
}

void height_block(const HeightLeaf& leaf, const float* value, const float* scale, const Block& block) {
  alignas(32) float z[8];
  for (std::size_t l = 0; l < 8; l += lane_count()) metres_of(block.z + l, block.zr + l).store(z + l);
  for (int j = 0; j < block.ny; ++j)
    for (std::size_t l = 0; l < 8; l += lane_count()) {
      const Lanes h = Lanes::load(value + j * Columns::stride + l),
                  c = Lanes::load(scale + j * Columns::stride + l);
      for (int k = 0; k < block.nz; ++k)
        sigma_lanes(leaf.sigma, (h - Lanes(z[k])) * c).store(block.f + k * block.plane + j * block.row + l);
    }
}

void domain_block(const DomainLeaf& leaf, const float* value, const Block& block) {
  alignas(32) float z[8];
  for (std::size_t l = 0; l < 8; l += lane_count())
    (metres_of(block.z + l, block.zr + l) - Lanes(leaf.base())).store(z + l);
  for (int j = 0; j < block.ny; ++j)
    for (std::size_t l = 0; l < 8; l += lane_count()) {
      const Lanes d = Lanes::load(value + j * Columns::stride + l);
      for (int k = 0; k < block.nz; ++k)
        sigma_lanes(leaf.sigma, corner_lanes(d, Lanes(z[k])))
            .store(block.f + k * block.plane + j * block.row + l);
    }
}

/// Value and derivatives, per pixel, of a raster at eight points; [tap][lane].
struct PointSamples {
  alignas(32) float v[4][8], vy[4][8], vyy[4][8];
  Weights x;
};

/// The 4 x 4 pixels under one point, and their rows joined by vertical weights.
struct Patch {
  alignas(16) float edge[4][4];  ///< copies, where the raster's border cuts the patch
  const float* rows[4];

  TAFONI_LANES_INLINE Patch(const raster::Grid<float>& grid, int col, int row) {
    const bool inside = col >= 0 && col + 4 <= grid.width();
    for (int r = 0; r < 4; ++r) {
      const float* pixels = grid.row(std::clamp(row + r, 0, grid.height() - 1));
      if (inside) {
        rows[r] = pixels + col;
        continue;
      }
      for (int c = 0; c < 4; ++c) edge[r][c] = pixels[std::clamp(col + c, 0, grid.width() - 1)];
      rows[r] = edge[r];
    }
  }
  /// The same chain of operations as weigh().
  TAFONI_LANES_INLINE void join(const float (&w)[4][8], float (&out)[4][8], int lane) const {
    const hn::CappedTag<float, 4> d;  // one lane where the machine has no vectors
    alignas(16) float four[4];
    for (std::size_t c = 0; c < 4; c += hn::Lanes(d)) {
      auto sum = hn::Mul(hn::LoadU(d, rows[0] + c), hn::Set(d, w[0][lane]));
      for (int r = 1; r < 4; ++r) sum = hn::MulAdd(hn::LoadU(d, rows[r] + c), hn::Set(d, w[r][lane]), sum);
      hn::Store(sum, d, four + c);
    }
    for (int c = 0; c < 4; ++c) out[c][lane] = four[c];
  }
};

TAFONI_LANES_INLINE void sample_points(const Sampler& sampler, const Vec3d* p, int derivatives,
                                       PointSamples& s) {
  alignas(32) float tx[8], ty[8], live_x[8], live_y[8];
  std::int32_t col[8], row[8];
  for (int l = 0; l < 8; ++l) {
    const Place px = sampler.place_x(p[l].x), py = sampler.place_y(p[l].y);
    tx[l] = px.t, ty[l] = py.t, live_x[l] = px.live, live_y[l] = py.live;
    col[l] = px.first, row[l] = py.first;
  }
  Weights wy;
  weigh(sampler.bicubic(), tx, live_x, derivatives, s.x);
  weigh(sampler.bicubic(), ty, live_y, derivatives, wy);
  for (int l = 0; l < 8; ++l) {
    const Patch patch(sampler.raster().values, col[l], row[l]);
    patch.join(wy.w, s.v, l);
    if (derivatives >= 1) patch.join(wy.d, s.vy, l);
    if (derivatives >= 2) patch.join(wy.dd, s.vyy, l);
  }
}
TAFONI_LANES_INLINE Lanes across(const float (&a)[4][8], const float (&w)[4][8], std::size_t l) {
  return weigh(Lanes::load(a[0] + l), Lanes::load(a[1] + l), Lanes::load(a[2] + l), Lanes::load(a[3] + l),
               Lanes::load(w[0] + l), Lanes::load(w[1] + l), Lanes::load(w[2] + l), Lanes::load(w[3] + l));
}

void height_points(const HeightLeaf& leaf, const Vec3d* p, const PointLanes& lanes, float* f) {
  PointSamples s;
  sample_points(leaf.sampler, p, leaf.first_order ? 1 : 0, s);
  const Lanes sx(leaf.sampler.slope_x()), sy(leaf.sampler.slope_y());
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Lanes v = across(s.v, s.x.w, l) - metres_of(lanes.z + l, lanes.zr + l);
    const Lanes c = leaf.first_order
                        ? first_order_scale(across(s.v, s.x.d, l) * sx, across(s.vy, s.x.w, l) * sy)
                        : Lanes(1.f);
    sigma_lanes(leaf.sigma, v * c).store(f + l);
  }
}

void height_gradients(const HeightLeaf& leaf, const Vec3d* p, const PointLanes& lanes, PointValues& out) {
  PointSamples s;
  sample_points(leaf.sampler, p, leaf.first_order ? 2 : 1, s);
  const Lanes sx(leaf.sampler.slope_x()), sy(leaf.sampler.slope_y()), one(1.f);
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Lanes v = across(s.v, s.x.w, l) - metres_of(lanes.z + l, lanes.zr + l);
    const Lanes gx = across(s.v, s.x.d, l) * sx, gy = across(s.vy, s.x.w, l) * sy;
    const Lanes c = leaf.first_order ? first_order_scale(gx, gy) : one;
    const Lanes x = v * c, slope = sigma_slope(leaf.sigma, x);
    sigma_lanes(leaf.sigma, x).store(out.v + l);
    Lanes dx = c * gx, dy = c * gy;
    if (leaf.first_order) {  // grad(v c) = c grad v + v grad c, grad c = -c^3 (Hessian of h) (grad h)
      const Lanes hxx = across(s.v, s.x.dd, l) * sx * sx, hxy = across(s.vy, s.x.d, l) * sx * sy,
                  hyy = across(s.vyy, s.x.w, l) * sy * sy;
      const Lanes k = v * c * c * c;
      dx = dx - k * (gx * hxx + gy * hxy);
      dy = dy - k * (gx * hxy + gy * hyy);
    }
    (slope * dx).store(out.gx + l);
    (slope * dy).store(out.gy + l);
    (slope * -c).store(out.gz + l);
  }
}

/// Gradient of rectangle_distance().
TAFONI_LANES_INLINE void rectangle_gradient(const Box3d& box, Vec3d p, float& gx, float& gy) {
  const double west = p.x - box.lo.x, east = box.hi.x - p.x, south = p.y - box.lo.y, north = box.hi.y - p.y;
  const double a = std::min(west, east), b = std::min(south, north);
  const double dx = west < east ? 1 : -1, dy = south < north ? 1 : -1;
  const bool outside = a < 0 && b < 0;
  const double r = outside ? std::sqrt(a * a + b * b) : 1;
  gx = static_cast<float>(outside ? -a / r * dx : a <= b ? dx : 0);
  gy = static_cast<float>(outside ? -b / r * dy : a <= b ? 0 : dy);
}

void domain_gradients(const DomainLeaf& leaf, const Vec3d* p, const PointLanes& lanes, PointValues& out) {
  PointSamples s;
  alignas(32) float inside[8], inside_x[8], inside_y[8], z[8], d[8];
  if (leaf.inside) sample_points(*leaf.inside, p, 1, s);
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    (metres_of(lanes.z + l, lanes.zr + l) - Lanes(leaf.base())).store(z + l);
    if (!leaf.inside) continue;
    across(s.v, s.x.w, l).store(inside + l);
    (across(s.v, s.x.d, l) * Lanes(leaf.inside->slope_x())).store(inside_x + l);
    (across(s.vy, s.x.w, l) * Lanes(leaf.inside->slope_y())).store(inside_y + l);
  }
  const Box3d& box = leaf.domain.box;
  for (int l = 0; l < 8; ++l) {
    const float plane = rectangle_distance(box, p[l].x, p[l].y);
    d[l] = leaf.inside ? std::min(inside[l], plane) : plane;
    out.gx[l] = out.gy[l] = out.gz[l] = 0;
    if (z[l] >= d[l] || d[l] < 0) {
      if (leaf.inside && inside[l] < plane)
        out.gx[l] = inside_x[l], out.gy[l] = inside_y[l];
      else
        rectangle_gradient(box, p[l], out.gx[l], out.gy[l]);
    }
    if (z[l] < d[l]) out.gz[l] = 1;
    if (z[l] < 0 && d[l] < 0) {
      const float r = std::sqrt(d[l] * d[l] + z[l] * z[l]), k = -d[l] / r;
      out.gx[l] *= k, out.gy[l] *= k;
      out.gz[l] = -z[l] / r;
    }
  }
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    const Lanes x = corner_lanes(Lanes::load(d + l), Lanes::load(z + l)), slope = sigma_slope(leaf.sigma, x);
    sigma_lanes(leaf.sigma, x).store(out.v + l);
    (slope * Lanes::load(out.gx + l)).store(out.gx + l);
    (slope * Lanes::load(out.gy + l)).store(out.gy + l);
    (slope * Lanes::load(out.gz + l)).store(out.gz + l);
  }
}

void domain_points(const DomainLeaf& leaf, const Vec3d* p, const PointLanes& lanes, float* f) {
  PointSamples s;
  alignas(32) float d[8];
  if (leaf.inside) sample_points(*leaf.inside, p, 0, s);
  for (int l = 0; l < 8; ++l) d[l] = rectangle_distance(leaf.domain.box, p[l].x, p[l].y);
  for (std::size_t l = 0; l < 8; l += lane_count()) {
    Lanes plane = Lanes::load(d + l);
    if (leaf.inside) plane = min(across(s.v, s.x.w, l), plane);
    const Lanes z = metres_of(lanes.z + l, lanes.zr + l) - Lanes(leaf.base());
    sigma_lanes(leaf.sigma, corner_lanes(plane, z)).store(f + l);
  }
}

LeafKernels make_leaf_kernels() {
  return {&height_columns, &domain_columns,   &height_block,  &domain_block,
          &height_points,  &height_gradients, &domain_points, &domain_gradients};
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::field::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::field::impl {

HWY_EXPORT(make_leaf_kernels);

const LeafKernels& leaf_kernels() {
  static const LeafKernels table = HWY_DYNAMIC_DISPATCH(make_leaf_kernels)();
  return table;
}

}  // namespace tafoni::field::impl
#endif
