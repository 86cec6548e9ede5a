#pragma once
// What the picture formats share.

#include <cstddef>
#include <string>
#include <vector>

#include "tafoni/raster/image.h"

namespace tafoni::io::impl {

/// A stb_image_write callback that appends to a std::string. The file may throw, which must not pass through
/// C code; so the bytes are collected first.
inline void append_to(void* bytes, void* data, int size) {
  static_cast<std::string*>(bytes)->append(static_cast<const char*>(data), size);
}

/// The first `channels` of each pixel, row by row.
inline std::vector<std::uint8_t> interleave(const raster::Image& image, int channels) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(image.size() * channels);
  for (const auto& pixel : image.values()) bytes.insert(bytes.end(), pixel.begin(), pixel.begin() + channels);
  return bytes;
}

}  // namespace tafoni::io::impl
