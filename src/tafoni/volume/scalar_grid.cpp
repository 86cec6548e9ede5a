// Scalar grids: slots of 32^3 samples that are either one value or a shared chunk. Reads, edits and
// interpolation go chunk by chunk; ranges are kept by blocks of 8^3 samples.

#include "tafoni/volume/scalar_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/math/lattice.h"
#include "tafoni/volume/impl/chunk_editor.h"

namespace tafoni::volume {
namespace {

using impl::ChunkEditor;
using impl::ChunkPtr;
using impl::common;
using impl::covers;
using impl::expand;
using impl::GridChunk;
using impl::read_row;
using impl::round_row;
using impl::side;
using impl::Slot;

constexpr int shift = 5;
static_assert(1 << shift == side);

/// A cell and where in it, each of t in [0, 1].
struct CellPoint {
  Vec3i cell;
  Vec3f t;
};

/// Along one axis of n samples; beyond them the nearest.
int cell_of(double u, int n) {
  return std::min(u > 0 ? static_cast<int>(std::min(u, n - 1.0)) : 0, n - 2);
}

void expand(Interval& range, Interval by) {
  range = {std::min(range.lo, by.lo), std::max(range.hi, by.hi)};
}

}  // namespace

struct ScalarGrid::State {
  GridFrame frame;
  Precision precision;
  Vec3i chunks;
  std::vector<Slot> slots;
  double per_metre;

  std::size_t slot_index(Vec3i c) const { return (std::int64_t{c.z} * chunks.y + c.y) * chunks.x + c.x; }
  const Slot& slot_of(Vec3i s) const { return slots[slot_index({s.x >> shift, s.y >> shift, s.z >> shift})]; }
  SampleBox samples() const { return {{0, 0, 0}, {frame.size.x - 1, frame.size.y - 1, frame.size.z - 1}}; }
  SampleBox samples_of(Vec3i c) const {
    return common(samples(), {{c.x * side, c.y * side, c.z * side},
                              {c.x * side + side - 1, c.y * side + side - 1, c.z * side + side - 1}});
  }

  CellPoint locate(Vec3d p) const {
    const auto axis = [&](double x, double o, int n, int& cell, float& t) {
      const double u = (x - o) * per_metre;
      cell = cell_of(u, n);
      t = static_cast<float>(std::min(std::max(u - cell, 0.0), 1.0));
    };
    CellPoint c;
    axis(p.x, frame.origin.x, frame.size.x, c.cell.x, c.t.x);
    axis(p.y, frame.origin.y, frame.size.y, c.cell.y, c.t.y);
    axis(p.z, frame.origin.z, frame.size.z, c.cell.z, c.t.z);
    return c;
  }

  float at(Vec3i s) const {
    const Slot& slot = slot_of(s);
    if (!slot.chunk) return slot.value;
    return slot.chunk.get()->at(GridChunk::index(s.x & (side - 1), s.y & (side - 1), s.z & (side - 1)));
  }

  /// The cell's corners, x fastest.
  void corners(Vec3i cell, float out[8]) const {
    const Vec3i in{cell.x & (side - 1), cell.y & (side - 1), cell.z & (side - 1)};
    if (in.x == side - 1 || in.y == side - 1 || in.z == side - 1) {
      for (int c = 0; c < 8; ++c) out[c] = at({cell.x + (c & 1), cell.y + ((c >> 1) & 1), cell.z + (c >> 2)});
      return;
    }
    const Slot& slot = slot_of(cell);
    const GridChunk* chunk = slot.chunk.get();
    const int first = GridChunk::index(in.x, in.y, in.z);
    const auto fetch = [&](const auto& sample) {
      constexpr int rows[] = {0, side, side * side, side * side + side};
      for (int row = 0; row < 4; ++row) {
        out[2 * row] = sample(first + rows[row]);
        out[2 * row + 1] = sample(first + rows[row] + 1);
      }
    };
    if (!chunk)
      std::fill_n(out, 8, slot.value);
    else if (const float* single = chunk->single.get())
      fetch([single](int i) { return single[i]; });
    else
      fetch([half = chunk->half.get()](int i) { return from_half(half[i]); });
  }

