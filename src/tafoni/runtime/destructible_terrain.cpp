// An edit changes the grid, the mesher makes its chunks anew, and a new snapshot takes the place of the one
// before under a lock held for moments. One mutex puts edits in order; readers hold snapshots.

#include "tafoni/runtime/destructible_terrain.h"

#include <algorithm>
#include <limits>
#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/runtime/impl/bytes.h"
#include "tafoni/runtime/impl/ground.h"
#include "tafoni/runtime/impl/history.h"
#include "tafoni/runtime/impl/snapshot_state.h"
#include "tafoni/runtime/impl/state_hash.h"

namespace tafoni::runtime {
namespace {

using surface::ChunkChange;
using surface::ChunkOrder;
using volume::SampleBox;

/// When each chunk changed last, newest last.
class ChangeLog {
 public:
  void note(Vec3i chunk, std::uint64_t version) {
    const auto [entry, fresh] = versions_.try_emplace(chunk, version);
    if (!fresh) {
      by_version_.erase({chunk, entry->second});
      entry->second = version;
    }
    by_version_.insert({chunk, version});
  }
  /// Those after `version`, sorted.
  std::vector<ChunkChange> since(std::uint64_t version) const {
    constexpr std::int32_t most = std::numeric_limits<std::int32_t>::max();
    std::vector<ChunkChange> out(by_version_.upper_bound({{most, most, most}, version}), by_version_.end());
    std::sort(out.begin(), out.end(), ChunkOrder());
    return out;
  }

 private:
  struct Order {
    bool operator()(const ChunkChange& a, const ChunkChange& b) const {
      return a.version != b.version ? a.version < b.version : ChunkOrder()(a, b);
    }
  };
  std::map<Vec3i, std::uint64_t, ChunkOrder> versions_;
  std::set<ChunkChange, Order> by_version_;
};

/// A hash of what edits do not change.
Digest digest_of(const impl::Ground& ground, std::uint64_t samples) {
  impl::ByteWriter out;
  const volume::GridFrame& frame = ground.grid.frame();
  for (Vec3d p : {ground.place.origin, frame.origin}) {
    for (double v : {p.x, p.y, p.z}) out.put(v);
  }
  out.put(frame.spacing);
  for (std::int32_t n : {frame.size.x, frame.size.y, frame.size.z}) out.put(n);
  out.put(static_cast<std::uint32_t>(ground.grid.precision()));
  out.put(ground.place.band);
  out.put(samples);
  if (ground.place.first_layer > 0) out.put(static_cast<std::int32_t>(ground.place.first_layer));
  return impl::checksum(out.bytes);
}

}  // namespace

struct DestructibleTerrain::Impl {
  Impl(impl::Ground opened, const DestructibleTerrainSettings& settings, Progress& progress);

  SnapshotPtr snapshot() const {
    const std::lock_guard lock(published_mutex);
    return published;
  }
  using MeshChanges = std::vector<ChunkChange>;
  SnapshotPtr next(const MeshChanges& changes, std::size_t edits_made) const;
  void publish(SnapshotPtr now, const MeshChanges& changes);
  /// After edits that were not made, the mesher follows the grid back.
  void bring_in_step(Progress& progress);
  void check_work(const Operation& operation) const;
  /// Of the history as it is now, with so many chunks of samples held in full and meshes of so many bytes.
  std::uint64_t use_with(std::uint64_t full, std::uint64_t meshes) const {
    return impl::bytes_of(ground.grid, full) + history.bytes() + meshes;
  }
  /// Throws where the terrain as it is now takes too much. `full` chunks at most are held in full, which is
  /// counted only where it matters.
  void check_use(std::uint64_t& full, std::uint64_t meshes) const;
  /// Makes the edits, one version each, and meshes once. For whoever holds edit_mutex.
  void apply(std::span<const Message> messages, Progress& progress);
  void replay(const JournalContents& contents, const std::filesystem::path& file, Progress& progress);

  /// Serialises edits and guards all that only they use.
  std::mutex edit_mutex;
  impl::Ground ground;
  surface::GridMesher mesher;
  std::vector<SampleBox> behind;  ///< where its meshes are those of an edit that was not made
  impl::StateHash hash;
  Digest base;
  impl::History history;
  std::uint64_t edit_work, memory;
  std::uint64_t mesh_bytes = 0, full_chunks = 0;  ///< of the published snapshot; chunks at most
  std::optional<JournalWriter> journal;

