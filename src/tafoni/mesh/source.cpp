#include "tafoni/mesh/source.h"

#include "tafoni/mesh/impl/field_source.h"
#include "tafoni/mesh/polygonize.h"

namespace tafoni::mesh {
SourceFactory field_source(const field::CompiledField& field, double voxel, Progress& progress) {
  return [&field, voxel, &progress] { return std::make_unique<impl::FieldSource>(field, voxel, &progress); };
}

Mesh polygonize(const field::CompiledField& field, const PolygonizeSettings& settings, Progress& progress,
                PolygonizeStats* stats) {
  return polygonize(field_source(field, settings.voxel, progress), field.bounds(), settings, progress, stats);
}

void polygonize_tiles(const field::CompiledField& field, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress, PolygonizeStats* stats) {
  polygonize_tiles(field_source(field, settings.voxel, progress), field.bounds(), settings, sink, progress,
                   stats);
}

}  // namespace tafoni::mesh