  float value(Vec3d p) const {
    const CellPoint at_point = locate(p);
    float c[8];
    corners(at_point.cell, c);
    const Vec3f t = at_point.t, s{1 - t.x, 1 - t.y, 1 - t.z};
    const float low = s.y * (s.x * c[0] + t.x * c[1]) + t.y * (s.x * c[2] + t.x * c[3]);
    const float high = s.y * (s.x * c[4] + t.x * c[5]) + t.y * (s.x * c[6] + t.x * c[7]);
    // Rounding must not leave what range() gives.
    float least = c[0], most = c[0];
    for (int i = 1; i < 8; ++i) least = std::min(least, c[i]), most = std::max(most, c[i]);
    return std::min(std::max(s.z * low + t.z * high, least), most);
  }

  Vec3f gradient(Vec3d p) const {
    const CellPoint at_point = locate(p);
    float c[8];
    corners(at_point.cell, c);
    const Vec3f t = at_point.t, s{1 - t.x, 1 - t.y, 1 - t.z};
    const float scale = static_cast<float>(1 / frame.spacing);
    const float low = s.x * (c[2] - c[0]) + t.x * (c[3] - c[1]),
                high = s.x * (c[6] - c[4]) + t.x * (c[7] - c[5]);
    Vec3f g{
        s.z * (s.y * (c[1] - c[0]) + t.y * (c[3] - c[2])) + t.z * (s.y * (c[5] - c[4]) + t.y * (c[7] - c[6])),
        s.z * low + t.z * high,
        s.y * (s.x * (c[4] - c[0]) + t.x * (c[5] - c[1])) +
            t.y * (s.x * (c[6] - c[2]) + t.x * (c[7] - c[3]))};
    const Box3d box = frame.box();
    if (p.x < box.lo.x || p.x > box.hi.x) g.x = 0;
    if (p.y < box.lo.y || p.y > box.hi.y) g.y = 0;
    if (p.z < box.lo.z || p.z > box.hi.z) g.z = 0;
    return g * scale;
  }

  /// The samples that value() reads for points of the box.
  SampleBox samples_for(const Box3d& box) const {
    const auto first = [&](double x, double o, int n) { return cell_of((x - o) * per_metre, n); };
    const Vec3d o = frame.origin;
    const Vec3i n = frame.size;
    return {{first(box.lo.x, o.x, n.x), first(box.lo.y, o.y, n.y), first(box.lo.z, o.z, n.z)},
            {first(box.hi.x, o.x, n.x) + 1, first(box.hi.y, o.y, n.y) + 1, first(box.hi.z, o.z, n.z) + 1}};
  }

  /// visit(chunk, its samples within the box), z slowest.
  template <class F>
  void for_chunks(const SampleBox& box, const F& visit) const {
    const SampleBox inside = common(box, samples());
    if (inside.empty()) return;
    for (int c = inside.lo.z >> shift; c <= inside.hi.z >> shift; ++c)
      for (int b = inside.lo.y >> shift; b <= inside.hi.y >> shift; ++b)
        for (int a = inside.lo.x >> shift; a <= inside.hi.x >> shift; ++a)
          visit(Vec3i{a, b, c}, common(inside, samples_of({a, b, c})));
  }

  /// Of some samples of one block.
  static void block_range(const GridChunk& chunk, const SampleBox& part, Interval& range) {
    constexpr int most = impl::block_side;
    float halves[most], lo[most], hi[most];
    std::fill_n(lo, most, range.lo);
    std::fill_n(hi, most, range.hi);
    const int n = part.size().x;
    for (int k = part.lo.z; k <= part.hi.z; ++k)
      for (int j = part.lo.y; j <= part.hi.y; ++j) {
        const int first = GridChunk::index(part.lo.x, j, k);
        const float* row = halves;
        if (chunk.single)
          row = chunk.single.get() + first;
        else
          for (int i = 0; i < n; ++i) halves[i] = from_half(chunk.half[first + i]);
        for (int i = 0; i < n; ++i) {
          lo[i] = std::min(lo[i], row[i]);
          hi[i] = std::max(hi[i], row[i]);
        }
      }
    range = {*std::min_element(lo, lo + n), *std::max_element(hi, hi + n)};
  }

