#include "tafoni/surface/sample_source.h"

#include "tafoni/surface/impl/field_source.h"
#include "tafoni/surface/polygonize.h"

namespace tafoni::surface {
SourceFactory field_source(const field::CompiledField& field, double voxel, Progress& progress) {
  return [&field, voxel, &progress] { return std::make_unique<impl::FieldSource>(field, voxel, &progress); };
}

mesh::Mesh polygonize(const field::CompiledField& field, const PolygonizeSettings& settings,
                      Progress& progress, PolygonizeStats* stats) {
  return polygonize(field_source(field, settings.voxel, progress), field.bounds(), settings, progress, stats);
}

void polygonize_tiles(const field::CompiledField& field, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress, PolygonizeStats* stats) {
  polygonize_tiles(field_source(field, settings.voxel, progress), field.bounds(), settings, sink, progress,
                   stats);
}

}  // namespace tafoni::surface
