// Embree: the mesh's triangles as one geometry, asked one ray at a time.

#include "tafoni/render/impl/tracer.h"

#include <cstring>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/render/impl/embree.h"

namespace tafoni::render::impl {
namespace {

/// Embree calls this often while it builds; false stops it.
bool go_on(void* progress, double) {
  return !static_cast<Progress*>(progress)->cancelled();
}

RTCRayHit ray_of(Vec3f from, Vec3f direction, float limit) {
  RTCRayHit query{};
  query.ray.org_x = from.x;
  query.ray.org_y = from.y;
  query.ray.org_z = from.z;
  query.ray.dir_x = direction.x;
  query.ray.dir_y = direction.y;
  query.ray.dir_z = direction.z;
  query.ray.tfar = limit;
  query.ray.mask = 0xffffffffu;
  query.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  return query;
}

}  // namespace

Tracer::Tracer(const mesh::Mesh& mesh, Progress& progress)
    : device_(nullptr, &rtcReleaseDevice), scene_(nullptr, &rtcReleaseScene) {
  progress.begin("indexing triangles for the picture", mesh.triangles.size(), "triangles");
  device_.reset(rtcNewDevice(nullptr));
  if (!device_) fail(ErrorKind::internal, "Embree cannot start on this machine.");
  RTCGeometry geometry = rtcNewGeometry(device_.get(), RTC_GEOMETRY_TYPE_TRIANGLE);
  // Embree reads 16 bytes at a vertex, so a buffer of its own, which it pads, is needed.
  void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                           sizeof(Vec3f), mesh.positions.size());
  if (vertices) std::memcpy(vertices, mesh.positions.data(), mesh.positions.size() * sizeof(Vec3f));
  rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  rtcCommitGeometry(geometry);
  scene_.reset(rtcNewScene(device_.get()));
  const int flags = RTC_SCENE_FLAG_ROBUST | (mesh.triangles.size() > 8'000'000 ? RTC_SCENE_FLAG_COMPACT : 0);
  rtcSetSceneFlags(scene_.get(), static_cast<RTCSceneFlags>(flags));
  rtcAttachGeometry(scene_.get(), geometry);
  rtcReleaseGeometry(geometry);
  rtcSetSceneProgressMonitorFunction(scene_.get(), go_on, &progress);
  // Joined from inside of our own loop, the build uses our threads and no others.
  parallel_for(1, [&](std::int64_t) { rtcJoinCommitScene(scene_.get()); });
  rtcSetSceneProgressMonitorFunction(scene_.get(), nullptr, nullptr);
  const RTCError error = rtcGetDeviceError(device_.get());
  if (error != RTC_ERROR_NONE) {
    progress.check();
    fail(ErrorKind::output, "The picture's ray tracing index cannot be built: {}.",
         error == RTC_ERROR_OUT_OF_MEMORY ? "out of memory; simplify the mesh" : "Embree reports an error");
  }
  progress.advance(mesh.triangles.size());
  progress.end();
}

Hit Tracer::closest(Vec3f from, Vec3f direction, float limit) const {
  RTCRayHit query = ray_of(from, direction, limit);
  intersect(scene_.get(), query);
  if (query.hit.geomID == RTC_INVALID_GEOMETRY_ID) return {};
  return {query.ray.tfar, query.hit.primID, query.hit.u, query.hit.v,
          normalized(Vec3f{query.hit.Ng_x, query.hit.Ng_y, query.hit.Ng_z})};
}

bool Tracer::blocked(Vec3f from, Vec3f direction, float limit) const {
  RTCRayHit query = ray_of(from, direction, limit);
  return occluded(scene_.get(), query.ray);
}

}  // namespace tafoni::render::impl
