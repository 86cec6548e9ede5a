// RoomAlongWay and floor are functions of the distance to the stretches of the way, by plain search: a way
// has some dozens. Their intervals follow from how fast a value can change along a line.

#include "tafoni/landforms/grammar-cave/cave_way.h"

#include <algorithm>
#include <cmath>

#include "tafoni/field/each_point.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/noise.h"

namespace tafoni::landforms::impl {
namespace {

/// Where on a stretch, from 0 to 1, a point is nearest; in plan where `flat`.
double along(const Stretch& s, Vec3d p, bool flat) {
  Vec3d way = s.to - s.from, off = p - s.from;
  if (flat) way.z = off.z = 0;
  const double square = dot(way, way);
  return square > 0 ? std::clamp(dot(off, way) / square, 0.0, 1.0) : 0;
}

constexpr double cosine = 0.9702957262759965, sine = 0.2419218955996677;  // of the 14 degrees beside the way
constexpr double bump_length = 3.5;  // metres; wavelength of the bumps, chosen by eye

/// Where a stretch is nearest in plan, and how far beyond its level width.
struct Beside {
  Vec3d on;
  double off;
};
Beside beside(const Stretch& s, Vec3d p) {
  const Vec3d on = s.from + (s.to - s.from) * along(s, p, true);
  return {on, std::max(0.0, std::hypot(p.x - on.x, p.y - on.y) - s.width)};
}

/// A function whose value changes by no more than `slope` times the way that is gone.
class Gentle : public field::Function {
 public:
  Gentle(std::vector<Stretch> way, const WaySettings& settings, double slope, double slack)
      : way_(std::move(way)), settings_(settings), slope_(slope), slack_(slack) {}

  void values(std::span<const Vec3d> points, std::span<float> out) const override {
    field::each_point(points, out, [this](Vec3d p) { return at(p); });
  }
  Interval range(const Box3d& box) const override {
    const double middle = plain(box.center()), way = slope_ * length(box.size()) / 2 + slack_ + 1e-3;
    return rounded(middle - way, middle + way);
  }
  double step() const override { return 0.01; }

 protected:
  virtual double plain(Vec3d p) const = 0;
  /// plain(), but for `slack` at most.
  virtual double at(Vec3d p) const { return plain(p); }

  std::vector<Stretch> way_;
  WaySettings settings_;

 private:
  double slope_, slack_;
};

class RoomAlongWay final : public Gentle {
 public:
  RoomAlongWay(std::vector<Stretch> way, const WaySettings& settings)
      : Gentle(std::move(way), settings, 1, 0) {
    std::erase_if(way_, [](const Stretch& s) { return !s.room; });
    for (Stretch& s : way_) s.from.z += settings.lift, s.to.z += settings.lift;
  }

 private:
  double plain(Vec3d p) const override {
    double least = 1e12;
    for (const Stretch& s : way_) {
      const Vec3d d = p - (s.from + (s.to - s.from) * along(s, p, false));
      least = std::min(least, dot(d, d));
    }
    return settings_.radius - std::sqrt(least);
  }
};

class Floor final : public Gentle {
 public:
  // Across, 14 degrees; along, a stretch has 27 at most. Both at once change it by 1.2 times the way.
  Floor(std::vector<Stretch> way, const WaySettings& settings)
      : Gentle(std::move(way), settings, 1.2, settings.bumps) {}

 private:
  double plain(Vec3d p) const override {
    double most = -1e12;
    for (const Stretch& s : way_) {
      const auto [on, off] = beside(s, p);
      most = std::max(most, std::min((on.z - p.z) * cosine - off * sine, p.z - (on.z - settings_.depth)));
    }
    return most;
  }
  double at(Vec3d p) const override {
    const double value = plain(p);
    // Away from its surface nothing depends on the bumps.
    if (std::abs(value) > 2 * settings_.bumps) return value;
    const double share = 1 - std::abs(value) / (2 * settings_.bumps);
    const double t = fbm(p * (1 / bump_length), 2, settings_.seed);
    return value + settings_.bumps * (2 * t - 1) * share;
  }
};

class Outside final : public Gentle {
 public:
  Outside(const Box3d& box, double steep) : Gentle({}, {}, steep, 0), box_(box), steep_(steep) {}

 private:
  double plain(Vec3d p) const override {
    const Vec3d below = box_.lo - p, above = p - box_.hi;
    return steep_ * std::max({below.x, below.y, below.z, above.x, above.y, above.z});
  }

  Box3d box_;
  double steep_;
};

}  // namespace

field::FunctionPtr outside_of(const Box3d& box, double steep) {
  return std::make_shared<Outside>(box, steep);
}

FloorAt floor_at(const Stretch& stretch, Vec3d p) {
  const auto [on, off] = beside(stretch, p);
  return {on.z - off * sine / cosine, on.z};
}

field::FunctionPtr room_of(std::vector<Stretch> way, const WaySettings& settings) {
  return std::make_shared<RoomAlongWay>(std::move(way), settings);
}

field::FunctionPtr floor_of(std::vector<Stretch> way, const WaySettings& settings) {
  return std::make_shared<Floor>(std::move(way), settings);
}

}  // namespace tafoni::landforms::impl
