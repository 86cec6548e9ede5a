#include "tafoni/io/impl/writing.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace tafoni::io::impl {

std::string origin_text(Vec3d origin) {
  return fmt::format("{} {} {}", origin.x, origin.y, origin.z);
}

std::optional<Vec3d> find_origin(std::string_view text, std::string_view key) {
  const std::size_t at = text.find(key);
  if (at == text.npos) return {};
  const char* p = text.data() + at + key.size();
  const char* const end = text.data() + text.size();
  double v[3] = {};
  for (double& x : v) {
    while (p != end && *p == ' ') ++p;
    const auto [next, error] = std::from_chars(p, end, x);
    if (error != std::errc() || !std::isfinite(x)) return {};
    p = next;
  }
  return Vec3d{v[0], v[1], v[2]};
}

std::string one_line(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return static_cast<unsigned char>(c) < 32; }, ' ');
  return line;
}

std::string ascii_line(std::string_view text) {
  std::string line;
  for (const char c : one_line(text)) {
    const bool ascii = static_cast<unsigned char>(c) < 127;
    // The bytes of a character after its first one say nothing new.
    if (ascii || (static_cast<unsigned char>(c) & 0xc0) != 0x80) line += ascii ? c : '?';
  }
  return line;
}

std::string axes_text(const MeshForm& form) {
  return fmt::format("tafoni: metres, {} up", form.up);
}

bool says_y_up(std::string_view header) {
  return header.find("tafoni: metres, y up") != header.npos;
}

float srgb_from_linear(std::uint8_t linear) {
  const double l = linear / 255.0;
  return static_cast<float>(l <= 0.0031308 ? 12.92 * l : 1.055 * std::pow(l, 1 / 2.4) - 0.055);
}

std::uint8_t linear_from_srgb(double srgb) {
  const double s = srgb > 0 ? std::min(srgb, 1.0) : 0.0;  // and for NaN
  const double l = s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
  return static_cast<std::uint8_t>(std::lround(l * 255));
}

}  // namespace tafoni::io::impl
