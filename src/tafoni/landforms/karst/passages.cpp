#include "tafoni/landforms/karst/passages.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "tafoni/core/random.h"
#include "tafoni/landforms/rock/erosion.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/math/noise.h"
#include "tafoni/math/smoothstep.h"

namespace tafoni::landforms::impl {
namespace {

/// Catmull-Rom between b and c.
Vec3d spline(Vec3d a, Vec3d b, Vec3d c, Vec3d d, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return 0.5 *
         (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2 + (3.0 * b - a - 3.0 * c + d) * t3);
}

class Shaper {
 public:
  Shaper(const field::CompiledField& field, const Ground& ground, const Percolation& percolation,
         const PassageSettings& s)
      : field_(field), ground_(ground), nodes_(percolation.nodes), percolation_(percolation), s_(s) {}

  CaveSystem run() {
    gather();
    widths();
    drop_dead_ends();
    name_networks();
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (kept_[i] && nodes_[i].parent < 0) walk_from_seed(i);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (kept_[i] && nodes_[i].parent >= 0 && !walked_[i]) walk_branch(i);
    for (const auto& [a, b] : percolation_.merges)
      add({at(a), at(b)}, {radius_[index(a)], radius_[index(b)]}, a);
    for (const CaveExit& exit : percolation_.exits) leave(exit);
    chambers();
    return std::move(caves_);
  }

 private:
  static std::size_t index(std::int32_t i) { return static_cast<std::size_t>(i); }
  Vec3d at(std::int32_t i) const { return nodes_[index(i)].position; }

  void gather() {
    children_.resize(nodes_.size());
    beyond_.assign(nodes_.size(), 1);
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      if (nodes_[i].parent < 0) continue;
      children_[index(nodes_[i].parent)].push_back(static_cast<std::int32_t>(i));
      beyond_[index(nodes_[i].parent)] += beyond_[i];
    }
  }

  /// The stress of a passage grows with what drains through it: the trunk near its seed most of all.
  void widths() {
    std::vector<double> most(nodes_.size(), 1.0);
    radius_.resize(nodes_.size());
    effect_.resize(nodes_.size());
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      const std::int32_t parent = nodes_[i].parent;
      most[i] = parent < 0 ? beyond_[i] : most[index(parent)];
      const double stress = 0.3 + 0.7 * std::sqrt(beyond_[i] / most[i]);
      effect_[i] = erosion_effect(nodes_[i].resistance, stress, s_.beta);
      radius_[i] = s_.radius * std::clamp(0.6 + 0.9 * effect_[i], 0.6, 1.5);
    }
  }

