#include "tafoni/mesh/source.h"

#include "tafoni/mesh/polygonize.h"

namespace tafoni::mesh {
namespace {

class FieldSource : public SampleSource {
 public:
  FieldSource(const field::CompiledField& field, double voxel) : evaluator_(field, voxel) {}
  Range column(int a, int b) override { return evaluator_.column(a, b); }
  bool evaluate(int c, field::ChunkSamples& out) override { return evaluator_.evaluate(c, out); }
  void gradients(std::span<const Vec3d> points, std::span<float> values,
                 std::span<Vec3f> gradients) override {
    evaluator_.gradients(points, values, gradients);
  }

 private:
  field::ChunkEvaluator evaluator_;
};

}  // namespace

SourceFactory field_source(const field::CompiledField& field, double voxel) {
  return [&field, voxel] { return std::make_unique<FieldSource>(field, voxel); };
}

Mesh polygonize(const field::CompiledField& field, const PolygonizeSettings& settings, Progress& progress,
                PolygonizeStats* stats) {
  return polygonize(field_source(field, settings.voxel), field.bounds(), settings, progress, stats);
}

void polygonize_tiles(const field::CompiledField& field, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress, PolygonizeStats* stats) {
  polygonize_tiles(field_source(field, settings.voxel), field.bounds(), settings, sink, progress, stats);
}

}  // namespace tafoni::mesh
