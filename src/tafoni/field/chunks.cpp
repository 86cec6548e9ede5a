// Evaluates a field on a lattice, chunk by chunk: which chunks of a column may hold surface, the samples of
// one, and gradients at points within it.

#include "tafoni/field/chunks.h"

#include <algorithm>
#include <cmath>

#include "tafoni/field/compiled.h"
#include "tafoni/field/impl/chunk_work.h"
#include "tafoni/math/whole.h"

namespace tafoni::field {

using impl::brick_index;
using impl::sides;

namespace {

constexpr int bricks = chunk_bricks;

/// Bit bx: brick bx of this row, or of one before it along y or z, is active.
unsigned near_row(const std::uint64_t (&active)[bricks], int by, int bz) {
  const std::uint64_t layer = (bz < bricks ? active[bz] : 0) | (bz > 0 ? active[bz - 1] : 0);
  const std::uint64_t row = by < bricks ? layer >> by * bricks : 0;
  const std::uint64_t before = by > 0 ? layer >> (by - 1) * bricks : 0;
  return static_cast<unsigned>((row | before) & 0xff);
}

}  // namespace

struct ChunkEvaluator::State {
  impl::ChunkFrame frame;
  impl::ChunkWork work;
  std::vector<std::uint32_t> cursor, order, bricks_of;
  const Progress* watched = nullptr;

  State(const impl::Program& program, double voxel, Vec3d origin, float band)
      : frame{voxel, origin, band, {}, {}, {}, {}}, work(program, frame) {
    if (!(voxel > 0) || !std::isfinite(voxel))
      fail(ErrorKind::usage, "the voxel size must be a positive length in metres");
  }

