// Finds the chunks that changed boxes touch, evaluates only the bricks of each that read a changed sample,
// and takes over from the last piece (impl/piece.h) every vertex whose edge kept both ends.

#include "tafoni/surface/incremental_mesher.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <mutex>
#include <optional>
#include <unordered_map>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/math/lattice.h"
#include "tafoni/math/whole.h"
#include "tafoni/surface/impl/connect.h"
#include "tafoni/surface/impl/field_source.h"
#include "tafoni/surface/impl/rim.h"

namespace tafoni::surface {
namespace {

using field::brick_cells;
using field::BrickBox;
using field::ChunkSamples;
using impl::CellSet;
using impl::Piece;

constexpr int n = field::chunk_cells;
constexpr int samples = n + 1;
constexpr int row_words = 2;
constexpr int far = (1 << 30) - 1;  ///< beyond every cell, yet differences fit an int

/// What is held of a chunk: its piece, in memory of its own, and what the next piece is made from.
struct Chunk {
  Piece piece;
  std::vector<Vec3f> positions, normals;
  std::vector<Vec3f>
      shown;  ///< normals that agree with the triangles; on the rim, which neighbours share, the field's
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::vector<std::uint32_t> edges;
  std::vector<impl::FacetSum> rim;
  std::vector<std::uint64_t> signs;  ///< solid bits of all samples, as impl::Kept has them
  std::uint64_t active[field::chunk_bricks] = {};
  std::uint64_t version = 0;
  bool parts_known = false;

  bool same_as(const Piece& other) const {
    const auto same = [](const auto& a, const auto& b) {
      return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size_bytes()) == 0);
    };
    return same(piece.positions, other.positions) && same(piece.triangles.wide(), other.triangles.wide()) &&
           same(piece.normals, other.normals);
  }
  /// Copies what lies in the memory of the maker, whose last piece it is.
  void take(Piece&& made, impl::PieceMaker& maker) {
    piece = std::move(made);
    const auto own = [](auto& span, auto& memory) {
      memory.assign(span.begin(), span.end());
      span = memory;
    };
    own(piece.positions, positions);
    own(piece.edges, edges);
    own(piece.rim, rim);
    const auto made_triangles = piece.triangles.wide();
    triangles.assign(made_triangles.begin(), made_triangles.end());
    piece.triangles = {triangles};
    parts_known = false;
    normals.assign(piece.normals.begin(), piece.normals.end());
    if (!normals.empty()) maker.settle(piece);
    shown.assign(piece.normals.begin(), piece.normals.end());
    piece.normals = normals;
  }
  void read_signs(const ChunkSamples& from, const BrickBox& box);
};

/// Takes over the signs of the samples that an evaluation of `box` wrote.
void Chunk::read_signs(const ChunkSamples& from, const BrickBox& box) {
  signs.resize(row_words * samples * samples, 0);
  for (int bz = box.lo.z; bz <= box.hi.z + 1; ++bz)
    for (int by = box.lo.y; by <= box.hi.y + 1; ++by)
      for (int bx = box.lo.x; bx <= box.hi.x + 1; ++bx) {
        const Vec3i count = from.read(bx, by, bz, box);
        const std::uint64_t mask = (std::uint64_t{1} << count.x) - 1;
        const std::size_t word = bx / brick_cells;
        const int shift = bx % brick_cells * brick_cells;
        for (int k = bz * brick_cells; k < bz * brick_cells + count.z; ++k)
          for (int j = by * brick_cells; j < by * brick_cells + count.y; ++j) {
            const float* f = from.f.data() + (k * ChunkSamples::ny + j) * ChunkSamples::nx + bx * brick_cells;
            std::uint64_t bits = 0;
            for (int i = 0; i < brick_cells; ++i) bits |= std::uint64_t{f[i] > 0} << i;
            std::uint64_t& row = signs[row_words * (k * samples + j) + word];
            row = (row & ~(mask << shift)) | ((bits & mask) << shift);
          }
      }
}

/// Samples [lo, hi] of the lattice, or of one chunk.
struct LatticeBox {
  Vec3i lo, hi;
};

/// A chunk to be made anew, and which of its samples may have changed.
struct Job {
  Vec3i chunk;
  LatticeBox changed;
  Chunk* held = nullptr;
  bool differs = false;
};

/// What one thread needs; its memory is used again from update to update.
struct Worker {
  Worker(const CellSet& cells, const PolygonizeSettings& settings)
      : maker(cells, settings.voxel, {.normals = settings.normals, .facets = settings.normals}) {}

