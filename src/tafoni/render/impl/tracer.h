#pragma once
// Embree behind two questions: what does a ray meet first, and does it meet anything.

#include <cstdint>
#include <limits>
#include <memory>

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"
#include "tafoni/mesh/mesh.h"

struct RTCDeviceTy;
struct RTCSceneTy;

namespace tafoni::render::impl {

inline constexpr float far_away = std::numeric_limits<float>::infinity();

/// What a ray met. Positions are local to the mesh's origin.
struct Hit {
  float t = far_away;
  std::uint32_t triangle = 0;
  float u = 0, v = 0;  ///< barycentric, of the second and third corner
  Vec3f face;          ///< unit normal of the triangle, outward as the mesh has it
  explicit operator bool() const { return t < far_away; }
};

class Tracer {
 public:
  /// `positions` are copied, `triangles` are shared with the mesh.
  Tracer(const mesh::Mesh& mesh, Progress& progress);

  Hit closest(Vec3f from, Vec3f direction, float limit = far_away) const;
  bool blocked(Vec3f from, Vec3f direction, float limit = far_away) const;

 private:
  // Owned each by itself: a cancelled constructor must free them too. The scene goes before its device.
  std::unique_ptr<RTCDeviceTy, void (*)(RTCDeviceTy*)> device_;
  std::unique_ptr<RTCSceneTy, void (*)(RTCSceneTy*)> scene_;
};

}  // namespace tafoni::render::impl
