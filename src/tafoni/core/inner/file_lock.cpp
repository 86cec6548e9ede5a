#include "tafoni/core/inner/file_lock.h"

#include <cerrno>
#include <thread>

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

namespace tafoni::inner {

Locked try_lock(int fd) {
  while (::flock(fd, LOCK_EX | LOCK_NB) != 0) {
    if (errno == EINTR) continue;
    return errno == EWOULDBLOCK ? Locked::no : Locked::unsupported;
  }
  return Locked::yes;
}

bool leads_to(const std::filesystem::path& path, int fd) {
  struct stat named {
  }, open{};
  return ::stat(path.c_str(), &named) == 0 && ::fstat(fd, &open) == 0 && named.st_dev == open.st_dev &&
         named.st_ino == open.st_ino;
}

std::optional<FileLock> FileLock::take(const std::filesystem::path& file, std::chrono::milliseconds wait) {
  constexpr std::chrono::milliseconds pause{5};
  const auto end = std::chrono::steady_clock::now() + wait;
  for (;;) {
    int fd = ::open(file.c_str(), O_RDWR | O_CLOEXEC | O_NONBLOCK);
    if (fd < 0) fd = ::open(file.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);
    FileLock lock(fd);
    if (fd < 0) return lock;
    const Locked locked = try_lock(fd);
    if (locked == Locked::unsupported || (locked == Locked::yes && leads_to(file, fd))) return lock;
    // A file that was replaced meanwhile is asked for again at once.
    if (locked == Locked::yes) continue;
    if (std::chrono::steady_clock::now() >= end) return std::nullopt;
    std::this_thread::sleep_for(pause);
  }
}

FileLock::~FileLock() {
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace tafoni::inner
