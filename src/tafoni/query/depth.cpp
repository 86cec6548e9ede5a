// How deep a place lies in the rock of a field: lines all about it grow until one comes to air; then that one
// is turned this way and that for as long as it becomes shorter.

#include <algorithm>
#include <array>
#include <cmath>

#include "tafoni/query/walks.h"

namespace tafoni::query {
namespace {

constexpr double first_step = 0.01, growth = 1.2;      // metres, and from sphere to sphere
constexpr double deepest = 100;                        // metres
constexpr double first_turn = 0.4, last_turn = 0.003;  // radians
constexpr double shorter = 0.9999;                     // by this share at least, or a turn is not worth it

bool air(const field::CompiledField& field, Vec3d p) {
  return !(field.value(p) > 0);
}

/// Where air begins along the line, between shares of it in the rock and in the air.
double way_to_air(const field::CompiledField& field, Vec3d p, Vec3d unit, double rock, double open) {
  for (int i = 0; i < 40; ++i) {
    const double middle = (rock + open) / 2;
    (air(field, p + unit * middle) ? open : rock) = middle;
  }
  return open;
}

std::array<Vec3d, 26> directions() {
  std::array<Vec3d, 26> out;
  std::size_t n = 0;
  for (int i = 0; i < 27; ++i)
    if (i != 13) out[n++] = normalized(Vec3d{i % 3 - 1.0, i / 3 % 3 - 1.0, i / 9 - 1.0});
  return out;
}

}  // namespace

double depth_in(const field::CompiledField& field, Vec3d p) {
  if (air(field, p)) return 0;
  static const std::array<Vec3d, 26> all = directions();
  double before = 0, best = deepest;
  Vec3d unit;
  for (double now = first_step; before < best; before = now, now *= growth) {
    for (Vec3d d : all) {
      if (!air(field, p + d * std::min(now, deepest))) continue;
      const double way = way_to_air(field, p, d, before, std::min(now, deepest));
      if (way < best) best = way, unit = d;
    }
  }
  if (best == deepest) return best;
  for (double turn = first_turn; turn > last_turn; turn /= 2) {
    const Vec3d side = normalized(cross(unit, std::abs(unit.z) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0}));
    const Vec3d other = cross(unit, side);
    for (Vec3d by : {side, -side, other, -other}) {
      const Vec3d turned = normalized(unit + by * turn);
      if (!air(field, p + turned * (best * shorter))) continue;
      best = way_to_air(field, p, turned, 0, best * shorter), unit = turned;
      turn *= 2;  // the same again from there
      break;
    }
  }
  return best;
}

}  // namespace tafoni::query
