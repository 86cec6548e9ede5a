// Makes a tile by evaluating the bricks that hold it, with a worker that goes on in the same chunk where it
// can, and polygonizes its cells.

#include "tafoni/query/field_collider.h"

#include <algorithm>

#include "tafoni/field/chunks.h"
#include "tafoni/field/compiled.h"
#include "tafoni/query/impl/tile.h"
#include "tafoni/surface/inner/bricks.h"

namespace tafoni::query {

using impl::Tile;

namespace {

constexpr int tile_bricks = Tile::cells / field::brick_cells;
constexpr int chunk_tiles = field::chunk_cells / Tile::cells;
static_assert(tile_bricks == 2, "fill_solid() relies on one sample that all bricks of a tile share");

std::int32_t chunk_of(std::int32_t tile) {
  return tile >= 0 ? tile / chunk_tiles : -((-tile + chunk_tiles - 1) / chunk_tiles);
}

/// A brick that is not active holds no sign change, so that its samples have the sign of the one in the
/// tile's middle.
void fill_solid(const field::ChunkSamples& samples, const field::BrickBox& box, Tile& tile) {
  constexpr int n = field::brick_cells, s = Tile::samples;
  const Vec3i first{box.lo.x * n, box.lo.y * n, box.lo.z * n};
  const bool middle = samples.at(first.x + n, first.y + n, first.z + n) > 0;
  tile.solid.assign(s * s, middle ? (1u << s) - 1 : 0);
  for (int bz = 0; bz < tile_bricks; ++bz)
    for (int by = 0; by < tile_bricks; ++by)
      for (int bx = 0; bx < tile_bricks; ++bx) {
        if (!samples.brick(box.lo.x + bx, box.lo.y + by, box.lo.z + bz)) continue;
        for (int k = bz * n; k <= (bz + 1) * n; ++k)
          for (int j = by * n; j <= (by + 1) * n; ++j) {
            std::uint32_t& word = tile.solid[k * s + j];
            for (int i = bx * n; i <= (bx + 1) * n; ++i) {
              const std::uint32_t bit = 1u << i;
              word = samples.at(first.x + i, first.y + j, first.z + k) > 0 ? word | bit : word & ~bit;
            }
          }
      }
}

bool no_surface(Interval range) {
  return range.lo > 0 || range.hi <= 0;
}

/// Elevations between which the surface lies, to `grain` metres: field.bounds() knows x and y, but functions
/// in the tree may vary at any elevation.
Box3d surface_bounds(const field::CompiledField& field, double grain) {
  constexpr double limit = 1e5;
  Box3d box = field.bounds();
  if (box.empty()) return box;
  const auto none = [&](double lo, double hi) {
    return no_surface(field.interval({{box.lo.x, box.lo.y, lo}, {box.hi.x, box.hi.y, hi}}));
  };
  // What lies beyond `from` towards `to` and holds surface, at its far end.
  const auto beyond = [&](auto& self, double from, double to) -> double {
    if (none(std::min(from, to), std::max(from, to))) return from;
    if (std::abs(to - from) <= grain) return to;
    const double middle = (from + to) / 2, far = self(self, middle, to);
    return far != middle ? far : self(self, from, middle);
  };
  const double top = beyond(beyond, box.hi.z, limit), bottom = beyond(beyond, box.lo.z, -limit);
  box.hi.z = top, box.lo.z = bottom;
  return box;
}

}  // namespace

/// What one thread makes tiles with.
struct FieldCollider::Worker {
  field::ChunkEvaluator evaluator;
  surface::BrickPolygonizer polygonizer;
  field::ChunkSamples samples;
  mesh::Mesh mesh;
  bool prepared = false;
  Vec3i chunk;  ///< whose column is prepared
  field::ChunkEvaluator::Range range;

  Worker(const field::CompiledField& field, const FieldSettings& settings, const Box3d& region)
      : evaluator(field, settings.voxel), polygonizer(settings.voxel, region) {}

  bool evaluate(Vec3i wanted, const field::BrickBox& box) {
    if (!prepared || wanted.x != chunk.x || wanted.y != chunk.y) range = evaluator.column(wanted.x, wanted.y);
    prepared = true;
    chunk = wanted;
    return wanted.z >= range.first && wanted.z <= range.last && evaluator.evaluate(wanted.z, box, samples);
  }
};

FieldCollider::FieldCollider(field::CompiledField field, const FieldSettings& settings)
    : LatticeCollider({}, settings.voxel, settings.cache_bytes),
      field_(std::move(field)),
      settings_(settings) {
  update(field_, {});
}
FieldCollider::~FieldCollider() = default;

void FieldCollider::update(field::CompiledField now, std::span<const Box3d> changed) {
  idle_.clear();
  field_ = std::move(now);
  bounds_ = surface_bounds(field_, Tile::cells * settings_.voxel);
  if (!bounds_.empty()) bounds_ = bounds_.grown(2 * settings_.voxel);
  idle_.push_back(
      std::make_unique<Worker>(field_, settings_, settings_.region.empty() ? bounds_ : settings_.region));
  forget(changed);
}

std::unique_ptr<FieldCollider::Worker> FieldCollider::take(Vec3i chunk) const {
  const std::lock_guard lock(mutex_);
  if (idle_.empty())
    return std::make_unique<Worker>(field_, settings_, settings_.region.empty() ? bounds_ : settings_.region);
  auto best = std::find_if(idle_.begin(), idle_.end(), [&](const auto& w) {
    return w->prepared && w->chunk.x == chunk.x && w->chunk.y == chunk.y;
  });
  if (best == idle_.end()) best = idle_.begin();
  std::unique_ptr<Worker> worker = std::move(*best);
  idle_.erase(best);
  return worker;
}

LatticeCollider::TilePtr FieldCollider::make(Vec3i index) const {
  const Vec3i chunk{chunk_of(index.x), chunk_of(index.y), chunk_of(index.z)};
  const Vec3i lo{(index.x - chunk.x * chunk_tiles) * tile_bricks,
                 (index.y - chunk.y * chunk_tiles) * tile_bricks,
                 (index.z - chunk.z * chunk_tiles) * tile_bricks};
  const field::BrickBox box{lo, {lo.x + tile_bricks - 1, lo.y + tile_bricks - 1, lo.z + tile_bricks - 1}};
  auto tile = std::make_shared<Tile>();
  std::unique_ptr<Worker> worker = take(chunk);
  std::fill(std::begin(worker->samples.active), std::end(worker->samples.active), 0);
  if (worker->evaluate(chunk, box)) {
    worker->polygonizer.polygonize(worker->samples, box, worker->mesh);
    fill_solid(worker->samples, box, *tile);
    tile->triangles = impl::TriangleTree(worker->mesh.positions, worker->mesh.triangles);
  } else {
    const double size = settings_.voxel;
    tile->rock = field_.value({size * (index.x * Tile::cells), size * (index.y * Tile::cells),
                               size * (index.z * Tile::cells)}) > 0;
  }
  const std::lock_guard lock(mutex_);
  idle_.push_back(std::move(worker));
  return tile;
}

bool FieldCollider::empty(const Box3d& box) const {
  return no_surface(field_.interval(box.grown(settings_.voxel)));
}

}  // namespace tafoni::query
