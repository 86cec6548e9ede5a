#pragma once
// The seven measures of [Zawadzki §4].

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "tafoni/mesh/convexity.h"
#include "tafoni/mesh/cubes.h"
#include "tafoni/scene/build/build.h"

namespace tafoni::scene {

struct SgmMeasures {
  int detail = 0;     ///< L_D; 0 for a mesh file
  double area = 0;    ///< square metres
  mesh::Cubes cubes;  ///< volume by cubes inside
  double volume = 0;  ///< cubic metres, exactly, from the mesh; of no meaning where it is not closed
  bool closed = false;
  mesh::Convexity convexity;
  std::uint64_t triangles = 0;
  std::optional<std::int64_t> elements,
      productions;                ///< of a scene: solids, and productions that joined them
  std::optional<double> seconds;  ///< of a scene: to grow and polygonize, without counting and measuring
};

/// Measures a mesh, with cubes of `edge` metres.
SgmMeasures sgm_measures(const mesh::Mesh& mesh, double edge, Progress& progress = silent());

/// Measures what a grammar-cave layer makes: a free solid, or the air of a cave as if it were one. One row
/// for each L_D of `details`, with L_D cubes for each size of the layer. Empty: the layer's own L_D. `layer`
/// is its name or type; empty for the first of them. Throws Error{usage} where there is none or it made
/// nothing.
std::vector<SgmMeasures> sgm_measures(const BuiltScene& scene, const std::string& layer,
                                      std::span<const int> details, Progress& progress = silent());

/// The cave or solid itself, positive inside, and a box that holds it; local.
struct SgmSolid {
  field::NodePtr tree;
  Box3d box;
};
SgmSolid sgm_solid(const BuiltScene& scene, const std::string& layer);

}  // namespace tafoni::scene
