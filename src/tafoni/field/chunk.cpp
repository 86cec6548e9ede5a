#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "tafoni/field/compiled.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/program.h"

namespace tafoni::field {

using impl::Axis;
using impl::Block;
using impl::Columns;
using impl::Instruction;
using impl::Primitives;
using impl::Program;

namespace {

constexpr int bricks = chunk_bricks;
constexpr int sides = bricks + 1;  ///< sample bricks a side: the last holds only the far face

int brick_index(int bx, int by, int bz) {
  return (bz * sides + by) * sides + bx;
}

/// Least and greatest of a column array over the closure of each 8 x 8 cell brick.
struct BrickRange {
  float lo[bricks * bricks], hi[bricks * bricks];
};

BrickRange brick_ranges(const std::vector<float>& values) {
  BrickRange out;
  for (int by = 0; by < bricks; ++by)
    for (int bx = 0; bx < bricks; ++bx) {
      float lo = std::numeric_limits<float>::max(), hi = std::numeric_limits<float>::lowest();
      for (int j = by * brick_cells; j <= (by + 1) * brick_cells; ++j) {
        const float* row = values.data() + j * Columns::stride + bx * brick_cells;
        for (int i = 0; i <= brick_cells; ++i) lo = std::min(lo, row[i]), hi = std::max(hi, row[i]);
      }
      out.lo[by * bricks + bx] = lo;
      out.hi[by * bricks + bx] = hi;
    }
  return out;
}

bool excludes_zero(Interval r) {
  return r.lo > 0 || r.hi < 0;
}

Interval join(const BrickRange& r) {
  return {*std::min_element(r.lo, r.lo + bricks * bricks), *std::max_element(r.hi, r.hi + bricks * bricks)};
}

}  // namespace

struct ChunkEvaluator::State {
  const Program& program;
  double voxel;
  const impl::LeafKernels& kernels = impl::leaf_kernels();

  int column_x = 0, column_y = 0, chunk_z = 0;
  Axis x, y, z;
  struct Height {
    Columns columns;
    BrickRange value, scale;
    Interval all_value, all_scale;
  };
  struct Plane {
    Columns columns;
    BrickRange value;
    Interval all_value;
  };
  std::vector<Height> heights;
  std::vector<Plane> domains;

  /// Primitives of one cloud that may touch the chunk column, and who touches which brick's closure.
  struct CloudPart {
    Primitives column;
    std::vector<std::uint32_t> begin;  ///< sides^3 + 1
    std::vector<std::uint32_t> items;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> pairs;
    std::size_t touching = 0;  ///< of this chunk
  };
  std::vector<CloudPart> clouds;

  impl::RangeWork range_work;
  std::vector<std::uint32_t> cursor, order, bricks_of;
  std::vector<std::vector<float>> scratch;  ///< one block a stack slot above the first
  impl::PointWork points;
  /// Ranges of a nested leaf over the chunk's eight octants, asked at need: they spare most bricks a
  /// question.
  struct NestedPart {
    Interval range[8];
    unsigned known = 0;
  };
  std::vector<NestedPart> nested;
  std::vector<Vec3d> lattice_points;
  std::vector<float> lattice_values;

  State(const Program& p, double v) : program(p), voxel(v) {
    if (!(v > 0) || !std::isfinite(v))
      fail(ErrorKind::usage, "the voxel size must be a positive length in metres");
    heights.resize(p.heights.size());
    domains.resize(p.domains.size());
    clouds.resize(p.clouds.size());
    nested.resize(p.nested.size());
    scratch.resize(p.depth, std::vector<float>(brick_cells * brick_cells * brick_cells));
  }

  /// Sample i of an axis in float metres, rounded outward by what float can lose.
  float low(const Axis& axis, int i) const { return static_cast<float>(axis.metres[i]) - slack(); }
  float high(const Axis& axis, int i) const { return static_cast<float>(axis.metres[i]) + slack(); }
  static float slack() { return impl::position_slack; }

