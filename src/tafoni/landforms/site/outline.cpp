// A polygon's edges in a tree of bounding rectangles, halved by the median of the longer side. Being inside
// is a count of crossings, distance a search that leaves out what lies farther away than the best so far.

#include "tafoni/landforms/site/outline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace tafoni::landforms::impl {
namespace {

constexpr std::uint32_t leaf = 8;  // edges that are not parted further
/// Spans are halved, so 32 levels hold all that 32 bits can number; a walk keeps one span a level.
constexpr std::size_t levels = 40;

}  // namespace

Outline::Outline(const std::vector<Ring>& rings) {
  for (const Ring& ring : rings)
    for (std::size_t i = 0, j = ring.size() - 1; i < ring.size(); j = i++)
      edges_.push_back({ring[i], ring[j]});
  if (!edges_.empty()) build(0, static_cast<std::uint32_t>(edges_.size()));
}

void Outline::build(std::uint32_t begin, std::uint32_t end) {
  const std::size_t self = spans_.size();
  Span span{edges_[begin].a, edges_[begin].a, begin, end, 0};
  for (std::uint32_t i = begin; i < end; ++i)
    for (Vec2d p : {edges_[i].a, edges_[i].b}) {
      span.lo = {std::min(span.lo.x, p.x), std::min(span.lo.y, p.y)};
      span.hi = {std::max(span.hi.x, p.x), std::max(span.hi.y, p.y)};
    }
  spans_.push_back(span);
  if (end - begin <= leaf) return;
  const bool by_x = span.hi.x - span.lo.x > span.hi.y - span.lo.y;
  const std::uint32_t middle = begin + (end - begin) / 2;
  const auto at = [&](std::uint32_t i) { return edges_.begin() + i; };
  std::nth_element(at(begin), at(middle), at(end), [by_x](const Edge& a, const Edge& b) {
    return by_x ? a.a.x + a.b.x < b.a.x + b.b.x : a.a.y + a.b.y < b.a.y + b.b.y;
  });
  build(begin, middle);
  spans_[self].second = static_cast<std::uint32_t>(spans_.size());
  build(middle, end);
}

bool Outline::inside(Vec2d p) const {
  if (spans_.empty()) return false;
  bool odd = false;
  std::array<std::uint32_t, levels> stack{};
  for (std::size_t depth = 1; depth > 0;) {
    const std::uint32_t i = stack[--depth];
    const Span& span = spans_[i];
    if (p.y < span.lo.y || p.y > span.hi.y || p.x > span.hi.x) continue;
    if (span.second != 0) {
      stack[depth++] = span.second;
      stack[depth++] = i + 1;
      continue;
    }
    for (std::uint32_t e = span.begin; e < span.end; ++e) {
      const Vec2d a = edges_[e].a, b = edges_[e].b;
      if ((a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * ((p.y - a.y) / (b.y - a.y))) odd = !odd;
    }
  }
  return odd;
}

double Outline::gap2(const Span& span, Vec2d p) {
  const double x = std::max({span.lo.x - p.x, 0.0, p.x - span.hi.x});
  const double y = std::max({span.lo.y - p.y, 0.0, p.y - span.hi.y});
  return x * x + y * y;
}

double Outline::distance2(const Edge& edge, Vec2d p) {
  const Vec2d along = edge.b - edge.a, to = p - edge.a;
  const double length2 = along.x * along.x + along.y * along.y;
  const double t = length2 > 0 ? std::clamp((to.x * along.x + to.y * along.y) / length2, 0.0, 1.0) : 0.0;
  const Vec2d off = to - along * t;
  return off.x * off.x + off.y * off.y;
}

double Outline::distance(Vec2d p, double most) const {
  if (spans_.empty()) return most;
  double best = most * most;
  std::array<std::uint32_t, levels> stack{};
  for (std::size_t depth = 1; depth > 0;) {
    const std::uint32_t i = stack[--depth];
    const Span& span = spans_[i];
    if (gap2(span, p) >= best) continue;
    if (span.second == 0) {
      for (std::uint32_t e = span.begin; e < span.end; ++e) best = std::min(best, distance2(edges_[e], p));
      continue;
    }
    // The nearer half last, so that it is looked at first.
    const bool first = gap2(spans_[i + 1], p) < gap2(spans_[span.second], p);
    stack[depth++] = first ? span.second : i + 1;
    stack[depth++] = first ? i + 1 : span.second;
  }
  return std::min(most, std::sqrt(best));
}

Box3d Outline::bounds() const {
  if (spans_.empty()) return {};
  return {{spans_[0].lo.x, spans_[0].lo.y, 0}, {spans_[0].hi.x, spans_[0].hi.y, 0}};
}

}  // namespace tafoni::landforms::impl
