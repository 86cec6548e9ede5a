// A name says nothing of the process that made it: numbers of processes are used again, and others may stand
// for them in a container or on another machine. Locks are known to all who see the file.

#include "tafoni/core/impl/left_over.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdint>
#include <mutex>
#include <random>
#include <set>
#include <string>
#include <string_view>

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include "tafoni/core/inner/file_lock.h"

namespace tafoni::impl {

namespace fs = std::filesystem;

namespace {

constexpr std::string_view front = ".tafoni-", back = ".part";
constexpr std::size_t digits = 16;

bool is_temporary(std::string_view name) {
  if (name.size() != front.size() + digits + back.size() || !name.starts_with(front) || !name.ends_with(back))
    return false;
  const std::string_view number = name.substr(front.size(), digits);
  return std::all_of(number.begin(), number.end(), [](unsigned char c) { return std::isxdigit(c) != 0; });
}

/// Removes it unless somebody holds it, or that cannot be told.
void remove_left_over(const fs::path& path) {
  const auto open = [&](int how) { return ::open(path.c_str(), how | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC); };
  int fd = open(O_RDWR);  // disks across a network lock what is open for writing alone
  if (fd < 0) fd = open(O_RDONLY);
  if (fd < 0) return;
  std::error_code ignored;
  if (inner::try_lock(fd) == inner::Locked::yes && inner::leads_to(path, fd)) fs::remove_all(path, ignored);
  ::close(fd);
}

}  // namespace

fs::path temporary_name(const fs::path& folder) {
  std::random_device random;
  const std::uint64_t number = std::uint64_t{random()} << 32 | random();
  return folder / fmt::format("{}{:016x}{}", front, number, back);
}

int make_temporary_file(const fs::path& folder, fs::path& name) {
  for (int attempt = 0; attempt < 100; ++attempt) {
    name = temporary_name(folder);
    const int fd = ::open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == EEXIST) continue;
    if (fd < 0) return fd;
    inner::try_lock(fd);
    // Before the lock was taken, another process may have found the file left over.
    if (inner::leads_to(name, fd)) return fd;
    ::close(fd);
  }
  errno = EEXIST;
  return -1;
}

void clear_left_over(const fs::path& folder) {
  static std::mutex mutex;
  static std::set<fs::path> cleared;
  std::error_code code;
  {
    const std::lock_guard lock(mutex);
    if (!cleared.insert(fs::weakly_canonical(folder, code)).second) return;
  }
  for (fs::directory_iterator at(folder, code), end; !code && at != end; at.increment(code))
    if (is_temporary(at->path().filename().string())) remove_left_over(at->path());
}

}  // namespace tafoni::impl
