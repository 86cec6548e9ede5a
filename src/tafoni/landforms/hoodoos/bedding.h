#pragma once
// Thin level beds within the rock of a geology, the same for everything that grows in a scene.

#include "tafoni/core/random.h"
#include "tafoni/landforms/hoodoos/growth.h"
#include "tafoni/landforms/site/ground.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {

/// Bedding planes lie at fixed world elevations, so that neighbours share their ledges and necks.
class Bedding final : public Surroundings {
 public:
  /// Beds of about `thickness` metres, each harder or softer than its geology by up to `contrast`.
  Bedding(const Ground& ground, double thickness, double contrast)
      : ground_(ground),
        thickness_(thickness),
        contrast_(contrast),
        planes_(ground.site().seed, Stream::planes),
        hardness_(ground.site().seed, Stream::hardness) {}

  double resistance(Vec3d p) const override {
    const Bed bed = at(p.z);
    double sum = 0;
    for (const double t : {0.25, 0.75})
      sum += ground_.resistance({p.x, p.y, bed.foot + t * (bed.top - bed.foot)});
    return std::clamp(sum / 2 + contrast_ * unit(hardness_, bed.index), 0.0, 1.0);
  }
  double ground(Vec3d p) const override { return ground_.height(p.x, p.y); }
  double bed(Vec3d p) const override { return at(p.z).top - p.z; }
  bool allowed(Vec3d p) const override { return ground_.usable(p); }

 private:
  enum class Stream : std::uint64_t { planes = 0xbed0, hardness = 0xbed1 };
  // Chosen by eye: how far a plane moves off its even place, and how much of a bed below its top, in beds.
  static constexpr double uneven = 0.3, sliver = 0.25;

  struct Bed {
    std::int64_t index;
    double foot, top;  ///< local
  };

  /// What lies just below a plane counts with the bed above it, so that no sliver is left.
  Bed at(double z) const {
    const double world = z + ground_.site().origin.z + sliver * thickness_;
    auto k = floor_to<std::int64_t>(world / thickness_);
    while (plane(k) > world) --k;
    while (plane(k + 1) <= world) ++k;
    return {k, plane(k) - ground_.site().origin.z, plane(k + 1) - ground_.site().origin.z};
  }
  double plane(std::int64_t k) const {
    return (static_cast<double>(k) + uneven * unit(planes_, k)) * thickness_;
  }
  /// Uniform in [-1, 1).
  static double unit(const Random& random, std::int64_t i) { return 2 * unit_real(random.at(i)) - 1; }

  const Ground& ground_;
  double thickness_, contrast_;
  Random planes_, hardness_;
};

}  // namespace tafoni::landforms::impl
