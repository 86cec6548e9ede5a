// Asks a compiled field at points. Many points are sorted along a space-filling curve first, so that the
// eight of a pack are neighbours and share the primitives that are found for them.

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

using impl::Program;

CompiledField compile(const NodePtr& root) {
  limit_simd();
  return CompiledField(impl::Compiler().program(root));
}

namespace {

// Chosen for speed: others give the same values. Only a pack has the width of the widest vectors.
constexpr std::size_t pack_size = 8;
constexpr std::size_t few = 64;         // points that are not worth sorting
constexpr std::size_t group_size = 64;  // points at most that look for primitives together
constexpr float group_reaches = 3;      // how wide these may be, in mean reaches of the primitives
constexpr std::size_t ahead = 32;       // points whose memory is asked for in advance
constexpr std::size_t share = 2048;     // points of one task

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
  parallel_blocks(points.size(), 1 << 16, [&](std::int64_t begin, std::int64_t end) {
    for (std::int64_t i = begin; i < end; ++i) {
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
void in_packs(const Program& program, std::span<const Vec3d> points, bool with_gradients, const Run& run) {
  std::vector<std::uint32_t> order;
  if (points.size() > few) {
    order = spatial_order(points);
  } else {
    order.resize(points.size());
    std::iota(order.begin(), order.end(), 0u);
  }
  // A group grows past one pack only while it stays as small as the primitives it would find.
  const float spread = program.reach * group_reaches;
  const auto group_end = [&](std::size_t begin, std::size_t end) {
    Box3f box;
    std::size_t i = begin;
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
    const impl::PointWork::Lease lease;
    impl::PointWork& work = *lease;
    while (begin < end) {
      const std::size_t next = group_end(begin, end);
      const auto group = std::span(order).subspan(begin, next - begin);
      begin = next;
      work.collect(program, points, group);
      work.ask_nested(program, points, group, with_gradients);
      for (std::size_t i = 0; i < group.size(); i += pack_size) {
        const auto pack = group.subspan(i, std::min(pack_size, group.size() - i));
        work.load(points, pack, i);
        if (group.size() > pack_size) work.narrow(program);
        run(work, pack);
      }
    }
  };
  if (points.size() <= share) return groups(0, points.size());
  parallel_blocks(points.size(), share, [&](std::int64_t begin, std::int64_t end) { groups(begin, end); });
}

}  // namespace

float CompiledField::value(Vec3d p) const {
  float out = 0;
  values({&p, 1}, {&out, 1});
  return out;
}

void CompiledField::values(std::span<const Vec3d> points, std::span<float> out) const {
  if (out.size() != points.size()) fail(ErrorKind::internal, "values() wants one result a point");
  in_packs(*program_, points, false, [&](impl::PointWork& work, std::span<const std::uint32_t> pack) {
    const float* f = work.values(*program_);
    for (std::size_t l = 0; l < pack.size(); ++l) out[pack[l]] = f[l];
  });
}

void CompiledField::gradients(std::span<const Vec3d> points, std::span<float> values,
                              std::span<Vec3f> gradients) const {
  if (values.size() != points.size() || gradients.size() != points.size())
    fail(ErrorKind::internal, "gradients() wants one result a point");
  in_packs(*program_, points, true, [&](impl::PointWork& work, std::span<const std::uint32_t> pack) {
    const impl::PointValues& g = work.gradients(*program_);
    for (std::size_t l = 0; l < pack.size(); ++l) {
      values[pack[l]] = g.v[l];
      gradients[pack[l]] = {g.gx[l], g.gy[l], g.gz[l]};
    }
  });
}

Interval CompiledField::interval(const Box3d& box) const {
  return impl::PointWork::Lease()->range(*program_, box);
}

Box3d CompiledField::bounds() const {
  return impl::bounds(*program_);
}

}  // namespace tafoni::field
