#pragma once
// What the readers share: a file in memory, and bounds-checked steps through it.

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/mesh/mesh.h"

namespace tafoni::io::impl {

/// A whole regular file mapped read-only.
class MappedFile {
 public:
  /// Throws Error{input} when the file is missing, unreadable, empty or not a regular file.
  explicit MappedFile(const std::filesystem::path& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;
  std::span<const std::byte> bytes() const { return {static_cast<const std::byte*>(data_), size_}; }

 private:
  void* data_ = nullptr;
  std::size_t size_ = 0;
};

inline std::string_view as_text(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The T at a byte offset, which must lie inside.
template <class T>
T load(std::span<const std::byte> bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof(T));
  return value;
}

/// Steps through text token by token and line by line.
class TextCursor {
 public:
  TextCursor(std::string_view text, std::string_view file, std::size_t first_line = 1)
      : text_(text), file_(file), line_(first_line) {}

  bool at_end() const { return at_ >= text_.size(); }
  std::size_t left() const { return text_.size() - at_; }
  std::size_t line() const { return line_; }
  /// The rest of this line without its end; moves to the next line.
  std::string_view rest_of_line();
  /// The next token of this line, empty at the line's end or at a comment sign.
  std::string_view token(char comment = '#');
  /// The next token, over line ends and comments; empty only at the end of the text.
  std::string_view token_anywhere(char comment = '#');
  /// Throws Error{input} with file and line.
  [[noreturn]] void fail_here(std::string_view what) const;
  double number(std::string_view token) const;
  std::int64_t integer(std::string_view token) const;

 private:
  std::string_view text_, file_;
  std::size_t at_ = 0, line_;
};

std::string lower_case(std::string_view text);
/// What may stand for "none" or "infinite" among numbers, as C libraries print it.
bool is_no_number(std::string_view word);

/// Shares vertices whose positions are equal (0 and -0 are).
class Welder {
 public:
  explicit Welder(std::vector<Vec3f>& positions, std::size_t expected);
  std::uint32_t add(Vec3f p);

 private:
  struct Hash {
    std::size_t operator()(const std::array<std::uint32_t, 3>& k) const;
  };
  std::vector<Vec3f>& positions_;
  std::unordered_map<std::array<std::uint32_t, 3>, std::uint32_t, Hash> seen_;
};

/// Throws Error{input} unless there are triangles, all positions are finite, all indices in range and
/// attributes complete. Normals that are not unit length are normalised; when one is not usable, all are
/// dropped.
void check_read(mesh::Mesh& mesh, std::string_view file);

}  // namespace tafoni::io::impl