  Box3f brick_box(int bx, int by, int bz) const {
    const int i = bx * brick_cells, j = by * brick_cells, k = bz * brick_cells;
    return {{low(x, i), low(y, j), low(z, k)},
            {high(x, i + brick_cells), high(y, j + brick_cells), high(z, k + brick_cells)}};
  }
  void list_primitives(CloudPart& part, const BrickBox& box);
  Interval brick_range(const Box3f& box, int bx, int by, int bz, bool coarse = false);
  bool may_hold_surface(int bx, int by, int bz);
  Interval octant_range(std::size_t index, int bx, int by, int bz);
  Interval bare_range(double z0, double z1);
  Range widened(Range known);
  int highest(int from, int to);
  int lowest(int from, int to);
  void evaluate_block(int bx, int by, int bz, int nx, int ny, int nz, ChunkSamples& out);
  void nested_block(std::size_t index, Vec3i first, int nx, const Block& block);
  Box3d closure(int bx, int by, int bz, int side) const;
};

ChunkEvaluator::ChunkEvaluator(const CompiledField& field, double voxel)
    : state_(std::make_unique<State>(field.program(), voxel)) {}
ChunkEvaluator::~ChunkEvaluator() = default;

ChunkEvaluator::Range ChunkEvaluator::column(int a, int b) {
  State& s = *state_;
  s.column_x = a;
  s.column_y = b;
  s.x.set(static_cast<std::int64_t>(a) * chunk_cells, s.voxel);
  s.y.set(static_cast<std::int64_t>(b) * chunk_cells, s.voxel);
  float lo = std::numeric_limits<float>::max(), hi = std::numeric_limits<float>::lowest();
  for (std::size_t i = 0; i < s.heights.size(); ++i) {
    auto& h = s.heights[i];
    const impl::HeightLeaf& leaf = *s.program.heights[i];
    s.kernels.height_columns(leaf, s.x, s.y, h.columns);
    h.value = brick_ranges(h.columns.value);
    h.scale = brick_ranges(h.columns.scale);
    h.all_value = join(h.value);
    h.all_scale = join(h.scale);
    // Beyond the reach of sigma the leaf is constant; a first-order distance reaches further on slopes.
    const float reach = leaf.sigma.influence / h.all_scale.lo;
    lo = std::min(lo, h.all_value.lo - reach);
    hi = std::max(hi, h.all_value.hi + reach);
  }
  for (std::size_t i = 0; i < s.domains.size(); ++i) {
    auto& d = s.domains[i];
    const impl::DomainLeaf& leaf = *s.program.domains[i];
    s.kernels.domain_columns(leaf, s.x, s.y, d.columns);
    d.value = brick_ranges(d.columns.value);
    d.all_value = join(d.value);
    const float base = static_cast<float>(leaf.domain.box.lo.z);
    lo = std::min(lo, base - leaf.sigma.influence);
    hi = std::max(hi, base + leaf.sigma.influence);
  }
  for (std::size_t i = 0; i < s.clouds.size(); ++i) {
    auto& part = s.clouds[i];
    part.column.clear();
    constexpr float tall = static_cast<float>(impl::reach_limit);
    s.program.clouds[i]->collect(
        {{s.low(s.x, 0), s.low(s.y, 0), -tall}, {s.high(s.x, chunk_cells), s.high(s.y, chunk_cells), tall}},
        part.column);
    for (std::size_t p = 0; p < part.column.size(); ++p) {
      const float c = static_cast<float>(impl::to_metres(part.column.z[p]));
      lo = std::min(lo, c - part.column.reach[p]);
      hi = std::max(hi, c + part.column.reach[p]);
    }
  }
  const Box3d column{{s.x.metres[0], s.y.metres[0], 0},
                     {s.x.metres[chunk_cells], s.y.metres[chunk_cells], 0}};
  for (std::size_t i = 0; i < s.program.nested.size(); ++i) {
    const Interval extent = s.program.nested[i]->extent(column, s.points.nested(i));
    lo = std::min(lo, extent.lo);
    hi = std::max(hi, extent.hi);
  }
  const double size = s.voxel * chunk_cells;
  Range range;
  if (lo <= hi)
    range = {static_cast<int>(std::floor(lo / size)) - (lo == std::floor(lo / size) * size ? 1 : 0),
             static_cast<int>(std::floor(hi / size))};
  return s.program.nested.empty() ? range : s.widened(range);
}

/// Nested leaves may vary at any elevation: what their ranges do not exclude is added to the known range.
ChunkEvaluator::Range ChunkEvaluator::State::widened(Range known) {
  const int limit = static_cast<int>(std::ceil(impl::reach_limit / (voxel * chunk_cells)));
  if (known.first > known.last) {
    const int last = highest(-limit, limit);
    return last < -limit ? Range{} : Range{lowest(-limit, last), last};
  }
  return {std::min(known.first, lowest(-limit, known.first - 1)),
          std::max(known.last, highest(known.last + 1, limit))};
}

/// The greatest chunk of the column in [from, to] whose bare range may hold 0; from - 1 when there is none.
int ChunkEvaluator::State::highest(int from, int to) {
  const double size = voxel * chunk_cells;
  if (from > to || excludes_zero(bare_range(from * size, (to + 1) * size))) return from - 1;
  if (from == to) return from;
  const int middle = from + (to - from) / 2, upper = highest(middle + 1, to);
  return upper > middle ? upper : highest(from, middle);
}

/// The least; to + 1 when there is none.
int ChunkEvaluator::State::lowest(int from, int to) {
  const double size = voxel * chunk_cells;
  if (from > to || excludes_zero(bare_range(from * size, (to + 1) * size))) return to + 1;
  if (from == to) return from;
  const int middle = from + (to - from) / 2, lower = lowest(from, middle);
  return lower <= middle ? lower : lowest(middle + 1, to);
}

/// Those of the bricks of `box` and of the next ones, whose near faces they read.
void ChunkEvaluator::State::list_primitives(CloudPart& part, const BrickBox& box) {
  const Primitives& p = part.column;
  part.touching = 0;
  if (p.size() == 0 && part.items.empty() && !part.begin.empty()) return;  // the lists are empty already
  part.pairs.clear();
  part.begin.assign(sides * sides * sides + 1, 0);
  const float inv = static_cast<float>(1 / (voxel * brick_cells));
  const float origin[3] = {static_cast<float>(x.metres[0]), static_cast<float>(y.metres[0]),
                           static_cast<float>(z.metres[0])};
  const float brick = static_cast<float>(voxel * brick_cells);
  const int first[3] = {box.lo.x, box.lo.y, box.lo.z}, last[3] = {box.hi.x, box.hi.y, box.hi.z};
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    const float c[3] = {static_cast<float>(impl::to_metres(p.x[i])) - origin[0],
                        static_cast<float>(impl::to_metres(p.y[i])) - origin[1],
                        static_cast<float>(impl::to_metres(p.z[i])) - origin[2]};
    const float reach = p.reach[i] + slack();
    int lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      // Brick b's closure is [b, b + 1] bricks.
      lo[a] = static_cast<int>(std::ceil(std::clamp((c[a] - reach) * inv - 1, -1e6f, 1e6f)));
      hi[a] = static_cast<int>(std::floor(std::clamp((c[a] + reach) * inv, -1e6f, 1e6f)));
      lo[a] = std::max(lo[a], first[a]);
      hi[a] = std::min(hi[a], last[a] + 1);
    }
    bool touches = false;
    for (int bz = lo[2]; bz <= hi[2]; ++bz)
      for (int by = lo[1]; by <= hi[1]; ++by)
        for (int bx = lo[0]; bx <= hi[0]; ++bx) {
          const int at[3] = {bx, by, bz};
          float d2 = 0;
          for (int a = 0; a < 3; ++a) {
            const float from = static_cast<float>(at[a]) * brick;
            const float d = std::max(std::max(from - c[a], c[a] - from - brick), 0.f);
            d2 += d * d;
          }
          if (d2 > reach * reach) continue;
          const auto b = static_cast<std::uint32_t>(brick_index(bx, by, bz));
          ++part.begin[b + 1];
          part.pairs.emplace_back(b, i);
          touches = true;
        }
    part.touching += touches;
  }
  for (std::size_t b = 0; b < sides * sides * sides; ++b) part.begin[b + 1] += part.begin[b];
  part.items.resize(part.pairs.size());
  cursor.assign(part.begin.begin(), part.begin.end() - 1);
  for (const auto& [b, i] : part.pairs) part.items[cursor[b]++] = i;
}

