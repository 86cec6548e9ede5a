#pragma once
// What the tests of elevation input share: text files made in a folder of their own, and what is thrown.

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include <gmock/gmock.h>

#include "tafoni/core/error.h"
#include "tafoni/core/test/test_folder.h"
#include "tafoni/io/dem.h"

namespace tafoni::io {

namespace fs = std::filesystem;

inline fs::path temporary(const std::string& name) {
  static const TestFolder folder;
  return folder.path / name;
}
inline fs::path written(const std::string& name, const std::string& content) {
  std::ofstream(temporary(name), std::ios::binary) << content;
  return temporary(name);
}

/// An ESRI ASCII grid; `f(col, row)` in text.
template <class F>
fs::path ascii(const std::string& name, int width, int height, const std::string& place, F&& f) {
  std::string text = fmt::format("ncols {}\nnrows {}\n{}\n", width, height, place);
  for (int r = 0; r < height; ++r) {
    for (int c = 0; c < width; ++c) text += fmt::format("{} ", f(c, r));
    text += '\n';
  }
  return written(name, text);
}
inline double hill(int c, int r) {
  return 300 + 0.5 * c + 10 * std::sin(0.21 * r);
}
inline const std::string at_home = "xllcorner 500000\nyllcorner 5900000\ncellsize 10";

struct Thrown {
  ErrorKind kind = ErrorKind::internal;
  std::string text;
};
template <class F>
Thrown thrown_by(F&& f) {
  try {
    f();
  } catch (const Error& error) {
    return {error.kind(), error.what()};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

inline double at(const raster::Raster& r, int col, int row) {
  return r.values.at(col, row);
}
inline std::string test_name(std::string file) {
  for (char& c : file)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return file;
}
inline std::string joined(const std::vector<std::string>& notes) {
  std::string out;
  for (const auto& note : notes) out += note + "\n";
  return out;
}

}  // namespace tafoni::io
