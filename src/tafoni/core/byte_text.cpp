#include "tafoni/core/byte_text.h"

#include <optional>

#include <fmt/format.h>

namespace tafoni {
namespace {

unsigned byte_at(std::string_view text, std::size_t at) {
  return at < text.size() ? static_cast<unsigned char>(text[at]) : 0u;
}

/// The bytes of the character that a text begins with; 0 where it is not UTF-8 as RFC 3629 has it.
std::size_t character_bytes(std::string_view text) {
  const unsigned first = byte_at(text, 0), second = byte_at(text, 1);
  if (first < 0x80) return 1;
  const std::size_t count = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  for (std::size_t i = 1; i < count; ++i)
    if ((byte_at(text, i) & 0xc0) != 0x80) return 0;
  const bool overlong = (first == 0xe0 && second < 0xa0) || (first == 0xf0 && second < 0x90);
  const bool surrogate = first == 0xed && second >= 0xa0;
  const bool beyond = first == 0xf4 && second >= 0x90;
  return overlong || surrogate || beyond ? 0 : count;
}

std::optional<unsigned> hex_digit(unsigned c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  return std::nullopt;
}

/// The byte that an escape at the beginning of a text stands for.
std::optional<unsigned> escaped(std::string_view text) {
  if (!text.starts_with("\\x")) return std::nullopt;
  const auto high = hex_digit(byte_at(text, 2)), low = hex_digit(byte_at(text, 3));
  if (!high || !low) return std::nullopt;
  return *high * 16 + *low;
}

}  // namespace

std::string to_utf8(std::string_view bytes) {
  std::string out;
  while (!bytes.empty()) {
    const std::size_t count = character_bytes(bytes);
    if (count == 0 || escaped(bytes))
      out += fmt::format("\\x{:02X}", byte_at(bytes, 0));
    else
      out += bytes.substr(0, count);
    bytes.remove_prefix(count == 0 ? 1 : count);
  }
  return out;
}

std::size_t first_not_utf8(std::string_view text) {
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t count = character_bytes(text.substr(at));
    if (count == 0) return at;
    at += count;
  }
  return std::string_view::npos;
}

std::string from_utf8(std::string_view text) {
  std::string out;
  while (!text.empty()) {
    const auto byte = escaped(text);
    out += byte ? static_cast<char>(*byte) : text.front();
    text.remove_prefix(byte ? 4 : 1);
  }
  return out;
}

}  // namespace tafoni
