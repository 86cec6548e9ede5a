// The warp operator: the tree is asked at positions that noise has moved, by as much as a control function
// says.

#include <algorithm>
#include <cmath>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/field/impl/node.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/warp_noise.h"
#include "tafoni/field/operator.h"

namespace tafoni::field {
namespace {

using impl::PointWork;
using impl::Program;

/// Noise in float may exceed its amplitude by a few parts in 10^7.
constexpr double over = 1 + 1e-5;

/// A box grown by at most `amplitude` along each axis.
Box3d grow(const Box3d& box, Vec3d amplitude) {
  return box.empty() ? box : Box3d{box.lo - amplitude, box.hi + amplitude};
}

class Warped final : public impl::Nested {
 public:
  Warped(std::shared_ptr<const Program> child, FunctionPtr control, const WarpSettings& settings)
      : child_(std::move(child)), control_(std::move(control)) {
    noise_.inv_lateral = 1 / settings.lateral;
    noise_.inv_vertical = 1 / settings.vertical;
    noise_.octaves = settings.octaves;
    const double amplitude[3] = {settings.amplitude.x, settings.amplitude.y, settings.amplitude.z};
    for (std::uint64_t i = 0; i < 3; ++i) {
      noise_.seed[i] = static_cast<std::uint32_t>(hash_combine(settings.seed, i));
      noise_.amplitude[i] = static_cast<float>(amplitude[i]);
    }
  }

  void values(std::span<const Vec3d> points, PointWork& work, float* out) const override {
    const float* control = controls(points, work);
    auto& moved = work.scratch.points;
    moved.assign(points.begin(), points.end());
    impl::Displacement d;
    for (std::size_t i = 0; i < points.size(); i += 8) {
      const std::size_t n = std::min<std::size_t>(8, points.size() - i);
      if (std::all_of(control + i, control + i + n, [](float c) { return c == 0; })) continue;
      impl::warp_kernels().displace(noise_, points.data() + i, n, d);
      for (std::size_t l = 0; l < n; ++l) moved[i + l] += displacement(d, l, control[i + l]);
    }
    work.values(*child_, moved, out);
  }

  void gradients(std::span<const Vec3d> points, PointWork& work, impl::PointValues* out) const override {
    const float* control = controls(points, work);
    auto& slopes = work.scratch.slopes;
    slopes.assign(points.size(), Vec3f{});
    if (control_) control_->gradients(points, slopes);
    auto& moved = work.scratch.points;
    moved.assign(points.begin(), points.end());
    auto& offsets = work.scratch.displacements;
    offsets.resize((points.size() + 7) / 8);
    for (std::size_t i = 0; i < points.size(); i += 8) {
      const std::size_t n = std::min<std::size_t>(8, points.size() - i);
      impl::Displacement& d = offsets[i / 8];
      impl::warp_kernels().displace_with_jacobian(noise_, points.data() + i, n, d);
      for (std::size_t l = 0; l < n; ++l)
        if (control[i + l] != 0) moved[i + l] += displacement(d, l, control[i + l]);
    }
    work.gradients(*child_, moved, out);
    for (std::size_t i = 0; i < points.size(); ++i)
      if (control[i] != 0) chain(offsets[i / 8], i % 8, control[i], slopes[i], out[i / 8]);
  }

  Interval range(const Box3d& box, PointWork& work) const override {
    const Interval control = control_ ? control_->range(box) : Interval{1, 1};
    return work.range(*child_, grow(box, greatest(control)));
  }

  const Program* still(const Box3d& box) const override {
    if (!control_) return nullptr;
    const Interval control = control_->range(box);
    return control.lo == 0 && control.hi == 0 ? child_.get() : nullptr;
  }

  Interval extent(const Box3d& column, PointWork& work) const override {
    const Vec3d most = greatest({0, 1});
    const Interval child = work.extent(*child_, grow(column, most));
    if (child.lo > child.hi) return child;
    return {child.lo - static_cast<float>(most.z), child.hi + static_cast<float>(most.z)};
  }

  Box3d bounds() const override { return grow(impl::bounds(*child_), greatest({0, 1})); }
  float reach() const override { return child_->reach; }

