// Evaluates the bricks of one chunk: primitives are found once for the chunk and listed by brick; ranges that
// bound the field over a brick leave out those that cannot hold the surface; the others run the program on
// blocks.

#include "tafoni/field/impl/chunk_work.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tafoni/math/whole.h"

namespace tafoni::field::impl {
namespace {

constexpr int bricks = chunk_bricks;

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

Interval join(const BrickRange& r) {
  return {*std::min_element(r.lo, r.lo + bricks * bricks), *std::max_element(r.hi, r.hi + bricks * bricks)};
}

}  // namespace

Box3f ChunkFrame::brick_box(int bx, int by, int bz) const {
  const int i = bx * brick_cells, j = by * brick_cells, k = bz * brick_cells;
  return {{low(x, i), low(y, j), low(z, k)},
          {high(x, i + brick_cells), high(y, j + brick_cells), high(z, k + brick_cells)}};
}

Box3d ChunkFrame::closure(int bx, int by, int bz, int side) const {
  const int i = bx * brick_cells, j = by * brick_cells, k = bz * brick_cells, n = side * brick_cells;
  return {{x.metres[i], y.metres[j], z.metres[k]}, {x.metres[i + n], y.metres[j + n], z.metres[k + n]}};
}

ChunkWork::ChunkWork(const Program& program, const ChunkFrame& frame)
    : program_(program),
      frame_(frame),
      heights_(program.heights.size()),
      domains_(program.domains.size()),
      clouds_(program.clouds.size()),
      nested_(program.nested.size()),
      scratch_(program.depth, std::vector<float>(brick_cells * brick_cells * brick_cells)) {}

Interval ChunkWork::set_column() {
  const Axis &x = frame_.x, &y = frame_.y;
  Interval z = no_extent;
  const auto include = [&z](float lo, float hi) { z = {std::min(z.lo, lo), std::max(z.hi, hi)}; };
  for (std::size_t i = 0; i < heights_.size(); ++i) {
    Height& h = heights_[i];
    const HeightLeaf& leaf = *program_.heights[i];
    kernels_.height_columns(leaf, x, y, h.columns);
    h.value = brick_ranges(h.columns.value);
    h.scale = brick_ranges(h.columns.scale);
    h.all_value = join(h.value);
    h.all_scale = join(h.scale);
    // Beyond the reach of sigma the leaf is constant; a first-order distance reaches further on slopes.
    const float reach = leaf.sigma.influence / h.all_scale.lo;
    include(h.all_value.lo - reach, h.all_value.hi + reach);
  }
  for (std::size_t i = 0; i < domains_.size(); ++i) {
    Plane& d = domains_[i];
    const DomainLeaf& leaf = *program_.domains[i];
    kernels_.domain_columns(leaf, x, y, d.columns);
    d.value = brick_ranges(d.columns.value);
    d.all_value = join(d.value);
    const float base = leaf.base();
    include(base - leaf.sigma.influence, base + leaf.sigma.influence);
  }
  constexpr float tall = static_cast<float>(reach_limit);
  const Box3f column{{ChunkFrame::low(x, 0), ChunkFrame::low(y, 0), -tall},
                     {ChunkFrame::high(x, chunk_cells), ChunkFrame::high(y, chunk_cells), tall}};
  for (std::size_t i = 0; i < clouds_.size(); ++i) {
    Primitives& found = clouds_[i].column;
    found.clear();
    program_.clouds[i]->collect(column, found);
    for (std::size_t p = 0; p < found.size(); ++p) {
      const float c = to_float_metres(found.z[p]);
      include(c - found.reach[p], c + found.reach[p]);
    }
  }
  for (std::size_t i = 0; i < nested_.size(); ++i) {
    nested_[i].column_set = nested_[i].chunk_set = false;
    const Interval own = program_.nested[i]->extent(
        {{x.metres[0], y.metres[0], 0}, {x.metres[chunk_cells], y.metres[chunk_cells], 0}},
        points_.nested(i));
    include(own.lo, own.hi);
  }
  return z;
}

std::size_t ChunkWork::set_chunk(const BrickBox& box) {
  box_ = box;
  for (NestedPart& part : nested_) {
    part.known = 0;
    part.chunk_set = false;
  }
  std::size_t touching = 0;
  for (CloudPart& part : clouds_) touching += list_primitives(part, box);
  return touching;
}

/// Those of the bricks of `box` and of the next ones, whose near faces they read. How many touch any.
std::size_t ChunkWork::list_primitives(CloudPart& part, const BrickBox& box) {
  const Primitives& p = part.column;
  if (p.size() == 0 && part.items.empty() && !part.begin.empty()) return 0;  // the lists are empty already
  part.pairs.clear();
  std::size_t touching = 0;
  part.begin.assign(sides * sides * sides + 1, 0);
  const float inv = static_cast<float>(1 / (frame_.voxel * brick_cells));
  const float origin[3] = {static_cast<float>(frame_.x.metres[0]), static_cast<float>(frame_.y.metres[0]),
                           static_cast<float>(frame_.z.metres[0])};
  const float brick = static_cast<float>(frame_.voxel * brick_cells);
  const int first[3] = {box.lo.x, box.lo.y, box.lo.z}, last[3] = {box.hi.x, box.hi.y, box.hi.z};
  for (std::uint32_t i = 0; i < p.size(); ++i) {
    const float c[3] = {to_float_metres(p.x[i]) - origin[0], to_float_metres(p.y[i]) - origin[1],
                        to_float_metres(p.z[i]) - origin[2]};
    const float reach = p.reach[i] + position_slack;
    int lo[3], hi[3];
    for (int a = 0; a < 3; ++a) {
      // Brick b's closure is [b, b + 1] bricks.
      lo[a] = ceil_to(std::clamp((c[a] - reach) * inv - 1, -1e6f, 1e6f));
      hi[a] = floor_to(std::clamp((c[a] + reach) * inv, -1e6f, 1e6f));
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
    touching += touches;
  }
  for (std::size_t b = 0; b < sides * sides * sides; ++b) part.begin[b + 1] += part.begin[b];
  part.items.resize(part.pairs.size());
  cursor_.assign(part.begin.begin(), part.begin.end() - 1);
  for (const auto& [b, i] : part.pairs) part.items[cursor_[b]++] = i;
  return touching;
}

Interval ChunkWork::brick_range(int bx, int by, int bz, bool coarse) {
  const Box3f box = frame_.brick_box(bx, by, bz);
  const int plane = by * bricks + bx;
  const std::size_t b = brick_index(bx, by, bz);
  return range_of(program_, ranges_, [&](const Instruction& in) -> Interval {
    if (in.kind == Instruction::Kind::height) {
      const Height& h = heights_[in.index];
      return height_range(*program_.heights[in.index], h.value.lo[plane], h.value.hi[plane],
                          h.scale.lo[plane], h.scale.hi[plane], box.lo.z, box.hi.z);
    }
    if (in.kind == Instruction::Kind::domain) {
      const Plane& d = domains_[in.index];
      return domain_range(*program_.domains[in.index], d.value.lo[plane], d.value.hi[plane], box.lo.z,
                          box.hi.z);
    }
    if (in.kind == Instruction::Kind::nested) return nested_range(in.index, bx, by, bz, coarse);
    const CloudPart& part = clouds_[in.index];
    Interval sum{0, 0};
    for (std::uint32_t m = part.begin[b]; m < part.begin[b + 1]; ++m)
      sum = sum + program_.clouds[in.index]->contribution(part.column, part.items[m], box);
    const float count = static_cast<float>(part.begin[b + 1] - part.begin[b]);
    const float loss = 1e-7f * count * (std::fabs(sum.lo) + std::fabs(sum.hi));
    return {sum.lo - loss, sum.hi + loss};
  });
}

Interval ChunkWork::nested_range(std::size_t index, int bx, int by, int bz, bool coarse) {
  const Interval range = octant_range(index, bx, by, bz);
  if (coarse || range.lo == range.hi) return range;
  const Box3d box = frame_.closure(bx, by, bz, 1);
  if (ChunkWork* child = still(index, box)) return child->brick_range(bx, by, bz, false);
  return program_.nested[index]->range(box, points_.nested(index));
}

Interval ChunkWork::octant_range(std::size_t index, int bx, int by, int bz) {
  constexpr int half = bricks / 2;
  const int octant = bz / half * 4 + by / half * 2 + bx / half;
  NestedPart& part = nested_[index];
  if (!(part.known >> octant & 1u)) {
    part.known |= 1u << octant;
    part.range[octant] = program_.nested[index]->range(
        frame_.closure(bx / half * half, by / half * half, bz / half * half, half), points_.nested(index));
  }
  return part.range[octant];
}

ChunkWork* ChunkWork::still(std::size_t index, const Box3d& box) {
  const Program* program = program_.nested[index]->still(box);
  if (!program) return nullptr;
  NestedPart& part = nested_[index];
  if (!part.still) part.still = std::make_unique<ChunkWork>(*program, frame_);
  if (!part.column_set) part.still->set_column();
  if (!part.chunk_set) part.still->set_chunk(box_);
  part.column_set = part.chunk_set = true;
  return part.still.get();
}

Interval ChunkWork::bare_range(double lo, double hi) {
  const float z0 = static_cast<float>(lo) - position_slack, z1 = static_cast<float>(hi) + position_slack;
  const Axis &x = frame_.x, &y = frame_.y;
  return range_of(program_, ranges_, [&](const Instruction& in) -> Interval {
    switch (in.kind) {
      case Instruction::Kind::height: {
        const Height& h = heights_[in.index];
        return height_range(*program_.heights[in.index], h.all_value.lo, h.all_value.hi, h.all_scale.lo,
                            h.all_scale.hi, z0, z1);
      }
      case Instruction::Kind::domain:
        return domain_range(*program_.domains[in.index], domains_[in.index].all_value.lo,
                            domains_[in.index].all_value.hi, z0, z1);
      case Instruction::Kind::nested:
        return program_.nested[in.index]->range(
            {{x.metres[0], y.metres[0], lo}, {x.metres[chunk_cells], y.metres[chunk_cells], hi}},
            points_.nested(in.index));
      default:
        return {0, 0};
    }
  });
}

bool ChunkWork::may_hold_surface(int bx, int by, int bz) {
  if (!nested_.empty() && frame_.beyond(brick_range(bx, by, bz, true))) return false;
  return !frame_.beyond(brick_range(bx, by, bz, false));
}

void ChunkWork::nested_block(std::size_t index, int bx, int by, int bz, int nx, const Block& block) {
  const Axis &x = frame_.x, &y = frame_.y, &z = frame_.z;
  const int i0 = bx * brick_cells, j0 = by * brick_cells, k0 = bz * brick_cells;
  const Box3d box{{x.metres[i0], y.metres[j0], z.metres[k0]},
                  {x.metres[i0 + nx - 1], y.metres[j0 + block.ny - 1], z.metres[k0 + block.nz - 1]}};
  if (ChunkWork* child = still(index, box)) return child->evaluate(bx, by, bz, nx, block);
  lattice_points_.clear();
  for (int k = 0; k < block.nz; ++k)
    for (int j = 0; j < block.ny; ++j)
      for (int i = 0; i < nx; ++i)
        lattice_points_.push_back({x.metres[i0 + i], y.metres[j0 + j], z.metres[k0 + k]});
  lattice_values_.resize(lattice_points_.size());
  program_.nested[index]->values(lattice_points_, points_.nested(index), lattice_values_.data());
  const float* from = lattice_values_.data();
  for (int k = 0; k < block.nz; ++k)
    for (int j = 0; j < block.ny; ++j, from += nx) {
      float* row = block.f + k * block.plane + j * block.row;
      std::copy_n(from, nx, row);
      std::fill(row + nx, row + brick_cells, from[0]);  // read by nobody, but operators compute on it
    }
}

void ChunkWork::evaluate(int bx, int by, int bz, int nx, const Block& target) {
  const int j0 = by * brick_cells, i0 = bx * brick_cells;
  const auto slot = [&](int i) {
    Block block = target;
    if (i == 0) return block;
    block.row = brick_cells;
    block.plane = brick_cells * brick_cells;
    block.f = scratch_[i].data();
    return block;
  };
  const std::uint8_t* dead = nullptr;
  const bool whole = bx < bricks && by < bricks && bz < bricks;
  // Operators may leave an operand unread where its range decides nothing; the far faces evaluate all.
  if (whole && program_.depth > 1) {
    brick_range(bx, by, bz, false);
    dead = ranges_.dead.data();
  }
  const std::ptrdiff_t at = j0 * Columns::stride + i0;
  walk(
      program_, dead,
      [&](int i, const Instruction& in) {
        const Block block = slot(i);
        if (in.kind == Instruction::Kind::height) {
          const Columns& c = heights_[in.index].columns;
          kernels_.height_block(*program_.heights[in.index], c.value.data() + at, c.scale.data() + at, block);
        } else if (in.kind == Instruction::Kind::domain) {
          kernels_.domain_block(*program_.domains[in.index], domains_[in.index].columns.value.data() + at,
                                block);
        } else if (in.kind == Instruction::Kind::nested) {
          nested_block(in.index, bx, by, bz, nx, block);
        } else {
          for (int k = 0; k < block.nz; ++k)
            for (int j = 0; j < block.ny; ++j)
              std::fill_n(block.f + k * block.plane + j * block.row, brick_cells, in.value);
        }
      },
      [&](int i, const Instruction& in) {
        const CloudPart& part = clouds_[in.index];
        const std::size_t b = brick_index(bx, by, bz);
        const std::size_t count = part.begin[b + 1] - part.begin[b];
        if (count == 0) return;
        const Cloud& cloud = *program_.clouds[in.index];
        cloud.type().kernels().add_block(cloud.view(part.column), part.items.data() + part.begin[b], count,
                                         slot(i));
      },
      [&](int i, const Instruction& in) { in.op->kernels().block(slot(i), slot(i + 1), in.value); });
}

void ChunkWork::lists(std::size_t b, std::vector<PointWork::List>& out) const {
  out.clear();
  for (const CloudPart& part : clouds_)
    out.push_back({&part.column, part.items.data() + part.begin[b], part.begin[b + 1] - part.begin[b]});
}

}  // namespace tafoni::field::impl