/// Ranges over the closure of cell brick (bx, by, bz), whose z limits are box's.
/// `coarse`: with the nested leaves' ranges over the brick's octant.
Interval ChunkEvaluator::State::brick_range(const Box3f& box, int bx, int by, int bz, bool coarse) {
  const int plane = by * bricks + bx;
  const auto b = static_cast<std::size_t>(brick_index(bx, by, bz));
  return impl::range_of(program, range_work, [&](const Instruction& in) -> Interval {
    if (in.kind == Instruction::Kind::height) {
      const Height& h = heights[in.index];
      return impl::height_range(*program.heights[in.index], h.value.lo[plane], h.value.hi[plane],
                                h.scale.lo[plane], h.scale.hi[plane], box.lo.z, box.hi.z);
    }
    if (in.kind == Instruction::Kind::domain) {
      const Plane& d = domains[in.index];
      return impl::domain_range(*program.domains[in.index], d.value.lo[plane], d.value.hi[plane], box.lo.z,
                                box.hi.z);
    }
    if (in.kind == Instruction::Kind::nested) {
      const Interval range = octant_range(in.index, bx, by, bz);
      if (coarse || range.lo == range.hi) return range;
      return program.nested[in.index]->range(closure(bx, by, bz, 1), points.nested(in.index));
    }
    const CloudPart& part = clouds[in.index];
    Interval sum{0, 0};
    for (std::uint32_t m = part.begin[b]; m < part.begin[b + 1]; ++m)
      sum = sum + program.clouds[in.index]->contribution(part.column, part.items[m], box);
    const float count = static_cast<float>(part.begin[b + 1] - part.begin[b]);
    const float loss = 1e-7f * count * (std::fabs(sum.lo) + std::fabs(sum.hi));
    return {sum.lo - loss, sum.hi + loss};
  });
}

