// Finds the chunks that changed samples touch, lets one GridChunkMaker a thread make them anew, and tells
// which meshes differ. Assembling numbers each vertex by the chunk that owns its edge.

#include "tafoni/surface/grid_mesher.h"

#include <algorithm>
#include <bit>
#include <mutex>
#include <optional>
#include <tuple>
#include <unordered_map>

#include "tafoni/core/parallel.h"
#include "tafoni/mesh/inner/size32.h"
#include "tafoni/surface/impl/connect.h"
#include "tafoni/surface/impl/grid_chunk_maker.h"

namespace tafoni::surface {
namespace {

using impl::GridChunkMaker;
using impl::GridChunkState;
using impl::GridLayout;
using volume::SampleBox;

bool voxel_before(Vec3i a, Vec3i b) {
  return std::tie(a.z, a.y, a.x) < std::tie(b.z, b.y, b.x);
}

/// A chunk to be made anew, and which samples may have changed.
struct ChunkJob {
  Vec3i chunk;
  SampleBox changed;
  GridChunkState* state = nullptr;
  bool differs = false;
};

SampleBox box_around(const SampleBox& a, const SampleBox& b) {
  return {{std::min(a.lo.x, b.lo.x), std::min(a.lo.y, b.lo.y), std::min(a.lo.z, b.lo.z)},
          {std::max(a.hi.x, b.hi.x), std::max(a.hi.y, b.hi.y), std::max(a.hi.z, b.hi.z)}};
}

/// Whether the chunk may hold surface; quick, and seldom in vain.
bool may_have_surface(const volume::ScalarGrid& grid, const GridLayout& layout, Vec3i chunk) {
  const auto block = layout.block(chunk);
  const Vec3i n = layout.frame.size;
  const auto within = [](int sample, int count) { return std::clamp(sample, 0, count - 1); };
  const auto sample = [&](Vec3i s) {
    return layout.frame.position({within(s.x, n.x), within(s.y, n.y), within(s.z, n.z)});
  };
  const Vec3i lo = block.origin + block.lo, hi = block.origin + block.hi;
  const Interval range = grid.range({sample(lo), sample(hi)});
  if (!(range.hi > 0)) return false;
  const bool air_beyond = lo.x < 0 || lo.y < 0 || lo.z < 0 || hi.x >= n.x || hi.y >= n.y || hi.z >= n.z;
  return air_beyond || !(range.lo > 0);
}

}  // namespace

std::pair<std::uint32_t, std::uint32_t> VoxelPolygons::of(Vec3i voxel) const {
  const auto found = std::lower_bound(voxels.begin(), voxels.end(), voxel, voxel_before);
  if (found == voxels.end() || !(*found == voxel)) return {0, 0};
  const std::size_t at = found - voxels.begin();
  return {first[at], first[at + 1]};
}

struct GridMesher::State {
  GridMesherSettings settings;
  std::optional<GridLayout> layout;
  std::unordered_map<Vec3i, GridChunkState, ChunkHash> chunks;
  std::uint64_t version = 0;
  bool complete = false;  ///< chunks is the mesh of the last update's grid
  std::mutex mutex;
  std::vector<std::unique_ptr<GridChunkMaker>> idle;
  GridChunkPtr nothing = std::make_shared<GridChunkMesh>();

  std::vector<ChunkJob> jobs(const volume::ScalarGrid& grid, std::span<const SampleBox> boxes) const;
  void make(const volume::ScalarGrid& grid, ChunkJob& job);
};

/// The chunks that the boxes touch, with surface or where some may be, in order.
std::vector<ChunkJob> GridMesher::State::jobs(const volume::ScalarGrid& grid,
                                              std::span<const SampleBox> boxes) const {
  std::vector<ChunkJob> out;
  for (const SampleBox& box : boxes) {
    const auto [first, last] = layout->touched(box);
    for (int b = first.y; b <= last.y; ++b)
      for (int a = first.x; a <= last.x; ++a)
        for (int c = first.z; c <= last.z; ++c)
          if (chunks.contains({a, b, c}) || may_have_surface(grid, *layout, {a, b, c}))
            out.push_back({{a, b, c}, box});
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const ChunkJob& a, const ChunkJob& b) { return chunk_before(a.chunk, b.chunk); });
  std::size_t count = 0;
  for (const ChunkJob& job : out)
    if (count && out[count - 1].chunk == job.chunk)
      out[count - 1].changed = box_around(out[count - 1].changed, job.changed);
    else
      out[count++] = job;
  out.resize(count);
  return out;
}

void GridMesher::State::make(const volume::ScalarGrid& grid, ChunkJob& job) {
  std::unique_ptr<GridChunkMaker> maker;
  {
    const std::lock_guard lock(mutex);
    if (!idle.empty()) {
      maker = std::move(idle.back());
      idle.pop_back();
    }
  }
  if (!maker) maker = std::make_unique<GridChunkMaker>(*layout, settings.polygons);
  job.differs = maker->make(grid, job.chunk, job.changed, version, *job.state);
  const std::lock_guard lock(mutex);
  idle.push_back(std::move(maker));
}

GridMesher::GridMesher(const GridMesherSettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
}
GridMesher::~GridMesher() = default;

