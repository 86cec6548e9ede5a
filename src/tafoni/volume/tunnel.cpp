// Tunnels [Ju01 §3]: an axis of displaced midpoints, levelled so that it can be walked, and its carving
// into a grid, brick by brick, by the segments that reach each brick.

#include "tafoni/volume/tunnel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "tafoni/core/error.h"
#include "tafoni/core/parallel.h"
#include "tafoni/core/random.h"
#include "tafoni/math/draw.h"
#include "tafoni/math/whole.h"
#include "tafoni/volume/impl/chunk_editor.h"
#include "tafoni/volume/impl/cones.h"

namespace tafoni::volume {
namespace {

using impl::Cone;

/// A tunnel's radius varies by this share of itself at most; at 1 it would close.
constexpr double most_swelling = 0.9;
/// The whole is halved so many times at most, so that a tiny step ends.
constexpr int most_halvings = 24;
/// Metres along the ground: a shaft that goes straight down counts as so long.
constexpr double shortest = 1e-9;
/// Part of an even ramp's slope that is added to it, so that rounding leaves a way between the ends; metres
/// by which a way may miss.
constexpr double ramp_slack = 1e-9, height_slack = 1e-9;

std::vector<Cone> cones_of(const Tunnel& tunnel) {
  std::vector<Cone> out;
  const auto& axis = tunnel.axis;
  for (std::size_t i = 0; i + 1 < axis.size(); ++i)
    out.push_back(impl::cone_between(axis[i].position, axis[i].radius, axis[i + 1].position,
                                     axis[i + 1].radius, tunnel.floor));
  if (axis.size() == 1) out.push_back({axis[0].position, {1, 0, 0}, 0, axis[0].radius, 0, tunnel.floor});
  return out;
}

/// Finds the bricks that cones reach, takes the least of the cones that matter in each, and lowers the grid.
class Carving {
 public:
  Carving(ScalarGrid& grid, double reach) : grid_(grid), frame_(grid.frame()) {
    bricks_ = {(frame_.size.x - 1) / side + 1, (frame_.size.y - 1) / side + 1,
               (frame_.size.z - 1) / side + 1};
    half_ = 0.5 * std::sqrt(3.0) * (side - 1) * frame_.spacing;
    reach_ = std::min<double>(reach, grid.range(frame_.box()).hi);
  }

  SampleBox run(const std::vector<Cone>& cones, Progress& progress) {
    for (const Cone& cone : cones) spread(cone);
    // Bricks go in the order in which they lie in memory; in each, cones in the order given.
    std::stable_sort(near_.begin(), near_.end(), [](const Near& a, const Near& b) { return a.key < b.key; });
    for (std::size_t i = 0; i < near_.size(); ++i)
      if (i == 0 || near_[i].key != near_[i - 1].key) starts_.push_back(i);
    starts_.push_back(near_.size());
    // Chunks are carved at the same time, which edit() allows; the bricks of one lie together.
    std::vector<std::size_t> chunks;
    for (std::size_t i = 0; i + 1 < starts_.size(); ++i)
      if (i == 0 || key_at(i) >> 6 != key_at(i - 1) >> 6) chunks.push_back(i);
    chunks.push_back(starts_.size() - 1);
    std::vector<SampleBox> lowered(chunks.size() - 1);
    parallel_for(std::ssize(lowered), [&](std::int64_t c) {
      progress.check();
      Made made;
      for (std::size_t brick = chunks[c]; brick < chunks[c + 1]; ++brick) {
        evaluate(brick, made);
        lower(made, lowered[c]);
      }
    });
    SampleBox changed;
    for (const SampleBox& box : lowered) impl::expand(changed, box);
    return changed;
  }

 private:
  static constexpr int side = impl::brick_side;
  static_assert(ScalarGrid::chunk_samples == 4 * side, "key_of() and run() take 64 bricks for a chunk");
  struct Near {
    std::uint64_t key;
    const Cone* cone;
  };
  /// A brick's values.
  struct Made {
    SampleBox box;
    bool any;
    float values[side * side * side];
  };

  std::uint64_t key_at(std::size_t brick) const { return near_[starts_[brick]].key; }
  /// Bricks of a chunk are neighbours.
  static std::uint64_t key_of(Vec3i b) {
    const auto part = [](int v, int bits) {
      return std::pair{static_cast<std::uint64_t>(v) >> 2, (static_cast<std::uint64_t>(v) & 3) << bits};
    };
    const auto [cx, x] = part(b.x, 0);
    const auto [cy, y] = part(b.y, 2);
    const auto [cz, z] = part(b.z, 4);
    return (((cz << 18 | cy) << 18 | cx) << 6) | z | y | x;
  }
  static Vec3i brick_of(std::uint64_t key) {
    const auto join = [&](int chunk, int own) {
      return static_cast<int>((key >> chunk & 0x3ffff) << 2 | (key >> own & 3));
    };
    return {join(6, 0), join(24, 2), join(42, 4)};
  }
  Vec3d center(Vec3i b) const {
    const double half = 0.5 * (side - 1);
    const auto at = [&](int v) { return frame_.spacing * (side * v + half); };
    return frame_.origin + Vec3d{at(b.x), at(b.y), at(b.z)};
  }

