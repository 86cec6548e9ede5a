// Stores a cloud: records are sorted along a space-filling curve, packed in blocks of 16, and indexed by a
// tree over the blocks' boxes. Also the ranges of single primitives, from their distance to a box.

#include "tafoni/field/impl/cloud.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <limits>

#include "tafoni/field/impl/curve.h"

namespace tafoni::field::impl {
namespace {

float pad(float reach) {
  return reach * reach_factor + reach_margin;
}

}  // namespace

Cloud::Cloud(const PrimitiveType& type, float falloff, const Noise& noise, std::vector<Record> records,
             const std::vector<float>& pool)
    : type_(&type), falloff_(falloff), noise_(noise) {
  struct Key {
    CurveKey place;
    std::uint32_t index;
  };
  std::vector<Key> keys(records.size());
  for (std::uint32_t i = 0; i < records.size(); ++i) keys[i] = {curve_key(records[i].anchor), i};
  const auto extras_of = [&](const Record& r) { return std::span(pool.data() + r.extra, r.extra_count); };
  // Canonical: depends on the primitives alone. Records equal in every field may swap without a trace.
  std::sort(keys.begin(), keys.end(), [&](const Key& a, const Key& b) {
    if (a.place != b.place) return a.place < b.place;
    const Record &ra = records[a.index], &rb = records[b.index];
    const auto ka = std::array{order_key(ra.radius), order_key(ra.energy)};
    const auto kb = std::array{order_key(rb.radius), order_key(rb.energy)};
    if (ka != kb) return ka < kb;
    const auto ea = extras_of(ra), eb = extras_of(rb);
    return std::lexicographical_compare(ea.begin(), ea.end(), eb.begin(), eb.end());
  });

  for (auto* v : {&packed_.lo, &packed_.hi}) v->reserve(records.size());
  for (auto* v : {&packed_.radius, &packed_.energy}) v->reserve(records.size());
  if (type.variable) extra_offsets_.reserve(records.size() + 1);
  std::vector<Box3f> boxes;
  double reaches = 0;
  for (std::uint32_t i = 0; i < keys.size(); ++i) {
    const Record& r = records[keys[i].index];
    const Vec3i a = r.anchor;
    const std::int16_t cell[3] = {static_cast<std::int16_t>(a.x >> cell_bits),
                                  static_cast<std::int16_t>(a.y >> cell_bits),
                                  static_cast<std::int16_t>(a.z >> cell_bits)};
    if (blocks_.empty() || blocks_.back().count == block_size ||
        std::memcmp(blocks_.back().cell, cell, sizeof(cell)) != 0) {
      blocks_.push_back({{cell[0], cell[1], cell[2]}, 0, i});
      boxes.emplace_back();
    }
    ++blocks_.back().count;
    const std::uint32_t wx = a.x & cell_mask, wy = a.y & cell_mask, wz = a.z & cell_mask;
    packed_.lo.push_back(wx | wy << 21);
    packed_.hi.push_back(wy >> 11 | wz << 10);
    packed_.radius.push_back(r.radius);
    packed_.energy.push_back(r.energy);
    const auto extras = extras_of(r);
    if (type.variable) extra_offsets_.push_back(static_cast<std::uint32_t>(pool_.size()));
    pool_.insert(pool_.end(), extras.begin(), extras.end());
    const float reach = reach_of(r.radius, extras);
    reaches += reach;
    const Vec3f c{to_float_metres(a.x), to_float_metres(a.y), to_float_metres(a.z)};
    // The anchor itself is rounded to float here: 8 mm at the limit of the frame.
    boxes.back().expand(Box3f{c, c}.grown(reach + position_slack));
  }
  if (type.variable) extra_offsets_.push_back(static_cast<std::uint32_t>(pool_.size()));
  blocks_.shrink_to_fit();
  pool_.shrink_to_fit();
  for (const Box3f& b : boxes) bounds_.expand(b);
  if (!records.empty()) mean_reach_ = static_cast<float>(reaches / static_cast<double>(records.size()));
  tree_ = BoxTree(std::move(boxes));
}

float Cloud::reach_of(float radius, std::span<const float> extras) const {
  const float support = type_->volumetric ? radius + falloff_ : radius;
  const float extent = extras.empty() ? 0.f : type_->extent(extras);
  return pad(support + noise_.amplitude + extent);
}

std::uint64_t Cloud::bytes() const {
  const std::uint64_t own = sizeof(*this) + packed_.size() * 16 + blocks_.size() * sizeof(Block) +
                            pool_.size() * sizeof(float) + extra_offsets_.size() * sizeof(std::uint32_t);
  return own + tree_.bytes();
}

void Cloud::decode_extras(const Block& block, const Box3f& box, std::size_t from, Primitives& out) const {
  std::size_t kept = from;
  for (std::size_t i = 0; i < block.count; ++i) {
    const std::size_t at = block.first + i, in = from + i;
    const std::size_t group = type_->extras;
    const std::size_t begin = type_->variable ? extra_offsets_[at] : at * group;
    const std::size_t end = type_->variable ? extra_offsets_[at + 1] : begin + group;
    const float reach = reach_of(out.radius[in], std::span(pool_).subspan(begin, end - begin));
    const auto gap = [](float lo, float hi, std::int32_t v) {
      const float c = to_float_metres(v);
      return std::max(std::max(lo - c, c - hi), 0.f);
    };
    const float dx = gap(box.lo.x, box.hi.x, out.x[in]), dy = gap(box.lo.y, box.hi.y, out.y[in]),
                dz = gap(box.lo.z, box.hi.z, out.z[in]);
    const float far = reach + position_slack;
    if (dx * dx + dy * dy + dz * dz > far * far) continue;
    out.x[kept] = out.x[in], out.y[kept] = out.y[in], out.z[kept] = out.z[in];
    out.radius[kept] = out.radius[in], out.energy[kept] = out.energy[in], out.reach[kept] = reach;
    out.extra.push_back(static_cast<std::uint32_t>(begin));
    out.extra_count.push_back(static_cast<std::uint32_t>(end - begin));
    ++kept;
  }
  out.count = kept;
}

void Cloud::collect(const Box3f& box, Primitives& out) const {
  const auto decode = index_kernels().decode;
  tree_.visit(box, [&](std::size_t b) {
    const Block& block = blocks_[b];
    constexpr std::int32_t cell_size = 1 << cell_bits;
    const PackedRange range{&packed_,
                            block.first,
                            block.count,
                            {block.cell[0] * cell_size, block.cell[1] * cell_size, block.cell[2] * cell_size},
                            (type_->volumetric ? falloff_ : 0.f) + noise_.amplitude};
    const std::size_t from = out.size();
    if (type_->extras == 0) {
      decode(range, box, out);
    } else {
      constexpr float all = std::numeric_limits<float>::max();
      decode(range, {{-all, -all, -all}, {all, all, all}}, out);
      decode_extras(block, box, from, out);
    }
  });
}

Cloud::Distances Cloud::distances(const Primitives& p, std::size_t i, const Box3f& box) const {
  if (type_->extras > 0) {
    // The distance to any skeleton is 1-Lipschitz: bound it from the box's centre.
    PointLanes center;
    const Vec3f c = box.center();
    const Fixed at[3] = {to_fixed(c.x), to_fixed(c.y), to_fixed(c.z)};
    std::fill_n(center.x, 8, at[0].units), std::fill_n(center.xr, 8, at[0].rest);
    std::fill_n(center.y, 8, at[1].units), std::fill_n(center.yr, 8, at[1].rest);
    std::fill_n(center.z, 8, at[2].units), std::fill_n(center.zr, 8, at[2].rest);
    alignas(32) float d[8];
    type_->kernels().distance(view(p), static_cast<std::uint32_t>(i), center, d);
    const float half = 0.5f * length(box.size());
    return {std::max(d[0] - half, 0.f), d[0] + half};
  }
  const Vec3f a{to_float_metres(p.x[i]), to_float_metres(p.y[i]), to_float_metres(p.z[i])};
  const auto near = [](float lo, float hi, float c) { return std::max(std::max(lo - c, c - hi), 0.f); };
  const auto far = [](float lo, float hi, float c) { return std::max(c - lo, hi - c); };
  return {length(Vec3f{near(box.lo.x, box.hi.x, a.x), near(box.lo.y, box.hi.y, a.y),
                       near(box.lo.z, box.hi.z, a.z)}),
          length(Vec3f{far(box.lo.x, box.hi.x, a.x), far(box.lo.y, box.hi.y, a.y),
                       far(box.lo.z, box.hi.z, a.z)})};
}

Interval Cloud::contribution(const Primitives& p, std::size_t i, const Box3f& box) const {
  const auto [near, far] = distances(p, i, box);
  const auto closeness = [&](float d, float noise) {
    const float support = type_->volumetric ? falloff_ : p.radius[i] + noise;
    const float q = (type_->volumetric ? std::max(d - p.radius[i] - noise, 0.f) : d) / support;
    const float t = std::max(1.f - q * q, 0.f);
    return t * t * t;
  };
  const float most = closeness(std::max(near - position_slack, 0.f), noise_.amplitude);
  const float least = closeness(far + position_slack, -noise_.amplitude);
  const float e = p.energy[i];
  return e < 0 ? Interval{e * most, e * least} : Interval{e * least, e * most};
}

Interval Cloud::interval(const Box3f& box, Primitives& scratch) const {
  scratch.clear();
  collect(box, scratch);
  Interval sum{0, 0};
  for (std::size_t i = 0; i < scratch.size(); ++i) sum = sum + contribution(scratch, i, box);
  return sum;
}

}  // namespace tafoni::field::impl
