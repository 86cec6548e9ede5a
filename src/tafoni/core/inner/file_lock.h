#pragma once
// Locks between processes, and between the parts of one, that end with whoever holds them.

#include <chrono>
#include <filesystem>
#include <optional>
#include <utility>

namespace tafoni::inner {

/// What became of asking for the lock of an open file: got, held by someone else, or not known on that disk.
enum class Locked { yes, no, unsupported };
/// Does not wait. The lock lasts until the descriptor is closed.
Locked try_lock(int fd);

/// Whether the path is that of the open file still, and not of one that was put in its place.
bool leads_to(const std::filesystem::path& path, int fd);

/// The lock of a file that exists, also while the file is replaced by another of its name.
class FileLock {
 public:
  /// Waits for others as long as that; nothing where they hold it still. Where there is no such file, or its
  /// disk knows no locks, it goes on without one.
  static std::optional<FileLock> take(const std::filesystem::path& file, std::chrono::milliseconds wait);
  ~FileLock();
  FileLock(FileLock&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
  FileLock& operator=(FileLock&&) = delete;

 private:
  explicit FileLock(int fd) : fd_(fd) {}
  int fd_;
};

}  // namespace tafoni::inner