  void start(const field::CompiledField& field, double voxel) {
    source.emplace(field, voxel);
    range.reset();
    stats = {};
  }
  field::ChunkEvaluator::Range prepare(int a, int b) {
    if (!range || a != column_x || b != column_y) range = source->column(a, b);
    column_x = a, column_y = b;
    return *range;
  }

  std::optional<impl::FieldSource> source;  ///< of the update's field
  impl::PieceMaker maker;
  ChunkSamples samples;
  int column_x = 0, column_y = 0;
  std::optional<field::ChunkEvaluator::Range> range;  ///< of the column prepared last
  IncrementalMesher::Stats stats;
};

}  // namespace

struct IncrementalMesher::State {
  PolygonizeSettings settings;
  std::optional<CellSet> cells;
  std::unordered_map<Vec3i, std::unique_ptr<Chunk>, ChunkHash> chunks;
  std::uint64_t version = 0;
  bool complete = false;  ///< chunks is the mesh of the last update's field
  Stats stats;
  std::mutex mutex;
  std::vector<std::unique_ptr<Worker>> idle, workers;  ///< idle: not yet used in this update

  void rest();
  bool choose_cells(const Box3d& bounds);
  std::vector<Job> touched(const field::CompiledField& now, std::span<const LatticeBox> boxes);
  std::vector<LatticeBox> lattice_boxes(std::span<const Box3d> changed) const;
  std::vector<Vec3i> candidates(const field::CompiledField& now, Vec3i first, Vec3i last);
  void remake(Worker& worker, Job& job);
  std::vector<ChunkChange> collect(std::span<const Job> jobs);

  template <class Body>
  void with_worker(const field::CompiledField& now, const Body& body) {
    std::unique_ptr<Worker> worker;
    {
      const std::lock_guard lock(mutex);
      for (auto* from : {&workers, &idle})
        if (!worker && !from->empty()) {
          worker = std::move(from->back());
          from->pop_back();
        }
    }
    if (!worker) worker = std::make_unique<Worker>(*cells, settings);
    if (!worker->source) worker->start(now, settings.voxel);
    body(*worker);
    const std::lock_guard lock(mutex);
    workers.push_back(std::move(worker));
  }
};

/// Lets workers go of the field, which may not outlive the update.
void IncrementalMesher::State::rest() {
  for (auto& worker : workers) {
    worker->source.reset();
    idle.push_back(std::move(worker));
  }
  workers.clear();
}

/// Whether the cells to mesh are those of the last update.
bool IncrementalMesher::State::choose_cells(const Box3d& bounds) {
  if (cells && cells->limits() == CellSet::limits(bounds, settings)) return true;
  idle.clear();
  cells.emplace(bounds, settings);
  return false;
}

/// The samples in closed boxes; a little more, since positions are rounded.
std::vector<LatticeBox> IncrementalMesher::State::lattice_boxes(std::span<const Box3d> changed) const {
  constexpr double most = far, margin = 0.01;
  const auto low = [&](double v) { return floor_to(std::clamp(v / settings.voxel - margin, -most, most)); };
  const auto high = [&](double v) { return ceil_to(std::clamp(v / settings.voxel + margin, -most, most)); };
  std::vector<LatticeBox> out;
  for (const Box3d& b : changed)
    if (!b.empty())
      out.push_back({{low(b.lo.x), low(b.lo.y), low(b.lo.z)}, {high(b.hi.x), high(b.hi.y), high(b.hi.z)}});
  return out;
}

/// The chunks from `first` to `last` that may hold surface, or did.
std::vector<Vec3i> IncrementalMesher::State::candidates(const field::CompiledField& now, Vec3i first,
                                                        Vec3i last) {
  const int width = last.x - first.x + 1, depth = last.y - first.y + 1;
  if (width <= 0 || depth <= 0) return {};
  constexpr int few = 64;
  const field::ChunkEvaluator::Range given{first.z, last.z};
  std::vector<field::ChunkEvaluator::Range> ranges(std::ptrdiff_t{width} * depth, given);
  std::vector<Vec3i> out;
  if (last.z - first.z >= few) {
    // Too tall to look everywhere.
    parallel_for(std::ssize(ranges), [&](std::int64_t i) {
      with_worker(now, [&](Worker& worker) {
        const auto own =
            worker.prepare(first.x + static_cast<int>(i % width), first.y + static_cast<int>(i / width));
        auto& range = ranges[i];
        range = {std::max(range.first, own.first), std::min(range.last, own.last)};
      });
    });
    for (const auto& [at, chunk] : chunks)
      if (at.x >= first.x && at.x <= last.x && at.y >= first.y && at.y <= last.y && at.z >= first.z &&
          at.z <= last.z)
        out.push_back(at);
  }
  for (int i = 0; i < width * depth; ++i)
    for (int c = ranges[i].first; c <= ranges[i].last; ++c)
      out.push_back({first.x + i % width, first.y + i / width, c});
  return out;
}

