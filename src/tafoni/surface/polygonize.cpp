// Walks the columns of chunks on all threads, makes a piece of every chunk with surface (impl/piece.h),
// decides over all pieces which parts are too small to keep, and joins pieces to one mesh or one a tile.

#include "tafoni/surface/polygonize.h"

#include <algorithm>
#include <mutex>

#include "tafoni/core/clock.h"
#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/field/chunks.h"
#include "tafoni/surface/impl/connect.h"

namespace tafoni::surface {
namespace {

using impl::CellSet;
using impl::ChunkColumns;
using impl::Connectivity;
using impl::Piece;
using impl::PieceMaker;
using impl::PieceParts;
using impl::SeamSums;

/// What one thread needs to work on a column of chunks.
struct PolygonizeWorker {
  PolygonizeWorker(std::unique_ptr<SampleSource> s, const CellSet& cells, double voxel,
                   const PieceParts& wanted)
      : source(std::move(s)), maker(cells, voxel, wanted) {}

  std::unique_ptr<SampleSource> source;
  PieceMaker maker;
  field::ChunkSamples samples;
  PolygonizeStats stats;
};

class PolygonizeJob {
 public:
  PolygonizeJob(const SourceFactory& factory, const Box3d& bounds, const PolygonizeSettings& settings,
                Progress& progress)
      : factory_(factory), settings_(settings), progress_(progress), cells_(bounds, settings) {
    if (settings.tiles_x < 1 || settings.tiles_y < 1)
      fail(ErrorKind::usage, "{} x {} tiles cannot be made: give at least 1 x 1", settings.tiles_x,
           settings.tiles_y);
    if (cells_.empty()) return;
    first_ = cells_.first_chunk();
    last_ = cells_.last_chunk();
    if (!settings.region.empty() && !bounds.empty()) skip_empty(bounds);
  }

  bool empty() const { return cells_.empty() || first_.x > last_.x || first_.y > last_.y; }
  std::uint64_t columns() const { return empty() ? 0 : whole().count(); }
  ChunkColumns whole() const { return {first_.x, last_.x + 1, first_.y, last_.y + 1}; }
  ChunkColumns tile(TileIndex t) const {
    const auto cut = [](int first, int last, int at, int tiles) {
      return first + static_cast<int>((std::int64_t{last} + 1 - first) * at / tiles);
    };
    return {
        cut(first_.x, last_.x, t.x, settings_.tiles_x), cut(first_.x, last_.x, t.x + 1, settings_.tiles_x),
        cut(first_.y, last_.y, t.y, settings_.tiles_y), cut(first_.y, last_.y, t.y + 1, settings_.tiles_y)};
  }
  template <class Body>
  void for_each_tile(const Body& body) const {
    if (empty()) return;
    for (int y = 0; y < settings_.tiles_y; ++y)
      for (int x = 0; x < settings_.tiles_x; ++x)
        if (tile({x, y}).count() > 0) body(TileIndex{x, y});
  }

  /// The pieces of a box of columns, in order. Their memory stays until release().
  std::vector<Piece> pieces(const ChunkColumns& box, bool normals, bool parts);
  void add_stats(PolygonizeStats& stats) const;
  void forget_workers() { workers_.clear(); }
  void release() { arenas_.clear(); }

 private:
  void skip_empty(const Box3d& bounds);
  void column(PolygonizeWorker& worker, int a, int b, std::vector<Piece>& out);
  std::unique_ptr<PolygonizeWorker> take(bool normals, bool parts);

