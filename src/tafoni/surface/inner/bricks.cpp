// Walks a box of bricks as one block with the polygonizer's core; cells of inactive bricks are masked out.

#include "tafoni/surface/inner/bricks.h"

#include <cstring>

#include "tafoni/surface/impl/block.h"
#include "tafoni/surface/impl/lattice.h"

namespace tafoni::surface {

using namespace impl;

struct BrickPolygonizer::State {
  Plane plane;
  BlockWalker walker;
  Buffer<float> positions;
  Vec3i first;                       ///< the box's first cell
  std::vector<std::uint64_t> cells;  ///< a word a row
  std::vector<bool> layers;
  int rows_a_layer = 0;
  const float* f = nullptr;
  mesh::Mesh* out = nullptr;

  bool layer(int k) const { return k >= 0 && k < std::ssize(layers) && layers[k]; }
  const std::uint64_t* rows(int k) const { return cells.data() + k * rows_a_layer; }

  bool choose_cells(const field::ChunkSamples& samples, const field::BrickBox& box) {
    constexpr int n = field::brick_cells;
    rows_a_layer = (box.hi.y - box.lo.y + 1) * n;
    const int height = (box.hi.z - box.lo.z + 1) * n;
    cells.assign(rows_a_layer * height, 0);
    layers.assign(height, false);
    bool any = false;
    for (int bz = box.lo.z; bz <= box.hi.z; ++bz)
      for (int by = box.lo.y; by <= box.hi.y; ++by)
        for (int bx = box.lo.x; bx <= box.hi.x; ++bx) {
          if (!samples.brick(bx, by, bz)) continue;
          any = true;
          const std::uint64_t bits = std::uint64_t{0xff} << ((bx - box.lo.x) * n);
          for (int k = (bz - box.lo.z) * n; k < (bz - box.lo.z + 1) * n; ++k) {
            layers[k] = true;
            for (int j = (by - box.lo.y) * n; j < (by - box.lo.y + 1) * n; ++j)
              cells[k * rows_a_layer + j] |= bits;
          }
        }
    return any;
  }

  void vertices(int k, const PlaneOutput& found) {
    const std::size_t count = found.keys.size();
    plane.f = f + std::ptrdiff_t{k} * plane.plane_step;
    plane.k = k;
    plane.level = first.z + k;
    positions.reserve_extra(3 * (count + kernel_slack));
    place(plane, found.keys.data(), count, positions.end(), nullptr, nullptr);
    positions.commit(3 * count);
  }

  void triangles(const PlaneOutput& found) {
    const std::size_t count = found.indices.size() / 3, before = out->triangles.size();
    out->triangles.resize(before + count);
    if (count) std::memcpy(&out->triangles[before], found.indices.data(), count * sizeof out->triangles[0]);
  }
};

BrickPolygonizer::BrickPolygonizer(double voxel, const Box3d& region) : state_(std::make_unique<State>()) {
  // How far cells reach does not count up and down.
  const Box3d flat{{region.lo.x, region.lo.y, 0}, {region.hi.x, region.hi.y, 0}};
  const Box3d wanted = !region.empty() && flat.bounded() ? flat : Box3d{};
  PolygonizeSettings settings;
  settings.voxel = voxel;
  const CellSet set(wanted, settings);
  Plane& plane = state_->plane;
  plane.voxel = voxel;
  plane.margin = margin_for(set.reach());
  plane.row_step = field::ChunkSamples::nx;
  plane.plane_step = field::ChunkSamples::nx * field::ChunkSamples::ny;
}
BrickPolygonizer::~BrickPolygonizer() = default;

void BrickPolygonizer::polygonize(const field::ChunkSamples& samples, const field::BrickBox& box,
                                  mesh::Mesh& out) {
  State& s = *state_;
  out.positions.clear();
  out.normals.clear();
  out.colors.clear();
  out.texture.clear();
  out.triangles.clear();
  if (!s.choose_cells(samples, box)) return;
  constexpr int n = field::brick_cells;
  const Vec3i lo{box.lo.x * n, box.lo.y * n, box.lo.z * n};
  const Vec3i hi{(box.hi.x + 1) * n, (box.hi.y + 1) * n, (box.hi.z + 1) * n};
  constexpr int cells = field::chunk_cells;
  s.first = {samples.chunk.x * cells + lo.x, samples.chunk.y * cells + lo.y, samples.chunk.z * cells + lo.z};
  s.plane.i0 = s.first.x, s.plane.j0 = s.first.y;
  s.f = samples.f.data() + (std::ptrdiff_t{lo.z} * s.plane.plane_step + lo.y * s.plane.row_step + lo.x);
  s.out = &out;
  s.positions.clear();
  s.walker.walk(s.f, hi.x - lo.x + 1, hi.y - lo.y + 1, hi.z - lo.z + 1, s.plane.row_step, s.plane.plane_step,
                s, s);
  const auto* p = reinterpret_cast<const Vec3f*>(s.positions.data());
  out.positions.assign(p, p + s.walker.vertex_count());
}

}  // namespace tafoni::surface
