// Flips the longest edge of every triangle without area, by a table that says which triangle passes a
// directed edge, until none is left or none can be mended.

#include <algorithm>
#include <unordered_map>

#include "tafoni/mesh/impl/patches.h"

namespace tafoni::mesh::impl {
namespace {

/// A triangle whose height is below this share of its longest side has no area to speak of in single
/// precision.
constexpr double flat = 1e-6;
/// Each pass mends the next triangle along a straight border; borders of a patch are shorter than this.
constexpr int most_passes = 1000;

std::uint64_t directed(std::uint32_t a, std::uint32_t b) {
  return (std::uint64_t{a} << 32) | b;
}

class Flipper {
 public:
  Flipper(std::span<const Vec3f> positions, std::vector<Triangle>& triangles)
      : positions_(positions), triangles_(triangles) {}

  void run() {
    std::vector<std::uint32_t> bad;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t)
      if (shape(triangles_[t]) < flat) bad.push_back(t);
    if (bad.empty()) return;
    for (std::uint32_t t = 0; t < triangles_.size(); ++t) note(t);
    // A neighbour may be flat as well until it is mended itself: along a straight border one follows another.
    bool progress = true;
    for (int pass = 0; pass < most_passes && progress; ++pass) {
      progress = false;
      for (std::uint32_t t : bad)
        if (shape(triangles_[t]) < flat && flip(t)) progress = true;
      std::erase_if(bad, [&](std::uint32_t t) { return shape(triangles_[t]) >= flat; });
    }
  }

 private:
  Vec3d at(std::uint32_t v) const { return to_double(positions_[v]); }
  /// Twice the area over the longest side squared.
  double shape(const Triangle& t) const {
    const Vec3d u = at(t[1]) - at(t[0]), v = at(t[2]) - at(t[0]), w = v - u;
    const double longest = std::max({dot(u, u), dot(v, v), dot(w, w)});
    return longest > 0 ? length(cross(u, v)) / longest : 0;
  }
  double reach(const Triangle& t) const {
    return std::max({length(at(t[1]) - at(t[0])), length(at(t[2]) - at(t[1])), length(at(t[0]) - at(t[2]))});
  }
  void note(std::uint32_t t) {
    for (std::size_t c = 0; c < 3; ++c) owner_[directed(triangles_[t][c], triangles_[t][(c + 1) % 3])] = t;
  }
  bool joined(std::uint32_t a, std::uint32_t b) const {
    return owner_.contains(directed(a, b)) || owner_.contains(directed(b, a));
  }

  bool flip(std::uint32_t t) {
    const Triangle old = triangles_[t];
    std::size_t longest = 0;
    const auto side = [&](std::size_t c) { return length(at(old[(c + 1) % 3]) - at(old[c])); };
    for (std::size_t c = 1; c < 3; ++c)
      if (side(c) > side(longest)) longest = c;
    const std::uint32_t c = old[longest], a = old[(longest + 1) % 3], b = old[(longest + 2) % 3];
    const auto found = owner_.find(directed(a, c));
    if (found == owner_.end()) return false;
    const std::uint32_t n = found->second;
    std::uint32_t d = a;
    for (auto v : triangles_[n])
      if (v != a && v != c) d = v;
    if (d == b || joined(b, d)) return false;
    const Triangle first{b, c, d}, second{b, d, a};
    // Two flat triangles on one line come apart when their common side is the longest of both.
    const bool better = shape(triangles_[n]) < flat ? std::max(reach(first), reach(second)) < reach(old)
                                                    : std::min(shape(first), shape(second)) > shape(old);
    if (!better) return false;
    owner_.erase(directed(a, c));
    owner_.erase(directed(c, a));
    triangles_[t] = first;
    triangles_[n] = second;
    note(t);
    note(n);
    return true;
  }

  std::span<const Vec3f> positions_;
  std::vector<Triangle>& triangles_;
  std::unordered_map<std::uint64_t, std::uint32_t> owner_;
};

}  // namespace

void flip_flat_triangles(std::span<const Vec3f> positions, std::vector<Triangle>& triangles) {
  Flipper(positions, triangles).run();
}

}  // namespace tafoni::mesh::impl
