#include "tafoni/landforms/impl/percolation.h"

#include <algorithm>
#include <cmath>
#include <queue>

#include "tafoni/core/random.h"
#include "tafoni/landforms/spatial_hash.h"

namespace tafoni::landforms::impl {
namespace {

constexpr double full_turn = 6.28318530717958647692;

class Percolator {
 public:
  Percolator(const field::CompiledField& field, const Ground& ground, const PercolationSettings& s,
             Progress& progress)
      : field_(field),
        ground_(ground),
        s_(s),
        progress_(progress),
        random_(s.seed, 0x70),
        spheres_(2 * s.spacing),
        mouths_(6 * s.spacing) {}

  Percolation run(const std::vector<Vec3d>& seeds) {
    for (std::size_t i = 0; i < seeds.size(); ++i) {
      if (spheres_.any_near(seeds[i], s_.spacing)) continue;
      const auto start = static_cast<std::int32_t>(tops_.size());
      tops_.push_back(seeds[i].z);
      network_.push_back(start);
      carved_of_.push_back(0);
      // Seeds come first: where water enters is given, only its way on follows the rock.
      push(seeds[i], -1, start, -1);
    }
    progress_.begin("percolating", tops_.size() * s_.points_per_seed, "points");
    while (!queue_.empty()) {
      const Candidate next = queue_.top();
      queue_.pop();
      auto& carved = carved_of_[static_cast<std::size_t>(next.start)];
      const bool is_seed = next.parent < 0;
      if (!is_seed && (next.rho >= s_.threshold || carved >= s_.points_per_seed)) continue;
      ++carved;
      progress_.advance();
      const auto node = static_cast<std::int32_t>(result_.nodes.size());
      result_.nodes.push_back({next.position, next.parent, next.start, next.rho});
      node_of_[next.sphere] = node;
      propagate(node);
    }
    progress_.end();
    return std::move(result_);
  }

 private:
  struct Candidate {
    double key;  ///< rho + epsilon * random
    std::uint32_t sphere;
    std::int32_t parent, start;
    double rho;
    Vec3d position;
    /// The least first; equal ones by age.
    bool operator<(const Candidate& b) const { return key != b.key ? key > b.key : sphere > b.sphere; }
  };

  void push(Vec3d p, std::int32_t parent, std::int32_t start, double key) {
    const double rho = ground_.resistance(p);
    if (parent >= 0) key = rho + s_.epsilon * random_.uniform();
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
    const CaveNode from = result_.nodes[static_cast<std::size_t>(node)];
    const double lowest = std::max(s_.base_z, tops_[static_cast<std::size_t>(from.start)] - s_.depth);
    bool out = false;
    for (int i = 0; i < s_.directions; ++i) {
      Vec3d to = from.position + direction() * (s_.spacing * random_.uniform(1.001, 1.4));
      // A seed's first step gets under cover at once.
      if (from.parent < 0) to.z = std::min(to.z, ground_.height(to.x, to.y) - 1.05 * s_.cover);
      to.z = std::max(to.z, lowest);
      if (!ground_.usable(to, s_.spacing)) continue;
      if (field_.value(to) <= 0) {
        if (!out && from.parent >= 0) out = emerge(node, from.position, to);
        continue;
      }
      if (merge(node, to) || !covered(from, to)) continue;
      push(to, node, from.start, 0);
    }
  }

  /// Whether the sphere of `to` is taken. Links to what takes it if that is a tunnel of another network.
  bool merge(std::int32_t node, Vec3d to) {
    std::int32_t other = -1;
    double nearest = s_.spacing * s_.spacing;
    const bool taken = spheres_.near(to, s_.spacing, [&](std::uint32_t id, double d2) {
      const std::int32_t carved = node_of_[id];
      if (carved >= 0 && d2 < nearest && carved != node) {
        nearest = d2;
        other = carved;
      }
      return false;
    }) || spheres_.any_near(to, s_.spacing);
    if (other >= 0) {
      const CaveNode& a = result_.nodes[static_cast<std::size_t>(node)];
      const CaveNode& b = result_.nodes[static_cast<std::size_t>(other)];
      const std::int32_t na = find(a.start), nb = find(b.start);
      if (na != nb && b.parent >= 0 && covered(a, b.position)) {
        network_[static_cast<std::size_t>(na)] = nb;
        result_.merges.emplace_back(node, other);
      }
    }
    return taken;
  }

  std::int32_t find(std::int32_t start) const {
    while (network_[static_cast<std::size_t>(start)] != start)
      start = network_[static_cast<std::size_t>(start)];
    return start;
  }

  /// Enough rock over the whole way, so that no shells are left; a seed's way begins in the open.
  bool covered(const CaveNode& from, Vec3d to) const {
    constexpr int probes = 4;
    for (int i = 1; i <= probes; ++i) {
      const double t = static_cast<double>(i) / probes;
      if (from.parent < 0 && i < probes) continue;
      const Vec3d p = from.position + (to - from.position) * t;
      for (const Vec3d d : {Vec3d{0, 0, 0}, {0, 0, 1}, {0.8, 0, 0}, {-0.8, 0, 0}, {0, 0.8, 0}, {0, -0.8, 0}})
        if (field_.value(p + d * s_.cover) <= 0) return false;
    }
    return true;
  }

  /// Opens a way out where the line to `to` leaves the rock through a steep face.
  bool emerge(std::int32_t node, Vec3d from, Vec3d to) {
    double inside = 0, outside = 1;
    for (int i = 0; i < 24; ++i) {
      const double middle = 0.5 * (inside + outside);
      (field_.value(from + (to - from) * middle) > 0 ? inside : outside) = middle;
    }
    const Vec3d at = from + (to - from) * inside;
    float value = 0;
    Vec3f gradient;
    field_.gradients({&at, 1}, {&value, 1}, {&gradient, 1});
    const Vec3d outward = normalized(-to_double(gradient));
    if (outward.z > s_.face_z || mouths_.any_near(at, 3 * s_.spacing)) return false;
    mouths_.insert(at);
    result_.exits.push_back({node, at, outward});
    return true;
  }

  const field::CompiledField& field_;
  const Ground& ground_;
  const PercolationSettings& s_;
  Progress& progress_;
  Random random_;
  SpatialHash spheres_, mouths_;
  std::vector<std::int32_t> node_of_;  ///< by sphere; -1: a candidate still
  std::vector<double> tops_;           ///< by seed: its z
  std::vector<std::int32_t> network_;  ///< by seed: a seed it is joined with
  std::vector<std::size_t> carved_of_;
  std::priority_queue<Candidate> queue_;
  Percolation result_;
};

}  // namespace

Percolation percolate(const field::CompiledField& field, const Ground& ground,
                      const std::vector<Vec3d>& seeds, const PercolationSettings& settings,
                      Progress& progress) {
  return Percolator(field, ground, settings, progress).run(seeds);
}

}  // namespace tafoni::landforms::impl
