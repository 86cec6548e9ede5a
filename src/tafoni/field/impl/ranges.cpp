// Ranges of a program over boxes, columns and as a whole.

#include <algorithm>
#include <cmath>

#include "tafoni/field/impl/points.h"
#include "tafoni/field/impl/program.h"

namespace tafoni::field::impl {
namespace {

Interval height_over(const HeightLeaf& leaf, const Box3d& box, float z0, float z1) {
  const auto r = leaf.sampler.range(box.lo.x, box.lo.y, box.hi.x, box.hi.y);
  const float least = leaf.first_order ? 1.f / std::sqrt(1.f + r.slope * r.slope) : 1.f;
  return height_range(leaf, r.lo, r.hi, least, 1.f, z0, z1);
}

Interval domain_over(const DomainLeaf& leaf, const Box3d& box, float z0, float z1) {
  const Box3d& d = leaf.domain.box;
  // The distance to a rectangle's border is 1-Lipschitz; at a box it is bounded axis by axis.
  const double lo = corner_distance(std::min(box.lo.x - d.lo.x, d.hi.x - box.hi.x),
                                    std::min(box.lo.y - d.lo.y, d.hi.y - box.hi.y));
  const double mx = std::min(std::min(box.hi.x, d.hi.x) - d.lo.x, d.hi.x - std::max(box.lo.x, d.lo.x));
  const double my = std::min(std::min(box.hi.y, d.hi.y) - d.lo.y, d.hi.y - std::max(box.lo.y, d.lo.y));
  float least = static_cast<float>(lo), most = static_cast<float>(corner_distance(mx, my));
  if (leaf.inside) {
    const auto r = leaf.inside->range(box.lo.x, box.lo.y, box.hi.x, box.hi.y);
    least = std::min(least, r.lo);
    most = std::min(most, r.hi);
  }
  return domain_range(leaf, least - position_slack, most + position_slack, z0, z1);
}

/// How far above and below its heights a leaf is not constant.
float height_reach(const HeightLeaf& leaf, const Sampler::Range& r) {
  return leaf.sigma.influence * (leaf.first_order ? std::sqrt(1.f + r.slope * r.slope) : 1.f);
}

}  // namespace

Interval PointWork::range(const Program& program, const Box3d& box) {
  // Rounding the box to float must not shrink it.
  const Box3f floats = Box3f{to_float(box.lo), to_float(box.hi)}.grown(position_slack);
  return range_of(program, ranges_, [&](const Instruction& in) -> Interval {
    switch (in.kind) {
      case Instruction::Kind::height:
        return height_over(*program.heights[in.index], box, floats.lo.z, floats.hi.z);
      case Instruction::Kind::domain:
        return domain_over(*program.domains[in.index], box, floats.lo.z, floats.hi.z);
      case Instruction::Kind::nested:
        return program.nested[in.index]->range(box, nested(in.index));
      default:
        return program.clouds[in.index]->interval(floats, in_box_);
    }
  });
}

Interval PointWork::extent(const Program& program, const Box3d& column) {
  float lo = std::numeric_limits<float>::max(), hi = std::numeric_limits<float>::lowest();
  const auto include = [&](float a, float b) { lo = std::min(lo, a), hi = std::max(hi, b); };
  for (const HeightLeaf* leaf : program.heights) {
    const auto r = leaf->sampler.range(column.lo.x, column.lo.y, column.hi.x, column.hi.y);
    const float reach = height_reach(*leaf, r);
    include(r.lo - reach, r.hi + reach);
  }
  for (const DomainLeaf* leaf : program.domains) {
    const float base = leaf->base();
    include(base - leaf->sigma.influence, base + leaf->sigma.influence);
  }
  Box3f tall = Box3f{to_float(column.lo), to_float(column.hi)}.grown(position_slack);
  tall.lo.z = -static_cast<float>(reach_limit), tall.hi.z = static_cast<float>(reach_limit);
  for (const Cloud* cloud : program.clouds) {
    in_box_.clear();
    cloud->collect(tall, in_box_);
    for (std::size_t p = 0; p < in_box_.size(); ++p) {
      const float c = to_float_metres(in_box_.z[p]);
      include(c - in_box_.reach[p], c + in_box_.reach[p]);
    }
  }
  for (std::size_t i = 0; i < program.nested.size(); ++i) {
    const Interval own = program.nested[i]->extent(column, nested(i));
    include(own.lo, own.hi);
  }
  return {lo, hi};
}

Box3d bounds(const Program& program) {
  Box3d box;
  for (const auto* leaf : program.heights) {
    const auto& r = leaf->sampler.raster();
    const auto range = leaf->sampler.range();
    const auto& p = r.placement;
    // Alone or with clouds of known bounds it has its surface at its heights; a function may shift that.
    const float reach = program.nested.empty() ? 0.f : height_reach(*leaf, range);
    box.expand(Box3d{{p.west, p.north - r.height() * p.dy, range.lo - reach},
                     {p.west + r.width() * p.dx, p.north, range.hi + reach}});
  }
  for (const auto* cloud : program.clouds)
    if (cloud->size() > 0) box.expand(Box3d{to_double(cloud->bounds().lo), to_double(cloud->bounds().hi)});
  for (const auto* leaf : program.domains) {
    const Box3d& d = leaf->domain.box;
    box.expand(Box3d{d.lo, {d.hi.x, d.hi.y, d.lo.z}});
  }
  for (const auto& nested : program.nested) box.expand(nested->bounds());
  return box;
}

}  // namespace tafoni::field::impl