  /// Of samples of one full chunk. Blocks that are not wholly in it count whole unless `exact`.
  static void chunk_range(const GridChunk& chunk, Vec3i first, const SampleBox& part, bool exact,
                          Interval& range) {
    constexpr int n = impl::block_side;
    const Vec3i lo = part.lo - first, hi = part.hi - first;
    for (int z = lo.z / n; z <= hi.z / n; ++z)
      for (int y = lo.y / n; y <= hi.y / n; ++y)
        for (int x = lo.x / n; x <= hi.x / n; ++x) {
          const SampleBox block{{x * n, y * n, z * n}, {x * n + n - 1, y * n + n - 1, z * n + n - 1}};
          const SampleBox both = common({lo, hi}, block);
          if (!exact || both == block) {
            expand(range, chunk.ranges[(z * impl::blocks_side + y) * impl::blocks_side + x]);
            continue;
          }
          block_range(chunk, both, range);
        }
  }
};

void check(const GridFrame& frame) {
  const Vec3i n = frame.size;
  if (n.x < 2 || n.y < 2 || n.z < 2)
    fail(ErrorKind::usage, "a grid of {} x {} x {} samples has no cells: each side takes at least 2", n.x,
         n.y, n.z);
  if (!(frame.spacing > 0) || !std::isfinite(frame.spacing) || !frame.box().bounded())
    fail(ErrorKind::usage, "a grid's origin must be finite and its spacing ({}) above 0 and finite",
         frame.spacing);
  if (1.0 * n.x * n.y * n.z > 0x1p40 || std::max({n.x, n.y, n.z}) > 1 << 30)
    fail(ErrorKind::usage, "a grid of {} x {} x {} samples is too large: at most 2^40 in all, 2^30 a side",
         n.x, n.y, n.z);
}

ScalarGrid::ScalarGrid(const GridFrame& frame, float value, Precision precision) {
  check(frame);
  const Vec3i n = frame.size;
  const auto count = [](int samples) { return (samples - 1) / side + 1; };
  float row[1] = {value};
  round_row(precision, row);
  state_ = std::make_unique<State>(
      State{frame, precision, {count(n.x), count(n.y), count(n.z)}, {}, 1 / frame.spacing});
  const Vec3i c = state_->chunks;
  state_->slots.assign(std::int64_t{c.x} * c.y * c.z, {{}, row[0]});
}

ScalarGrid::ScalarGrid(const ScalarGrid& other) : state_(std::make_unique<State>(*other.state_)) {}
ScalarGrid& ScalarGrid::operator=(const ScalarGrid& other) {
  if (this != &other) state_ = std::make_unique<State>(*other.state_);
  return *this;
}
ScalarGrid::ScalarGrid(ScalarGrid&&) noexcept = default;
ScalarGrid& ScalarGrid::operator=(ScalarGrid&&) noexcept = default;
ScalarGrid::~ScalarGrid() = default;

const GridFrame& ScalarGrid::frame() const {
  return state_->frame;
}
Precision ScalarGrid::precision() const {
  return state_->precision;
}
SampleBox ScalarGrid::samples() const {
  return state_->samples();
}
Vec3i ScalarGrid::chunks() const {
  return state_->chunks;
}

SampleBox ScalarGrid::samples_in(const Box3d& box) const {
  if (box.empty() || !box.overlaps(state_->frame.box())) return {};
  return state_->samples_for(box);
}

float ScalarGrid::at(Vec3i s) const {
  const Vec3i n = state_->frame.size;
  return state_->at({std::clamp(s.x, 0, n.x - 1), std::clamp(s.y, 0, n.y - 1), std::clamp(s.z, 0, n.z - 1)});
}

void ScalarGrid::read(const SampleBox& box, float* out) const {
  if (box.empty()) return;
  const State& state = *state_;
  const Vec3i n = state.frame.size;
  const std::ptrdiff_t row = box.size().x, plane = row * box.size().y;
  const auto clamped = [](int v, int samples) { return std::clamp(v, 0, samples - 1); };
  // Chunk by chunk what lies within the frame along x.
  for (int x = std::max(box.lo.x, 0); x <= std::min(box.hi.x, n.x - 1); x = (x | (side - 1)) + 1) {
    const int count = std::min({box.hi.x, n.x - 1, x | (side - 1)}) - x + 1;
    for (int z = box.lo.z; z <= box.hi.z; ++z)
      for (int y = box.lo.y; y <= box.hi.y;) {
        const Vec3i first{x, clamped(y, n.y), clamped(z, n.z)};
        const Slot& slot = state.slot_of(first);
        float* to = out + (z - box.lo.z) * plane + (y - box.lo.y) * row + (x - box.lo.x);
        // Beyond the frame the border's row is repeated.
        const int last = y < 0 || y >= n.y ? y : std::min({box.hi.y, n.y - 1, y | (side - 1)});
        for (int index = GridChunk::index(x & (side - 1), first.y & (side - 1), first.z & (side - 1));
             y <= last; ++y, to += row, index += side) {
          if (count == side)
            read_row(slot, index, side, to);
          else
            read_row(slot, index, count, to);
        }
      }
  }
  const int left = std::clamp(-box.lo.x, 0, box.size().x),
            right = std::clamp(box.hi.x - n.x + 1, 0, box.size().x);
  if (!left && !right) return;
  for (int z = box.lo.z; z <= box.hi.z; ++z)
    for (int y = box.lo.y; y <= box.hi.y; ++y, out += row) {
      const int in_y = clamped(y, n.y), in_z = clamped(z, n.z);
      if (left) std::fill_n(out, left, state.at({0, in_y, in_z}));
      if (right) std::fill_n(out + row - right, right, state.at({n.x - 1, in_y, in_z}));
    }
}

void ScalarGrid::write(const SampleBox& box, const float* in) {
  State& state = *state_;
  if (!box.empty() && !covers(state.samples(), box))
    fail(ErrorKind::internal,
         "samples ({}, {}, {}) to ({}, {}, {}) are written, which the grid does not have", box.lo.x, box.lo.y,
         box.lo.z, box.hi.x, box.hi.y, box.hi.z);
  std::vector<std::pair<Vec3i, SampleBox>> parts;
  state.for_chunks(box, [&](Vec3i chunk, const SampleBox& part) { parts.emplace_back(chunk, part); });
  parallel_blocks(std::ssize(parts), 4, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
      const auto& [chunk, part] = parts[i];
      ChunkEditor(state.slots[state.slot_index(chunk)], state.precision, state.samples_of(chunk))
          .rows(part, [&](Vec3i first, std::span<float> row) {
            std::copy_n(in + box.index(first), row.size(), row.data());
          });
    }
  });
}

