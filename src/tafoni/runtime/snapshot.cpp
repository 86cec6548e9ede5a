// Queries in world positions: each is the collider's own, moved by the origin on the way in and back on the
// way out.

#include "tafoni/runtime/impl/snapshot_state.h"

namespace tafoni::runtime {

Snapshot::Snapshot(std::unique_ptr<State> state) : state_(std::move(state)) {}
Snapshot::~Snapshot() = default;

std::uint64_t Snapshot::version() const {
  return state_->version;
}
Vec3d Snapshot::origin() const {
  return state_->origin;
}
const volume::ScalarGrid& Snapshot::grid() const {
  return state_->grid;
}
const query::Collider& Snapshot::collider() const {
  return state_->collider;
}

TerrainChunk Snapshot::chunk(Vec3i chunk) const {
  static const auto nothing = std::make_shared<const surface::GridChunkMesh>();
  const impl::ChunkEntry* entry = state_->chunks.find(chunk);
  if (!entry) return {chunk, 0, state_->origin, nothing};
  return {chunk, entry->version, state_->origin, entry->shape->mesh()};
}

std::vector<Vec3i> Snapshot::chunks() const {
  std::vector<Vec3i> out;
  state_->chunks.each([&](Vec3i chunk, const impl::ChunkEntry& entry) {
    if (!entry.shape->mesh()->triangles.empty()) out.push_back(chunk);
  });
  return out;
}

std::optional<query::RayHit> Snapshot::ray(Vec3d from, Vec3d direction, double distance) const {
  auto hit = collider().ray(to_local(from), direction, distance);
  if (hit) hit->point = to_world(hit->point);
  return hit;
}

bool Snapshot::solid(Vec3d p) const {
  return collider().solid(to_local(p));
}

std::optional<query::ClosestPoint> Snapshot::closest(Vec3d p, double distance) const {
  auto near = collider().closest(to_local(p), distance);
  if (near) near->point = to_world(near->point);
  return near;
}

bool Snapshot::overlaps(const query::Capsule& shape) const {
  return collider().overlaps(shape.moved(-origin()));
}

std::optional<query::Contact> Snapshot::contact(const query::Capsule& shape) const {
  auto contact = collider().contact(shape.moved(-origin()));
  if (contact) contact->point = to_world(contact->point);
  return contact;
}

std::optional<query::SweepHit> Snapshot::sweep(const query::Capsule& shape, Vec3d motion) const {
  auto hit = collider().sweep(shape.moved(-origin()), motion);
  if (hit) hit->point = to_world(hit->point);
  return hit;
}

query::Slide Snapshot::slide(const query::Capsule& shape, Vec3d motion,
                             const query::SlideSettings& settings) const {
  query::Slide slide = collider().slide(shape.moved(-origin()), motion, settings);
  for (query::SweepHit& hit : slide.hits) hit.point = to_world(hit.point);
  return slide;
}

}  // namespace tafoni::runtime
