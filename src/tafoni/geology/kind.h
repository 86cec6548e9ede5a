#pragma once
// What the program knows of a kind of geology node: a declaration and one function that makes it.

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/registry.h"
#include "tafoni/geology/geology.h"

namespace tafoni::geology {

struct GeologyType {
  Declaration about = {};
  std::size_t min_children = 0, max_children = 0;  ///< a primitive has none
  /// `values` hold only what differs from the defaults. Positions of the node and of its children are world
  /// positions. Called by make_geology(), which has checked values and children.
  GeologyPtr (*make)(const Values& values, std::vector<GeologyPtr> children, std::uint64_t seed) = nullptr;
};

/// "no children", "1 child", "2 or 3 children".
std::string children_text(const GeologyType& type);

/// Every kind, sorted by name; kinds/NAME.cpp defines `const GeologyType& declaration()` in its namespace
/// `geology_NAME`.
std::span<const GeologyType* const> all_geologies();
/// Throws Error{usage} naming the nearest known one.
const GeologyType& find_geology(std::string_view name);

/// Makes a node of the named kind, to be asked at local positions as its children are; `origin` is the world
/// position of local zero. Throws Error{usage} for a wrong name, value or number of children.
GeologyPtr make_geology(std::string_view name, const Values& values, std::vector<GeologyPtr> children,
                        Vec3d origin, std::uint64_t seed);

/// The rock of a scene that names none: the strata kind with its defaults.
GeologyPtr default_geology(Vec3d origin, std::uint64_t seed);

}  // namespace tafoni::geology
