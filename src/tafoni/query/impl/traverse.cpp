// How trees of triangles are searched, compiled for every instruction set.

#include <algorithm>
#include <cmath>

#include <hwy/highway.h>

#include "tafoni/math/simd.h"
#include "tafoni/query/impl/triangle_tree.h"

#ifndef TAFONI_QUERY_TRAVERSE_ONCE
#define TAFONI_QUERY_TRAVERSE_ONCE
namespace tafoni::query::impl {

using Layout = TriangleTree::Layout;

/// A path clipped to the tree, in float. `half` is grown by what float can lose.
struct Probe {
  float from[3], along[3], inverse[3], half[3], axis[3];
  float radius, slack;
  double begin, scale;  ///< share of the path = begin + scale * share of the probe
  float end;            ///< share of the probe
};

struct Around {
  float at[3];
  float slack;
};

using PathFound = double (*)(void*, const Triangle&, double end);
using AroundFound = double (*)(void*, const Triangle&, double distance);

inline Triangle triangle_of(const TriangleTree::Block& block, int lane) {
  Triangle t;
  for (int c = 0; c < 3; ++c) t.v[c] = {block.v[c][0][lane], block.v[c][1][lane], block.v[c][2][lane]};
  return t;
}

/// Nodes yet to be looked at; the nearest of those last found is on top.
struct Stack {
  struct Entry {
    float near;
    std::uint32_t index;
    int level;  ///< 0: a block
  };
  Entry entries[11 * TriangleTree::width];
  int count = 0;

  void push(unsigned mask, const float* near, std::uint32_t first, int level) {
    const int bottom = count;
    for (; mask; mask &= mask - 1) {
      const int lane = __builtin_ctz(mask);
      int at = count++;
      for (; at > bottom && entries[at - 1].near < near[lane]; --at) entries[at] = entries[at - 1];
      entries[at] = {near[lane], first + lane, level};
    }
  }
  Entry pop() { return entries[--count]; }
};

}  // namespace tafoni::query::impl
#endif

HWY_BEFORE_NAMESPACE();
namespace tafoni::query::impl {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

constexpr int width = TriangleTree::width;
using F = hn::CappedTag<float, width>;
using V = hn::Vec<F>;
using M = hn::Mask<F>;

HWY_INLINE unsigned bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(F(), mask, bytes);
  return bytes[0];
}

struct Slab {
  V near, far;
};

HWY_INLINE Slab slab(V lo, V hi, const Probe& p, int axis, Slab so_far) {
  const F d;
  const V from = hn::Set(d, p.from[axis]), inverse = hn::Set(d, p.inverse[axis]),
          half = hn::Set(d, p.half[axis]);
  const V a = hn::Mul(hn::Sub(hn::Sub(lo, half), from), inverse);
  const V b = hn::Mul(hn::Sub(hn::Add(hi, half), from), inverse);
  return {hn::Max(so_far.near, hn::Min(a, b)), hn::Min(so_far.far, hn::Max(a, b))};
}

/// Children that the probe may meet before `end`, and when.
HWY_INLINE unsigned meet_boxes(const TriangleTree::Node& node, const Probe& p, float end, float* near) {
  const F d;
  unsigned mask = 0;
  for (std::size_t i = 0; i < width; i += hn::Lanes(d)) {
    Slab s{hn::Zero(d), hn::Set(d, end)};
    for (int axis = 0; axis < 3; ++axis)
      s = slab(hn::Load(d, node.lo[axis] + i), hn::Load(d, node.hi[axis] + i), p, axis, s);
    hn::Store(s.near, d, near + i);
    mask |= bits_of(hn::Le(s.near, s.far)) << i;
  }
  return mask;
}

struct Corners {
  V v[3][3];
};
HWY_INLINE Corners corners_of(const TriangleTree::Block& block, std::size_t i) {
  const F d;
  Corners c;
  for (int corner = 0; corner < 3; ++corner)
    for (int axis = 0; axis < 3; ++axis) c.v[corner][axis] = hn::Load(d, block.v[corner][axis] + i);
  return c;
}
HWY_INLINE void normal_of(const Corners& c, V n[3]) {
  V u[3], w[3];
  for (int axis = 0; axis < 3; ++axis) {
    u[axis] = hn::Sub(c.v[1][axis], c.v[0][axis]);
    w[axis] = hn::Sub(c.v[2][axis], c.v[0][axis]);
  }
  for (int axis = 0; axis < 3; ++axis) {
    const int a = (axis + 1) % 3, b = (axis + 2) % 3;
    n[axis] = hn::Sub(hn::Mul(u[a], w[b]), hn::Mul(u[b], w[a]));
  }
}
HWY_INLINE V dot3(const V* a, const V* b) {
  return hn::Add(hn::Add(hn::Mul(a[0], b[0]), hn::Mul(a[1], b[1])), hn::Mul(a[2], b[2]));
}

