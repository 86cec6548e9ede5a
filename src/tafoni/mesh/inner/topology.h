#pragma once
// Edges of an index list, grouped by vertex in linear time.

#include <algorithm>
#include <array>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

namespace tafoni::mesh::inner {

using Triangle = std::array<std::uint32_t, 3>;

/// Calls body(low, high, forward, backward) once an undirected edge, by ascending low, then high:
/// how many triangles pass it from low to high and back. Triangles must name vertices below `vertices`;
/// those with a repeated vertex are skipped.
template <class Body>
void for_each_edge(std::span<const Triangle> triangles, std::size_t vertices, const Body& body);

/// Which vertices lie on an open border, as flags.
inline std::vector<bool> on_border(std::span<const Triangle> triangles, std::size_t vertices) {
  std::vector<bool> out(vertices, false);
  for_each_edge(triangles, vertices,
                [&](std::uint32_t a, std::uint32_t b, std::uint32_t forward, std::uint32_t backward) {
                  if (forward + backward == 1) out[a] = out[b] = true;
                });
  return out;
}

inline bool repeats_vertex(const Triangle& t) {
  return t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
}

/// Disjoint sets over vertices; the root of a set is its lowest vertex.
class Sets {
 public:
  explicit Sets(std::size_t n) { reset(n); }
  void reset(std::size_t n) {
    parents_.resize(n);
    std::iota(parents_.begin(), parents_.end(), 0u);
  }
  std::uint32_t root(std::uint32_t v) {
    while (parents_[v] != v) v = parents_[v] = parents_[parents_[v]];
    return v;
  }
  void join(std::uint32_t a, std::uint32_t b) {
    if (parents_[a] == parents_[b]) return;
    a = root(a), b = root(b);
    parents_[a < b ? b : a] = a < b ? a : b;
  }

 private:
  std::vector<std::uint32_t> parents_;
};

/// Triangles by vertex.
struct Incidence {
  std::vector<std::uint64_t> first;
  std::vector<std::uint32_t> list;

  std::span<const std::uint32_t> at(std::size_t vertex) const {
    return {list.begin() + first[vertex], list.begin() + first[vertex + 1]};
  }
};
inline Incidence incidence(std::span<const Triangle> triangles, std::size_t vertices) {
  Incidence out;
  out.first.assign(vertices + 1, 0);
  for (const Triangle& t : triangles)
    for (auto v : t) ++out.first[v + 1];
  for (std::size_t v = 0; v < vertices; ++v) out.first[v + 1] += out.first[v];
  out.list.resize(out.first[vertices]);
  std::vector<std::uint64_t> next(out.first.begin(), out.first.end() - 1);
  for (std::uint32_t i = 0; i < triangles.size(); ++i)
    for (auto v : triangles[i]) out.list[next[v]++] = i;
  return out;
}

/// Counts the fans of triangles around a vertex that hang together by shared edges.
class FanCounter {
 public:
  std::size_t count(std::span<const Triangle> triangles, std::span<const std::uint32_t> around,
                    std::uint32_t vertex) {
    rim_.clear();
    for (auto i : around)
      for (auto v : triangles[i])
        if (v != vertex) rim_.push_back(v);
    sorted_ = rim_;
    std::sort(sorted_.begin(), sorted_.end());
    sorted_.erase(std::unique(sorted_.begin(), sorted_.end()), sorted_.end());
    const auto place = [&](std::uint32_t v) {
      return static_cast<std::uint32_t>(std::lower_bound(sorted_.begin(), sorted_.end(), v) -
                                        sorted_.begin());
    };
    sets_.reset(sorted_.size());
    for (std::size_t i = 0; i + 1 < rim_.size(); i += 2) sets_.join(place(rim_[i]), place(rim_[i + 1]));
    std::size_t fans = 0;
    for (std::uint32_t i = 0; i < sorted_.size(); ++i) fans += sets_.root(i) == i;
    return fans;
  }

 private:
  std::vector<std::uint32_t> rim_, sorted_;
  Sets sets_{0};
};

template <class Body>
void for_each_edge(std::span<const Triangle> triangles, std::size_t vertices, const Body& body) {
  // Half edges in buckets by their lower vertex: twice the higher vertex, plus one if it runs downward.
  std::vector<std::uint64_t> first(vertices + 1, 0);
  const auto each = [&](const auto& visit) {
    for (const Triangle& t : triangles) {
      if (repeats_vertex(t)) continue;
      for (std::size_t c = 0; c < 3; ++c) {
        const std::uint32_t a = t[c], b = t[c == 2 ? 0 : c + 1];
        visit(a < b ? a : b, a < b ? std::uint64_t{b} << 1 : (std::uint64_t{a} << 1) | 1);
      }
    }
  };
  each([&](std::uint32_t low, std::uint64_t) { ++first[low + 1]; });
  for (std::size_t v = 0; v < vertices; ++v) first[v + 1] += first[v];
  std::vector<std::uint64_t> halves(first[vertices]);
  std::vector<std::uint64_t> next(first.begin(), first.end() - 1);
  each([&](std::uint32_t low, std::uint64_t half) { halves[next[low]++] = half; });
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const auto begin = halves.begin() + first[v];
    const auto end = halves.begin() + first[v + 1];
    std::sort(begin, end);
    for (auto at = begin; at != end;) {
      const std::uint64_t high = *at >> 1;
      std::uint32_t uses[2] = {0, 0};
      for (; at != end && *at >> 1 == high; ++at) ++uses[*at & 1];
      body(v, static_cast<std::uint32_t>(high), uses[0], uses[1]);
    }
  }
}

}  // namespace tafoni::mesh::inner
