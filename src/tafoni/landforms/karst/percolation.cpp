// Water works its way down: a queue of candidate points by the resistance of the way to them, spheres around
// carved points that keep others off, tunnels out at faces, links between networks that meet, and at last the
// ways down to the springs.

#include "tafoni/landforms/karst/percolation.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <queue>

#include "tafoni/core/error.h"
#include "tafoni/core/random.h"
#include "tafoni/landforms/site/spatial_hash.h"
#include "tafoni/math/angle.h"

namespace tafoni::landforms::impl {
namespace {

enum class PercolationStream : std::uint64_t { directions = 0x70 };

// Chosen by eye; lengths in spacings unless said otherwise.
constexpr double shortest_step = 1.001, longest_step = 1.4;  // of a way: just outside the sphere it leaves
constexpr double reach_up = 0.35, reach_aside = 0.5;         // how far a way's end moves to softer rock
constexpr float detour = 0.03f;        // resistance by which softer rock must be softer to be worth moving to
constexpr double mouths_apart = 3;     // between ways out of the rock
constexpr double spring_covers = 1.2;  // covers behind a spring at which its way reaches it
constexpr double near_spring = 1.2;    // from there a way goes straight to its spring
constexpr double straightness = 0.33;  // weight of the detour against the rock on the way to a spring
constexpr int most_spring_steps = 10000;  // a way that circles in its rock for longer is given up

/// Nodes, and what waits in the queue to become one: half a gigabyte.
constexpr std::size_t most_places = 3'000'000;

class Percolator {
 public:
  Percolator(const field::CompiledField& field, const Ground& ground, const PercolationSettings& settings,
             const PercolationSpace& space, Progress& progress)
      : field_(field),
        ground_(ground),
        s_(settings),
        space_(space),
        progress_(progress),
        random_(space.seed, PercolationStream::directions),
        spheres_(2 * space.spacing),
        mouths_(2 * mouths_apart * space.spacing) {}

  Percolation run(const Entrances& entrances) {
    for (Vec3d seed : entrances.seeds) begin(seed);
    progress_.begin("percolating", tops_.size() * space_.points_per_seed, "points");
    while (!queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      auto& carved = carved_of_[next.start];
      const bool is_seed = next.parent < 0;
      if (!is_seed && (next.rho >= s_.resistance || carved >= space_.points_per_seed)) continue;
      if (node_of_.size() > most_places)
        fail(ErrorKind::usage,
             "karst: the passages lead to more than {} million places a spacing of {:g} m apart; give a "
             "larger "
             "spacing or a smaller passage",
             most_places / 1'000'000, space_.spacing);
      ++carved;
      progress_.advance();
      const std::int32_t node = add({next.position, next.parent, next.start, next.rho});
      node_of_[next.sphere] = node;
      propagate(node);
    }
    progress_.end();
    for (Vec3d spring : entrances.springs) resurge(spring);
    return std::move(result_);
  }

 private:
  struct Candidate {
    double key;  ///< mean rho of the way here + epsilon * random
    std::uint32_t sphere;
    std::int32_t parent, start;
    double rho;
    Vec3d position;
    /// The least first; equal ones by age.
    bool operator<(const Candidate& b) const { return key != b.key ? key > b.key : sphere > b.sphere; }
  };
  /// A step that may be taken.
  struct Way {
    Vec3d to;
    double chance = 0, rho = 0;  ///< rho at its end
    double resistance = 0;       ///< mean on the way
  };

  /// Seeds come first in the queue: where water enters is given, only its way on follows the rock.
  void begin(Vec3d seed) {
    if (spheres_.any_near(seed, space_.spacing)) return;
    const auto start = static_cast<std::int32_t>(tops_.size());
    tops_.push_back(seed.z);
    network_.push_back(start);
    carved_of_.push_back(0);
    push(seed, -1, start, -1, ground_.resistance(seed));
  }

  void push(Vec3d p, std::int32_t parent, std::int32_t start, double key, double rho) {
    queue_.push({key, spheres_.insert(p), parent, start, rho, p});
    node_of_.push_back(-1);
  }

  /// A direction on the lower hemisphere.
  Vec3d direction() {
    const double z = random_.uniform(), around = full_turn * random_.uniform();
    const double across = std::sqrt(1 - z * z);
    return normalized(Vec3d{across * std::cos(around), across * std::sin(around), -s_.steepness * z});
  }