  /// Where ways meet or the rock is weak a room breaks out, if the rock around bears it.
  void chambers() {
    if (s_.chambers <= 0) return;
    std::vector<int> ways(nodes_.size(), 0);
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (kept_[i] && nodes_[i].parent >= 0) ++ways[i], ++ways[index(nodes_[i].parent)];
    for (const auto& [a, b] : percolation_.merges) ways[index(a)] += 2, ways[index(b)] += 2;
    SpatialHash rooms(8 * s_.spacing);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!kept_[i] || nodes_[i].parent < 0) continue;
      Random random(s_.seed, i);
      const double weak = 1 - smoothstep(0.1, 0.5, nodes_[i].resistance);
      const double chance = s_.chambers *
                            (ways[i] > 3    ? 0.7
                             : ways[i] == 3 ? 0.4
                                            : 0.08) *
                            (0.3 + 0.7 * weak);
      if (random.uniform() > chance || rooms.any_near(at(static_cast<std::int32_t>(i)), 3.5 * s_.spacing))
        continue;
      const double radius = s_.radius * (2.2 + 2.4 * random.uniform() * (0.4 + 0.6 * weak));
      if (!bears(nodes_[i].position, radius)) continue;
      rooms.insert(nodes_[i].position);
      Vec3d center = nodes_[i].position;
      wind({&center, 1});
      caves_.chambers.push_back({center, radius});
    }
  }

  bool bears(Vec3d p, double radius) const {
    for (const Vec3d d :
         {Vec3d{0, 0, 1.3}, {1.4, 0, 0}, {-1.4, 0, 0}, {0, 1.4, 0}, {0, -1.4, 0}, {0, 0, -0.8}})
      if (field_.value(p + d * radius) <= 0) return false;
    return ground_.usable(p, 1.4 * radius);
  }

  void drop_dead_ends() {
    kept_.assign(nodes_.size(), true);
    std::vector<bool> needed(nodes_.size(), false);
    for (const auto& [a, b] : percolation_.merges) needed[index(a)] = needed[index(b)] = true;
    for (const CaveExit& exit : percolation_.exits) needed[index(exit.node)] = true;
    for (std::size_t i = nodes_.size(); i-- > 0;) {
      for (std::int32_t c : children_[i]) needed[i] = needed[i] || kept_[index(c)];
      kept_[i] = needed[i] || effect_[i] >= s_.threshold;
    }
    // A seed that led nowhere leaves no mark.
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].parent < 0 && (beyond_[i] < 4 && !needed[i])) kept_[i] = false;
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].parent >= 0 && !kept_[index(nodes_[i].parent)]) kept_[i] = false;
  }

  void name_networks() {
    std::vector<std::int32_t> joined(nodes_.size());
    std::iota(joined.begin(), joined.end(), 0);
    const auto root = [&](std::int32_t i) {
      while (joined[index(i)] != i) i = joined[index(i)];
      return i;
    };
    for (std::size_t i = 0; i < nodes_.size(); ++i)
      if (nodes_[i].parent >= 0) joined[i] = root(nodes_[i].parent);
    for (const auto& [a, b] : percolation_.merges) joined[index(root(a))] = root(b);
    std::vector<std::int32_t> names(nodes_.size(), -1);
    network_.assign(nodes_.size(), -1);
    for (std::size_t i = 0; i < nodes_.size(); ++i) {
      if (!kept_[i]) continue;
      std::int32_t& name = names[index(root(static_cast<std::int32_t>(i)))];
      if (name < 0) name = caves_.networks++;
      network_[i] = name;
    }
    walked_.assign(nodes_.size(), false);
  }

  /// The child most of the water comes from, among those not walked yet.
  std::int32_t main_child(std::int32_t node) const {
    std::int32_t best = -1;
    for (std::int32_t c : children_[index(node)])
      if (kept_[index(c)] && !walked_[index(c)] && (best < 0 || beyond_[index(c)] > beyond_[index(best)]))
        best = c;
    return best;
  }

  void follow(std::int32_t node, std::vector<Vec3d>& line, std::vector<double>& radius) {
    for (; node >= 0; node = main_child(node)) {
      walked_[index(node)] = true;
      line.push_back(at(node));
      radius.push_back(radius_[index(node)]);
    }
  }

  void walk_from_seed(std::size_t seed) {
    const Vec3d p = nodes_[seed].position;
    float value = 0;
    Vec3f gradient;
    field_.gradients({&p, 1}, {&value, 1}, {&gradient, 1});
    std::vector<Vec3d> line;
    std::vector<double> radius;
    if (std::abs(value) < 1) {
      const Vec3d outward = normalized(-to_double(gradient));
      const double mouth = 1.25 * radius_[seed];
      line.push_back(p + outward * mouth);
      radius.push_back(mouth);
      radius_[seed] = mouth;
      caves_.entrances.push_back(p);
      if (outward.z > 0.8) caves_.swallets.push_back(p);
    }
    follow(static_cast<std::int32_t>(seed), line, radius);
    add(line, radius, static_cast<std::int32_t>(seed));
  }

  void walk_branch(std::size_t node) {
    std::vector<Vec3d> line = {at(nodes_[node].parent)};
    std::vector<double> radius = {std::min(radius_[index(nodes_[node].parent)], radius_[node])};
    follow(static_cast<std::int32_t>(node), line, radius);
    add(line, radius, static_cast<std::int32_t>(node));
  }

  void leave(const CaveExit& exit) {
    if (!kept_[index(exit.node)]) return;
    const double r = radius_[index(exit.node)], mouth = 1.3 * r;
    add({at(exit.node), exit.position, exit.position + exit.outward * mouth}, {r, mouth, mouth}, exit.node);
    caves_.entrances.push_back(exit.position);
  }

  /// A smooth line through the given places, displaced by noise of the place itself, so that passages which
  /// share a node still meet.
  void add(const std::vector<Vec3d>& line, const std::vector<double>& radius, std::int32_t node) {
    if (line.size() < 2 || !kept_[index(node)]) return;
    Passage passage;
    passage.network = network_[index(node)];
    const auto n = static_cast<std::int64_t>(line.size());
    const auto point = [&](std::int64_t i) {
      return line[static_cast<std::size_t>(std::clamp<std::int64_t>(i, 0, n - 1))];
    };
    const double step = place_step * s_.radius;
    for (std::int64_t i = 0; i + 1 < n; ++i) {
      const double span = length(point(i + 1) - point(i));
      const int pieces = std::max(1, static_cast<int>(std::ceil(span / step)));
      for (int k = 0; k < pieces + (i + 2 == n); ++k) {
        const double t = static_cast<double>(k) / pieces;
        const double r0 = radius[static_cast<std::size_t>(i)], r1 = radius[static_cast<std::size_t>(i) + 1];
        passage.line.push_back(spline(point(i - 1), point(i), point(i + 1), point(i + 2), t));
        passage.radius.push_back(r0 + (r1 - r0) * t * t * (3 - 2 * t));
      }
    }
    wind(passage.line);
    for (std::size_t i = 0; i + 1 < passage.line.size(); ++i)
      caves_.length += length(passage.line[i + 1] - passage.line[i]);
    caves_.passages.push_back(std::move(passage));
  }

  void wind(std::span<Vec3d> line) const {
    std::vector<Vec3d> world;
    for (Vec3d p : line) world.push_back((p + ground_.site().origin) * (1 / (0.8 * s_.spacing)));
    const double amplitude = 0.9 * s_.winding * s_.spacing;
    std::vector<float> noise(line.size());
    for (const Vec3d axis : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, 0.35}}) {
      fbm(world, 2, hash_combine(s_.seed, axis.x > 0 ? 1 : axis.y > 0 ? 2 : 3), noise);
      for (std::size_t i = 0; i < line.size(); ++i)
        line[i] += axis * (amplitude * (static_cast<double>(noise[i]) - 0.5));
    }
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const std::vector<CaveNode>& nodes_;
  const Percolation& percolation_;
  const PassageSettings& s_;
  std::vector<std::vector<std::int32_t>> children_;
  std::vector<double> beyond_;  ///< nodes from here on, itself included
  std::vector<double> radius_, effect_;
  std::vector<bool> kept_, walked_;
  std::vector<std::int32_t> network_;
  CaveSystem caves_;
};

}  // namespace

CaveSystem make_passages(const field::CompiledField& field, const Ground& ground,
                         const Percolation& percolation, const PassageSettings& settings) {
  return Shaper(field, ground, percolation, settings).run();
}

std::vector<bool> open_networks(const field::CompiledField& field, const CaveSystem& caves) {
  std::vector<bool> open(static_cast<std::size_t>(caves.networks), true);
  for (const Passage& passage : caves.passages) {
    // Between the places too, where a way closes first.
    std::vector<Vec3d> way = passage.line;
    for (std::size_t i = 0; i + 1 < passage.line.size(); ++i)
      way.push_back(0.5 * (passage.line[i] + passage.line[i + 1]));
    std::vector<float> values(way.size());
    field.values(way, values);
    if (std::any_of(values.begin(), values.end(), [](float f) { return f >= 0; }))
      open[static_cast<std::size_t>(passage.network)] = false;
  }
  return open;
}

}  // namespace tafoni::landforms::impl
