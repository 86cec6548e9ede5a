#pragma once
// What rounding makes of exact contacts.

namespace tafoni::query::impl {

/// Metres. Shapes nearer than this to touching count as touching.
inline constexpr double touching = 1e-6;
/// A motion towards a surface by less than this share of its length counts as along it.
inline constexpr double parallel = 1e-9;
/// Metres. Triangles this near to a point of the surface meet there.
inline constexpr double meeting = 1e-7;

}  // namespace tafoni::query::impl
