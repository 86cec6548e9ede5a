// Passages along the ways that water found: the trunk of a network first, then its branches. How much drains
// through a place decides how wide it is; noise of the place bends the line; rooms break out where ways meet
// or rock is weak.

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
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

enum class PassagesStream : std::uint64_t { winding_x = 1, winding_y, winding_z };

// Chosen by eye.
constexpr double least_stress = 0.3;  // of the last twig, as a share of the trunk's
constexpr double narrowest = 0.6, widest = 1.5, widening = 0.9;  // radii without, at most, and by the effect
constexpr double soft_rock = 0.1, firm_rock = 0.5;  // resistances at which rock is quite weak and not at all
constexpr double crossing_chance = 0.7, fork_chance = 0.4, way_chance = 0.08;  // of a room, by ways that meet
constexpr double sound_share = 0.3;                    // of that chance in rock that is not weak
constexpr double rooms_apart = 3.5;                    // spacings
constexpr double least_room = 2.2, more_room = 2.4;    // radii of a passage: smallest, and most beyond it
constexpr double beside_room = 1.4;                    // room radii of rock that it needs on all sides
constexpr double seed_mouth = 1.25, exit_mouth = 1.3;  // radii of a passage where it opens
constexpr double swallet_up = 0.8;                     // normal's z of ground flat enough to hold a doline
constexpr double fewest_nodes = 4;  // a seed that grows fewer led nowhere and leaves no mark
constexpr double winding_length = 0.8, winding_reach = 0.9;  // spacings; wavelength and amplitude
constexpr double winding_up = 0.35;                          // share of it up and down

/// Catmull-Rom between b and c.
Vec3d spline(Vec3d a, Vec3d b, Vec3d c, Vec3d d, double t) {
  const double t2 = t * t, t3 = t2 * t;
  return 0.5 *
         (2.0 * b + (c - a) * t + (2.0 * a - 5.0 * b + 4.0 * c - d) * t2 + (3.0 * b - a - 3.0 * c + d) * t3);
}

class Shaper {
 public:
  Shaper(const field::CompiledField& field, const Ground& ground, const Percolation& percolation,
         const CaveSize& size, const PassageSettings& s, std::uint64_t seed)
      : field_(field),
        ground_(ground),
        nodes_(percolation.nodes),
        percolation_(percolation),
        size_(size),
        s_(s),
        seed_(seed) {}

  CaveSystem run() {
    gather();
    widths();
    drop_dead_ends();
    name_networks();
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (kept_[i] && nodes_[i].parent < 0) walk_from_seed(i);
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (kept_[i] && nodes_[i].parent >= 0 && !walked_[i]) walk_branch(i);
    for (const auto& [a, b] : percolation_.merges) add({at(a), at(b)}, {radius_[a], radius_[b]}, a);
    for (const CaveExit& exit : percolation_.exits) leave(exit);
    chambers();
    return std::move(caves_);
  }

 private:
  Vec3d at(std::int32_t i) const { return nodes_[i].position; }

  void gather() {
    children_.resize(nodes_.size());
    beyond_.assign(nodes_.size(), 1);
    for (auto i = static_cast<std::int32_t>(nodes_.size()); i-- > 0;) {
      if (nodes_[i].parent < 0) continue;
      children_[nodes_[i].parent].push_back(i);
      beyond_[nodes_[i].parent] += beyond_[i];
    }
  }

