// Collision queries near the surface of scene S(N): a second on one core, from a warm cache and from a cold
// one, beside the mesh of the same place under this program's own tree and, for rays, under Embree. Prints
// CSV.
//
//   bench_query [N [CELLS [QUERIES]]]
//
// CELLS counts the cells across the 5120 m. Places lie about the primitives, half of them within a few metres
// of the ground; shapes have the size of a person, motions that of a step of the game. Sides are interleaved
// in three runs, of which the best counts.

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "measure.h"
#include "scene_s.h"
#include <fmt/core.h>
#if TAFONI_EMBREE >= 4
#include <embree4/rtcore.h>
#else
#include <embree3/rtcore.h>
#endif

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/compiled.h"
#include "tafoni/query/field_collider.h"
#include "tafoni/query/mesh_collider.h"
#include "tafoni/surface/polygonize.h"

namespace {

using namespace tafoni;
using namespace tafoni::bench;

constexpr double half_region = 250;  ///< metres about the middle of the scene, which is meshed for the peers
constexpr double radius = 0.4, height = 1.0, stride = 1.0, ray_length = 50, reach = 5;

struct Place {
  Vec3d at, direction;
};

/// Within 3 m of the surface, which for each is found along a vertical line.
std::vector<Place> places_near(const query::Collider& ground, int count) {
  std::vector<Place> places;
  Random random(5);
  while (static_cast<int>(places.size()) < count) {
    const double x = extent / 2 + random.uniform(-half_region, half_region) * 0.95;
    const double y = extent / 2 + random.uniform(-half_region, half_region) * 0.95;
    const Vec3d from{x, y, elevation(x, y) + random.uniform(-25, 20)};
    const auto near = ground.closest(from, 10);
    const Vec3d direction =
        normalized(Vec3d{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)});
    if (!near) continue;
    places.push_back({near->point + near->normal * random.uniform(0.41, 3), direction});
  }
  return places;
}

struct Row {
  std::string name;
  std::function<double(const query::Collider&, const Place&)> ask;  ///< a number that tells the answer
};

std::vector<Row> rows() {
  using query::Capsule;
  using query::Sphere;
  const auto time = [](const std::optional<query::SweepHit>& hit) {
    return hit ? hit->time + hit->depth : 2.0;
  };
  return {
      {"ray",
       [](const query::Collider& c, const Place& p) {
         const auto hit = c.ray(p.at, p.direction, ray_length);
         return hit ? hit->distance : -1.0;
       }},
      {"solid", [](const query::Collider& c, const Place& p) { return c.solid(p.at) ? 1.0 : 0.0; }},
      {"overlaps",
       [](const query::Collider& c, const Place& p) {
         return c.overlaps(Sphere{p.at, radius}) ? 1.0 : 0.0;
       }},
      {"closest",
       [](const query::Collider& c, const Place& p) {
         const auto near = c.closest(p.at, reach);
         return near ? near->distance : -1.0;
       }},
      {"sphere sweep",
       [time](const query::Collider& c, const Place& p) {
         return time(c.sweep(Sphere{p.at, radius}, p.direction * stride));
       }},
      {"capsule sweep",
       [time](const query::Collider& c, const Place& p) {
         return time(c.sweep(Capsule(p.at, p.at + Vec3d{0, 0, height}, radius), p.direction * stride));
       }},
      {"sphere sweep 50 m",
       [time](const query::Collider& c, const Place& p) {
         return time(c.sweep(Sphere{p.at, radius}, p.direction * ray_length));
       }},
      {"capsule slide",
       [](const query::Collider& c, const Place& p) {
         return length(
             c.slide(Capsule(p.at, p.at + Vec3d{0, 0, height}, radius), p.direction * stride).moved);
       }},
  };
}

