#pragma once
// Ground that players dig while they look at it: edits in, changed chunks and collisions out.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/mesh/mesh.h"
#include "tafoni/query/collider.h"
#include "tafoni/runtime/journal.h"
#include "tafoni/runtime/operation.h"
#include "tafoni/surface/chunk.h"
#include "tafoni/surface/grid_mesher.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::scene {
struct BuiltScene;
}

namespace tafoni::runtime {

struct DestructibleTerrainSettings {
  double voxel = 0;  ///< metres; 0: the scene's own. Volumes have theirs
  volume::Precision precision = volume::Precision::single;
  /// Metres that values are limited to, 0 for four voxels. What lies deeper in rock or air takes no memory,
  /// and an explosion of more energy than this breaks rock of any depth.
  double band = 0;
  double above = 10, below = 10;  ///< metres that can be built above the highest and dug below the lowest
  /// Metres, from the lowest rock there is when opened, in which nothing is dug or filled: a floor, so that
  /// who digs down does not fall out of the world. None: two voxels. 0 lets everything be dug, as journals
  /// expect that were begun when there was no floor.
  std::optional<double> floor = {};
  /// None: the scene's own, and `solid` for a volume. An open terrain ends at its border without walls.
  std::optional<surface::Boundary> boundary = {};
  bool polygons = true;  ///< convex polygons for collision by other engines
  /// Allows Rewind. Keeps the ground as opened and at up to eight versions since, as far as they differ. To
  /// go back further costs every edit up to there.
  bool rewind = false;
  /// Bytes that the terrain may take: more when it is opened is an error that says how much it would be, and
  /// edits that would make it take more are refused, whoever sent them; so give the same to all peers.
  /// Counted are samples, meshes, what colliders make of them, messages and what rewinding keeps; not what
  /// snapshots hold that others keep.
  std::uint64_t memory = std::uint64_t{4} << 30;
  /// Samples that one edit may look at: all in its box, and in that of a hull once for each of its sides. A
  /// larger edit is refused, whoever sent it; so give the same to all peers. With the default, 200 samples
  /// each way, the worst that can be sent takes some seconds. Not so a Rewind: it makes again the edits
  /// between its version and the nearest kept one before, each of so many samples at most. These are at most
  /// 64 where it leads to within 448 edits of the present and no other rewinds lie between, and else may be
  /// all edits there were; so allow rewinding only among peers who are trusted with that.
  std::uint64_t edit_work = std::uint64_t{1} << 23;
};

/// Immutable: who holds one may read it in any thread, whatever happens to the terrain. What chunks and
/// changes are, surface/chunk.h says; versions here are the terrain's and count edits.
struct TerrainChunk {
  Vec3i chunk;
  std::uint64_t version = 0;   ///< of the edit that changed it last
  Vec3d origin;                ///< world position that the mesh's positions are relative to
  surface::GridChunkPtr mesh;  ///< never null; its own version is not the terrain's
};

/// The terrain at one version, immutable: samples, chunks and collisions that belong together. Any number of
/// threads may read one. Positions are world, in double; local is world minus origin().
class Snapshot {
 public:
  ~Snapshot();
  Snapshot(const Snapshot&) = delete;
  Snapshot& operator=(const Snapshot&) = delete;

  std::uint64_t version() const;
  Vec3d origin() const;
  Vec3d to_local(Vec3d world) const { return world - origin(); }
  Vec3d to_world(Vec3d local) const { return local + origin(); }

  /// Chunk (a, b, c) has the voxels from (32 a, 32 b, 32 c). Its mesh is empty where there is no surface.
  TerrainChunk chunk(Vec3i chunk) const;
  /// Every chunk with triangles, sorted.
  std::vector<Vec3i> chunks() const;
  const volume::ScalarGrid& grid() const;  ///< local

  /// What query::Walker and whatever else takes a collider are given; its positions are local.
  const query::Collider& collider() const;
  /// query::Collider's own, in world positions.
  std::optional<query::RayHit> ray(Vec3d from, Vec3d direction, double distance) const;
  bool solid(Vec3d p) const;
  std::optional<query::ClosestPoint> closest(Vec3d p, double distance) const;
  bool overlaps(const query::Capsule& shape) const;
  std::optional<query::Contact> contact(const query::Capsule& shape) const;
  std::optional<query::SweepHit> sweep(const query::Capsule& shape, Vec3d motion) const;
  query::Slide slide(const query::Capsule& shape, Vec3d motion,
                     const query::SlideSettings& settings = {}) const;

