#pragma once
// Erosion effect and carving energies (document 003, section 6.1).

#include <cmath>

namespace tafoni::landforms {

/// e(rho, sigma) = sigma (1 - rho) (1 - beta) + sigma beta: none without stress, beta for the hardest rock
/// under full stress. All in [0, 1].
inline double erosion_effect(double resistance, double stress, double beta) {
  return stress * (1 - resistance) * (1 - beta) + stress * beta;
}

/// The energy a line of points `step` apart, each of falloff radius `reach`, needs so that, deep in rock
/// where f = amplitude, it opens a tube of radius `open` < reach. The sum of the points' falloffs at distance
/// r from the line is (32/35) (reach / step) (1 - (r / reach)^2)^(7/2), for a step well below the reach.
inline double tube_energy(double amplitude, double open, double reach, double step) {
  const double q = 1 - (open / reach) * (open / reach);
  return amplitude * step * 35 / (32 * reach * std::pow(q, 3.5));
}

}  // namespace tafoni::landforms
