// The header of a PLY file is read line by line; counts that cannot fit in the file are refused before
// anything is given memory for them.

#include "tafoni/io/impl/ply_header.h"

#include <utility>

namespace tafoni::io::impl {
namespace {

PlyType type_of(std::string_view word, const TextCursor& cursor) {
  static constexpr std::pair<std::string_view, PlyType> names[] = {
      {"char", PlyType::i8},    {"uchar", PlyType::u8},   {"short", PlyType::i16},
      {"ushort", PlyType::u16}, {"int", PlyType::i32},    {"uint", PlyType::u32},
      {"float", PlyType::f32},  {"double", PlyType::f64}, {"int8", PlyType::i8},
      {"uint8", PlyType::u8},   {"int16", PlyType::i16},  {"uint16", PlyType::u16},
      {"int32", PlyType::i32},  {"uint32", PlyType::u32}, {"float32", PlyType::f32},
      {"float64", PlyType::f64}};
  for (const auto& [name, type] : names)
    if (name == word) return type;
  cursor.fail_here(fmt::format("'{}' is not a PLY type", word.substr(0, 40)));
}

PlyEncoding encoding_of(std::string_view word, const TextCursor& cursor) {
  if (word == "ascii") return PlyEncoding::text;
  if (word == "binary_little_endian") return PlyEncoding::little;
  if (word == "binary_big_endian") return PlyEncoding::big;
  cursor.fail_here(fmt::format("'{}' is not a PLY encoding", word.substr(0, 40)));
}

PlyProperty read_property(TextCursor& cursor) {
  PlyProperty property;
  std::string_view word = cursor.token('\0');
  property.list = word == "list";
  if (property.list) {
    property.count_type = type_of(cursor.token('\0'), cursor);
    if (property.count_type == PlyType::f32 || property.count_type == PlyType::f64)
      cursor.fail_here("a list's length is not a whole number");
    word = cursor.token('\0');
  }
  property.type = type_of(word, cursor);
  property.name = cursor.token('\0');
  return property;
}

void check_fits(const PlyHeader& header, std::uint64_t left, const TextCursor& cursor) {
  const bool text = header.encoding == PlyEncoding::text;
  // The last line of a text may lack its end.
  left += text ? 1 : 0;
  for (const PlyElement& element : header.elements) {
    const std::uint64_t least = std::max<std::uint64_t>(element.least_bytes(text), 1);
    if (element.count > left / least)
      cursor.fail_here(
          fmt::format("{} elements '{}' do not fit in the file", element.count, element.name.substr(0, 40)));
    left -= element.count * least;
  }
}

}  // namespace

int PlyElement::find(std::string_view property) const {
  for (std::size_t i = 0; i < properties.size(); ++i)
    if (properties[i].name == property) return static_cast<int>(i);
  return -1;
}

std::size_t PlyElement::least_bytes(bool text) const {
  std::size_t bytes = 0;
  for (const PlyProperty& property : properties)
    bytes += text ? 2 : size_of(property.list ? property.count_type : property.type);
  return bytes;
}

PlyHeader read_ply_header(std::span<const std::byte> bytes, std::string_view file) {
  PlyHeader header;
  TextCursor cursor(as_text(bytes), file);
  if (cursor.rest_of_line() != "ply") cursor.fail_here("the word ply is missing at the beginning");
  bool ended = false, encoded = false;
  while (!cursor.at_end() && !ended) {
    const std::string_view word = cursor.token('\0');
    if (word == "format") {
      header.encoding = encoding_of(cursor.token('\0'), cursor);
      encoded = true;
    } else if (word == "element") {
      PlyElement element;
      element.name = cursor.token('\0');
      const std::int64_t count = cursor.integer(cursor.token('\0'));
      if (count < 0) cursor.fail_here("an element's count is negative");
      element.count = count;
      header.elements.push_back(std::move(element));
    } else if (word == "property") {
      if (header.elements.empty()) cursor.fail_here("a property stands before any element");
      header.elements.back().properties.push_back(read_property(cursor));
    }
    ended = word == "end_header";
    cursor.rest_of_line();
  }
  if (!ended || !encoded) cursor.fail_here("the header is not complete");
  header.bytes = bytes.size() - cursor.left();
  header.lines = cursor.line();
  check_fits(header, cursor.left(), cursor);
  return header;
}

}  // namespace tafoni::io::impl
