#pragma once
// Files to be read are regular ones: a pipe, a device or a folder in place of one is refused before a byte is
// asked of it, as it may never give one, or never an end.

#include <cstdint>
#include <filesystem>
#include <string>

namespace tafoni {

/// A regular file that is open for reading.
class InputFile {
 public:
  /// Throws Error{input}: missing, not readable, a folder, a pipe, a device.
  explicit InputFile(std::filesystem::path path);
  ~InputFile();
  InputFile(const InputFile&) = delete;
  InputFile& operator=(const InputFile&) = delete;

  int descriptor() const { return fd_; }
  std::uint64_t size() const { return size_; }
  /// Its first bytes, at most `most` of them. Throws Error{input} when they cannot be read.
  std::string first(std::uint64_t most) const;
  std::string whole() const { return first(size_); }

 private:
  std::filesystem::path path_;
  int fd_ = -1;
  std::uint64_t size_ = 0;
};

}  // namespace tafoni
