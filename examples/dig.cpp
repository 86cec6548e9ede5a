// A level that players dig in: a tunnel and an explosion, what changed, a walk through, and a saved game.

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "tafoni/io/mesh_file.h"
#include "tafoni/query/walker.h"
#include "tafoni/runtime/destructible_terrain.h"
#include "tafoni/scene/build/build.h"

using namespace tafoni;
using volume::Edit;
using volume::Tool;

int main() try {
  const auto text = R"(
    scene = { voxel = 0.5 }
    terrain = { generator = "coast", width = 120, height = 100 }
    layer = [{ type = "sea-cliff", range = 8.0 }]
  )";
  const scene::BuiltScene scene = scene::build(scene::parse_scene(text, "coast.toml"));
  runtime::DestructibleTerrain ground(scene);  // a file: DestructibleTerrain::open("coast.toml")

  // Where a game uploads meshes: at first all chunks, later those that changed.
  std::size_t triangles = 0;
  const auto first = ground.changes_since(0);
  for (const auto& change : first.chunks) triangles += ground.chunk(change.chunk).mesh->triangles.size();
  std::printf("%zu chunks, %zu triangles\n", first.chunks.size(), triangles);

  // A tunnel, dug ball by ball from a ledge of the cliff, northwards and down. Positions are in the scene's
  // CRS.
  const auto grass = ground.snapshot()->ray({60, 45, 500}, {0, 0, -1}, 1000);
  if (!grass) return 1;
  const Vec3d entrance = grass->point, north{0, 0.95, -0.3};
  for (int i = 0; i < 30; ++i) ground.apply(Tool::sphere(entrance + i * north, 2), Edit::remove);
  const Vec3d hall = entrance + 30 * north;
  const std::uint64_t version = ground.explode(hall, 5, 20);
  const auto changed = ground.changes_since(version - 1);
  std::printf("the explosion, edit %llu, changed %zu chunks\n", static_cast<unsigned long long>(version),
              changed.chunks.size());
  for (const auto& change : changed.chunks) {
    const runtime::TerrainChunk chunk = ground.chunk(change.chunk);  // stays as it is while others dig on
    std::printf("  %d,%d,%d: %zu vertices, %zu convex polygons\n", chunk.chunk.x, chunk.chunk.y,
                chunk.chunk.z, chunk.mesh->positions.size(), chunk.mesh->polygons.size());
  }

  // A player walks in. A collider is local: the origin is taken off.
  const runtime::SnapshotPtr now = ground.snapshot();
  query::Walker player({}, now->to_local(entrance + 2 * north));
  for (int frame = 0; frame < 60 * 15; ++frame)
    if (!player.move(now->collider(), {0, 2.5, 0}, 1.0 / 60))
      player.escape(now->collider());  // where someone has buried them
  const Vec3d feet = now->to_world(player.feet());
  const auto roof = now->ray(feet + Vec3d{0, 0, 1}, {0, 0, 1}, 50);
  std::printf("after 15 s the player stands %.1f m below the entrance, %.1f m below a roof\n",
              entrance.z - feet.z, roof ? roof->distance + 1 : 0);

  // A saved game is its edits. The same bytes, sent as messages, keep other players' ground the same.
  ground.save("dig.edits");
  runtime::DestructibleTerrain again(scene);
  again.replay("dig.edits");
  const bool same = again.state() == ground.state();
  std::printf("%zu bytes of journal, replayed: %s\n",
              static_cast<std::size_t>(std::filesystem::file_size("dig.edits")),
              same ? "the same" : "different");

  io::write_mesh("dig.glb", ground.mesh());
  return same && roof && !now->overlaps(player.capsule().moved(now->origin())) ? 0 : 1;
} catch (const Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