  void propagate(std::int32_t node) {
    const CaveNode from = result_.nodes[node];
    std::vector<Way> ways(s_.directions);
    for (Way& way : ways) {
      way.to = from.position + direction() * (space_.spacing * random_.uniform(shortest_step, longest_step));
      way.chance = random_.uniform();
    }
    settle(from, ways);
    bool out = false;
    for (const Way& way : ways) {
      if (!ground_.usable(way.to, space_.spacing)) continue;
      if (field_.value(way.to) <= 0) {
        if (!out && from.parent >= 0) out = emerge(node, from.position, way.to);
        continue;
      }
      if (merge(node, way.to) || !covered(from, way.to)) continue;
      push(way.to, node, from.start, way.resistance + s_.epsilon * way.chance, way.rho);
    }
  }

  /// Moves each end to the least resistance about it, a bed or a fault, and weighs the rock on the way there.
  void settle(const CaveNode& from, std::vector<Way>& ways) {
    const double lowest = std::max(space_.base_z, tops_[from.start] - s_.depth);
    const double up = reach_up * space_.spacing, aside = reach_aside * space_.spacing;
    probes_.clear();
    for (Way& way : ways) {
      if (from.parent < 0) way.to = under_cover(way.to);
      way.to.z = std::max(way.to.z, lowest);
      const Vec3d ahead = normalized(way.to - from.position);
      const Vec3d left = normalized(Vec3d{-ahead.y, ahead.x, 0});
      for (const Vec3d d :
           {Vec3d{0, 0, 0}, {0, 0, up}, {0, 0, -up}, {0, 0, -2 * up}, left * aside, -aside * left}) {
        Vec3d p = from.position + normalized(way.to + d - from.position) * length(way.to - from.position);
        p.z = std::clamp(p.z, std::min(lowest, from.position.z), from.position.z);
        if (from.parent < 0) p.z = std::min(p.z, way.to.z);
        probes_.push_back(p);
      }
    }
    weigh(probes_);
    const std::size_t tries = probes_.size() / ways.size();
    for (std::size_t i = 0; i < ways.size(); ++i) {
      std::size_t best = i * tries;
      for (std::size_t k = best; k < (i + 1) * tries; ++k)
        if (rho_[k] + (k % tries == 0 ? 0.0f : detour) < rho_[best]) best = k;
      ways[i].to = probes_[best];
      ways[i].rho = rho_[best];
    }
    probes_.clear();
    for (const Way& way : ways)
      for (double t : {0.25, 0.5, 0.75}) probes_.push_back(from.position + (way.to - from.position) * t);
    weigh(probes_);
    for (std::size_t i = 0; i < ways.size(); ++i)
      ways[i].resistance = 0.25 * (ways[i].rho + (rho_[3 * i] + rho_[3 * i + 1] + rho_[3 * i + 2]));
  }

  void weigh(const std::vector<Vec3d>& points) {
    rho_.resize(points.size());
    ground_.resistances(points, rho_);
  }

  /// Where a seed's first step gets under cover at once, if that is not too far down.
  Vec3d under_cover(Vec3d to) const {
    const double step = 0.25 * space_.cover;
    for (int i = 0; i < 24; ++i, to.z -= step)
      if (field_.value(to + Vec3d{0, 0, 1.05 * space_.cover}) > 0 && field_.value(to) > 0) return to;
    return to;
  }

  /// Whether the sphere of `to` is taken. Links to what takes it if that is a tunnel of another network.
  bool merge(std::int32_t node, Vec3d to) {
    std::int32_t other = -1;
    double nearest = space_.spacing * space_.spacing;
    const bool taken = spheres_.near(to, space_.spacing, [&](std::uint32_t id, double d2) {
      const std::int32_t carved = node_of_[id];
      if (carved >= 0 && d2 < nearest && carved != node) {
        nearest = d2;
        other = carved;
      }
      return false;
    }) || spheres_.any_near(to, space_.spacing);
    if (other >= 0) {
      const CaveNode& a = result_.nodes[node];
      const CaveNode& b = result_.nodes[other];
      const std::int32_t na = find(a.start), nb = find(b.start);
      if (na != nb && b.parent >= 0 && covered(a, b.position)) {
        network_[na] = nb;
        result_.merges.emplace_back(node, other);
      }
    }
    return taken;
  }

  std::int32_t find(std::int32_t start) const {
    while (network_[start] != start) start = network_[start];
    return start;
  }

