#pragma once
// What the polygonizer needs of a field: samples by chunk and gradients. Lets it run on a compiled field, on
// a volume, or on an analytic function in a test.

#include <functional>
#include <memory>
#include <span>

#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"

namespace tafoni::surface {

/// Each thread has its own source. The contracts of field::ChunkEvaluator hold: samples are valid wherever an
/// active brick needs them, an inactive brick holds no sign change, and all of it is bit-identical between
/// sources.
class SampleSource {
 public:
  using Range = field::ChunkEvaluator::Range;

  virtual ~SampleSource() = default;
  virtual Range column(int a, int b) = 0;
  virtual bool evaluate(int c, field::ChunkSamples& out) = 0;
  /// Values and gradients at local points within the chunk last evaluated.
  virtual void gradients(std::span<const Vec3d> points, std::span<float> values,
                         std::span<Vec3f> gradients) = 0;
};

using SourceFactory = std::function<std::unique_ptr<SampleSource>()>;

/// Sources that evaluate `field` until `progress` is cancelled; both must outlive them.
SourceFactory field_source(const field::CompiledField& field, double voxel, Progress& progress = silent());

}  // namespace tafoni::surface
