#pragma once
// Angles are radians inside; users give degrees.

#include <numbers>

namespace tafoni {

inline constexpr double degree = std::numbers::pi / 180;
inline constexpr double full_turn = 2 * std::numbers::pi;

}  // namespace tafoni
