#pragma once
// How strongly rock is carved [Paris19 §6.1], and the primitives that do it.

#include <algorithm>
#include <cmath>

namespace tafoni::landforms {

/// e(rho, sigma) = sigma (1 - rho)(1 - beta) + sigma beta, in [0, 1]: no effect without stress, and beta on
/// the hardest rock under full stress.
constexpr double erosion_effect(double rho, double stress, double beta) {
  return stress * (1 - rho) * (1 - beta) + stress * beta;
}

/// The energy of each of a line of points `step` apart, of radius of influence `reach`, that opens a tube of
/// radius `open` < reach where the rock's field is `amplitude` (deep inside). For a step below reach / 2
/// their falloffs sum up to (32/35) (reach / step) (1 - (r / reach)^2)^(7/2) at distance r from a long line.
inline double tube_energy(double amplitude, double open, double reach, double step) {
  const double q = 1 - (open / reach) * (open / reach);
  return amplitude * step * 35 / (32 * reach * std::pow(q, 3.5));
}

/// How many times its own energy the points together take off a plane that dart throwing has covered with
/// points of radius of influence `radius`, no two nearer than `spacing`; at least 1. Such throwing leaves
/// about 0.7 samples a spacing squared, and a point of energy E integrates to E pi radius^2 / 4 over the
/// plane.
inline double overlap_of_darts(double radius, double spacing) {
  return std::max(1.0, 0.7 * 0.785 * (radius / spacing) * (radius / spacing));
}

}  // namespace tafoni::landforms
