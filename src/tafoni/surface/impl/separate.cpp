// Gives every fan of triangles around a vertex a vertex of its own: corners of triangles are joined across
// the edges that they share, and where more than two triangles meet at an edge, across the solid between
// them.

#include "tafoni/surface/impl/separate.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "tafoni/mesh/inner/size32.h"
#include "tafoni/mesh/inner/topology.h"

namespace tafoni::surface::impl {

namespace {

using mesh::inner::Sets;
using mesh::inner::Triangle;

using Index = std::uint32_t;
constexpr Index none = ~Index{0};

/// A triangle's edge from its corner c to the next; `corner` is 3 * triangle + c.
struct Half {
  Index low, high, corner;
  bool forward;  ///< from low to high
};

Index next_corner(Index corner) {
  return corner % 3 == 2 ? corner - 2 : corner + 1;
}

class Separation {
 public:
  Separation(mesh::Mesh& mesh, std::vector<std::uint8_t>& tags) : mesh_(mesh), tags_(tags), sets_(0) {}

  void run() {
    drop_covered();
    sets_.reset(3 * mesh_.triangles.size());
    pair_edges();
    number();
    cut_double_edges();
  }

 private:
  /// Pairs of triangles of the same vertices and opposite orientation.
  void drop_covered() {
    struct Key {
      Triangle sorted;
      Index at;
      bool even;
    };
    std::vector<Key> keys;
    keys.reserve(mesh_.triangles.size());
    for (Index i = 0; i < mesh_.triangles.size(); ++i) {
      Triangle t = mesh_.triangles[i];
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      const bool even = t[1] < t[2];
      if (!even) std::swap(t[1], t[2]);
      keys.push_back({t, i, even});
    }
    std::sort(keys.begin(), keys.end(), [](const Key& a, const Key& b) {
      return a.sorted != b.sorted ? a.sorted < b.sorted : a.at < b.at;
    });
    std::vector<bool> gone(keys.size(), false);
    for (std::size_t from = 0, to = 0; from < keys.size(); from = to) {
      while (to < keys.size() && keys[to].sorted == keys[from].sorted) ++to;
      for (std::size_t a = from; a < to; ++a)
        for (std::size_t b = a + 1; b < to && !gone[keys[a].at]; ++b)
          if (keys[a].even != keys[b].even && !gone[keys[b].at]) gone[keys[a].at] = gone[keys[b].at] = true;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < gone.size(); ++i) {
      if (gone[i]) continue;
      mesh_.triangles[kept] = mesh_.triangles[i];
      tags_[kept++] = tags_[i];
    }
    mesh_.triangles.resize(kept);
    tags_.resize(kept);
  }

  Index vertex(Index corner) const { return mesh_.triangles[corner / 3][corner % 3]; }

  void pair_edges() {
    std::vector<Half> halves;
    halves.reserve(3 * mesh_.triangles.size());
    for (Index c = 0; c < 3 * mesh_.triangles.size(); ++c) {
      const Index a = vertex(c), b = vertex(next_corner(c));
      halves.push_back({std::min(a, b), std::max(a, b), c, a < b});
    }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
      if (a.low != b.low) return a.low < b.low;
      return a.high != b.high ? a.high < b.high : a.corner < b.corner;
    });
    for (std::size_t from = 0, to = 0; from < halves.size(); from = to) {
      while (to < halves.size() && halves[to].low == halves[from].low && halves[to].high == halves[from].high)
        ++to;
      if (to - from == 2)
        join(halves[from].corner, halves[from + 1].corner);
      else
        pair_fan({halves.begin() + from, halves.begin() + to});
    }
  }

  void join(Index a, Index b) {
    sets_.join(a, next_corner(b));
    sets_.join(next_corner(a), b);
  }

