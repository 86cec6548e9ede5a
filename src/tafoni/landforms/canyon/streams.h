#pragma once
// Rivers of a terrain and what they do to their banks [Paris19 §6.1]: found once, by stream power, as rasters
// of the floods' stress, the bed's elevation and the flow, which any place is looked up in.

#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

struct StreamSettings {
  double threshold = 0.12;  ///< share of the terrain's greatest stream power from which water is a river
  double catchment = 0;     ///< m^2 that a river drains at least
  double flood = 1.5;       ///< metres that floods rise above the bed
  /// Metres that they act beyond what they cover, and a third of what they cover at most.
  double banks = 12;
};

/// Stream power is sigma = A^(1/2) s over the filled terrain, with the A of [Freeman91]. As a sheer face
/// outdoes any river by its slope, s is averaged over a few pixels and kept within [0.02, 0.35]; and as water
/// on a plain slope is no river however long the slope, a river needs a catchment too.
class Streams {
 public:
  Streams(const Ground& ground, const StreamSettings& settings, Progress& progress);

  /// How many cells the river bed has.
  std::size_t cells() const { return cells_; }

  struct Bank {
    double stress = 0;  ///< [0, 1]; 0 out of reach of every flood
    double bed = 0;     ///< elevation of the river there, local metres
    Vec2d flow;         ///< unit, or 0
  };
  Bank at(Vec3d p) const;
  /// Whether a flood may reach places within `around` metres of p, if it acts up to `height` above the bed.
  bool near(Vec3d p, double around, double height) const;

  struct Course {
    std::vector<Vec3d> line;  ///< on the bed, upstream from where it leaves or joins another; a pixel apart
    std::vector<double> stress;
  };
  /// The `count` strongest rivers, the main stem first, then its greatest tributaries.
  std::vector<Course> courses(std::size_t count) const;

 private:
  raster::Grid<float> power(Progress& progress);
  bool rim(int col, int row) const;
  void flood(raster::Grid<float>& stress, raster::Grid<float>& level) const;
  void spread();
  std::ptrdiff_t receiver(std::ptrdiff_t cell) const;
  Course trace(std::ptrdiff_t mouth, std::vector<bool>& taken) const;

  const Ground& ground_;
  StreamSettings settings_;
  raster::Raster filled_;
  raster::Grid<float> area_, stress_;  ///< of the river's cells alone
  struct Reach {
    float stress = 0, bed = 0, flow_x = 0, flow_y = 0;
  };
  raster::Grid<Reach> reach_;
  raster::Grid<float> tiles_;  ///< of 8 x 8 cells each: the highest bed of those that have stress
  std::size_t cells_ = 0;
};

}  // namespace tafoni::landforms::impl
