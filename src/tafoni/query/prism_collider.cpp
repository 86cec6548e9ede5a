// Finds the chunks of the prism mesh near a box and their trees, which are made when they are first asked
// for; tells sides by the pieces of the four columns around.

#include "tafoni/query/prism_collider.h"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "tafoni/field/chunks.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query {

using surface::PrismMesher;
using volume::ColumnFrame;

struct PrismCollider::Chunk {
  std::once_flag once;
  std::unique_ptr<const impl::TriangleTree> tree;
};

PrismCollider::PrismCollider(const volume::PrismFields& fields, const surface::PrismMeshSettings& settings)
    : fields_(fields), mesher_(settings) {
  const ColumnFrame& frame = fields_.frame();
  update(fields, {0, 0, frame.nx - 1, frame.ny - 1});
}
PrismCollider::~PrismCollider() = default;

void PrismCollider::update(const volume::PrismFields& now, const volume::ColumnBox& changed) {
  fields_ = now;
  const auto changes = mesher_.update(fields_, changed);
  chunks_.resize(std::ptrdiff_t{mesher_.chunks_x()} * mesher_.chunks_y());
  for (auto& chunk : chunks_)
    if (!chunk) chunk = std::make_unique<Chunk>();
  for (const surface::ChunkChange& change : changes)
    chunks_[index(change.chunk.x, change.chunk.y)] = std::make_unique<Chunk>();
  // Vertices are rounded to float.
  bounds_ = fields_.bounds();
  if (!bounds_.empty())
    bounds_ = bounds_.grown(1e-6 + 1.2e-7 * std::max(length(bounds_.lo), length(bounds_.hi)));
}

double PrismCollider::stride() const {
  return PrismMesher::chunk_cells * std::min(fields_.frame().dx, fields_.frame().dy);
}

const impl::TriangleTree& PrismCollider::tree(int a, int b) const {
  Chunk& chunk = *chunks_[index(a, b)];
  std::call_once(chunk.once, [&] {
    const surface::PrismChunkMesh& mesh = mesher_.chunk({a, b, 0});
    std::vector<Vec3f> positions;
    positions.reserve(mesh.positions.size());
    for (const Vec3f& p : mesh.positions)
      positions.push_back(to_float(fields_.frame().origin + to_double(p)));
    chunk.tree = std::make_unique<const impl::TriangleTree>(positions, mesh.triangles);
  });
  return *chunk.tree;
}

void PrismCollider::visit(const Box3d& box, const TreeVisitor& visitor) const {
  if (!box.overlaps(bounds_)) return;
  const ColumnFrame& frame = fields_.frame();
  const double slack = 1.2e-7 * std::max(length(bounds_.lo), length(bounds_.hi));
  const auto chunk_of = [](double d, double step, int count) {
    return static_cast<int>(std::clamp(std::floor(d / (step * PrismMesher::chunk_cells)), 0.0, count - 1.0));
  };
  const int a0 = chunk_of(box.lo.x - slack - frame.origin.x, frame.dx, mesher_.chunks_x());
  const int a1 = chunk_of(box.hi.x + slack - frame.origin.x, frame.dx, mesher_.chunks_x());
  const int b0 = chunk_of(box.lo.y - slack - frame.origin.y, frame.dy, mesher_.chunks_y());
  const int b1 = chunk_of(box.hi.y + slack - frame.origin.y, frame.dy, mesher_.chunks_y());
  for (int b = b0; b <= b1; ++b)
    for (int a = a0; a <= a1; ++a) {
      const impl::TriangleTree& found = tree(a, b);
      if (!found.empty()) visitor(found);
    }
}

/// Matter between columns lies within the hull of theirs. Where each has one piece and all hold the
/// elevation, what is between does, too; where columns split, only the surface can tell.
Collider::Side PrismCollider::side(Vec3d p) const {
  const ColumnFrame& frame = fields_.frame();
  const Vec3d d = p - frame.origin;
  const double u = std::floor(d.x / frame.dx), v = std::floor(d.y / frame.dy);
  if (!(u >= 0 && v >= 0 && u < frame.nx - 1 && v < frame.ny - 1)) return Side::air;
  bool within = false, everywhere = true;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (int corner = 0; corner < 4; ++corner) {
    const int i = static_cast<int>(u) + (corner & 1), j = static_cast<int>(v) + (corner >> 1);
    int pieces = 0;
    bool holds = false;
    for (int layer = 0; layer < fields_.layers(); ++layer) {
      if (!fields_.active(layer, i, j)) continue;
      const volume::Matter matter = fields_.point(layer, i, j);
      const double bottom = matter.bottom, top = matter.top;
      ++pieces;
      lowest = std::min(lowest, bottom);
      highest = std::max(highest, top);
      holds = holds || (bottom < d.z && d.z < top);
    }
    everywhere = everywhere && pieces == 1 && holds;
  }
  within = lowest <= d.z && d.z <= highest;
  return everywhere ? Side::rock : within ? Side::unknown : Side::air;
}

}  // namespace tafoni::query