/// Lanes whose triangle's box, and whose plane, the probe may meet.
HWY_INLINE unsigned meet_triangles(const TriangleTree::Block& block, const Probe& p, float end) {
  const F d;
  unsigned mask = 0;
  for (std::size_t i = 0; i < width; i += hn::Lanes(d)) {
    const Corners c = corners_of(block, i);
    Slab s{hn::Zero(d), hn::Set(d, end)};
    for (int axis = 0; axis < 3; ++axis)
      s = slab(hn::Min(hn::Min(c.v[0][axis], c.v[1][axis]), c.v[2][axis]),
               hn::Max(hn::Max(c.v[0][axis], c.v[1][axis]), c.v[2][axis]), p, axis, s);
    const M boxed = hn::Le(s.near, s.far);
    if (hn::AllFalse(d, boxed)) continue;
    V n[3], offset[3], motion[3], axis_half[3], ones[3];
    normal_of(c, n);
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] = hn::Sub(hn::Set(d, p.from[axis]), c.v[0][axis]);
      motion[axis] = hn::Set(d, p.along[axis]);
      axis_half[axis] = hn::Set(d, p.axis[axis]);
      ones[axis] = hn::Abs(n[axis]);
    }
    const V first = dot3(offset, n), last = hn::Add(first, hn::Mul(hn::Set(d, end), dot3(motion, n)));
    const V size = hn::Sqrt(dot3(n, n));
    const V sum = hn::Add(hn::Add(ones[0], ones[1]), ones[2]);
    const V reach = hn::Add(hn::Add(hn::Abs(dot3(axis_half, n)), hn::Mul(hn::Set(d, p.radius), size)),
                            hn::Mul(hn::Set(d, p.slack), sum));
    const M off = hn::Or(hn::Gt(hn::Min(first, last), reach), hn::Lt(hn::Max(first, last), hn::Neg(reach)));
    mask |= bits_of(hn::AndNot(off, boxed)) << i;
  }
  return mask;
}

/// Squared distances from the point to boxes, and which are within `limit`.
HWY_INLINE V box_distance(const V* lo, const V* hi, const Around& p) {
  const F d;
  V sum = hn::Zero(d);
  for (int axis = 0; axis < 3; ++axis) {
    const V at = hn::Set(d, p.at[axis]);
    const V off = hn::Max(hn::Max(hn::Sub(lo[axis], at), hn::Sub(at, hi[axis])), hn::Zero(d));
    sum = hn::Add(sum, hn::Mul(off, off));
  }
  return sum;
}

HWY_INLINE unsigned near_boxes(const TriangleTree::Node& node, const Around& p, float limit, float* near) {
  const F d;
  unsigned mask = 0;
  for (std::size_t i = 0; i < width; i += hn::Lanes(d)) {
    V lo[3], hi[3];
    for (int axis = 0; axis < 3; ++axis)
      lo[axis] = hn::Load(d, node.lo[axis] + i), hi[axis] = hn::Load(d, node.hi[axis] + i);
    const V squared = box_distance(lo, hi, p);
    hn::Store(squared, d, near + i);
    mask |= bits_of(hn::Le(squared, hn::Set(d, limit * limit))) << i;
  }
  return mask;
}

HWY_INLINE unsigned near_triangles(const TriangleTree::Block& block, const Around& p, float limit) {
  const F d;
  unsigned mask = 0;
  const V most = hn::Set(d, limit * limit);
  for (std::size_t i = 0; i < width; i += hn::Lanes(d)) {
    const Corners c = corners_of(block, i);
    V lo[3], hi[3], n[3], offset[3];
    for (int axis = 0; axis < 3; ++axis) {
      lo[axis] = hn::Min(hn::Min(c.v[0][axis], c.v[1][axis]), c.v[2][axis]);
      hi[axis] = hn::Max(hn::Max(c.v[0][axis], c.v[1][axis]), c.v[2][axis]);
      offset[axis] = hn::Sub(hn::Set(d, p.at[axis]), c.v[0][axis]);
    }
    normal_of(c, n);
    const V height = dot3(offset, n);
    const M near = hn::Le(box_distance(lo, hi, p), most);
    const M level = hn::Le(hn::Mul(height, height), hn::Mul(most, dot3(n, n)));
    mask |= bits_of(hn::And(near, level)) << i;
  }
  return mask;
}

/// What is looked for along a path: shares of it.
struct AlongSearch {
  const Probe& p;
  PathFound found;
  void* context;
  float end = p.end;
  double best = p.begin + p.scale * end;

  bool beyond(float near) const { return near > end; }
  unsigned boxes(const TriangleTree::Node& node, float* near) const { return meet_boxes(node, p, end, near); }
  unsigned triangles(const TriangleTree::Block& block) const { return meet_triangles(block, p, end); }
  bool take(const Triangle& triangle) {
    const double now = found(context, triangle, best);
    if (now >= best) return true;
    best = now;
    end = std::min(p.end, static_cast<float>((best - p.begin) / p.scale) + 1e-6f);
    return best >= p.begin;
  }
};