/// Embree over the same triangles.
class Rays {
 public:
  explicit Rays(const mesh::Mesh& mesh) : device_(rtcNewDevice("threads=1")), scene_(rtcNewScene(device_)) {
    const RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* v = static_cast<Vec3f*>(rtcSetNewGeometryBuffer(
        geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3f), mesh.positions.size()));
    std::copy(mesh.positions.begin(), mesh.positions.end(), v);
    auto* t = static_cast<std::array<std::uint32_t, 3>*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                3 * sizeof(std::uint32_t), mesh.triangles.size()));
    std::copy(mesh.triangles.begin(), mesh.triangles.end(), t);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene_, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(scene_);
  }
  ~Rays() {
    rtcReleaseScene(scene_);
    rtcReleaseDevice(device_);
  }
  Rays(const Rays&) = delete;
  Rays& operator=(const Rays&) = delete;

  double cast(const Place& p) const {
    RTCRayHit ray{};
    const Vec3f at = to_float(p.at), d = to_float(p.direction);
    ray.ray = {at.x, at.y, at.z, 0, d.x, d.y, d.z, 0, static_cast<float>(ray_length), 0xffffffffu, 0, 0};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
#if TAFONI_EMBREE >= 4
    rtcIntersect1(scene_, &ray);
#else
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    rtcIntersect1(scene_, &context, &ray);
#endif
    return ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? -1.0 : ray.ray.tfar;
  }

 private:
  RTCDevice device_;
  RTCScene scene_;
};

struct Timed {
  double seconds = 1e9;
  std::vector<double> answers;

  void run(const std::vector<Place>& places, const std::function<double(const Place&)>& ask) {
    answers.resize(places.size());
    const double begin = bench::thread_seconds();
    for (std::size_t i = 0; i < places.size(); ++i) answers[i] = ask(places[i]);
    seconds = std::min(seconds, bench::thread_seconds() - begin);
  }
  double rate() const { return static_cast<double>(answers.size()) / seconds; }
};

void run(int count, int cells, int queries) {
  const Ground ground = make_ground();
  const std::vector<Sphere> spheres = tunnels(count);
  const field::CompiledField field =
      field::compile(field::blend({ground_node(ground, true), cloud_of(spheres)}));
  const double voxel = extent / cells;
  surface::PolygonizeSettings settings;
  settings.voxel = voxel;
  settings.boundary = surface::Boundary::open;
  const Vec3d middle{extent / 2, extent / 2, 0};
  settings.region = {middle - Vec3d{half_region, half_region, -ground.region.lo.z},
                     middle + Vec3d{half_region, half_region, ground.region.hi.z}};
  const mesh::Mesh mesh = surface::polygonize(field, settings);
  const query::MeshCollider peer(mesh);
  const Rays embree(mesh);
  const query::FieldSettings collider_settings{.voxel = voxel, .region = ground.region};
  query::FieldCollider warm(field, collider_settings);
  const std::vector<Place> places = places_near(warm, queries);
  const std::size_t few = places.size() / 20;

  for (const Row& row : rows()) {
    Timed own, cold, mesh_time, embree_time;
    const auto with = [&](const query::Collider& c) { return [&](const Place& p) { return row.ask(c, p); }; };
    own.run(places, with(warm));
    for (int i = 0; i < 3; ++i) {
      own.run(places, with(warm));
      mesh_time.run(places, with(peer));
      if (row.name == "ray") embree_time.run(places, [&](const Place& p) { return embree.cast(p); });
      const query::FieldCollider fresh(field, collider_settings);
      cold.run({places.begin(), places.begin() + few}, with(fresh));
    }
    // Beyond the meshed region, and behind its border, the peer knows nothing.
    std::size_t differ = 0;
    double worst = 0;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double d = std::abs(own.answers[i] - mesh_time.answers[i]);
      if (d > 1e-6)
        ++differ;
      else
        worst = std::max(worst, d);
    }
    fmt::print("{},{:.0f},{:.0f},{:.0f},{},{:.1e},{},{:016x}\n", row.name, own.rate() / 1e3,
               mesh_time.rate() / 1e3, row.name == "ray" ? embree_time.rate() / 1e3 : 0,
               fmt::format("{:.1f}", cold.rate() / 1e3), worst, differ,
               hash(own.answers.data(), own.answers.size() * sizeof(double)));
  }
  const auto cache = warm.cache();
  std::fprintf(stderr, "%d primitives, voxel %.2f m, %zu triangles for the peers, %llu cubes in %.1f MB\n",
               count, voxel, mesh.triangles.size(), static_cast<unsigned long long>(cache.tiles),
               static_cast<double>(cache.bytes) / 1e6);
}

}  // namespace

int main(int argc, char** argv) {
  std::puts("query,field_k_s,own_mesh_k_s,embree_k_s,cold_k_s,worst_difference,differ,answers_hash");
  try {
    set_thread_count(1);
    run(argc > 1 ? std::atoi(argv[1]) : 165000, argc > 2 ? std::atoi(argv[2]) : 5120,
        argc > 3 ? std::atoi(argv[3]) : 50000);
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
