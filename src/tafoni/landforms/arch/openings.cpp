// Windows and bridges as rock shapes: superellipses across the way, each of whose values falls with the
// distance from its axis, so that ranges over boxes follow from the box's extents along the shape's own axes.

#include "tafoni/landforms/arch/openings.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

/// Chosen by eye.
namespace openings_look {
// Powers of the superellipses: a window's vault and its flat floor with rounded corners; a bridge's section.
constexpr double vault = 2.3, floor = 5;
// How a window's section meets its far ends: the powers of both in a superellipse, so that it stays wide.
constexpr double section = 6, lengthways = 12;
constexpr double bridge_section = 3;
// Share of its span that each end of a bridge reaches into the rock.
constexpr double overhang = 0.12;
// How much broader and deeper a bridge is at its ends than in the middle, and by which power of the way
// there.
constexpr double end_breadth = 0.9, end_depth = 1.6, end_power = 3;
// A bridge bends to the side as a sine of so many radians from end to end, from this one on.
constexpr double bend = 3.1, bend_start = 0.4;
// Bounds of what follows from these: of the slope of the bend, in wanders a span, and of the line's, in
// rises; of the ends' thickness, in the middle's, and of how far they reach beyond the span, in spans.
constexpr double bend_slope = 6, rise_slope = 5.5, thickest = 3.2, beyond = 0.3;
}  // namespace openings_look

struct Span {
  double lo, hi;
  double least() const { return lo > 0 ? lo : hi < 0 ? -hi : 0; }  ///< of the magnitude
  double most() const { return std::max(-lo, hi); }
};

/// The box's extent along a unit direction, from `zero`.
Span along(const Box3d& box, Vec3d zero, Vec3d d) {
  const double middle = dot(box.center() - zero, d);
  const Vec3d half = 0.5 * box.size();
  const double r = std::abs(d.x) * half.x + std::abs(d.y) * half.y + std::abs(d.z) * half.z;
  return {middle - r, middle + r};
}

class WindowShape final : public RockShape {
 public:
  WindowShape(const Window& w, const RockTexture& texture)
      : RockShape(texture), w_(w), along_(w.along()), least_(std::min(w.half_width, w.half_height)) {}

 protected:
  double body(Vec3d p) const override {
    const Vec3d d = p - w_.center;
    const double tunnel = tube(std::abs(dot(d, along_)), d.z, std::abs(dot(d, w_.through)));
    if (w_.shaft_radius <= 0) return tunnel;
    const Vec3d from = d - w_.through * w_.shaft_at;
    return std::max(tunnel, shaft(std::hypot(from.x, from.y), d.z));
  }

  Range body_range(const Box3d& box) const override {
    const Span s = impl::along(box, w_.center, along_), t = impl::along(box, w_.center, {0, 0, 1}),
               w = impl::along(box, w_.center, w_.through);
    Range r{std::min(tube(s.most(), t.lo, w.most()), tube(s.most(), t.hi, w.most())),
            tube(s.least(), std::clamp(0.0, t.lo, t.hi), w.least())};
    if (w_.shaft_radius <= 0) return r;
    const Vec3d middle = w_.center + w_.through * w_.shaft_at;
    const Span x = impl::along(box, middle, {1, 0, 0}), y = impl::along(box, middle, {0, 1, 0});
    const double near = std::hypot(x.least(), y.least()), far = std::hypot(x.most(), y.most());
    r.lo = std::max(r.lo, std::min(shaft(far, t.lo), shaft(far, t.hi)));
    r.hi = std::max(r.hi, std::min({w_.shaft_radius - near, t.hi + w_.half_height, w_.shaft_top - t.lo}));
    return r;
  }

 private:
  /// The tunnel's value at distances sideways, upwards and lengthways; it falls with the magnitude of each.
  double tube(double s, double t, double w) const {
    const double a = s / w_.half_width, l = w / w_.half_length;
    const double b = std::abs(t) / w_.half_height;
    // The roof is vaulted, the floor flat with rounded corners.
    const double n = t > 0 ? openings_look::vault : openings_look::floor;
    const double section = std::pow(std::pow(a, n) + std::pow(b, n), 1 / n);
    return (1 - std::pow(std::pow(section, openings_look::section) + std::pow(l, openings_look::lengthways),
                         1 / openings_look::section)) *
           least_;
  }

  /// The shaft's value at a distance from its axis and a height above the window's centre.
  double shaft(double r, double t) const {
    return std::min({w_.shaft_radius - r, t + w_.half_height, w_.shaft_top - t});
  }

  Window w_;
  Vec3d along_;
  double least_;
};

class BridgeShape final : public RockShape {
 public:
  BridgeShape(const Bridge& b, const RockTexture& texture) : RockShape(texture), b_(b) {
    const Vec3d d = b.to - b.from;
    ahead_ = normalized(Vec3d{d.x, d.y, 0});
    side_ = {-ahead_.y, ahead_.x, 0};
    span_ = std::max(std::hypot(d.x, d.y), 1e-3);
  }

 protected:
  double body(Vec3d p) const override {
    const Vec3d d = p - b_.from;
    return value(dot(d, ahead_) / span_, dot(d, side_), p.z);
  }

