#pragma once
// From a document to a field: elevation model, terrain, geology, layers in order.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/field/compiled.h"
#include "tafoni/field/tree.h"
#include "tafoni/geology/geology.h"
#include "tafoni/io/dem.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/surface/polygonize.h"
#include "tafoni/terrain/terrain.h"

namespace tafoni::scene {

/// What a build made of one layer.
struct LayerResult {
  std::string name;  ///< its own or its type's
  std::string type;
  landforms::Result made;  ///< what it does to the tree, and facts
  double seconds = 0;
  bool reused = false;  ///< taken over from an earlier build by the same session
};

/// All that a document describes, before it is meshed. Immutable once built.
struct BuiltScene {
  Document document;
  double voxel = 0;  ///< metres; chosen where the document leaves it open
  std::string crs;   ///< WKT; empty when unknown
  terrain::Terrain terrain;
  field::HeightfieldSettings settings;
  geology::GeologyPtr geology;
  std::vector<LayerResult> layers;                      ///< those enabled
  field::NodePtr open;                                  ///< f_T and the layers
  field::NodePtr solid;                                 ///< the same, cut to the domain: min(open, f_P)
  std::vector<std::pair<std::string, double>> seconds;  ///< by stage

  const field::NodePtr& tree(surface::Boundary boundary) const {
    return boundary == surface::Boundary::solid ? solid : open;
  }
  field::CompiledField field_for(surface::Boundary boundary) const { return field::compile(tree(boundary)); }
  surface::Boundary boundary() const {
    return document.scene.boundary == "open" ? surface::Boundary::open : surface::Boundary::solid;
  }
};

/// Throws Error as the modules below do; a layer's error names the layer.
BuiltScene build(const Document& document, Progress& progress = silent());

/// What a terrain's words ask of reading its source.
io::DemOptions dem_options(const TerrainSection& words);

/// A round voxel size for a raster: a pixel, or a tenth of R where pixels are coarser than what landforms
/// carve, but not so small that the whole is more than about 1,200 cells a side or a pixel more than three,
/// or that heights in a wrong unit, which are steeper than any ground, make a mesh of far more triangles.
double default_voxel(const raster::Raster& raster, double influence);

/// The seed of layers[index]: its own, or one made from the scene's seed, the layer's type and name, and how
/// many layers of the same type and name stand before it, muted or not. So it stays the same when other
/// layers are added, muted or moved.
std::uint64_t layer_seed(const Document& document, std::size_t index);

/// The scene's sea level as a world elevation: what the first enabled layer that knows one says.
std::optional<double> sea_level(const Document& document);

/// The program's version, "0.1.0".
std::string_view version();

}  // namespace tafoni::scene