  void check() const {
    if (watched) watched->check();
  }
  Range widened(Range known);
  int highest(int from, int to);
  int lowest(int from, int to);
};

ChunkEvaluator::ChunkEvaluator(const CompiledField& field, double voxel, Vec3d origin, float band)
    : state_(std::make_unique<State>(field.program(), voxel, origin, band)) {}
ChunkEvaluator::~ChunkEvaluator() = default;

void ChunkEvaluator::watch(const Progress& progress) {
  state_->watched = &progress;
}

ChunkEvaluator::Range ChunkEvaluator::column(int a, int b) {
  State& s = *state_;
  s.frame.chunk = {a, b, 0};
  s.frame.x.set(std::int64_t{a} * chunk_cells, s.frame.voxel, s.frame.origin.x);
  s.frame.y.set(std::int64_t{b} * chunk_cells, s.frame.voxel, s.frame.origin.y);
  const Interval z = s.work.set_column();
  const double size = s.frame.voxel * chunk_cells;
  Range range;
  if (z.lo <= z.hi) {
    const double lo = z.lo - s.frame.origin.z, hi = z.hi - s.frame.origin.z;
    range = {floor_to(lo / size) - (lo == std::floor(lo / size) * size ? 1 : 0), floor_to(hi / size)};
  }
  return s.work.program().nested.empty() ? range : s.widened(range);
}

/// Nested leaves may vary at any elevation: what their ranges do not exclude is added to the known range.
ChunkEvaluator::Range ChunkEvaluator::State::widened(Range known) {
  const int limit = ceil_to(impl::reach_limit / (frame.voxel * chunk_cells));
  if (known.first > known.last) {
    const int last = highest(-limit, limit);
    return last < -limit ? Range{} : Range{lowest(-limit, last), last};
  }
  return {std::min(known.first, lowest(-limit, known.first - 1)),
          std::max(known.last, highest(known.last + 1, limit))};
}

/// The greatest chunk of the column in [from, to] whose bare range may hold 0; from - 1 when there is none.
int ChunkEvaluator::State::highest(int from, int to) {
  const double size = frame.voxel * chunk_cells;
  if (from > to ||
      frame.beyond(work.bare_range(frame.origin.z + from * size, frame.origin.z + (to + 1) * size)))
    return from - 1;
  if (from == to) return from;
  const int middle = from + (to - from) / 2, upper = highest(middle + 1, to);
  return upper > middle ? upper : highest(from, middle);
}

/// The least; to + 1 when there is none.
int ChunkEvaluator::State::lowest(int from, int to) {
  const double size = frame.voxel * chunk_cells;
  if (from > to ||
      frame.beyond(work.bare_range(frame.origin.z + from * size, frame.origin.z + (to + 1) * size)))
    return to + 1;
  if (from == to) return from;
  const int middle = from + (to - from) / 2, lower = lowest(from, middle);
  return lower <= middle ? lower : lowest(middle + 1, to);
}

Vec3i ChunkSamples::read(int bx, int by, int bz, const BrickBox& among) const {
  const auto reads = [&](int x, int y, int z) {
    return x >= among.lo.x && y >= among.lo.y && z >= among.lo.z && x <= among.hi.x && y <= among.hi.y &&
           z <= among.hi.z && brick(x, y, z);
  };
  if (reads(bx, by, bz)) return {brick_cells, brick_cells, brick_cells};
  Vec3i n{0, 0, 0};
  for (int from = 1; from < 8; ++from) {
    const int dx = from & 1, dy = from >> 1 & 1, dz = from >> 2;
    if (!reads(bx - dx, by - dy, bz - dz)) continue;
    n.x = std::max(n.x, dx ? 1 : brick_cells);
    n.y = std::max(n.y, dy ? 1 : brick_cells);
    n.z = std::max(n.z, dz ? 1 : brick_cells);
  }
  return n;
}

bool ChunkEvaluator::evaluate(int c, ChunkSamples& out) {
  std::fill(std::begin(out.active), std::end(out.active), 0);
  return evaluate(c, BrickBox{}, out);
}

bool ChunkEvaluator::evaluate(int c, const BrickBox& box, ChunkSamples& out) {
  State& s = *state_;
  impl::ChunkFrame& frame = s.frame;
  frame.chunk.z = c;
  frame.z.set(std::int64_t{c} * chunk_cells, frame.voxel, frame.origin.z);
  out.chunk = frame.chunk;
  out.evaluated = 0;
  out.f.resize(ChunkSamples::nx * ChunkSamples::ny * ChunkSamples::nz);
  const bool bare = s.work.set_chunk(box) == 0 &&
                    frame.beyond(s.work.bare_range(frame.z.metres[0], frame.z.metres[chunk_cells]));
  bool any = false;
  for (int bz = box.lo.z; bz <= box.hi.z; ++bz)
    for (int by = box.lo.y; by <= box.hi.y; ++by) {
      s.check();
      for (int bx = box.lo.x; bx <= box.hi.x; ++bx) {
        const std::uint64_t bit = std::uint64_t{1} << (by * bricks + bx);
        const bool active = !bare && s.work.may_hold_surface(bx, by, bz);
        out.active[bz] = active ? out.active[bz] | bit : out.active[bz] & ~bit;
        any = any || active;
      }
    }
  if (!any) return false;

  constexpr std::ptrdiff_t row = ChunkSamples::nx, plane = row * ChunkSamples::ny;
  for (int bz = box.lo.z; bz <= box.hi.z + 1; ++bz)
    for (int by = box.lo.y; by <= box.hi.y + 1; ++by) {
      const unsigned near = near_row(out.active, by, bz);
      for (int bx = box.lo.x; near != 0 && bx <= box.hi.x + 1; ++bx) {
        if (!((near | near << 1) >> bx & 1u)) continue;
        const Vec3i n = out.read(bx, by, bz, box);
        if (n.x == 0) continue;
        s.check();
        const int i = bx * brick_cells, j = by * brick_cells, k = bz * brick_cells;
        const impl::Axis &x = frame.x, &y = frame.y, &z = frame.z;
        s.work.evaluate(bx, by, bz, n.x,
                        {x.units + i, y.units + j, z.units + k, x.rest + i, y.rest + j, z.rest + k, n.y, n.z,
                         out.f.data() + k * plane + j * row + i, row, plane});
        out.evaluated += n.x * n.y * n.z;
      }
    }
  return true;
}

void ChunkEvaluator::gradients(std::span<const Vec3d> points, std::span<float> values,
                               std::span<Vec3f> gradients) {
  if (values.size() != points.size() || gradients.size() != points.size())
    fail(ErrorKind::internal, "gradients() wants one result a point");
  State& s = *state_;
  const double inv = 1 / (s.frame.voxel * brick_cells);
  const Vec3d origin{s.frame.x.metres[0], s.frame.y.metres[0], s.frame.z.metres[0]};
  const auto brick_of = [&](const Vec3d& p) {
    // What lies below 0 is clamped: cutting off is as good as rounding down.
    const auto axis = [&](double d) { return std::clamp(static_cast<int>(d * inv), 0, bricks - 1); };
    return brick_index(axis(p.x - origin.x), axis(p.y - origin.y), axis(p.z - origin.z));
  };
  auto& order = s.order;
  order.resize(points.size());
  auto& start = s.cursor;
  start.assign(sides * sides * sides + 1, 0);
  auto& at = s.bricks_of;
  at.resize(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    at[i] = static_cast<std::uint32_t>(brick_of(points[i]));
    ++start[at[i] + 1];
  }
  for (std::size_t b = 1; b < start.size(); ++b) start[b] += start[b - 1];
  const std::vector<std::uint32_t> begin = start;
  for (std::uint32_t i = 0; i < points.size(); ++i) order[start[at[i]]++] = i;

  impl::PointWork& work = s.work.points();
  for (std::size_t b = 0; b + 1 < begin.size(); ++b) {
    if (begin[b] == begin[b + 1]) continue;
    s.check();
    s.work.lists(b, work.lists());
    const auto group = std::span<const std::uint32_t>(order).subspan(begin[b], begin[b + 1] - begin[b]);
    work.ask_nested(s.work.program(), points, group, true);
    for (std::size_t i = 0; i < group.size(); i += impl::PointWork::pack_size) {
      const auto pack = group.subspan(i, std::min(impl::PointWork::pack_size, group.size() - i));
      work.load(points, pack, i);
      const impl::PointValues& g = work.gradients(s.work.program());
      for (std::size_t l = 0; l < pack.size(); ++l) {
        values[pack[l]] = g.v[l];
        gradients[pack[l]] = {g.gx[l], g.gy[l], g.gz[l]};
      }
    }
  }
}

}  // namespace tafoni::field