  /// The bricks that a cone may reach; a long one piece by piece, or its box would hold many that are far.
  void spread(const Cone& cone) {
    const double stride = frame_.spacing * side;
    const double radius = std::max(cone.radius, cone.radius + cone.grow * cone.length) + reach_;
    const int pieces = floor_to(cone.length / (2 * radius + 4 * stride)) + 1;
    const std::size_t first = near_.size();
    for (int i = 0; i < pieces; ++i) {
      Box3d box;
      box.expand(cone.from + cone.along * (cone.length * i / pieces));
      box.expand(cone.from + cone.along * (cone.length * (i + 1) / pieces));
      box = box.grown(radius);
      const auto from = [&](double v, double o) { return std::max(std::floor((v - o) / stride), 0.0); };
      const auto to = [&](double v, double o, int n) { return std::min((v - o) / stride, n - 1.0); };
      for (double z = from(box.lo.z, frame_.origin.z); z <= to(box.hi.z, frame_.origin.z, bricks_.z); ++z)
        for (double y = from(box.lo.y, frame_.origin.y); y <= to(box.hi.y, frame_.origin.y, bricks_.y); ++y)
          for (double x = from(box.lo.x, frame_.origin.x); x <= to(box.hi.x, frame_.origin.x, bricks_.x);
               ++x) {
            const Vec3i b{static_cast<int>(x), static_cast<int>(y), static_cast<int>(z)};
            if (cone.round(center(b)) - half_ < reach_) near_.push_back({key_of(b), &cone});
          }
    }
    if (pieces == 1) return;
    const auto begin = near_.begin() + first;
    std::sort(begin, near_.end(), [](const Near& a, const Near& b) { return a.key < b.key; });
    near_.erase(std::unique(begin, near_.end(), [](const Near& a, const Near& b) { return a.key == b.key; }),
                near_.end());
  }

  /// Leaves out cones that are nowhere the least in the brick, and the brick where all that stands is lower.
  void evaluate(std::size_t brick, Made& made) const {
    const std::size_t begin = starts_[brick], end = starts_[brick + 1];
    const Vec3i b = brick_of(near_[begin].key), n = frame_.size;
    const Vec3d at = center(b);
    const Vec3i lo{side * b.x, side * b.y, side * b.z};
    made.box = {
        lo, {std::min(lo.x + side, n.x) - 1, std::min(lo.y + side, n.y) - 1, std::min(lo.z + side, n.z) - 1}};
    thread_local std::vector<std::pair<double, const Cone*>> all;
    thread_local std::vector<const Cone*> list;
    all.clear(), list.clear();
    double lowest = std::numeric_limits<double>::infinity(), least = lowest;
    for (std::size_t i = begin; i < end; ++i) {
      const Cone* c = near_[i].cone;
      const double round = c->round(at);
      all.emplace_back(round - half_, c);
      lowest = std::min(lowest, round - half_);
      // A sloping floor is steeper than a wall.
      least = std::min(least, c->floor < impl::round_floor ? c->value(at) + 3 * half_ : round + half_);
    }
    grid_.read(made.box, made.values);
    const Vec3i size = made.box.size();
    const float stands = *std::max_element(made.values, made.values + size.x * size.y * size.z);
    made.any = lowest < stands;
    if (!made.any) return;
    for (const auto& [below, cone] : all)
      if (below <= least) list.push_back(cone);
    impl::least_values(list, frame_.position(lo), frame_.spacing, made.values);
  }

  void lower(const Made& made, SampleBox& changed) {
    if (!made.any) return;
    const auto reach = static_cast<float>(reach_);
    const Vec3i lo = made.box.lo;
    const SampleBox by = grid_.edit(made.box, [&](Vec3i first, std::span<float> row) {
      const float* values = made.values + ((first.z - lo.z) * side + (first.y - lo.y)) * side;
      for (std::size_t i = 0; i < row.size(); ++i)
        if (values[i] < reach && values[i] < row[i]) row[i] = values[i];
    });
    impl::expand(changed, by);
  }