/// What is looked for around a point: distances, squared where they are a box's.
struct AroundSearch {
  const Around& p;
  AroundFound found;
  void* context;
  double distance;
  float limit = static_cast<float>(distance) + p.slack;

  bool beyond(float near) const { return near > limit * limit; }
  unsigned boxes(const TriangleTree::Node& node, float* near) const {
    return near_boxes(node, p, limit, near);
  }
  unsigned triangles(const TriangleTree::Block& block) const { return near_triangles(block, p, limit); }
  bool take(const Triangle& triangle) {
    const double now = found(context, triangle, distance);
    if (now >= distance) return true;
    distance = now;
    limit = static_cast<float>(distance) + p.slack;
    return distance >= 0;
  }
};

/// Near boxes first; what the search has found meanwhile leaves out those behind. take() says whether to go
/// on.
template <class Search>
HWY_INLINE void traverse(const Layout& tree, Search search) {
  Stack stack;
  stack.entries[stack.count++] = {0, 0, tree.levels};
  while (stack.count > 0) {
    const Stack::Entry e = stack.pop();
    if (search.beyond(e.near)) continue;
    if (e.level > 0) {
      alignas(32) float near[width];
      const unsigned mask = search.boxes(tree.nodes[tree.first[e.level - 1] + e.index], near);
      stack.push(mask, near, e.index * width, e.level - 1);
      continue;
    }
    const TriangleTree::Block& block = tree.blocks[e.index];
    for (unsigned mask = search.triangles(block); mask; mask &= mask - 1)
      if (!search.take(triangle_of(block, __builtin_ctz(mask)))) return;
  }
}

void along_kernel(const Layout& tree, const Probe& p, PathFound found, void* context) {
  traverse(tree, AlongSearch{p, found, context});
}
void around_kernel(const Layout& tree, const Around& p, double distance, AroundFound found, void* context) {
  traverse(tree, AroundSearch{p, found, context, distance});
}

}  // namespace HWY_NAMESPACE
}  // namespace tafoni::query::impl
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace tafoni::query::impl {
namespace {

HWY_EXPORT(along_kernel);
HWY_EXPORT(around_kernel);

/// What rounding positions and half sides of this size to float may lose, with room to spare.
float slack_of(const Box3f& box, double reach) {
  float most = static_cast<float>(reach);
  for (float v : {box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z})
    most = std::max(most, std::abs(v));
  return 2e-6f * most + 1e-6f;
}

}  // namespace

void TriangleTree::along(const Path& path, PathFound found, void* context) const {
  if (empty()) return;
  [[maybe_unused]] static const bool limited = (limit_simd(), true);
  Probe p{};
  const double from[3] = {path.from.x, path.from.y, path.from.z};
  const double delta[3] = {path.along.x, path.along.y, path.along.z};
  const double axis[3] = {path.half.x, path.half.y, path.half.z};
  const double lo[3] = {bounds_.lo.x, bounds_.lo.y, bounds_.lo.z};
  const double hi[3] = {bounds_.hi.x, bounds_.hi.y, bounds_.hi.z};
  p.slack = slack_of(bounds_, path.radius + length(path.half));
  double begin = path.begin, end = path.end;
  for (int a = 0; a < 3; ++a) {
    const double half = std::abs(axis[a]) + path.radius + p.slack;
    const double near = lo[a] - half - from[a], far = hi[a] + half - from[a];
    if (delta[a] == 0) {
      if (near > 0 || far < 0) return;
    } else {
      const double s = near / delta[a], t = far / delta[a];
      begin = std::max(begin, std::min(s, t));
      end = std::min(end, std::max(s, t));
    }
    p.half[a] = static_cast<float>(half);
    p.axis[a] = static_cast<float>(axis[a]);
  }
  if (begin > end) return;
  p.begin = begin;
  p.scale = end > begin ? end - begin : 1;
  p.radius = static_cast<float>(path.radius);
  p.end = end > begin ? 1.0f : 0.0f;
  for (int a = 0; a < 3; ++a) {
    p.from[a] = static_cast<float>(from[a] + delta[a] * begin);
    p.along[a] = static_cast<float>(delta[a] * p.scale);
    const float safe = std::abs(p.along[a]) < 1e-30f ? std::copysign(1e-30f, p.along[a]) : p.along[a];
    p.inverse[a] = 1 / safe;
  }
  HWY_DYNAMIC_DISPATCH(along_kernel)(layout(), p, found, context);
}

void TriangleTree::around(Vec3d at, double distance, AroundFound found, void* context) const {
  if (empty()) return;
  [[maybe_unused]] static const bool limited = (limit_simd(), true);
  const Vec3f center = to_float(at);
  Around p{{center.x, center.y, center.z}, 0};
  p.slack = slack_of(bounds_, std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}));
  HWY_DYNAMIC_DISPATCH(around_kernel)(layout(), p, distance, found, context);
}

}  // namespace tafoni::query::impl
#endif
