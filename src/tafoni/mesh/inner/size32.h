#pragma once
// Meshes number vertices and triangles by 32 bits.

#include <cstdint>

namespace tafoni::mesh::inner {

/// How long a list is: the index that its next element will have. Whoever may make 2^32 or more of them
/// checks that first.
template <class List>
constexpr std::uint32_t size32(const List& list) {
  return static_cast<std::uint32_t>(list.size());
}

}  // namespace tafoni::mesh::inner