  ScalarGrid& grid_;
  GridFrame frame_;
  Vec3i bricks_;
  double half_, reach_;
  std::vector<Near> near_;
  std::vector<std::size_t> starts_;
};

}  // namespace

Tunnel fractal_tunnel(Vec3d from, Vec3d to, const TunnelSettings& s) {
  if (!(s.radius > 0) || !(s.step > 0) || !std::isfinite(s.radius))
    fail(ErrorKind::usage, "a tunnel's radius and step must be positive lengths in metres");
  const double share = std::clamp(s.swelling, 0.0, most_swelling);
  Tunnel tunnel;
  if (s.floor < 1) tunnel.floor = s.floor * s.radius;
  // A segment's place in the tree of halves: its noise does not depend on which others are halved.
  struct Part {
    AxisPoint end;
    std::uint64_t place;
  };
  AxisPoint begin{from, s.radius};
  std::vector<Part> ahead = {{{to, s.radius}, 1}};
  tunnel.axis = {begin};
  const Random random(s.seed);
  while (!ahead.empty()) {
    const Part part = ahead.back();
    const double l = length(part.end.position - begin.position);
    if (l <= s.step || part.place >> most_halvings) {
      tunnel.axis.push_back(begin = part.end);
      ahead.pop_back();
      continue;
    }
    const auto noise = [&](std::uint64_t which) {
      return 2 * unit_real(random.at(4 * part.place + which)) - 1;
    };
    const double swell = s.radius * share * std::ldexp(2.0, -static_cast<int>(std::bit_width(part.place)));
    AxisPoint middle{0.5 * (begin.position + part.end.position), 0.5 * (begin.radius + part.end.radius)};
    middle.position += Vec3d{noise(0), noise(1), s.climb * noise(2)} * (s.wander * l);
    middle.radius =
        std::clamp(middle.radius + swell * noise(3), s.radius * (1 - share), s.radius * (1 + share));
    ahead.back().place = 2 * part.place + 1;
    ahead.push_back({middle, 2 * part.place});
  }
  double along = 0;
  for (std::size_t i = 1; i < tunnel.axis.size(); ++i) {
    const Vec3d d = tunnel.axis[i].position - tunnel.axis[i - 1].position;
    along += std::hypot(d.x, d.y);
  }
  // Between ends that are too far apart in height for the slope, an even ramp is the best that can be.
  level_axis(tunnel.axis,
             std::max(s.slope, std::abs(to.z - from.z) / std::max(along, shortest) * (1 + ramp_slack)));
  return tunnel;
}

bool level_axis(std::vector<AxisPoint>& axis, double slope, const std::function<double(Vec3d)>& highest) {
  const std::size_t n = axis.size();
  std::vector<double> along(n, 0.0), low(n), high(n);
  for (std::size_t i = 1; i < n; ++i) {
    const Vec3d d = axis[i].position - axis[i - 1].position;
    along[i] = along[i - 1] + std::hypot(d.x, d.y);
  }
  const double first = axis.front().position.z, last = axis.back().position.z;
  // Every height is brought between what a climber from either end could reach.
  for (std::size_t i = 0; i < n; ++i) {
    const double from = slope * along[i], to = slope * (along.back() - along[i]);
    const double least = std::max(first - from, last - to);
    double most = std::min(first + from, last + to);
    if (highest && i > 0 && i + 1 < n) most = std::min(most, highest(axis[i].position));
    if (least > most + height_slack) return false;
    low[i] = high[i] = std::clamp(axis[i].position.z, least, std::max(least, most));
  }
  // `low` becomes the greatest heights below, and `high` the least above, that are nowhere steeper.
  const auto relax = [&](std::size_t i, std::size_t from) {
    const double d = slope * std::abs(along[i] - along[from]);
    low[i] = std::min(low[i], low[from] + d);
    high[i] = std::max(high[i], high[from] - d);
  };
  for (std::size_t i = 1; i < n; ++i) relax(i, i - 1);
  for (std::size_t i = n - 1; i-- > 0;) relax(i, i + 1);
  for (std::size_t i = 1; i + 1 < n; ++i) axis[i].position.z = highest ? low[i] : 0.5 * (low[i] + high[i]);
  return true;
}

double length(const Tunnel& tunnel) {
  double sum = 0;
  for (std::size_t i = 0; i + 1 < tunnel.axis.size(); ++i)
    sum += length(tunnel.axis[i + 1].position - tunnel.axis[i].position);
  return sum;
}

double distance(const Tunnel& tunnel, Vec3d p) {
  double least = std::numeric_limits<double>::infinity();
  for (const Cone& cone : cones_of(tunnel)) least = std::min(least, cone.value(p));
  return least;
}

Box3d bounds(const Tunnel& tunnel, double reach) {
  Box3d box;
  for (const AxisPoint& a : tunnel.axis) box.expand(Box3d{a.position, a.position}.grown(a.radius + reach));
  return box;
}

SampleBox carve(ScalarGrid& grid, std::span<const Tunnel> tunnels, double reach, Progress& progress) {
  std::vector<Cone> cones;
  for (const Tunnel& tunnel : tunnels) {
    const auto more = cones_of(tunnel);
    cones.insert(cones.end(), more.begin(), more.end());
  }
  return Carving(grid, reach).run(cones, progress);
}

}  // namespace tafoni::volume
