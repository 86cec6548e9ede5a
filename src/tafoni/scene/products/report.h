#pragma once
// The report of a scene: numbers for those who print them, and all of it as JSON.

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "tafoni/mesh/metrics.h"
#include "tafoni/scene/products/mesh_scene.h"

namespace tafoni::scene {

/// What a report tells of a mesh, simplified or not.
struct MeshCounts {
  std::uint64_t vertices = 0, triangles = 0;
  std::uint64_t components = 0;                         ///< without those that were removed
  std::uint64_t fragments_removed = 0;                  ///< pieces of rock that floated
  std::uint64_t bubbles_removed = 0;                    ///< pieces of air within rock
  std::uint64_t samples_evaluated = 0;                  ///< of the field
  std::optional<std::uint64_t> triangles_unsimplified;  ///< of a mesh that was simplified
  std::optional<mesh::MeshMetrics> metrics;             ///< of a mesh that was kept whole
};

/// Of stages, by name.
using Seconds = std::vector<std::pair<std::string, double>>;

class Report {
 public:
  /// `result` is null for a scene that was not meshed. Both must outlive the report. `after` are the stages
  /// that came after the mesh.
  Report(const BuiltScene& scene, const MeshResult* result, Seconds after = {});

  /// Nothing where the scene was not meshed.
  const std::optional<MeshCounts>& mesh() const { return mesh_; }
  std::string json(std::span<const std::string> warnings) const;

 private:
  const BuiltScene& scene_;
  const MeshResult* result_;
  std::optional<MeshCounts> mesh_;
  Seconds after_;
};

}  // namespace tafoni::scene