/// Chunks with samples in the boxes, in order.
std::vector<Job> IncrementalMesher::State::touched(const field::CompiledField& now,
                                                   std::span<const LatticeBox> boxes) {
  std::vector<Job> jobs;
  if (cells->empty()) return jobs;
  const Vec3i first = cells->first_chunk(), last = cells->last_chunk();
  // Chunk c reads the samples from n c to n (c + 1).
  static_assert(n == 1 << 6);
  const auto from = [](int sample, int least) { return std::max((sample - 1) >> 6, least); };
  const auto to = [](int sample, int most) { return std::min(sample >> 6, most); };
  const auto within = [](Vec3i v) {
    return Vec3i{std::clamp(v.x, 0, n), std::clamp(v.y, 0, n), std::clamp(v.z, 0, n)};
  };
  for (const LatticeBox& box : boxes)
    for (Vec3i chunk :
         candidates(now, {from(box.lo.x, first.x), from(box.lo.y, first.y), from(box.lo.z, first.z)},
                    {to(box.hi.x, last.x), to(box.hi.y, last.y), to(box.hi.z, last.z)})) {
      const Vec3i origin = chunk * n;
      jobs.push_back({chunk, {within(box.lo - origin), within(box.hi - origin)}});
    }
  std::sort(jobs.begin(), jobs.end(),
            [](const Job& a, const Job& b) { return chunk_before(a.chunk, b.chunk); });
  std::size_t count = 0;
  for (const Job& job : jobs) {
    if (count == 0 || !(jobs[count - 1].chunk == job.chunk)) {
      jobs[count++] = job;
      continue;
    }
    LatticeBox& all = jobs[count - 1].changed;
    const LatticeBox& more = job.changed;
    all.lo = {std::min(all.lo.x, more.lo.x), std::min(all.lo.y, more.lo.y), std::min(all.lo.z, more.lo.z)};
    all.hi = {std::max(all.hi.x, more.hi.x), std::max(all.hi.y, more.hi.y), std::max(all.hi.z, more.hi.z)};
  }
  jobs.resize(count);
  return jobs;
}

void IncrementalMesher::State::remake(Worker& worker, Job& job) {
  Chunk& held = *job.held;
  // A brick reads the samples of its closure.
  const auto first = [](int sample) { return std::max((sample - 1) >> 3, 0); };
  const auto last = [](int sample) { return std::min(sample >> 3, field::chunk_bricks - 1); };
  static_assert(brick_cells == 1 << 3);
  const LatticeBox& s = job.changed;
  const BrickBox box{{first(s.lo.x), first(s.lo.y), first(s.lo.z)},
                     {last(s.hi.x), last(s.hi.y), last(s.hi.z)}};
  worker.prepare(job.chunk.x, job.chunk.y);
  std::copy(std::begin(held.active), std::end(held.active), worker.samples.active);
  worker.source->evaluate(job.chunk.z, box, worker.samples);
  worker.stats.evaluated += worker.samples.evaluated;
  worker.stats.chunks += 1;
  std::copy(std::begin(worker.samples.active), std::end(worker.samples.active), held.active);
  Piece made;
  if (worker.samples.any()) {
    held.read_signs(worker.samples, box);
    const impl::Kept kept{held.piece, s.lo, s.hi, held.signs.data()};
    if (worker.maker.make(worker.samples, *worker.source, made, &kept))
      worker.stats.vertices += worker.maker.fresh_vertices();
    else
      made = Piece{};
  }
  made.chunk = job.chunk;
  job.differs = !held.same_as(made);
  if (job.differs) {
    held.take(std::move(made), worker.maker);
    held.version = version;
  }
  worker.maker.forget_pieces();
}

/// Drops chunks without active bricks and lists what differs.
std::vector<ChunkChange> IncrementalMesher::State::collect(std::span<const Job> jobs) {
  std::vector<ChunkChange> out;
  for (const Job& job : jobs) {
    if (job.differs) out.push_back({job.chunk, version});
    const bool any = std::any_of(std::begin(job.held->active), std::end(job.held->active),
                                 [](std::uint64_t bricks) { return bricks != 0; });
    if (!any) chunks.erase(job.chunk);
  }
  std::sort(out.begin(), out.end(), chunk_before);
  return out;
}