  const SourceFactory& factory_;
  const PolygonizeSettings& settings_;
  Progress& progress_;
  CellSet cells_;
  Vec3i first_, last_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<PolygonizeWorker>> workers_;
  std::vector<std::unique_ptr<impl::Arena>> arenas_;
};

/// Narrows the columns of chunks to those that can hold surface. Up and down, columns are walked where they
/// can have some.
void PolygonizeJob::skip_empty(const Box3d& bounds) {
  const double side = settings_.voxel * field::chunk_cells;
  const auto low = [&](int first, double lo) {
    return static_cast<int>(std::min(std::max<double>(std::floor(lo / side) - 1, first), 0x1p30));
  };
  const auto high = [&](int last, double hi) {
    return static_cast<int>(std::max(std::min<double>(std::floor(hi / side) + 1, last), -0x1p30));
  };
  first_ = {low(first_.x, bounds.lo.x), low(first_.y, bounds.lo.y), first_.z};
  last_ = {high(last_.x, bounds.hi.x), high(last_.y, bounds.hi.y), last_.z};
}

std::unique_ptr<PolygonizeWorker> PolygonizeJob::take(bool normals, bool parts) {
  {
    const std::lock_guard lock(mutex_);
    if (!workers_.empty()) {
      auto worker = std::move(workers_.back());
      workers_.pop_back();
      return worker;
    }
  }
  const PieceParts wanted{.normals = normals, .facets = settings_.normals, .parts = parts};
  return std::make_unique<PolygonizeWorker>(factory_(), cells_, settings_.voxel, wanted);
}

void PolygonizeJob::column(PolygonizeWorker& worker, int a, int b, std::vector<Piece>& out) {
  const double start = now(), before = worker.maker.triangles_seconds + worker.maker.normals_seconds;
  const auto range = worker.source->column(a, b);
  for (int c = std::max(range.first, first_.z); c <= std::min(range.last, last_.z); ++c) {
    if (!worker.source->evaluate(c, worker.samples)) continue;
    worker.stats.evaluated += worker.samples.evaluated;
    for (auto bricks : worker.samples.active) worker.stats.bricks += std::popcount(bricks);
    Piece piece;
    if (!worker.maker.make(worker.samples, *worker.source, piece)) continue;
    worker.stats.chunks += 1;
    worker.stats.cells += piece.cut_cells;
    // Beyond a tile's seam the triangles count, whose vertices get their normals later.
    if (settings_.normals) worker.maker.settle(piece);
    out.push_back(std::move(piece));
  }
  const double made = worker.maker.triangles_seconds + worker.maker.normals_seconds - before;
  worker.stats.evaluate_seconds += now() - start - made;
}

std::vector<Piece> PolygonizeJob::pieces(const ChunkColumns& box, bool normals, bool parts) {
  const int width = box.x1 - box.x0;
  std::vector<std::vector<Piece>> columns(box.count());
  parallel_for(
      box.count(),
      [&](std::int64_t at) {
        auto worker = take(normals, parts);
        column(*worker, box.x0 + static_cast<int>(at % width), box.y0 + static_cast<int>(at / width),
               columns[at]);
        const std::lock_guard lock(mutex_);
        workers_.push_back(std::move(worker));
      },
      progress_);
  for (const auto& worker : workers_) arenas_.push_back(worker->maker.take_arena());
  std::vector<Piece> all;
  for (auto& column : columns)
    for (Piece& piece : column) all.push_back(std::move(piece));
  return all;
}

void PolygonizeJob::add_stats(PolygonizeStats& stats) const {
  for (const auto& worker : workers_) {
    stats.chunks += worker->stats.chunks;
    stats.bricks += worker->stats.bricks;
    stats.cells += worker->stats.cells;
    stats.evaluated += worker->stats.evaluated;
    stats.evaluate_seconds += worker->stats.evaluate_seconds;
    stats.triangles_seconds += worker->maker.triangles_seconds;
    stats.normals_seconds += worker->maker.normals_seconds;
  }
}

void note_decision(const Connectivity::Result& result, PolygonizeStats& stats) {
  stats.components = result.components;
  stats.fragments_removed = result.fragments;
  stats.bubbles_removed = result.bubbles;
}

}  // namespace

mesh::Mesh polygonize(const SourceFactory& source, const Box3d& bounds, const PolygonizeSettings& settings,
                      Progress& progress, PolygonizeStats* stats) {
  PolygonizeStats sums;
  PolygonizeJob job(source, bounds, settings, progress);
  const bool parts = settings.min_fragment_volume > 0;
  progress.begin("mesh", job.columns(), "columns");
  std::vector<Piece> pieces;
  job.for_each_tile([&](TileIndex t) {
    for (Piece& piece : job.pieces(job.tile(t), settings.normals, parts)) pieces.push_back(std::move(piece));
  });
  job.add_stats(sums);
  job.forget_workers();
  std::sort(pieces.begin(), pieces.end(),
            [](const Piece& p, const Piece& q) { return ChunkOrder()(p.chunk, q.chunk); });
  Connectivity connectivity;
  if (parts) {
    const double start = now();
    for (const Piece& piece : pieces) connectivity.add(piece);
    note_decision(connectivity.decide(settings.min_fragment_volume), sums);
    sums.stitch_seconds += now() - start;
  }
  mesh::Mesh mesh = impl::assemble(pieces, settings.voxel, parts ? &connectivity : nullptr, SeamSums(),
                                   &sums.stitch_seconds, &sums.gather_seconds);
  sums.vertices = mesh.positions.size();
  sums.triangles = mesh.triangles.size();
  progress.end();
  if (stats) *stats = sums;
  return mesh;
}

void polygonize_tiles(const SourceFactory& source, const Box3d& bounds, const PolygonizeSettings& settings,
                      const TileSink& sink, Progress& progress, PolygonizeStats* stats) {
  PolygonizeStats sums;
  PolygonizeJob job(source, bounds, settings, progress);
  const bool parts = settings.min_fragment_volume > 0;
  Connectivity connectivity;
  SeamSums seams;
  // What a tile needs to know of the others: which parts are small, and which triangles lie beyond its seams.
  if (parts || (settings.normals && settings.tiles_x * settings.tiles_y > 1)) {
    progress.begin("look beyond the tiles", job.columns(), "columns");
    job.for_each_tile([&](TileIndex t) {
      const ChunkColumns tile = job.tile(t);
      for (Piece& piece : job.pieces(tile, false, parts)) {
        if (parts) connectivity.add(piece);
        if (settings.normals) seams.add(piece, tile);
      }
      job.release();
    });
    job.forget_workers();
    if (parts) note_decision(connectivity.decide(settings.min_fragment_volume), sums);
    progress.end();
  }
  progress.begin("mesh", job.columns(), "columns");
  job.for_each_tile([&](TileIndex t) {
    auto pieces = job.pieces(job.tile(t), settings.normals, connectivity.any_removed());
    mesh::Mesh mesh = impl::assemble(pieces, settings.voxel, parts ? &connectivity : nullptr, seams,
                                     &sums.stitch_seconds, &sums.gather_seconds);
    job.release();
    if (mesh.triangles.empty()) return;
    sums.vertices += mesh.positions.size();
    sums.triangles += mesh.triangles.size();
    sink(t, std::move(mesh));
  });
  job.add_stats(sums);
  progress.end();
  if (stats) *stats = sums;
}

}  // namespace tafoni::surface