  /// Enough rock over the whole way, so that no shells are left; a seed's way begins in the open.
  bool covered(const CaveNode& from, Vec3d to) const {
    constexpr int probes = 4;
    for (int i = 1; i <= probes; ++i) {
      const double t = 1.0 * i / probes;
      if (from.parent < 0 && i < probes) continue;
      const Vec3d p = from.position + (to - from.position) * t;
      for (const Vec3d d : {Vec3d{0, 0, 0}, {0, 0, 1}, {0.8, 0, 0}, {-0.8, 0, 0}, {0, 0.8, 0}, {0, -0.8, 0}})
        if (field_.value(p + d * space_.cover) <= 0) return false;
    }
    return true;
  }

  /// The way down to a spring, step by step towards it through the softest rock.
  void resurge(Vec3d spring) {
    std::int32_t node = -1;
    double nearest = std::numeric_limits<double>::max();
    for (std::int32_t i = 0; i < std::ssize(result_.nodes); ++i) {
      const CaveNode& n = result_.nodes[i];
      const double far = length(n.position - spring);
      if (n.parent < 0 || n.position.z < spring.z || far >= nearest) continue;
      nearest = far;
      node = i;
    }
    if (node < 0) return;
    const Vec3d outward = outward_at(spring);
    const Vec3d inside = spring - outward * (spring_covers * space_.cover);
    for (int step = 0; step < most_spring_steps; ++step) {
      const CaveNode from = result_.nodes[node];
      const Vec3d left = inside - from.position;
      if (length(left) < near_spring * space_.spacing) break;
      const Vec3d ahead = normalized(left), aside = normalized(Vec3d{-ahead.y, ahead.x, 0});
      probes_.clear();
      for (double turn : {0.0, 0.5, -0.5, 1.0, -1.0})
        for (double drop : {0.0, -0.3, 0.3}) {
          Vec3d p = from.position + normalized(ahead + aside * turn + Vec3d{0, 0, drop}) * space_.spacing;
          p.z = std::clamp(p.z, std::min(inside.z, from.position.z), from.position.z);
          probes_.push_back(p);
        }
      weigh(probes_);
      std::size_t best = 0;
      float least = std::numeric_limits<float>::max();
      for (std::size_t i = 0; i < probes_.size(); ++i) {
        if (field_.value(probes_[i]) <= 0) continue;
        const double lost = length(inside - probes_[i]) - (length(left) - space_.spacing);
        const float cost = rho_[i] + static_cast<float>(straightness * lost / space_.spacing);
        if (cost >= least) continue;
        least = cost;
        best = i;
      }
      node = extend(node, probes_[best], rho_[best]);
    }
    result_.exits.push_back({extend(node, inside, ground_.resistance(inside)), spring, outward});
  }

  std::int32_t add(const CaveNode& node) {
    result_.nodes.push_back(node);
    return static_cast<std::int32_t>(result_.nodes.size() - 1);
  }

  std::int32_t extend(std::int32_t node, Vec3d p, double rho) {
    return add({p, node, result_.nodes[node].start, rho});
  }

  Vec3d outward_at(Vec3d p) const {
    float value = 0;
    Vec3f gradient;
    field_.gradients({&p, 1}, {&value, 1}, {&gradient, 1});
    return normalized(-to_double(gradient));
  }

  /// Opens a way out where the line to `to` leaves the rock through a steep face.
  bool emerge(std::int32_t node, Vec3d from, Vec3d to) {
    double inside = 0, outside = 1;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (inside + outside);
      (field_.value(from + (to - from) * middle) > 0 ? inside : outside) = middle;
    }
    const Vec3d at = from + (to - from) * inside;
    const Vec3d outward = outward_at(at);
    if (outward.z > space_.face_z || mouths_.any_near(at, mouths_apart * space_.spacing)) return false;
    mouths_.insert(at);
    result_.exits.push_back({node, at, outward});
    return true;
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const PercolationSettings& s_;
  const PercolationSpace& space_;
  Progress& progress_;
  Random random_;
  SpatialHash spheres_, mouths_;
  std::vector<std::int32_t> node_of_;  ///< by sphere; -1: a candidate still
  std::vector<double> tops_;           ///< by seed: its z
  std::vector<std::int32_t> network_;  ///< by seed: a seed it is joined with
  std::vector<std::size_t> carved_of_;
  std::priority_queue<Candidate> queue_;
  std::vector<Vec3d> probes_;
  std::vector<float> rho_;
  Percolation result_;
};

}  // namespace

Percolation percolate(const field::CompiledField& field, const Ground& ground, const Entrances& entrances,
                      const PercolationSettings& settings, const PercolationSpace& space,
                      Progress& progress) {
  return Percolator(field, ground, settings, space, progress).run(entrances);
}

}  // namespace tafoni::landforms::impl