  /// Held for moments only; taken after edit_mutex where both are.
  mutable std::mutex published_mutex;
  SnapshotPtr published;
  ChangeLog log;
};

DestructibleTerrain::Impl::Impl(impl::Ground opened, const DestructibleTerrainSettings& settings,
                                Progress& progress)
    : ground(std::move(opened)),
      mesher({ground.boundary, settings.polygons}),
      hash(ground.grid),
      base(digest_of(ground, hash.of(ground.grid))),
      history(settings.rewind),
      edit_work(settings.edit_work),
      memory(settings.memory) {
  history.remember(ground.grid);
  const MeshChanges changes = mesher.update(ground.grid, {}, progress);
  for (const ChunkChange& change : changes) mesh_bytes += impl::bytes_of(*mesher.chunk(change.chunk));
  full_chunks = ground.grid.full_chunks();
  impl::check_memory(use_with(full_chunks, mesh_bytes), ground.grid.frame(), settings);
  publish(next(changes, 1), changes);
}

/// The grid and the mesher as they are now.
SnapshotPtr DestructibleTerrain::Impl::next(const MeshChanges& changes, std::size_t edits_made) const {
  const std::uint64_t version = (published ? published->version() : 0) + edits_made;
  impl::ChunkTable table = published ? published->state_->chunks : impl::ChunkTable(ground.grid.chunks());
  for (const auto& change : changes) {
    auto entry = std::make_shared<impl::ChunkEntry>();
    entry->shape = std::make_unique<const query::ChunkShape>(mesher.chunk(change.chunk));
    entry->version = version;
    table.set(change.chunk, std::move(entry));
  }
  return SnapshotPtr(
      new Snapshot(std::make_unique<Snapshot::State>(version, ground.place.origin, ground.grid, table)));
}

void DestructibleTerrain::Impl::publish(SnapshotPtr now, const MeshChanges& changes) {
  const std::lock_guard lock(published_mutex);
  for (const auto& change : changes) log.note(change.chunk, now->version());
  published.swap(now);  // what only the last one held is freed after the lock
}

void DestructibleTerrain::Impl::bring_in_step(Progress& progress) {
  if (behind.empty()) return;
  mesher.update(ground.grid, behind, progress);
  behind.clear();
}

void DestructibleTerrain::Impl::check_work(const Operation& operation) const {
  const std::uint64_t work = impl::work_of(operation, ground.grid, ground.place);
  if (work > edit_work)
    fail(ErrorKind::usage,
         "an edit would look at {} samples, more than the {} of DestructibleTerrainSettings::edit_work: make "
         "it smaller, "
         "give its hull fewer corners, or allow more",
         work, edit_work);
}

void DestructibleTerrain::Impl::check_use(std::uint64_t& full, std::uint64_t meshes) const {
  if (use_with(full, meshes) <= memory) return;
  full = ground.grid.full_chunks();
  const std::uint64_t bytes = use_with(full, meshes);
  if (bytes > memory)
    fail(ErrorKind::usage,
         "an edit would make the terrain take {:.3f} GB, more than the {:.3f} GB of "
         "DestructibleTerrainSettings::memory: allow more, or use a coarser voxel",
         static_cast<double>(bytes) * 1e-9, static_cast<double>(memory) * 1e-9);
}

void DestructibleTerrain::Impl::apply(std::span<const Message> messages, Progress& progress) {
  // Through their messages, here as on every peer, so that all make the edits of the same numbers.
  std::vector<Operation> operations;
  for (const Message& message : messages) operations.push_back(decode(message));
  const SnapshotPtr last = snapshot();
  bring_in_step(progress);

  std::vector<SampleBox> changed;
  std::uint64_t full = full_chunks, meshes = mesh_bytes;
  bool meshing = false;
  try {
    const impl::Editor editor(ground.grid, ground.place, history);
    for (std::size_t i = 0; i < messages.size(); ++i) {
      check_work(operations[i]);
      const std::vector<SampleBox> boxes = std::visit(editor, operations[i]);
      history.add(messages[i], boxes);
      history.remember(ground.grid);
      changed.insert(changed.end(), boxes.begin(), boxes.end());
      for (const SampleBox& box : boxes) full += impl::chunks_of(box);
      check_use(full, meshes);
      progress.check();
    }
    meshing = !changed.empty();
    const MeshChanges changes = meshing ? mesher.update(ground.grid, changed, progress) : MeshChanges();
    for (const ChunkChange& change : changes) {
      meshes += impl::bytes_of(*mesher.chunk(change.chunk));
      meshes -= impl::bytes_of(*last->chunk(change.chunk).mesh);
    }
    check_use(full, meshes);
    SnapshotPtr now = next(changes, messages.size());
    if (journal) journal->append(messages);
    publish(std::move(now), changes);
    mesh_bytes = meshes, full_chunks = full;
  } catch (...) {
    if (meshing) behind = changed;
    history.cut(last->version() - 1);
    ground.grid = last->grid();
    throw;
  }
  for (const SampleBox& box : changed) hash.touch(box);
}

void DestructibleTerrain::Impl::replay(const JournalContents& contents, const std::filesystem::path& file,
                                       Progress& progress) {
  if (!history.edits().empty())
    fail(ErrorKind::usage, "{}: a journal is replayed on a terrain without edits, and this one has {}",
         file.string(), history.edits().size());
  if (contents.base != base)
    fail(ErrorKind::input,
         "{}: belongs to another terrain, or to this one with another voxel size, precision, band or floor",
         file.string());
  apply(contents.edits, progress);
}

DestructibleTerrain::DestructibleTerrain(const scene::BuiltScene& scene,
                                         const DestructibleTerrainSettings& settings, Progress& progress)
    : impl_(std::make_unique<Impl>(impl::ground_of(scene, settings, progress), settings, progress)) {}
DestructibleTerrain::DestructibleTerrain(volume::ScalarGrid grid, Vec3d origin,
                                         const DestructibleTerrainSettings& settings, Progress& progress)
    : impl_(std::make_unique<Impl>(impl::ground_of(std::move(grid), origin, settings), settings, progress)) {}
DestructibleTerrain::DestructibleTerrain(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
DestructibleTerrain::~DestructibleTerrain() = default;
DestructibleTerrain::DestructibleTerrain(DestructibleTerrain&&) noexcept = default;

DestructibleTerrain DestructibleTerrain::open(const std::filesystem::path& file,
                                              const DestructibleTerrainSettings& settings,
                                              Progress& progress) {
  return DestructibleTerrain(
      std::make_unique<Impl>(impl::read_ground(file, settings, progress), settings, progress));
}

std::uint64_t DestructibleTerrain::apply(std::span<const Message> messages, Progress& progress) {
  const std::lock_guard lock(impl_->edit_mutex);
  impl_->apply(messages, progress);
  return version();
}
std::uint64_t DestructibleTerrain::apply(const Operation& operation) {
  const Message message = encode(operation);
  return apply({&message, 1});
}

Box3d DestructibleTerrain::bounds() const {
  const volume::GridFrame& frame = impl_->ground.grid.frame();  // which no edit changes
  const Vec3d origin = impl_->ground.place.origin;
  Box3d box = frame.box();
  box.lo.z = frame.position({0, 0, std::max(0, impl_->ground.place.first_layer - 1)}).z;
  return {box.lo + origin, box.hi + origin};
}

std::uint64_t DestructibleTerrain::version() const {
  return snapshot()->version();
}
SnapshotPtr DestructibleTerrain::snapshot() const {
  return impl_->snapshot();
}

DestructibleTerrain::Changes DestructibleTerrain::changes_since(std::uint64_t version) const {
  const std::lock_guard lock(impl_->published_mutex);
  return {impl_->published->version(), impl_->log.since(version)};
}

mesh::Mesh DestructibleTerrain::mesh() const {
  const std::lock_guard lock(impl_->edit_mutex);
  impl_->bring_in_step(silent());
  mesh::Mesh mesh = impl_->mesher.assemble();
  mesh.origin = impl_->ground.place.origin;
  return mesh;
}

Digest DestructibleTerrain::base() const {
  return impl_->base;
}

DestructibleTerrain::State DestructibleTerrain::state() const {
  const std::lock_guard lock(impl_->edit_mutex);
  return {version(), impl_->hash.of(impl_->ground.grid)};
}

std::vector<Message> DestructibleTerrain::edits_since(std::uint64_t version) const {
  const std::lock_guard lock(impl_->edit_mutex);
  const auto& edits = impl_->history.edits();
  const std::uint64_t first = std::clamp<std::uint64_t>(version, 1, edits.size() + 1) - 1;
  return {edits.begin() + first, edits.end()};
}

void DestructibleTerrain::save(const std::filesystem::path& journal) const {
  const std::lock_guard lock(impl_->edit_mutex);
  // What is recorded is in its file already.
  if (impl_->journal && impl_->journal->writes_to(journal)) return impl_->journal->sync();
  write_journal(journal, impl_->base, impl_->history.edits());
}

std::uint64_t DestructibleTerrain::replay(const std::filesystem::path& journal, Progress& progress) {
  const JournalContents contents = read_journal(journal);
  const std::lock_guard lock(impl_->edit_mutex);
  impl_->replay(contents, journal, progress);
  return contents.edits.size();
}

void DestructibleTerrain::record(const std::filesystem::path& journal, Progress& progress) {
  const std::lock_guard lock(impl_->edit_mutex);
  if (impl_->journal && impl_->journal->writes_to(journal)) return;
  const bool made = make_journal(journal, impl_->base, impl_->history.edits());
  const JournalContents contents = read_journal(journal);
  JournalWriter writer(journal, contents);  // from here on nobody else changes the file
  if (!made) impl_->replay(contents, journal, progress);
  writer.append({});  // cuts a torn end off
  impl_->journal.emplace(std::move(writer));
}

void DestructibleTerrain::sync() {
  const std::lock_guard lock(impl_->edit_mutex);
  if (impl_->journal) impl_->journal->sync();
}

}  // namespace tafoni::runtime
