#pragma once
// Output files appear whole or not at all.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace tafoni {

/// Writes to a temporary file beside the target and renames it over the target on commit(), so that neither
/// a crash, nor Ctrl-C, nor a full disk leaves a half-written result. Without commit() the destructor
/// removes the temporary file and the target stays as it was. Every failure is an Error{output} that names
/// the target.
class AtomicFile {
 public:
  /// Creates the temporary file; throws when the folder is missing or not writable, or the target is a
  /// folder.
  explicit AtomicFile(std::filesystem::path target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  /// Appends at the current position; buffered.
  void write(const void* data, std::size_t bytes);
  void write(std::string_view text) { write(text.data(), text.size()); }
  /// Bytes written so far, which is also the position unless seek() moved it.
  std::size_t position();
  /// Moves the write position, to go back and fill in a header.
  void seek(std::size_t position);
  /// Where the temporary file lies, for libraries that insist on opening a path themselves; they must have
  /// closed it before commit(). It keeps the target's extension.
  const std::filesystem::path& path() const { return temporary_; }
  /// Flushes to the disk and renames; the target is then complete. May be called once.
  void commit();

 private:
  [[noreturn]] void fail_write(const char* what) const;
  std::filesystem::path target_, temporary_;
  std::string buffer_;
  int fd_ = -1;
  void flush();
};

}  // namespace tafoni
