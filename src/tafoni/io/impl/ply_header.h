#pragma once
// The header of a PLY file: its encoding, elements and properties.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/io/impl/reading.h"

namespace tafoni::io::impl {

enum class PlyType : std::uint8_t { i8, u8, i16, u16, i32, u32, f32, f64 };
constexpr std::size_t size_of(PlyType type) {
  constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

struct PlyProperty {
  std::string name;
  PlyType type = PlyType::f32;
  bool list = false;
  PlyType count_type = PlyType::u8;  ///< of a list
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;

  /// The index of a property, or -1.
  int find(std::string_view property) const;
  /// The fewest bytes that one item can take.
  std::size_t least_bytes(bool text) const;
};

enum class PlyEncoding : std::uint8_t { text, little, big };

struct PlyHeader {
  PlyEncoding encoding = PlyEncoding::text;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0, lines = 0;  ///< what the header takes
};

/// Throws Error{input}, also when the elements announced cannot fit in the file.
PlyHeader read_ply_header(std::span<const std::byte> bytes, std::string_view file);

}  // namespace tafoni::io::impl
