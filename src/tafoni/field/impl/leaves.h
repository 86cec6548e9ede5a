#pragma once
// The two leaves that cover the plane: the heightfield and the domain prism [Paris19 §5.1].

#include <algorithm>
#include <cmath>
#include <memory>
#include <vector>

#include "tafoni/field/impl/kernels.h"
#include "tafoni/field/tree.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::field::impl {

/// sigma(x) = x + ((3T-2R)/R^2) x^2 + ((R-2T)/R^3) x^3 on [0, R), T beyond, odd: sigma(0) = 0, sigma'(0) = 1,
/// sigma(R) = T, sigma'(R) = 0. (The paper prints sigma(R) = 2T, with T added.)
struct Sigma {
  float influence, amplitude, k2, k3;
  explicit Sigma(const HeightfieldSettings& settings);
  float operator()(float x) const;
};

/// Where a sample lies along one axis of a raster.
struct Place {
  std::int32_t first;  ///< of the four pixels it takes part of, before clamping to the raster
  float t;             ///< in [0, 1), from the second pixel to the third
  float live;          ///< 0 beyond the border pixel's centre, where the value continues unchanged; else 1
};

/// Interpolates a raster at any position; outside, the border pixel's value continues.
class Sampler {
 public:
  Sampler(std::shared_ptr<const raster::Raster> raster, bool bicubic);

  const raster::Raster& raster() const { return *raster_; }
  /// Slopes are per pixel; these turn them into per metre (north is up, rows go south).
  float slope_x() const { return slope_x_; }
  float slope_y() const { return slope_y_; }
  bool bicubic() const { return bicubic_; }
  Place place_x(double x) const {
    return place((x - raster_->placement.west) * inv_dx_ - 0.5, raster_->width());
  }
  Place place_y(double y) const {
    return place((raster_->placement.north - y) * inv_dy_ - 0.5, raster_->height());
  }

  /// Least and greatest value, and the greatest slope, over a box in x and y.
  struct Range {
    float lo, hi, slope;
  };
  Range range(double x0, double y0, double x1, double y1) const;
  Range range() const { return top_; }

 private:
  static Place place(double pixel, int size) {
    const double clamped = std::clamp(pixel, 0.0, size - 1.0);
    const auto whole = static_cast<std::int32_t>(clamped);  // floor: clamped is not negative
    return {whole - 1, static_cast<float>(clamped - whole), clamped == pixel ? 1.f : 0.f};
  }
  void build_pyramid();
  Range tile_range(int tile_x, int tile_y) const;

  std::shared_ptr<const raster::Raster> raster_;
  bool bicubic_;
  double inv_dx_, inv_dy_;
  float slope_x_, slope_y_;
  std::vector<raster::Grid<Range>> pyramid_;  ///< [0] covers tiles of 16 x 16 pixels
  Range top_{};
};

struct HeightLeaf {
  Sampler sampler;
  Sigma sigma;
  bool first_order;
};

/// Signed distance to the border of what two signed distances of perpendicular borders leave, positive
/// inside. Grows with both.
template <class T>
T corner_distance(T a, T b) {
  return a < 0 && b < 0 ? -std::sqrt(a * a + b * b) : std::min(a, b);
}

struct DomainLeaf {
  Domain domain;
  float base() const { return static_cast<float>(domain.box.lo.z); }
  std::unique_ptr<Sampler> inside;
  Sigma sigma;
};

/// Samples of one axis of a chunk column: 72 places.
struct Axis {
  static constexpr int size = 72;
  double metres[size];
  alignas(32) std::int32_t units[size];
  alignas(32) float rest[size];
  void set(std::int64_t first, double voxel, double origin);
};

/// Per column of a chunk: [65][72]. For a heightfield the height and 1 / sqrt(1 + |grad h|^2) (1 where the
/// distance is vertical); for a domain the signed distance in the plane.
struct Columns {
  static constexpr int rows = 65, stride = 72;
  std::vector<float> value, scale;
};

/// The leaf kernels for this machine's instruction set.
struct LeafKernels {
  void (*height_columns)(const HeightLeaf&, const Axis& x, const Axis& y, Columns&);
  void (*domain_columns)(const DomainLeaf&, const Axis& x, const Axis& y, Columns&);
  /// `value` and `scale` point at the block's first column; their stride is Columns::stride.
  void (*height_block)(const HeightLeaf&, const float* value, const float* scale, const Block&);
  void (*domain_block)(const DomainLeaf&, const float* value, const Block&);
  void (*height_points)(const HeightLeaf&, const Vec3d* p, const PointLanes&, float* f);
  void (*height_gradients)(const HeightLeaf&, const Vec3d* p, const PointLanes&, PointValues&);
  void (*domain_points)(const DomainLeaf&, const Vec3d* p, const PointLanes&, float* f);
  void (*domain_gradients)(const DomainLeaf&, const Vec3d* p, const PointLanes&, PointValues&);
};
const LeafKernels& leaf_kernels();

}  // namespace tafoni::field::impl
