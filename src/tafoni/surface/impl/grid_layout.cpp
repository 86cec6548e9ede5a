// Cuts a grid's frame into chunks, axis by axis; a solid has a layer of air around the frame, whose voxels
// belong to the outermost chunks.

#include "tafoni/surface/impl/grid_layout.h"

#include <algorithm>
#include <cmath>

#include "tafoni/surface/impl/lattice.h"

namespace tafoni::surface::impl {
namespace {

using volume::SampleBox;

constexpr int side = volume::ScalarGrid::chunk_samples;
static_assert(side == 1 << 5);

struct Axis {
  int first, samples, lo, hi;
};

/// What chunk `at` of `chunks` has along one axis, of n samples in the frame.
Axis axis_of(int at, int chunks, int n, bool solid) {
  const int frame_lo = solid ? -1 : 0, frame_hi = solid ? n : n - 1;
  const int lo = at == 0 ? frame_lo : side * at, hi = at == chunks - 1 ? frame_hi : side * (at + 1);
  const int first = std::max(lo - 1, frame_lo), last = std::min(hi + 1, frame_hi);
  return {first, last - first + 1, lo - first, hi - first};
}

float margin_of(const volume::GridFrame& frame) {
  const Box3d box = frame.box();
  double reach = 0;
  for (Vec3d p : {box.lo, box.hi}) reach = std::max({reach, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return margin_for(static_cast<std::int64_t>(std::min(reach / frame.spacing, 1e15)) + 2);
}

}  // namespace

GridLayout::GridLayout(const volume::GridFrame& f, Boundary b) : frame(f), boundary(b), margin(margin_of(f)) {
  const auto count = [](int samples) { return (samples - 2) / side + 1; };
  chunks_ = {count(f.size.x), count(f.size.y), count(f.size.z)};
}

GridLayout::Block GridLayout::block(Vec3i chunk) const {
  const bool solid = boundary == Boundary::solid;
  const Axis x = axis_of(chunk.x, chunks_.x, frame.size.x, solid);
  const Axis y = axis_of(chunk.y, chunks_.y, frame.size.y, solid);
  const Axis z = axis_of(chunk.z, chunks_.z, frame.size.z, solid);
  return {
      {x.first, y.first, z.first}, {x.samples, y.samples, z.samples}, {x.lo, y.lo, z.lo}, {x.hi, y.hi, z.hi}};
}

std::pair<Vec3i, Vec3i> GridLayout::touched(const SampleBox& s) const {
  const Vec3i n = frame.size;
  const SampleBox in{{std::max(s.lo.x, 0), std::max(s.lo.y, 0), std::max(s.lo.z, 0)},
                     {std::min(s.hi.x, n.x - 1), std::min(s.hi.y, n.y - 1), std::min(s.hi.z, n.z - 1)}};
  if (in.empty()) return {{0, 0, 0}, {-1, -1, -1}};
  // Chunk a reads the samples from 32 a - 1 to 32 a + 33.
  const auto first = [](int lo) { return std::max(lo - 2, 0) >> 5; };
  const auto last = [](int hi, int chunks) { return std::min((hi + 1) >> 5, chunks - 1); };
  return {{first(in.lo.x), first(in.lo.y), first(in.lo.z)},
          {last(in.hi.x, chunks_.x), last(in.hi.y, chunks_.y), last(in.hi.z, chunks_.z)}};
}

Vec3i GridLayout::owner(Vec3i s) const {
  return {std::clamp(s.x >> 5, 0, chunks_.x - 1), std::clamp(s.y >> 5, 0, chunks_.y - 1),
          std::clamp(s.z >> 5, 0, chunks_.z - 1)};
}

}  // namespace tafoni::surface::impl
