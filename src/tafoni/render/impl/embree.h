#pragma once
// Embree 3 and 4 alike: what differs is how a ray is cast. CMake says by TAFONI_EMBREE which one it found.

#if TAFONI_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

namespace tafoni::render::impl {

/// Finds the nearest hit; without one the ray's geomID stays as it is.
inline void intersect(RTCScene scene, RTCRayHit& ray) {
#if TAFONI_EMBREE >= 4
  rtcIntersect1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcIntersect1(scene, &context, &ray);
#endif
}

/// Whether anything lies on the ray. Its tfar is minus infinity then.
inline bool occluded(RTCScene scene, RTCRay& ray) {
#if TAFONI_EMBREE >= 4
  rtcOccluded1(scene, &ray);
#else
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded1(scene, &context, &ray);
#endif
  return ray.tfar < 0;
}

}  // namespace tafoni::render::impl
