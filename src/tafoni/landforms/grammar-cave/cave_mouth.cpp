// Tries sixteen directions at the places of a grid: a good mouth has level ground before it and a hillside
// that rises fast behind it.

#include "tafoni/landforms/grammar-cave/cave_mouth.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "tafoni/core/parallel.h"
#include "tafoni/math/angle.h"
#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

constexpr int directions = 16;

// Chosen by eye.
constexpr double enough_rise = 3;   // times the rise wanted: more is no better
constexpr double slope_counts = 3;  // a slope of 1 before the mouth weighs as much as so many rises behind it
constexpr int most_rows = 256;      // of places tried
constexpr double least_step = 0.5;  // metres between them

Vec3d direction(int i) {
  return {std::cos(full_turn * i / directions), std::sin(full_turn * i / directions), 0};
}

double height(const Ground& ground, Vec3d p) {
  return ground.height(p.x, p.y);
}

/// How good a mouth is: the rise behind it as a share of what is wanted, less the slope before it.
double score(const Ground& ground, const CaveMouth& mouth, const MouthSettings& s) {
  double behind = 1e9;
  for (const double share : {0.5, 1.0, 1.5})
    behind = std::min(behind, (height(ground, mouth.at + mouth.inward * (share * s.within)) - mouth.at.z) /
                                  (s.rise * std::min(share, 1.0)));
  double before = 0;
  for (const double share : {0.5, 1.0})
    before =
        std::max(before, std::abs(height(ground, mouth.at - mouth.inward * (share * s.apron)) - mouth.at.z) /
                             (share * s.apron));
  return std::min(behind, enough_rise) - slope_counts * before;
}

bool possible(const Ground& ground, const CaveMouth& mouth, const MouthSettings& s) {
  for (const double off : {-s.apron, -0.5 * s.apron, 0.0, 0.5 * s.within, s.within}) {
    Vec3d p = mouth.at + mouth.inward * off;
    if (off < 0) p.z = height(ground, p);
    if (!ground.usable(p)) return false;
  }
  const auto slope = [&](double off) {
    return std::abs(height(ground, mouth.at - mouth.inward * off) - mouth.at.z) / off;
  };
  return slope(s.apron) <= s.slope && slope(0.5 * s.apron) <= s.slope &&
         height(ground, mouth.at + mouth.inward * s.within) - mouth.at.z >= s.rise;
}

}  // namespace

CaveMouth mouth_at(const Ground& ground, Vec2d at, const MouthSettings& settings) {
  CaveMouth best{{at.x, at.y, ground.height(at.x, at.y)}, {1, 0, 0}};
  double most = -1e300;
  for (int i = 0; i < directions; ++i) {
    const CaveMouth mouth{best.at, direction(i)};
    const double value = score(ground, mouth, settings);
    if (value > most) most = value, best = mouth;
  }
  return best;
}

std::optional<CaveMouth> find_mouth(const Ground& ground, const MouthSettings& settings, Progress& progress) {
  const Box3d& box = ground.box();
  if (box.empty()) return {};
  const double longest = std::max(box.size().x, box.size().y);
  const double step = std::max({ground.pixel(), longest / most_rows, least_step});
  const int columns = floor_to(box.size().x / step), rows = floor_to(box.size().y / step);
  struct Best {
    double value = -1e300;
    CaveMouth mouth;
  };
  std::vector<Best> best(std::max(rows, 0));
  progress.begin("looking for a mouth", best.size(), "rows");
  parallel_for(
      rows,
      [&](int row) {
        Best& here = best[row];
        for (int col = 0; col < columns; ++col) {
          Vec3d p{box.lo.x + (col + 0.5) * step, box.lo.y + (row + 0.5) * step, 0};
          p.z = height(ground, p);
          if (!ground.usable(p)) continue;
          for (int i = 0; i < directions; ++i) {
            const CaveMouth mouth{p, direction(i)};
            if (height(ground, p + mouth.inward * settings.within) - p.z < settings.rise) continue;
            const double value = score(ground, mouth, settings);
            if (value > here.value && possible(ground, mouth, settings)) here = {value, mouth};
          }
        }
      },
      progress);
  progress.end();
  progress.check();
  const auto found = std::max_element(best.begin(), best.end(),
                                      [](const Best& a, const Best& b) { return a.value < b.value; });
  if (found == best.end() || found->value <= -1e300) return std::nullopt;
  return found->mouth;
}

}  // namespace tafoni::landforms::impl
