#pragma once
// Output files appear whole or not at all.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>

namespace tafoni {

/// Writes to a file without a name, which takes the target's place on commit(), so that neither a crash, nor
/// Ctrl-C, nor a full disk leaves a half-written result or anything else. Without commit() the target stays
/// as it was. Where the disk has no files without names, and at the moment of replacing a target, it is a
/// temporary name beside the target; one that a killed process leaves there is removed by the next that
/// writes to the folder. Every failure is an Error{output} that names the target.
class AtomicFile {
 public:
  /// Throws when the folder is missing or not writable, or the target is a folder.
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
  /// What is written in the end: a link's, the file that it leads to.
  const std::filesystem::path& target() const { return target_; }
  /// A path of the open file, for libraries that insist on opening one themselves; they must have closed it
  /// before commit(). It has no extension.
  std::filesystem::path path() const;
  /// Flushes to the disk and takes the target's place; the target is then complete. Either of the two may be
  /// called once.
  void commit();
  /// The same where there is no target yet; gives false, and changes nothing, where one has come to exist.
  bool commit_new();

 private:
  [[noreturn]] void fail_write(const char* what) const;
  void flush();
  void finish();
  /// Gives the file that name unless another has it; false with errno.
  bool name_it(const std::filesystem::path& name);

  std::filesystem::path target_;
  std::filesystem::path temporary_;  ///< empty while it has no name
  std::string buffer_;
  int fd_ = -1;
};

}  // namespace tafoni
