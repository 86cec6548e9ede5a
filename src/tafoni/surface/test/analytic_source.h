#pragma once
// A field given as a function, sampled chunk by chunk, to test the polygonizer without a field engine.

#include <cmath>
#include <functional>

#include "tafoni/field/chunks.h"
#include "tafoni/math/whole.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface::test {

using Function = std::function<double(Vec3d)>;

/// Samples f on every lattice point of every chunk of the region; a brick is active when its samples differ
/// in sign. Samples that no active brick needs are spoilt, so that using one shows.
class AnalyticSource : public SampleSource {
 public:
  AnalyticSource(Function f, double voxel, const Box3d& region)
      : f_(std::move(f)), voxel_(voxel), first_(chunk_of(region.lo.z)), last_(chunk_of(region.hi.z)) {}

  Range column(int a, int b) override {
    a_ = a, b_ = b;
    return {first_, last_};
  }
  bool evaluate(int c, field::ChunkSamples& out) override {
    using S = field::ChunkSamples;
    constexpr int n = field::chunk_cells;
    out.chunk = {a_, b_, c};
    out.f.assign(std::size_t{S::nx} * S::ny * S::nz, 1e30f);
    const auto at = [](int i, int j, int k) { return (k * S::ny + j) * S::nx + i; };
    for (int k = 0; k <= n; ++k)
      for (int j = 0; j <= n; ++j)
        for (int i = 0; i <= n; ++i)
          out.f[at(i, j, k)] =
              static_cast<float>(f_({(a_ * n + i) * voxel_, (b_ * n + j) * voxel_, (c * n + k) * voxel_}));
    std::vector<bool> needed(out.f.size(), false);
    for (int bz = 0; bz < 8; ++bz) {
      out.active[bz] = 0;
      for (int by = 0; by < 8; ++by)
        for (int bx = 0; bx < 8; ++bx) {
          int solid = 0;
          const auto each = [&](const auto& visit) {
            for (int k = 8 * bz; k <= 8 * bz + 8; ++k)
              for (int j = 8 * by; j <= 8 * by + 8; ++j)
                for (int i = 8 * bx; i <= 8 * bx + 8; ++i) visit(at(i, j, k));
          };
          each([&](std::size_t s) { solid += out.f[s] > 0; });
          if (solid == 0 || solid == 729) continue;
          out.active[bz] |= std::uint64_t{1} << (by * 8 + bx);
          each([&](std::size_t s) { needed[s] = true; });
        }
    }
    for (std::size_t s = 0; s < out.f.size(); ++s)
      if (!needed[s]) out.f[s] = s % 2 ? 1e30f : -1e30f;
    return out.any();
  }
  void gradients(std::span<const Vec3d> points, std::span<float> values,
                 std::span<Vec3f> gradients) override {
    const double h = 1e-4;
    for (std::size_t p = 0; p < points.size(); ++p) {
      const Vec3d q = points[p];
      values[p] = static_cast<float>(f_(q));
      const auto d = [&](Vec3d e) { return (f_(q + e) - f_(q - e)) / (2 * h); };
      gradients[p] = to_float({d({h, 0, 0}), d({0, h, 0}), d({0, 0, h})});
    }
  }

 private:
  int chunk_of(double z) const { return floor_to(z / voxel_ / field::chunk_cells); }

  Function f_;
  double voxel_;
  int first_, last_;
  int a_ = 0, b_ = 0;
};

inline SourceFactory analytic(Function f, double voxel, const Box3d& region) {
  return [=] { return std::make_unique<AnalyticSource>(f, voxel, region); };
}

inline mesh::Mesh mesh_of(const Function& f, const PolygonizeSettings& settings,
                          PolygonizeStats* stats = nullptr) {
  return polygonize(analytic(f, settings.voxel, settings.region), settings.region, settings, silent(), stats);
}

inline Function sphere(Vec3d center, double radius) {
  return [=](Vec3d p) { return radius - length(p - center); };
}

/// Around the z axis.
inline Function torus(double ring, double tube) {
  return [=](Vec3d p) { return tube - std::hypot(std::hypot(p.x, p.y) - ring, p.z); };
}

}  // namespace tafoni::surface::test