 private:
  /// The control at each point, or ones.
  const float* controls(std::span<const Vec3d> points, PointWork& work) const {
    auto& control = work.scratch.control;
    control.assign(points.size(), 1.f);
    if (control_) control_->values(points, control);
    return control.data();
  }
  static Vec3d displacement(const impl::Displacement& d, std::size_t l, float control) {
    return to_double(Vec3f{d.d[0][l] * control, d.d[1][l] * control, d.d[2][l] * control});
  }
  /// grad f(p + c(p) d(p)) = (1 + c Jd + d grad(c)^T)^T grad f
  static void chain(const impl::Displacement& d, std::size_t l, float c, Vec3f dc, impl::PointValues& f) {
    const float g[3] = {f.gx[l], f.gy[l], f.gz[l]};
    const float slope[3] = {dc.x, dc.y, dc.z};
    float sum[3];
    for (int j = 0; j < 3; ++j) {
      sum[j] = g[j];
      for (int i = 0; i < 3; ++i) sum[j] += g[i] * (c * d.jacobian[3 * i + j][l] + d.d[i][l] * slope[j]);
    }
    f.gx[l] = sum[0], f.gy[l] = sum[1], f.gz[l] = sum[2];
  }
  /// The greatest displacement along each axis, rounding included.
  Vec3d greatest(Interval control) const {
    const double c = std::max(std::fabs(control.lo), std::fabs(control.hi));
    const double k = c * over;
    return {k * noise_.amplitude[0], k * noise_.amplitude[1], k * noise_.amplitude[2]};
  }

  std::shared_ptr<const Program> child_;
  FunctionPtr control_;
  impl::WarpNoise noise_;
};

class WarpNode final : public impl::NestedNode {
 public:
  WarpNode(NodePtr child, FunctionPtr control, const WarpSettings& settings)
      : child_(std::move(child)), control_(std::move(control)), settings_(settings) {}
  std::shared_ptr<const impl::Nested> compile(impl::Compiler& compiler) const override {
    return std::make_shared<Warped>(compiler.program(child_), control_, settings_);
  }
  NodePtr child() const override { return child_; }
  int depth_below() const override { return impl::depth_of(control_.get()); }
  Box3d support(const Box3d& child) const override { return grow(child, settings_.amplitude * over); }
  std::uint64_t bytes() const override { return sizeof(*this); }

 private:
  NodePtr child_;
  FunctionPtr control_;
  WarpSettings settings_;
};

}  // namespace

NodePtr warp(NodePtr below, FunctionPtr control, const WarpSettings& settings) {
  const Vec3d a = settings.amplitude;
  if (!(a.x >= 0 && a.y >= 0 && a.z >= 0) || !std::isfinite(a.x + a.y + a.z))
    fail(ErrorKind::usage, "a warp's amplitudes must be lengths in metres");
  if (!(settings.lateral > 0) || !(settings.vertical > 0) ||
      !std::isfinite(settings.lateral + settings.vertical))
    fail(ErrorKind::usage, "a warp's wavelengths must be positive lengths in metres");
  if (settings.octaves < 1 || settings.octaves > 12)
    fail(ErrorKind::usage, "a warp wants 1 to 12 octaves, not {}", settings.octaves);
  if (a == Vec3d{}) return below;
  return impl::make_nested(std::make_unique<WarpNode>(std::move(below), std::move(control), settings));
}

namespace operator_warp {
const OperatorType& declaration() {
  struct Params {
    double lateral_amplitude = 2, vertical_amplitude = 1, lateral = 20, vertical = 20;
    std::int64_t octaves = 3;
  };
  static const OperatorType type{
      .about = {.name = "warp",
                .doc = "Moves the positions at which a tree is asked by noise, where a control field says so",
                .source = "[Paris19 §5.3]",
                .params =
                    ParamTable<Params>()
                        .real("lateral_amplitude", &Params::lateral_amplitude, "m", 0, 1e4,
                              "How far along x and y a point is moved at most: more bends the tree more")
                        .real("vertical_amplitude", &Params::vertical_amplitude, "m", 0, 1e4,
                              "How far along z a point is moved at most: more bends the tree more")
                        .real("lateral", &Params::lateral, "m", 1e-2, 1e6,
                              "Wavelength of the noise along x and y: less makes smaller bends")
                        .real("vertical", &Params::vertical, "m", 1e-2, 1e6,
                              "Wavelength of the noise along z: less makes smaller bends")
                        .integer("octaves", &Params::octaves, "", 1, 12,
                                 "How many layers of noise, each of half the wavelength, are added: more "
                                 "gives finer detail")},
  };
  return type;
}
}  // namespace operator_warp

}  // namespace tafoni::field