void ScalarGrid::fill(const SampleBox& box, float value) {
  State& state = *state_;
  round_row(state.precision, {&value, 1});
  state.for_chunks(box, [&](Vec3i chunk, const SampleBox& part) {
    Slot& slot = state.slots[state.slot_index(chunk)];
    if (part == state.samples_of(chunk))
      slot = {{}, value};
    else
      ChunkEditor(slot, state.precision, state.samples_of(chunk))
          .rows(part, [&](Vec3i, std::span<float> row) { std::fill(row.begin(), row.end(), value); });
  });
}

void ScalarGrid::share(Vec3i from, Vec3i to) {
  State& state = *state_;
  if (state.samples_of(from).size() != state.samples_of(to).size())
    fail(ErrorKind::internal, "a chunk shares the samples of one of another size");
  state.slots[state.slot_index(to)] = state.slots[state.slot_index(from)];
}

SampleBox ScalarGrid::edit(const SampleBox& box,
                           const std::function<void(Vec3i first, std::span<float> row)>& change) {
  SampleBox changed;
  State& state = *state_;
  state.for_chunks(box, [&](Vec3i chunk, const SampleBox& part) {
    ChunkEditor editor(state.slots[state.slot_index(chunk)], state.precision, state.samples_of(chunk));
    expand(changed, editor.rows(part, change));
  });
  return changed;
}

void ScalarGrid::generate(const std::function<std::optional<float>(const SampleBox&, float*)>& make,
                          Progress& progress) {
  State& state = *state_;
  const Vec3i n = state.chunks;
  parallel_for(
      std::ssize(state.slots),
      [&](std::int64_t i) {
        const SampleBox box = state.samples_of(sample_at(n, i));
        Slot& slot = state.slots[i];
        std::unique_ptr<float[]> samples(new float[impl::chunk_size]);
        if (const auto same = make(box, samples.get())) {
          float row[1] = {*same};
          round_row(state.precision, row);
          slot = {{}, row[0]};
          return;
        }
        slot = {ChunkPtr(impl::make_chunk(std::move(samples), state.precision, box.size()).release()), 0};
      },
      progress);
}