  Range body_range(const Box3d& box) const override {
    const Span u = impl::along(box, b_.from, ahead_), s = impl::along(box, b_.from, side_);
    // In short pieces lengthways the curve, the breadth and the depth vary little.
    constexpr int most_pieces = 64;
    const double lo = std::clamp(u.lo / span_, -openings_look::overhang, 1 + openings_look::overhang),
                 hi = std::clamp(u.hi / span_, -openings_look::overhang, 1 + openings_look::overhang);
    const int pieces = std::clamp(ceil_to((hi - lo) * most_pieces), 1, 2 * most_pieces);
    Range r{1e30, -1e30};
    for (int i = 0; i < pieces; ++i) {
      const double t0 = lo + (hi - lo) * i / pieces, t1 = lo + (hi - lo) * (i + 1) / pieces;
      const Range piece = piece_range(t0, t1, s, box.lo.z, box.hi.z);
      r.lo = std::min(r.lo, piece.lo);
      r.hi = std::max(r.hi, piece.hi);
    }
    // Beyond the ends the value falls with the distance from them.
    const double beyond = std::max({0.0, u.lo / span_ - (1 + openings_look::overhang),
                                    -openings_look::overhang - u.hi / span_}) *
                          span_;
    const double farthest = std::max({0.0, u.hi / span_ - (1 + openings_look::overhang),
                                      -openings_look::overhang - u.lo / span_}) *
                            span_;
    return {r.lo - farthest, r.hi - beyond};
  }

 private:
  /// 0 in the middle, 1 at the ends and beyond.
  static double end(double t) { return std::clamp(std::abs(2 * t - 1), 0.0, 1.3); }
  double line(double t) const {
    return b_.from.z + (b_.to.z - b_.from.z) * t + b_.rise * (1 - end(t) * end(t));
  }
  double bend(double t) const {
    return b_.wander * std::sin(openings_look::bend * t + openings_look::bend_start) *
           (1 - std::min(1.0, end(t)));
  }
  double breadth(double t) const {
    return b_.width * (1 + openings_look::end_breadth * std::pow(end(t), openings_look::end_power));
  }
  double depth(double t) const {
    return b_.depth * (1 + openings_look::end_depth * std::pow(end(t), openings_look::end_power));
  }

  double value(double t, double s, double z) const {
    const double c = std::clamp(t, -openings_look::overhang, 1 + openings_look::overhang);
    // The deck stays level with the line: what the ends gain in depth they gain below.
    const double middle = line(c) - (depth(c) - b_.depth);
    return round(std::abs(s - bend(c)) / breadth(c), std::abs(z - middle) / depth(c)) -
           std::abs(t - c) * span_;
  }
  double round(double a, double b) const {
    constexpr double n = openings_look::bridge_section;
    return (1 - std::cbrt(std::pow(a, n) + std::pow(b, n))) * std::min(b_.width, b_.depth);
  }

  Range piece_range(double t0, double t1, Span s, double z0, double z1) const {
    const auto both = [&](double a, double b) { return Span{std::min(a, b), std::max(a, b)}; };
    // Each is monotone on either side of the middle; `bend` and `line` are bounded by their slope.
    Span w = both(breadth(t0), breadth(t1)), h = both(depth(t0), depth(t1));
    if (t0 < 0.5 && t1 > 0.5) w.lo = breadth(0.5), h.lo = depth(0.5);
    const double half = 0.5 * (t1 - t0), m = 0.5 * (t0 + t1);
    const double sway = half * openings_look::bend_slope * std::abs(b_.wander);
    const double climb =
        half * (std::abs(b_.to.z - b_.from.z) + openings_look::rise_slope * std::abs(b_.rise));
    const double low = line(m) - climb - (h.hi - b_.depth), high = line(m) + climb - (h.lo - b_.depth);
    const Span side{s.lo - bend(m) - sway, s.hi - bend(m) + sway}, up{z0 - high, z1 - low};
    return {round(side.most() / w.lo, up.most() / h.lo), round(side.least() / w.hi, up.least() / h.hi)};
  }

  Bridge b_;
  Vec3d ahead_, side_;
  double span_;
};

}  // namespace

std::shared_ptr<const RockShape> window_shape(const Window& window, const RockTexture& texture) {
  return std::make_shared<WindowShape>(window, texture);
}

Box3d reach(const Window& w, double margin, double amplitude) {
  const double least = std::min(w.half_width, w.half_height);
  const double grown = 1 + (margin + amplitude) / least;
  const Vec3d u = w.along();
  const auto half = [&](double a, double b) {
    return std::abs(a) * w.half_length * grown + std::abs(b) * w.half_width * grown;
  };
  const Vec3d r{half(w.through.x, u.x), half(w.through.y, u.y), w.half_height * grown};
  Box3d box{w.center - r, w.center + r};
  if (w.shaft_radius > 0) {
    const double more = w.shaft_radius + margin + amplitude;
    const Vec3d middle = w.center + w.through * w.shaft_at;
    box.expand(middle - Vec3d{more, more, w.half_height + margin + amplitude});
    box.expand(middle + Vec3d{more, more, w.shaft_top + margin + amplitude});
  }
  return box;
}

std::shared_ptr<const RockShape> bridge_shape(const Bridge& bridge, const RockTexture& texture) {
  return std::make_shared<BridgeShape>(bridge, texture);
}

Box3d reach(const Bridge& b, double margin, double amplitude) {
  const double grown = openings_look::thickest * std::max(b.width, b.depth) *
                       (1 + (margin + amplitude) / std::min(b.width, b.depth));
  Box3d box;
  const double beyond = openings_look::beyond * length(b.to - b.from) + margin + amplitude;
  box.expand(b.from);
  box.expand(b.to);
  box = box.grown(grown + std::abs(b.wander));
  box.lo.x -= beyond, box.lo.y -= beyond, box.hi.x += beyond, box.hi.y += beyond;
  box.hi.z += std::abs(b.rise);
  box.lo.z -= std::abs(b.rise);
  return box;
}

}  // namespace tafoni::landforms::impl
