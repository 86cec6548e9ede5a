#include "tafoni/field/compiled.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "tafoni/core/parallel.h"
#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/program.h"
#include "tafoni/math/simd.h"

namespace tafoni::field {

using impl::Instruction;
using impl::Program;

CompiledField compile(const NodePtr& root) {
  limit_simd();
  return CompiledField(std::make_shared<const Program>(impl::flatten(root)));
}

namespace {

/// Order of points along a space-filling curve, so that neighbours share a pack. Radix sort of 32-bit keys;
/// any order gives the same values.
std::vector<std::uint32_t> spatial_order(std::span<const Vec3d> points) {
  Box3d box;
  for (const Vec3d& p : points) box.expand(p);
  const Vec3d size = box.size();
  constexpr int bits = 11;
  const double scale = 2046 / std::max({size.x, size.y, 2 * size.z, 1e-9});
  const auto spread = [](std::uint32_t v) {
    std::uint64_t w = v;
    w = (w | w << 16) & 0x0000ff0000ffull;
    w = (w | w << 8) & 0x00f00f00f00full;
    w = (w | w << 4) & 0x0c30c30c30c3ull;
    return (w | w << 2) & 0x249249249249ull;
  };
  std::vector<std::uint64_t> items(points.size()), other(points.size());  // key above, index below
  parallel_blocks(static_cast<std::int64_t>(points.size()), 1 << 16,
                  [&](std::int64_t begin, std::int64_t end) {
                    for (auto i = static_cast<std::size_t>(begin); i < static_cast<std::size_t>(end); ++i) {
                      const Vec3d d = (points[i] - box.lo) * scale;
                      const std::uint64_t key = spread(static_cast<std::uint32_t>(d.x)) |
                                                spread(static_cast<std::uint32_t>(d.y)) << 1 |
                                                spread(static_cast<std::uint32_t>(d.z)) << 2;
                      items[i] = key << 32 | i;
                    }
                  });
  for (int shift = 32; shift < 64; shift += bits) {
    std::array<std::uint32_t, (1 << bits) + 1> count{};
    constexpr std::uint64_t mask = (1 << bits) - 1;
    for (std::uint64_t item : items) ++count[(item >> shift & mask) + 1];
    std::partial_sum(count.begin(), count.end(), count.begin());
    for (std::uint64_t item : items) other[count[item >> shift & mask]++] = item;
    items.swap(other);
  }
  std::vector<std::uint32_t> order(points.size());
  for (std::size_t i = 0; i < items.size(); ++i) order[i] = static_cast<std::uint32_t>(items[i]);
  return order;
}

/// Calls run(work, indices) for packs of up to eight neighbouring points, loaded and with their primitives
/// found.
template <class Run>
void in_packs(const Program& program, std::span<const Vec3d> points, const Run& run) {
  constexpr std::size_t few = 64, group_size = 64, pack_size = 8;
  std::vector<std::uint32_t> order;
  if (points.size() > few) {
    order = spatial_order(points);
  } else {
    order.resize(points.size());
    std::iota(order.begin(), order.end(), 0u);
  }
  // A group grows past one pack only while it stays as small as the primitives it would find.
  const float spread = impl::typical_reach(program) * 3;
  const auto group_end = [&](std::size_t begin, std::size_t end) {
    Box3f box;
    std::size_t i = begin;
    constexpr std::size_t ahead = 32;
    for (; i < std::min(begin + group_size, end); ++i) {
      // The points lie scattered in memory; sorting gave only their order.
      __builtin_prefetch(&points[order[std::min(i + ahead, order.size() - 1)]]);
      box.expand(to_float(points[order[i]]));
      const Vec3f size = box.size();
      if (i >= begin + pack_size && std::max({size.x, size.y, size.z}) > spread) break;
    }
    return i;
  };
  const auto groups = [&](std::size_t begin, std::size_t end) {
    auto& work = impl::PointWork::local();
    while (begin < end) {
      const std::size_t next = group_end(begin, end);
      const auto group = std::span(order).subspan(begin, next - begin);
      begin = next;
      work.collect(program, points, group);
      for (std::size_t i = 0; i < group.size(); i += pack_size) {
        const auto pack = group.subspan(i, std::min(pack_size, group.size() - i));
        work.load(points, pack);
        if (group.size() > pack_size) work.narrow(program);
        run(work, pack);
      }
    }
  };
  constexpr std::size_t share = 2048;
  if (points.size() <= share) return groups(0, points.size());
  parallel_blocks(static_cast<std::int64_t>(points.size()), share, [&](std::int64_t begin, std::int64_t end) {
    groups(static_cast<std::size_t>(begin), static_cast<std::size_t>(end));
  });
}

}  // namespace

float CompiledField::value(Vec3d p) const {
  float out = 0;
  values({&p, 1}, {&out, 1});
  return out;
}

void CompiledField::values(std::span<const Vec3d> points, std::span<float> out) const {
  if (out.size() != points.size()) fail(ErrorKind::internal, "values() wants one result a point");
  in_packs(*program_, points, [&](impl::PointWork& work, std::span<const std::uint32_t> pack) {
    const float* f = work.values(*program_);
    for (std::size_t l = 0; l < pack.size(); ++l) out[pack[l]] = f[l];
  });
}

void CompiledField::gradients(std::span<const Vec3d> points, std::span<float> values,
                              std::span<Vec3f> gradients) const {
  if (values.size() != points.size() || gradients.size() != points.size())
    fail(ErrorKind::internal, "gradients() wants one result a point");
  in_packs(*program_, points, [&](impl::PointWork& work, std::span<const std::uint32_t> pack) {
    const impl::PointValues& g = work.gradients(*program_);
    for (std::size_t l = 0; l < pack.size(); ++l) {
      values[pack[l]] = g.v[l];
      gradients[pack[l]] = {g.gx[l], g.gy[l], g.gz[l]};
    }
  });
}

Interval CompiledField::interval(const Box3d& box) const {
  static thread_local impl::RangeWork work;
  static thread_local impl::Primitives scratch;
  // Rounding the box to float must not shrink it.
  const float slack = impl::position_slack;
  const Box3f floats = Box3f{to_float(box.lo), to_float(box.hi)}.grown(slack);
  return impl::range_of(*program_, work, [&](const Instruction& in) -> Interval {
    if (in.kind == Instruction::Kind::height) {
      const impl::HeightLeaf& leaf = *program_->heights[in.index];
      const auto r = leaf.sampler.range(box.lo.x, box.lo.y, box.hi.x, box.hi.y);
      const float least = leaf.first_order ? 1.f / std::sqrt(1.f + r.slope * r.slope) : 1.f;
      return impl::height_range(leaf, r.lo, r.hi, least, 1.f, floats.lo.z, floats.hi.z);
    }
    if (in.kind == Instruction::Kind::domain) {
      const impl::DomainLeaf& leaf = *program_->domains[in.index];
      const Box3d& d = leaf.domain.box;
      // The distance to a rectangle's border is 1-Lipschitz; at a box it is bounded axis by axis.
      const double lo = impl::corner_distance(std::min(box.lo.x - d.lo.x, d.hi.x - box.hi.x),
                                              std::min(box.lo.y - d.lo.y, d.hi.y - box.hi.y));
      const double mx = std::min(std::min(box.hi.x, d.hi.x) - d.lo.x, d.hi.x - std::max(box.lo.x, d.lo.x));
      const double my = std::min(std::min(box.hi.y, d.hi.y) - d.lo.y, d.hi.y - std::max(box.lo.y, d.lo.y));
      float least = static_cast<float>(lo), most = static_cast<float>(impl::corner_distance(mx, my));
      if (leaf.inside) {
        const auto r = leaf.inside->range(box.lo.x, box.lo.y, box.hi.x, box.hi.y);
        least = std::min(least, r.lo);
        most = std::min(most, r.hi);
      }
      return impl::domain_range(leaf, least - slack, most + slack, floats.lo.z, floats.hi.z);
    }
    return program_->clouds[in.index]->interval(floats, scratch);
  });
}

Box3d CompiledField::bounds() const {
  Box3d box;
  for (const auto* leaf : program_->heights) {
    const auto& r = leaf->sampler.raster();
    const auto range = leaf->sampler.range();
    const auto& p = r.placement;
    box.expand(Box3d{{p.west, p.north - r.height() * p.dy, range.lo},
                     {p.west + r.width() * p.dx, p.north, range.hi}});
  }
  for (const auto* cloud : program_->clouds)
    if (cloud->size() > 0) box.expand(Box3d{to_double(cloud->bounds().lo), to_double(cloud->bounds().hi)});
  for (const auto* leaf : program_->domains) {
    const Box3d& d = leaf->domain.box;
    box.expand(Box3d{d.lo, {d.hi.x, d.hi.y, d.lo.z}});
  }
  return box;
}

}  // namespace tafoni::field