IncrementalMesher::IncrementalMesher(const PolygonizeSettings& settings) : state_(std::make_unique<State>()) {
  state_->settings = settings;
}
IncrementalMesher::~IncrementalMesher() = default;

std::vector<ChunkChange> IncrementalMesher::update(const field::CompiledField& now,
                                                   std::span<const Box3d> changed, Progress& progress) {
  State& s = *state_;
  s.rest();
  const bool same_cells = s.choose_cells(now.bounds());
  const bool partial = s.complete && same_cells;
  s.complete = false;
  ++s.version;
  s.stats = {};
  const LatticeBox everything{{-far, -far, -far}, {far, far, far}};
  auto jobs = partial ? s.touched(now, s.lattice_boxes(changed)) : s.touched(now, {&everything, 1});
  std::vector<ChunkChange> gone;
  if (!partial) {
    // Chunks that the cells no longer reach.
    std::vector<Vec3i> kept;
    for (const Job& job : jobs) kept.push_back(job.chunk);
    std::sort(kept.begin(), kept.end(), chunk_before);
    std::erase_if(s.chunks, [&](const auto& entry) {
      if (std::binary_search(kept.begin(), kept.end(), entry.first, chunk_before)) return false;
      if (!entry.second->triangles.empty()) gone.push_back({entry.first, s.version});
      return true;
    });
  }
  for (Job& job : jobs) {
    auto& held = s.chunks[job.chunk];
    if (!held) held = std::make_unique<Chunk>();
    job.held = held.get();
  }
  progress.begin("mesh", jobs.size(), "chunks");
  parallel_for(
      std::ssize(jobs),
      [&](std::int64_t i) { s.with_worker(now, [&](Worker& worker) { s.remake(worker, jobs[i]); }); },
      progress);
  progress.end();
  for (const auto& worker : s.workers) {
    s.stats.chunks += worker->stats.chunks;
    s.stats.evaluated += worker->stats.evaluated;
    s.stats.vertices += worker->stats.vertices;
  }
  s.rest();
  auto out = s.collect(jobs);
  out.insert(out.end(), gone.begin(), gone.end());
  std::sort(out.begin(), out.end(), chunk_before);
  s.complete = true;
  return out;
}

ChunkView IncrementalMesher::chunk(Vec3i chunk) const {
  const auto found = state_->chunks.find(chunk);
  if (found == state_->chunks.end()) return {};
  const Chunk& c = *found->second;
  return {c.positions, c.shown, c.triangles, c.version};
}

std::vector<Vec3i> IncrementalMesher::chunks() const {
  std::vector<Vec3i> out;
  for (const auto& [at, chunk] : state_->chunks)
    if (!chunk->triangles.empty()) out.push_back(at);
  std::sort(out.begin(), out.end(), chunk_before);
  return out;
}

mesh::Mesh IncrementalMesher::assemble() {
  State& s = *state_;
  if (!s.complete) fail(ErrorKind::internal, "a mesh cannot be assembled before an update() has succeeded");
  const auto order = chunks();
  const bool parts = s.settings.min_fragment_volume > 0;
  if (parts)
    parallel_for(std::ssize(order), [&](std::int64_t i) {
      Chunk& chunk = *s.chunks.at(order[i]);
      if (chunk.parts_known) return;
      std::vector<std::uint32_t> scratch;
      impl::find_parts(chunk.piece, scratch);
      chunk.parts_known = true;
    });
  // Joining sums up rims and settles their normals: it gets copies.
  impl::Arena arena;
  std::vector<Piece> pieces;
  impl::Connectivity connectivity;
  for (Vec3i at : order) {
    const Chunk& chunk = *s.chunks.at(at);
    pieces.push_back(chunk.piece);
    Piece& piece = pieces.back();
    piece.normals = arena.copy(chunk.shown.data(), chunk.shown.size());
    piece.rim = arena.copy(chunk.rim.data(), chunk.rim.size());
    if (parts) connectivity.add(piece);
  }
  if (parts) connectivity.decide(s.settings.min_fragment_volume);
  double seconds = 0;
  return impl::assemble(pieces, s.settings.voxel, parts ? &connectivity : nullptr, impl::SeamSums(), &seconds,
                        &seconds);
}

const IncrementalMesher::Stats& IncrementalMesher::stats() const {
  return state_->stats;
}

}  // namespace tafoni::surface