/// The column's range over [lo, hi] where no primitive touches that.
Interval ChunkEvaluator::State::bare_range(double lo, double hi) {
  const float z0 = static_cast<float>(lo) - slack(), z1 = static_cast<float>(hi) + slack();
  return impl::range_of(program, range_work, [&](const Instruction& in) -> Interval {
    switch (in.kind) {
      case Instruction::Kind::height: {
        const Height& h = heights[in.index];
        return impl::height_range(*program.heights[in.index], h.all_value.lo, h.all_value.hi, h.all_scale.lo,
                                  h.all_scale.hi, z0, z1);
      }
      case Instruction::Kind::domain:
        return impl::domain_range(*program.domains[in.index], domains[in.index].all_value.lo,
                                  domains[in.index].all_value.hi, z0, z1);
      case Instruction::Kind::nested:
        return program.nested[in.index]->range(
            {{x.metres[0], y.metres[0], lo}, {x.metres[chunk_cells], y.metres[chunk_cells], hi}},
            points.nested(in.index));
      default:
        return {0, 0};
    }
  });
}

/// Of `side` bricks a side from (bx, by, bz) on.
Box3d ChunkEvaluator::State::closure(int bx, int by, int bz, int side) const {
  const int i = bx * brick_cells, j = by * brick_cells, k = bz * brick_cells, n = side * brick_cells;
  return {{x.metres[i], y.metres[j], z.metres[k]}, {x.metres[i + n], y.metres[j + n], z.metres[k + n]}};
}

