#pragma once
// How strongly rock is carved [Paris19 §6.1], and the primitives that do it.

#include <cmath>

namespace tafoni::landforms {

/// e(rho, sigma) = sigma (1 - rho)(1 - beta) + sigma beta, in [0, 1]: no effect without stress, and beta on
/// the hardest rock under full stress.
constexpr double erosion_effect(double rho, double stress, double beta) {
  return stress * (1 - rho) * (1 - beta) + stress * beta;
}

/// The energy of each of a line of points `step` apart, of radius of influence `reach`, that opens a tube of
/// radius `open` < reach where the rock's field is `amplitude` (deep inside). Their falloffs sum up to
/// (32/35) (reach / step) (1 - (r / reach)^2)^(7/2) at distance r from a long line; for a step below reach
/// / 2.
inline double tube_energy(double amplitude, double open, double reach, double step) {
  const double q = 1 - (open / reach) * (open / reach);
  return amplitude * step * 35 / (32 * reach * std::pow(q, 3.5));
}

}  // namespace tafoni::landforms