void ScalarGrid::compact() {
  State& state = *state_;
  state.for_chunks(state.samples(), [&](Vec3i c, const SampleBox& part) {
    Slot& slot = state.slots[state.slot_index(c)];
    if (!slot.chunk || slot.chunk.get()->range.lo != slot.chunk.get()->range.hi) return;
    const Slot alike{{}, slot.chunk.get()->at(0)};
    // Zeros of both signs are equal but not alike.
    float row[side], same[side];
    std::fill_n(same, side, alike.value);
    const Vec3i n = part.size();
    for (int z = 0; z < n.z; ++z)
      for (int y = 0; y < n.y; ++y) {
        read_row(slot, GridChunk::index(0, y, z), n.x, row);
        if (std::memcmp(row, same, n.x * sizeof(float)) != 0) return;
      }
    slot = alike;
  });
}

float ScalarGrid::value(Vec3d p) const {
  return state_->value(p);
}

void ScalarGrid::values(std::span<const Vec3d> points, std::span<float> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = state_->value(points[i]);
}

void ScalarGrid::gradients(std::span<const Vec3d> points, std::span<Vec3f> out) const {
  for (std::size_t i = 0; i < points.size(); ++i) out[i] = state_->gradient(points[i]);
}

Interval ScalarGrid::range(const Box3d& box) const {
  if (box.empty()) return {};
  const State& state = *state_;
  const SampleBox samples = state.samples_for(box);
  constexpr int most = 2 * impl::block_side + 2;  // samples that 16 cells touch, wherever they begin
  const Vec3i n = samples.size();
  const bool exact = n.x <= most && n.y <= most && n.z <= most;
  const float first = state.at(samples.lo);
  Interval range{first, first};
  state.for_chunks(samples, [&](Vec3i c, const SampleBox& part) {
    const Slot& slot = state.slots[state.slot_index(c)];
    if (!slot.chunk)
      expand(range, {slot.value, slot.value});
    else if (part == state.samples_of(c))
      expand(range, slot.chunk.get()->range);
    else
      State::chunk_range(*slot.chunk.get(), {c.x * side, c.y * side, c.z * side}, part, exact, range);
  });
  return range;
}

const float* ScalarGrid::chunk(Vec3i c) const {
  const GridChunk* chunk = state_->slots[state_->slot_index(c)].chunk.get();
  return chunk ? chunk->single.get() : nullptr;
}

bool ScalarGrid::uniform(Vec3i c, float* value) const {
  const Slot& slot = state_->slots[state_->slot_index(c)];
  if (slot.chunk) return false;
  if (value) *value = slot.value;
  return true;
}

std::uint64_t ScalarGrid::full_chunks() const {
  return std::count_if(state_->slots.begin(), state_->slots.end(),
                       [](const Slot& s) { return bool(s.chunk); });
}

std::uint64_t ScalarGrid::slot_bytes() {
  return sizeof(Slot);
}

std::uint64_t ScalarGrid::full_chunk_bytes(Precision precision) {
  const std::uint64_t sample = precision == Precision::single ? sizeof(float) : sizeof(std::uint16_t);
  return sizeof(GridChunk) + sample * impl::chunk_size;
}

std::uint64_t ScalarGrid::bytes() const {
  return sizeof(State) + state_->slots.capacity() * slot_bytes() +
         full_chunks() * full_chunk_bytes(state_->precision);
}

bool operator==(const ScalarGrid& a, const ScalarGrid& b) {
  const ScalarGrid::State &s = *a.state_, &t = *b.state_;
  if (s.frame != t.frame || s.precision != t.precision) return false;
  bool equal = true;
  s.for_chunks(s.samples(), [&](Vec3i c, const SampleBox& part) {
    const Slot &p = s.slots[s.slot_index(c)], &q = t.slots[t.slot_index(c)];
    if (!equal || (p.chunk && p.chunk.get() == q.chunk.get())) return;
    const Vec3i n = part.size();
    for (int z = 0; z < n.z && equal; ++z)
      for (int y = 0; y < n.y && equal; ++y) {
        float u[side], v[side];
        read_row(p, GridChunk::index(0, y, z), n.x, u);
        read_row(q, GridChunk::index(0, y, z), n.x, v);
        equal = std::memcmp(u, v, n.x * sizeof(float)) == 0;
      }
  });
  return equal;
}

}  // namespace tafoni::volume