std::vector<ChunkChange> GridMesher::update(const volume::ScalarGrid& grid,
                                            std::span<const SampleBox> changed, Progress& progress) {
  State& s = *state_;
  const bool partial = s.complete && s.layout && s.layout->frame == grid.frame();
  s.complete = false;
  ++s.version;
  std::vector<ChunkChange> out;
  if (!partial) {
    GridLayout layout(grid.frame(), s.settings.boundary);
    s.idle.clear();
    s.layout.emplace(layout);
    // Meshes stay to be compared with; chunks beyond the frame go.
    const Vec3i n = layout.chunks();
    for (auto entry = s.chunks.begin(); entry != s.chunks.end();) {
      const Vec3i at = entry->first;
      entry->second.solid.clear();
      if (at.x < n.x && at.y < n.y && at.z < n.z) {
        ++entry;
        continue;
      }
      out.push_back({at, s.version});
      entry = s.chunks.erase(entry);
    }
  }
  const SampleBox everything = grid.samples();
  std::vector<ChunkJob> jobs = s.jobs(grid, partial ? changed : std::span(&everything, 1));
  for (ChunkJob& job : jobs) job.state = &s.chunks[job.chunk];
  progress.begin("mesh", jobs.size(), "chunks");
  parallel_for(
      std::ssize(jobs), [&](std::int64_t i) { s.make(grid, jobs[i]); }, progress);
  progress.end();
  for (const ChunkJob& job : jobs) {
    if (job.differs) out.push_back({job.chunk, s.version});
    if (!job.state->mesh) s.chunks.erase(job.chunk);
  }
  std::sort(out.begin(), out.end(), chunk_before);
  s.complete = true;
  return out;
}

GridChunkPtr GridMesher::chunk(Vec3i chunk) const {
  const auto found = state_->chunks.find(chunk);
  return found == state_->chunks.end() ? state_->nothing : found->second.mesh;
}

std::vector<Vec3i> GridMesher::chunks() const {
  std::vector<Vec3i> out;
  for (const auto& [at, state] : state_->chunks) out.push_back(at);
  std::sort(out.begin(), out.end(), chunk_before);
  return out;
}

namespace {

/// The edges of a chunk's vertices, in their order: the sample of the grid that each starts from, and its
/// axis.
template <class F>
void for_edges(const GridLayout& layout, Vec3i chunk, const GridChunkState& state, const F& visit) {
  const auto block = layout.block(chunk);
  std::uint32_t vertex = 0;
  for (int k = 0; k < block.samples.z; ++k)
    for (int j = 0; j < block.samples.y; ++j) {
      const impl::RowEdges e = state.edges(block, j, k);
      const std::uint64_t axes[] = {e.x, e.y, e.z};
      for (int axis = 0; axis < 3; ++axis)
        for (std::uint64_t left = axes[axis]; left; left &= left - 1)
          visit(vertex++, block.origin + Vec3i{std::countr_zero(left), j, k}, axis);
    }
}

/// The vertex of a chunk on the edge that starts from a sample of the grid.
std::uint32_t vertex_on(const GridLayout& layout, Vec3i chunk, const GridChunkState& state, Vec3i start,
                        int axis) {
  const auto block = layout.block(chunk);
  const Vec3i at = start - block.origin;
  const impl::RowEdges e = state.edges(block, at.y, at.z);
  const std::uint64_t axes[] = {e.x, e.y, e.z}, below = (std::uint64_t{1} << at.x) - 1;
  auto vertex = state.vertex_at[at.z * block.samples.y + at.y];
  for (int a = 0; a <= axis; ++a) vertex += std::popcount(a < axis ? axes[a] : axes[a] & below);
  return vertex;
}

}  // namespace

mesh::Mesh GridMesher::assemble() const {
  const State& s = *state_;
  if (!s.complete) fail(ErrorKind::internal, "a mesh cannot be assembled before an update() has succeeded");
  const auto order = chunks();
  // A vertex is its owner's; others look it up there by its edge.
  std::unordered_map<Vec3i, std::vector<std::uint32_t>, ChunkHash> numbers;
  mesh::Mesh out;
  for (Vec3i at : order) {
    const GridChunkState& state = s.chunks.at(at);
    auto& number = numbers[at];
    number.resize(state.mesh->positions.size());
    for_edges(*s.layout, at, state, [&](std::uint32_t v, Vec3i start, int) {
      if (!(s.layout->owner(start) == at)) return;
      number[v] = mesh::inner::size32(out.positions);
      out.positions.push_back(state.mesh->positions[v]);
      out.normals.push_back(state.mesh->normals[v]);
    });
  }
  for (Vec3i at : order) {
    const GridChunkState& state = s.chunks.at(at);
    auto& number = numbers[at];
    for_edges(*s.layout, at, state, [&](std::uint32_t v, Vec3i start, int axis) {
      const Vec3i owner = s.layout->owner(start);
      if (!(owner == at))
        number[v] = numbers.at(owner)[vertex_on(*s.layout, owner, s.chunks.at(owner), start, axis)];
    });
    for (const auto& t : state.mesh->triangles)
      out.triangles.push_back({number[t[0]], number[t[1]], number[t[2]]});
  }
  return out;
}

}  // namespace tafoni::surface
