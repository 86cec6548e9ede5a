#pragma once
// A compiled field as the polygonizer takes it.

#include "tafoni/field/chunks.h"
#include "tafoni/surface/sample_source.h"

namespace tafoni::surface::impl {

class FieldSource : public SampleSource {
 public:
  /// `progress` may be null.
  FieldSource(const field::CompiledField& field, double voxel, const Progress* progress = nullptr)
      : evaluator_(field, voxel) {
    if (progress) evaluator_.watch(*progress);
  }
  Range column(int a, int b) override { return evaluator_.column(a, b); }
  bool evaluate(int c, field::ChunkSamples& out) override { return evaluator_.evaluate(c, out); }
  bool evaluate(int c, const field::BrickBox& box, field::ChunkSamples& out) {
    return evaluator_.evaluate(c, box, out);
  }
  void gradients(std::span<const Vec3d> points, std::span<float> values,
                 std::span<Vec3f> gradients) override {
    evaluator_.gradients(points, values, gradients);
  }

 private:
  field::ChunkEvaluator evaluator_;
};

}  // namespace tafoni::surface::impl