Interval ChunkEvaluator::State::octant_range(std::size_t index, int bx, int by, int bz) {
  constexpr int half = bricks / 2;
  const int octant = bz / half * 4 + by / half * 2 + bx / half;
  NestedPart& part = nested[index];
  if (!(part.known >> octant & 1u)) {
    part.known |= 1u << octant;
    part.range[octant] = program.nested[index]->range(
        closure(bx / half * half, by / half * half, bz / half * half, half), points.nested(index));
  }
  return part.range[octant];
}

bool ChunkEvaluator::State::may_hold_surface(int bx, int by, int bz) {
  const Box3f box = brick_box(bx, by, bz);
  if (!nested.empty() && excludes_zero(brick_range(box, bx, by, bz, true))) return false;
  return !excludes_zero(brick_range(box, bx, by, bz));
}

/// The first nx samples of each row of the block that begins at sample `first`.
void ChunkEvaluator::State::nested_block(std::size_t index, Vec3i first, int nx, const Block& block) {
  lattice_points.clear();
  for (int k = 0; k < block.nz; ++k)
    for (int j = 0; j < block.ny; ++j)
      for (int i = 0; i < nx; ++i)
        lattice_points.push_back({x.metres[first.x + i], y.metres[first.y + j], z.metres[first.z + k]});
  lattice_values.resize(lattice_points.size());
  program.nested[index]->values(lattice_points, points.nested(index), lattice_values.data());
  const float* from = lattice_values.data();
  for (int k = 0; k < block.nz; ++k)
    for (int j = 0; j < block.ny; ++j, from += nx) {
      float* row = block.f + k * block.plane + j * block.row;
      std::copy_n(from, nx, row);
      std::fill(row + nx, row + brick_cells, from[0]);  // read by nobody, but operators compute on it
    }
}