  /// Turning about the edge counter-clockwise seen from its high end, a backward triangle is where solid
  /// begins and the next forward one where it ends.
  void pair_fan(const std::vector<Half>& fan) {
    const Vec3d from = to_double(mesh_.positions[fan[0].low]), to = to_double(mesh_.positions[fan[0].high]);
    const Vec3d axis = normalized(to - from);
    const Vec3d side = std::abs(axis.z) < 0.7 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
    const Vec3d u = normalized(cross(side, axis)), v = cross(axis, u);
    struct Turn {
      std::int64_t angle;  ///< rounded, so that triangles of one plane tie
      bool begins;
      Index corner;
    };
    std::vector<Turn> turns;
    for (const Half& h : fan) {
      const Vec3d d = to_double(mesh_.positions[vertex(next_corner(next_corner(h.corner)))]) - from;
      const double angle = std::atan2(dot(d, v), dot(d, u));
      turns.push_back({std::llround(angle * 1e6), !h.forward, h.corner});
    }
    // pi and -pi are one direction.
    for (Turn& t : turns)
      if (t.angle <= -3141592) t.angle += 6283185;
    std::sort(turns.begin(), turns.end(), [](const Turn& a, const Turn& b) {
      if (a.angle != b.angle) return a.angle < b.angle;
      return a.begins != b.begins ? b.begins : a.corner < b.corner;
    });
    std::vector<bool> taken(turns.size(), false);
    for (std::size_t i = 0; i < turns.size(); ++i) {
      if (!turns[i].begins) continue;
      for (std::size_t step = 1; step < turns.size(); ++step) {
        const std::size_t k = (i + step) % turns.size();
        if (turns[k].begins || taken[k]) continue;
        taken[k] = true;
        join(turns[i].corner, turns[k].corner);
        crowded_.push_back({turns[i].corner, turns[k].corner});
        break;
      }
    }
  }

  /// A vertex a set of corners.
  void number() {
    const std::size_t corners = 3 * mesh_.triangles.size();
    std::vector<Index> id(corners, none);
    // The roots of each vertex, in the order of their lowest corner.
    std::vector<std::pair<Index, Index>> roots;
    for (Index c = 0; c < corners; ++c)
      if (sets_.root(c) == c) roots.emplace_back(vertex(c), c);
    std::sort(roots.begin(), roots.end());
    std::vector<Vec3f> positions;
    positions.reserve(roots.size());
    for (auto [v, c] : roots) {
      id[c] = mesh::inner::size32(positions);
      positions.push_back(mesh_.positions[v]);
    }
    for (Index c = 0; c < corners; ++c) id[c] = id[sets_.root(c)];
    for (Index c = 0; c < corners; ++c) mesh_.triangles[c / 3][c % 3] = id[c];
    mesh_.positions = std::move(positions);
  }

  void cut_double_edges() {
    std::map<std::pair<Index, Index>, int> seen;
    std::map<Index, std::array<Index, 3>> middles;  // by triangle: of each edge
    for (auto [a, b] : crowded_) {
      const auto ends = std::minmax({vertex(a), vertex(next_corner(a))});
      if (seen[{ends.first, ends.second}]++ == 0) continue;
      const Index middle = mesh::inner::size32(mesh_.positions);
      mesh_.positions.push_back((mesh_.positions[ends.first] + mesh_.positions[ends.second]) * 0.5f);
      for (Index c : {a, b})
        middles.try_emplace(c / 3, std::array{none, none, none}).first->second[c % 3] = middle;
    }
    for (const auto& [t, m] : middles) cut(t, m);
  }

  void cut(Index at, std::array<Index, 3> m) {
    Triangle v = mesh_.triangles[at];
    const auto put = [&](std::initializer_list<Triangle> all) {
      mesh_.triangles[at] = *all.begin();
      for (const Triangle* t = all.begin() + 1; t != all.end(); ++t) {
        mesh_.triangles.push_back(*t);
        tags_.push_back(tags_[at]);
      }
    };
    const auto cuts = std::count_if(m.begin(), m.end(), [](Index i) { return i != none; });
    // Turned so that the first edge is cut and the last one is not.
    while (cuts < 3 && (m[0] == none || m[2] != none)) {
      std::rotate(v.begin(), v.begin() + 1, v.end());
      std::rotate(m.begin(), m.begin() + 1, m.end());
    }
    if (cuts == 1)
      put({{v[0], m[0], v[2]}, {m[0], v[1], v[2]}});
    else if (cuts == 2)
      put({{v[0], m[0], m[1]}, {m[0], v[1], m[1]}, {v[0], m[1], v[2]}});
    else
      put({{v[0], m[0], m[2]}, {m[0], v[1], m[1]}, {m[2], m[1], v[2]}, {m[0], m[1], m[2]}});
  }

  mesh::Mesh& mesh_;
  std::vector<std::uint8_t>& tags_;
  Sets sets_;
  std::vector<std::pair<Index, Index>> crowded_;  ///< pairs at edges of more than two triangles
};

}  // namespace

void separate(mesh::Mesh& mesh, std::vector<std::uint8_t>& tags) {
  Separation(mesh, tags).run();
}

}  // namespace tafoni::surface::impl
