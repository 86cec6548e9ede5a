#pragma once
// Fractal volumes by 3D midpoint subdivision [Ju01 §2, §4].

#include <cstdint>
#include <memory>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

/// Draws values towards one at a place: a hill, a hollow, an entrance. Later levels refine around it.
struct Pin {
  Vec3d position;     ///< local metres
  double value = 0;   ///< of the sample nearest to the position, exactly, in this level and all later ones
  double radius = 0;  ///< metres over which its draw falls off to 0; 0: that sample alone
  int level = 0;      ///< after which subdivision it acts, 0 for the coarse lattice; below levels
};

struct FractalSettings {
  Vec3d origin;          ///< local position of sample (0, 0, 0)
  double spacing = 1;    ///< metres between samples after the last subdivision
  Vec3i cells{2, 2, 1};  ///< of the coarse lattice, at least one a side
  /// (cells.x + 1) (cells.y + 1) (cells.z + 1) values, x fastest: the first levels, as coarse or as fine as
  /// they are to be given.
  std::vector<float> coarse;
  int levels = 6;  ///< subdivisions
  std::vector<double>
      noise;  ///< most that a new sample is off the smooth one, by level; none for the last: 0
  std::vector<Pin> pins;
  /// Values are limited to +-limit at last, so that what is far from the surface takes no memory.
  double limit = 1e30;
  std::uint64_t seed = 0;

  /// Samples a side: cells << levels, and one.
  Vec3i size() const { return {(cells.x << levels) + 1, (cells.y << levels) + 1, (cells.z << levels) + 1}; }
};

/// Each subdivision keeps every sample and puts a new one in the middle of every edge, face and cell. Its
/// value is the four-point interpolation of [Dubuc86], -1 9 9 -1 over 16, along each axis in which it is
/// new, plus noise that is uniform in +-amplitude. [Ju01] takes the average of the nearest (1 1 over
/// 2), which leaves creases along the planes of every lattice, plainest where the last levels are smooth;
/// four points give a C1 surface without them, keep planes exactly, and cost about as much. Beyond the border
/// values go on straight. Noise is a function of (seed, level, sample), so any part of the lattice, on any
/// number of threads, has the same bits.
class Fractal {
 public:
  /// Makes all levels but the last: an eighth of the work, and half a byte a sample. Throws Error{usage} for
  /// a wrong number of values, for what is not finite, and for more than 2^40 samples.
  explicit Fractal(FractalSettings settings, Progress& progress = silent());

  const FractalSettings& settings() const { return settings_; }
  /// out[(z * ny + y) * nx + x], counted from box.lo; a box within the lattice.
  void read(const SampleBox& box, float* out) const;
  /// Encloses the values of the box, before limiting.
  Interval range(const SampleBox& box) const;
  /// The samples of `box`. Chunks that are at the limit throughout take neither time nor memory.
  ScalarGrid grid(const SampleBox& box, Precision precision = Precision::single,
                  Progress& progress = silent()) const;
  /// Gives all samples.
  ScalarGrid grid(Precision precision = Precision::single, Progress& progress = silent()) const;

 private:
  struct Level {
    Vec3i size;
    std::vector<float> values;
  };
  void pin(int level, Level& values) const;

  FractalSettings settings_;
  Level last_;  ///< the last but one of all
};

/// Amplitudes by level for `noise`: scale times decay to the level's power, the last `smooth` of them 0. The
/// lower the decay, the smoother: 0.5 keeps hills of every size equally steep.
std::vector<double> decaying_noise(double scale, double decay, int levels, int smooth);

}  // namespace tafoni::volume