  /// The stress of a passage grows with what drains through it: the trunk near its seed bears most of all.
  void widths() {
    std::vector<double> most(nodes_.size(), 1.0);
    radius_.resize(nodes_.size());
    effect_.resize(nodes_.size());
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i) {
      const std::int32_t parent = nodes_[i].parent;
      most[i] = parent < 0 ? beyond_[i] : most[parent];
      const double stress = least_stress + (1 - least_stress) * std::sqrt(beyond_[i] / most[i]);
      effect_[i] = erosion_effect(nodes_[i].resistance, stress, s_.beta);
      radius_[i] = size_.radius * std::clamp(narrowest + widening * effect_[i], narrowest, widest);
    }
  }

  /// Where ways meet or the rock is weak a room breaks out, if the rock around bears it.
  void chambers() {
    if (s_.chambers <= 0) return;
    std::vector<int> ways(nodes_.size(), 0);
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (kept_[i] && nodes_[i].parent >= 0) ++ways[i], ++ways[nodes_[i].parent];
    for (const auto& [a, b] : percolation_.merges) ways[a] += 2, ways[b] += 2;
    SpatialHash rooms(8 * size_.spacing);
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i) {
      if (!kept_[i] || nodes_[i].parent < 0) continue;
      Random random(seed_, i);
      const double weak = 1 - smoothstep(soft_rock, firm_rock, nodes_[i].resistance);
      const double meeting = ways[i] > 3 ? crossing_chance : ways[i] == 3 ? fork_chance : way_chance;
      const double chance = s_.chambers * meeting * (sound_share + (1 - sound_share) * weak);
      Vec3d center = nodes_[i].position;
      if (random.uniform() > chance || rooms.any_near(center, rooms_apart * size_.spacing)) continue;
      const double radius = size_.radius * (least_room + more_room * random.uniform() * (0.4 + 0.6 * weak));
      if (!bears(center, radius)) continue;
      rooms.insert(center);
      wind({&center, 1});
      caves_.chambers.push_back({center, radius});
    }
  }

  bool bears(Vec3d p, double radius) const {
    for (const Vec3d d :
         {Vec3d{0, 0, 1.3}, {1.4, 0, 0}, {-1.4, 0, 0}, {0, 1.4, 0}, {0, -1.4, 0}, {0, 0, -0.8}})
      if (field_.value(p + d * radius) <= 0) return false;
    return ground_.usable(p, beside_room * radius);
  }

  void drop_dead_ends() {
    kept_.assign(nodes_.size(), true);
    std::vector<bool> needed(nodes_.size(), false);
    for (const auto& [a, b] : percolation_.merges) needed[a] = needed[b] = true;
    for (const CaveExit& exit : percolation_.exits) needed[exit.node] = true;
    for (auto i = static_cast<std::int32_t>(nodes_.size()); i-- > 0;) {
      for (std::int32_t c : children_[i]) needed[i] = needed[i] || kept_[c];
      kept_[i] = needed[i] || effect_[i] >= s_.threshold;
    }
    // A seed that led nowhere leaves no mark.
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (nodes_[i].parent < 0 && beyond_[i] < fewest_nodes && !needed[i]) kept_[i] = false;
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (nodes_[i].parent >= 0 && !kept_[nodes_[i].parent]) kept_[i] = false;
  }

  void name_networks() {
    std::vector<std::int32_t> joined(nodes_.size());
    std::iota(joined.begin(), joined.end(), 0);
    const auto root = [&](std::int32_t i) {
      while (joined[i] != i) i = joined[i];
      return i;
    };
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i)
      if (nodes_[i].parent >= 0) joined[i] = root(nodes_[i].parent);
    for (const auto& [a, b] : percolation_.merges) joined[root(a)] = root(b);
    std::vector<std::int32_t> names(nodes_.size(), -1);
    network_.assign(nodes_.size(), -1);
    for (std::int32_t i = 0; i < std::ssize(nodes_); ++i) {
      if (!kept_[i]) continue;
      std::int32_t& name = names[root(i)];
      if (name < 0) name = caves_.networks++;
      network_[i] = name;
    }
    walked_.assign(nodes_.size(), false);
  }

  /// The child most of the water comes from, among those not walked yet.
  std::int32_t main_child(std::int32_t node) const {
    std::int32_t best = -1;
    for (std::int32_t c : children_[node])
      if (kept_[c] && !walked_[c] && (best < 0 || beyond_[c] > beyond_[best])) best = c;
    return best;
  }

  void follow(std::int32_t node, std::vector<Vec3d>& line, std::vector<double>& radius) {
    for (; node >= 0; node = main_child(node)) {
      walked_[node] = true;
      line.push_back(at(node));
      radius.push_back(radius_[node]);
    }
  }

  void walk_from_seed(std::int32_t seed) {
    const Vec3d p = nodes_[seed].position;
    float value = 0;
    Vec3f gradient;
    field_.gradients({&p, 1}, {&value, 1}, {&gradient, 1});
    std::vector<Vec3d> line;
    std::vector<double> radius;
    if (std::abs(value) < 1) {
      const Vec3d outward = normalized(-to_double(gradient));
      const double mouth = seed_mouth * radius_[seed];
      line.push_back(p + outward * mouth);
      radius.push_back(mouth);
      radius_[seed] = mouth;
      caves_.entrances.push_back(p);
      if (outward.z > swallet_up) caves_.swallets.push_back(p);
    }
    follow(seed, line, radius);
    add(line, radius, seed);
  }

  void walk_branch(std::int32_t node) {
    std::vector<Vec3d> line = {at(nodes_[node].parent)};
    std::vector<double> radius = {std::min(radius_[nodes_[node].parent], radius_[node])};
    follow(node, line, radius);
    add(line, radius, node);
  }

  void leave(const CaveExit& exit) {
    if (!kept_[exit.node]) return;
    const double r = radius_[exit.node], mouth = exit_mouth * r;
    add({at(exit.node), exit.position, exit.position + exit.outward * mouth}, {r, mouth, mouth}, exit.node);
    caves_.entrances.push_back(exit.position);
  }

  /// A smooth line through the given places, displaced by noise of the place itself, so that passages which
  /// share a node still meet.
  void add(const std::vector<Vec3d>& line, const std::vector<double>& radius, std::int32_t node) {
    if (line.size() < 2 || !kept_[node]) return;
    Passage passage;
    passage.network = network_[node];
    const std::int64_t n = std::ssize(line);
    const auto point = [&](std::int64_t i) { return line[std::clamp<std::int64_t>(i, 0, n - 1)]; };
    const double step = place_step * size_.radius;
    for (std::int64_t i = 0; i + 1 < n; ++i) {
      const double span = length(point(i + 1) - point(i));
      const int pieces = std::max(1, ceil_to(span / step));
      for (int k = 0; k < pieces + (i + 2 == n); ++k) {
        const double t = 1.0 * k / pieces;
        const double r0 = radius[i], r1 = radius[i + 1];
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
    for (Vec3d p : line)
      world.push_back((p + ground_.site().origin) * (1 / (winding_length * size_.spacing)));
    const double amplitude = winding_reach * s_.winding * size_.spacing;
    std::vector<float> noise(line.size());
    for (const Vec3d axis : {Vec3d{1, 0, 0}, {0, 1, 0}, {0, 0, winding_up}}) {
      const PassagesStream stream = axis.x > 0   ? PassagesStream::winding_x
                                    : axis.y > 0 ? PassagesStream::winding_y
                                                 : PassagesStream::winding_z;
      fbm(world, 2, hash_combine(seed_, stream), noise);
      for (std::size_t i = 0; i < line.size(); ++i) line[i] += axis * (amplitude * (noise[i] - 0.5));
    }
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const std::vector<CaveNode>& nodes_;
  const Percolation& percolation_;
  const CaveSize& size_;
  const PassageSettings& s_;
  std::uint64_t seed_;
  std::vector<std::vector<std::int32_t>> children_;
  std::vector<double> beyond_;  ///< nodes from here on, itself included
  std::vector<double> radius_, effect_;
  std::vector<bool> kept_, walked_;
  std::vector<std::int32_t> network_;
  CaveSystem caves_;
};

}  // namespace

CaveSystem make_passages(const field::CompiledField& field, const Ground& ground,
                         const Percolation& percolation, const CaveSize& size,
                         const PassageSettings& settings, std::uint64_t seed) {
  return Shaper(field, ground, percolation, size, settings, seed).run();
}

std::vector<bool> open_networks(const field::CompiledField& field, const CaveSystem& caves) {
  std::vector<bool> open(caves.networks, true);
  for (const Passage& passage : caves.passages) {
    // Between the places too, where a way closes first.
    std::vector<Vec3d> way = passage.line;
    for (std::size_t i = 0; i + 1 < passage.line.size(); ++i)
      way.push_back(0.5 * (passage.line[i] + passage.line[i + 1]));
    std::vector<float> values(way.size());
    field.values(way, values);
    if (std::any_of(values.begin(), values.end(), [](float f) { return f >= 0; }))
      open[passage.network] = false;
  }
  return open;
}

}  // namespace tafoni::landforms::impl