void ChunkEvaluator::State::evaluate_block(int bx, int by, int bz, int nx, int ny, int nz,
                                           ChunkSamples& out) {
  const int i0 = bx * brick_cells, j0 = by * brick_cells, k0 = bz * brick_cells;
  Block base{
      x.units + i0, y.units + j0, z.units + k0, x.rest + i0, y.rest + j0, z.rest + k0, ny, nz, nullptr, 0, 0};
  const auto slot = [&](int i) {
    Block block = base;
    if (i == 0) {
      block.row = ChunkSamples::nx;
      block.plane = ChunkSamples::nx * ChunkSamples::ny;
      block.f = out.f.data() + k0 * block.plane + j0 * block.row + i0;
    } else {
      block.row = brick_cells;
      block.plane = brick_cells * brick_cells;
      block.f = scratch[static_cast<std::size_t>(i)].data();
    }
    return block;
  };
  const std::uint8_t* dead = nullptr;
  const bool whole = bx < bricks && by < bricks && bz < bricks;
  // Operators may leave an operand unread where its range decides nothing; the far faces evaluate all.
  if (whole && program.depth > 1) {
    brick_range(brick_box(bx, by, bz), bx, by, bz);
    dead = range_work.dead.data();
  }
  const std::ptrdiff_t at = j0 * Columns::stride + i0;
  impl::walk(
      program, dead,
      [&](int i, const Instruction& in) {
        const Block block = slot(i);
        if (in.kind == Instruction::Kind::height) {
          const Columns& c = heights[in.index].columns;
          kernels.height_block(*program.heights[in.index], c.value.data() + at, c.scale.data() + at, block);
        } else if (in.kind == Instruction::Kind::domain) {
          kernels.domain_block(*program.domains[in.index], domains[in.index].columns.value.data() + at,
                               block);
        } else if (in.kind == Instruction::Kind::nested) {
          nested_block(in.index, {i0, j0, k0}, nx, block);
        } else {
          for (int k = 0; k < nz; ++k)
            for (int j = 0; j < ny; ++j) std::fill_n(block.f + k * block.plane + j * block.row, 8, in.value);
        }
      },
      [&](int i, const Instruction& in) {
        const CloudPart& part = clouds[in.index];
        const auto b = static_cast<std::size_t>(brick_index(bx, by, bz));
        const std::size_t count = part.begin[b + 1] - part.begin[b];
        if (count == 0) return;
        const impl::Cloud& cloud = *program.clouds[in.index];
        cloud.type().kernels().add_block(cloud.view(part.column), part.items.data() + part.begin[b], count,
                                         slot(i));
      },
      [&](int i, const Instruction& in) { in.op->kernels().block(slot(i), slot(i + 1), in.value); });
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
  s.chunk_z = c;
  s.z.set(static_cast<std::int64_t>(c) * chunk_cells, s.voxel);
  out.chunk = {s.column_x, s.column_y, c};
  out.evaluated = 0;
  out.f.resize(static_cast<std::size_t>(ChunkSamples::nx * ChunkSamples::ny * ChunkSamples::nz));
  for (auto& part : s.nested) part.known = 0;
  std::size_t touching = 0;
  for (auto& part : s.clouds) {
    s.list_primitives(part, box);
    touching += part.touching;
  }
  const bool bare = touching == 0 && excludes_zero(s.bare_range(s.z.metres[0], s.z.metres[chunk_cells]));
  bool any = false;
  for (int bz = box.lo.z; bz <= box.hi.z; ++bz)
    for (int by = box.lo.y; by <= box.hi.y; ++by)
      for (int bx = box.lo.x; bx <= box.hi.x; ++bx) {
        const std::uint64_t bit = std::uint64_t{1} << (by * bricks + bx);
        const bool active = !bare && s.may_hold_surface(bx, by, bz);
        out.active[bz] = active ? out.active[bz] | bit : out.active[bz] & ~bit;
        any = any || active;
      }
  if (!any) return false;

  for (int bz = box.lo.z; bz <= box.hi.z + 1; ++bz)
    for (int by = box.lo.y; by <= box.hi.y + 1; ++by)
      for (int bx = box.lo.x; bx <= box.hi.x + 1; ++bx) {
        const Vec3i n = out.read(bx, by, bz, box);
        if (n.x == 0) continue;
        s.evaluate_block(bx, by, bz, n.x, n.y, n.z, out);
        out.evaluated += static_cast<std::uint64_t>(n.x * n.y * n.z);
      }
  return true;
}

void ChunkEvaluator::gradients(std::span<const Vec3d> points, std::span<float> values,
                               std::span<Vec3f> gradients) {
  if (values.size() != points.size() || gradients.size() != points.size())
    fail(ErrorKind::internal, "gradients() wants one result a point");
  State& s = *state_;
  const double inv = 1 / (s.voxel * brick_cells);
  const Vec3d origin{s.x.metres[0], s.y.metres[0], s.z.metres[0]};
  const auto brick_of = [&](const Vec3d& p) {
    const auto axis = [&](double d) {
      return std::clamp(static_cast<int>(std::floor(d * inv)), 0, bricks - 1);
    };
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

  auto& lists = s.points.lists();
  for (std::size_t b = 0; b + 1 < begin.size(); ++b) {
    if (begin[b] == begin[b + 1]) continue;
    lists.clear();
    for (const auto& part : s.clouds)
      lists.push_back({&part.column, part.items.data() + part.begin[b], part.begin[b + 1] - part.begin[b]});
    for (std::uint32_t i = begin[b]; i < begin[b + 1]; i += 8) {
      const auto pack = std::span(order).subspan(i, std::min<std::size_t>(8, begin[b + 1] - i));
      s.points.load(points, pack);
      const impl::PointValues& g = s.points.gradients(s.program);
      for (std::size_t l = 0; l < pack.size(); ++l) {
        values[pack[l]] = g.v[l];
        gradients[pack[l]] = {g.gx[l], g.gy[l], g.gz[l]};
      }
    }
  }
}

}  // namespace tafoni::field