 private:
  friend class DestructibleTerrain;
  struct State;
  explicit Snapshot(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};
using SnapshotPtr = std::shared_ptr<const Snapshot>;

/// All functions may be called from any thread. Edits wait for one another, and so do mesh(), state(),
/// edits_since(), save() and the like. version(), snapshot(), chunk() and changes_since() never wait for an
/// edit, only for the moment in which its result takes the place of the one before.
///
/// Positions are world (the scene's CRS), double, here and in messages. Version 1 is the terrain as opened;
/// each edit makes the next one, even if it changes nothing, so that all peers count alike. The same edits in
/// the same order give the same bytes of samples and meshes on every machine with fused multiply-add.
class DestructibleTerrain {
 public:
  /// Opens a scene file (.toml), a volume file that io::read_volume() knows, or else an elevation model.
  /// Throws Error as scene::build() does, and Error{usage} for what is too large. Small floating pieces,
  /// which scene::mesh_scene() leaves out below `scene.min_fragment`, are in the samples and so in the
  /// ground, as they are in what `tafoni build` writes as a volume.
  static DestructibleTerrain open(const std::filesystem::path& file,
                                  const DestructibleTerrainSettings& settings = {},
                                  Progress& progress = silent());
  explicit DestructibleTerrain(const scene::BuiltScene& scene,
                               const DestructibleTerrainSettings& settings = {},
                               Progress& progress = silent());
  /// A grid whose local zero lies at `origin`. It keeps its precision; values are limited to the band, if one
  /// is given, and are else taken as they are: then the band is their greatest magnitude.
  explicit DestructibleTerrain(volume::ScalarGrid grid, Vec3d origin = {},
                               const DestructibleTerrainSettings& settings = {},
                               Progress& progress = silent());
  ~DestructibleTerrain();
  DestructibleTerrain(DestructibleTerrain&&) noexcept;
  DestructibleTerrain& operator=(DestructibleTerrain&&) = delete;

  /// Each returns the new version. Throws Error{usage} for numbers that make no edit; nothing is changed
  /// then.
  std::uint64_t apply(const Operation& operation);
  std::uint64_t apply(const volume::Tool& tool, volume::Edit edit) { return apply(ToolUse{tool, edit}); }
  std::uint64_t explode(Vec3d center, double radius, double energy) {
    return apply(Explosion{center, radius, energy});
  }
  /// To version() - 1 is to undo one edit; costs as many edits as lie between, or 64 and the meshing.
  std::uint64_t rewind(std::uint64_t version) { return apply(Rewind{version}); }
  /// What encode() gave, here or on another machine, one version each; meshed and seen all at once. Throws
  /// Error{input} for anything else, and Error{usage} for one that this terrain refuses; none is made then.
  std::uint64_t apply(std::span<const Message> messages, Progress& progress = silent());

  /// World positions: all that can be dug or filled. Beyond it nothing is solid, but the floor below it.
  Box3d bounds() const;
  std::uint64_t version() const;
  SnapshotPtr snapshot() const;
  TerrainChunk chunk(Vec3i chunk) const { return snapshot()->chunk(chunk); }
  struct Changes {
    std::uint64_t version = 0;  ///< to ask for the next time
    /// Sorted; one that lost its last triangle is among them. Each with the version that changed it last.
    std::vector<surface::ChunkChange> chunks;
  };
  /// The chunks whose mesh changed after that version; every chunk with triangles after version 0, none after
  /// a version still to come.
  Changes changes_since(std::uint64_t version) const;
  /// All chunks as one mesh without repeated vertices.
  mesh::Mesh mesh() const;

  /// The digest of the terrain as opened: what a journal belongs to, and what peers compare first.
  Digest base() const;
  struct State {
    std::uint64_t version = 0;
    Digest hash = 0;  ///< of every sample: equal for peers that made the same edits
    friend bool operator==(const State&, const State&) = default;
  };
  /// Costs about 0.02 ms for each chunk of samples changed since it was last asked.
  State state() const;
  /// The messages that lead from that version to the present one, for a peer that joins late.
  std::vector<Message> edits_since(std::uint64_t version) const;

  /// Writes all edits as a journal, whole or not at all. Throws Error{output} for one that another terrain or
  /// program records in.
  void save(const std::filesystem::path& journal) const;
  /// Applies the journal's edits to a terrain that has none yet. An edit left unfinished at its end by a
  /// crash is left out. Returns how many were applied. Throws Error{usage} after edits, and Error{input} for
  /// a journal that is damaged or of another terrain.
  std::uint64_t replay(const std::filesystem::path& journal, Progress& progress = silent());
  /// From now on appends each edit to the journal before it is seen. Where the file exists its edits are
  /// replayed first; otherwise, and where it has no bytes, it begins with those made so far. An edit that
  /// cannot be appended throws Error{output} and is not made. Throws Error{output} where another terrain or
  /// program records in the file: one journal has one writer.
  void record(const std::filesystem::path& journal, Progress& progress = silent());
  /// Returns when all recorded edits are on the disk.
  void sync();

 private:
  struct Impl;
  explicit DestructibleTerrain(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace tafoni::runtime
