// From part to part in the order in which they were joined, each through the door between them: as steep as
// it takes to the next floor, or less steep where a floor would hang in the way of another stretch.

#include "tafoni/landforms/grammar-cave/cave_floor.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

// A walker's, metres.
constexpr double headroom = 2.2;   // a floor leaves so much of a part above it
constexpr double head = 2.4;       // below another floor: what a head needs over one
constexpr double step = 0.25;      // a floor that is so much higher is a step, not a slope
constexpr double open_step = 0.4;  // the same in the open
// Chosen by eye.
constexpr double slopes[] = {0.4, 0.2, 0};  // tangents; tried in turn
constexpr double floor_share = 0.3;         // of a part's height lies under sediment
constexpr double sunk = 0.5;                // metres below a part's own bottom at most

class Pathfinder {
 public:
  Pathfinder(const Ground& ground, std::span<const grammar::Part> parts, const grammar::Pose& frame,
             const WaySettings& settings)
      : ground_(ground), parts_(parts), frame_(frame), settings_(settings) {}

  Way run(double length, double width) {
    std::vector<Node> nodes(parts_.size());
    nodes[0] = {true, {length, 0, 0}, {}, length, -1};
    Vec3d outside = frame_.placed(Vec3d{-apron, 0, 0});
    outside.z = ground_.height(outside.x, outside.y);
    const Vec3d mouth = frame_.at, inner = frame_.placed(nodes[0].at);
    found_.stretches.push_back({outside, mouth, width, hinders(outside, mouth)});
    found_.stretches.push_back({mouth, inner, width});
    int last = 0;
    for (int i = 1; i < std::ssize(parts_); ++i) {
      nodes[i] = reach(parts_[i], nodes[parts_[i].parent]);
      if (nodes[i].length > nodes[last].length) last = i;
    }
    std::vector<Vec3d> back;
    for (int i = last; i > 0; i = nodes[i].parent) {
      back.push_back(frame_.placed(nodes[i].at));
      back.push_back(frame_.placed(nodes[i].door));
    }
    found_.route = {outside, mouth, inner};
    found_.route.insert(found_.route.end(), back.rbegin(), back.rend());
    return std::move(found_);
  }

 private:
  /// A part's place on the way, in the cave's own frame.
  struct Node {
    bool reached = false;
    Vec3d at, door;
    double length = 0;
    int parent = -1;
  };

  Node reach(const grammar::Part& part, const Node& from) {
    const auto plan = [](Vec3d a, Vec3d b) { return std::hypot(a.x - b.x, a.y - b.y); };
    Vec3d to = part.core.center(), door = part.door.point;
    const double before = plan(from.at, door), length = before + plan(door, to);
    if (!from.reached || length < 0.1) return {};
    const double floor = part.core.lo.z + floor_share * part.core.size().z;
    for (const double steepest : slopes) {
      to.z = std::clamp(floor, from.at.z - steepest * length, from.at.z + steepest * length);
      if (to.z < part.core.lo.z - sunk || to.z > part.core.hi.z - headroom) return {};
      door.z = from.at.z + (to.z - from.at.z) * before / length;
      const Stretch first{frame_.placed(from.at), frame_.placed(door)},
          second{frame_.placed(door), frame_.placed(to)};
      if (crosses(first) || crosses(second)) continue;
      found_.stretches.push_back(first);
      found_.stretches.push_back(second);
      return {true, to, door, from.length + length, part.parent};
    }
    return {};
  }

  /// Whether the floor of one stretch would lie in the way of another.
  bool crosses(const Stretch& added) const {
    return std::any_of(found_.stretches.begin(), found_.stretches.end(),
                       [&](const Stretch& s) { return blocks(s, added) || blocks(added, s); });
  }

  bool blocks(const Stretch& s, const Stretch& other) const {
    const int n = 2 + floor_to(2 * length(s.to - s.from));
    for (int i = 0; i <= n; ++i) {
      const Vec3d p = s.from + (s.to - s.from) * (1.0 * i / n);
      const auto [top, on] = floor_at(other, p);
      if (top > p.z + step && on - settings_.depth < p.z + head) return true;
    }
    return false;
  }

  /// Whether the ground lies higher than a step above a way in the open.
  bool hinders(Vec3d from, Vec3d to) const {
    for (double t = 0; t <= 1; t += 0.1) {
      const Vec3d p = from + (to - from) * t;
      if (ground_.height(p.x, p.y) > p.z + open_step) return true;
    }
    return false;
  }

  const Ground& ground_;
  std::span<const grammar::Part> parts_;
  const grammar::Pose& frame_;
  const WaySettings& settings_;
  Way found_;
};

}  // namespace

Way find_way(const Ground& ground, std::span<const grammar::Part> parts, const grammar::Pose& frame,
             double length, double width, const WaySettings& settings) {
  return Pathfinder(ground, parts, frame, settings).run(length, width);
}

}  // namespace tafoni::landforms::impl
