// Writes a file under a temporary name beside its target through a buffer, and renames it when it is
// complete.

#include "tafoni/core/atomic_file.h"

#include <atomic>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tafoni/core/error.h"

namespace tafoni {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

/// A plain file, or nothing yet. A device such as /dev/null has no "beside" and cannot be replaced.
bool replaceable(const std::filesystem::path& target) {
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  std::error_code ignored;
  if (target_.filename().empty() || std::filesystem::is_directory(target_, ignored))
    fail(ErrorKind::output, "cannot write {}: it is a folder; name a file.", target_.string());
  if (!replaceable(target_))
    fail(ErrorKind::output, "cannot write {}: it is not a plain file; name one.", target_.string());
  // A link stays a link: what it points at is replaced.
  if (std::filesystem::is_symlink(target_, ignored)) {
    auto resolved = std::filesystem::weakly_canonical(target_, ignored);
    if (!ignored) target_ = std::move(resolved);
  }
  static std::atomic<unsigned> counter{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    temporary_ = target_;
    temporary_.replace_filename(fmt::format(".{}.{}-{}{}", target_.stem().string(), ::getpid(), counter++,
                                            target_.extension().string()));
    fd_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ >= 0 || errno != EEXIST) break;
  }
  if (fd_ < 0) fail_write(std::strerror(errno));
  struct stat info {};
  if (::stat(target_.c_str(), &info) == 0) (void)::fchmod(fd_, info.st_mode & 07777);
  buffer_.reserve(buffer_bytes);
}

AtomicFile::~AtomicFile() {
  if (fd_ < 0) return;
  ::close(fd_);
  ::unlink(temporary_.c_str());
}

void AtomicFile::fail_write(const char* what) const {
  fail(ErrorKind::output, "cannot write {}: {}.", target_.string(), what);
}

void AtomicFile::flush() {
  const char* data = buffer_.data();
  std::size_t left = buffer_.size();
  while (left > 0) {
    const ssize_t written = ::write(fd_, data, left);
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail_write(std::strerror(errno));
    data += written;
    left -= static_cast<std::size_t>(written);
  }
  buffer_.clear();
}

void AtomicFile::write(const void* data, std::size_t bytes) {
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    const std::size_t part = std::min(bytes, buffer_bytes - buffer_.size());
    buffer_.append(from, part);
    if (buffer_.size() == buffer_bytes) flush();
    from += part;
    bytes -= part;
  }
}

std::size_t AtomicFile::position() {
  const off_t at = ::lseek(fd_, 0, SEEK_CUR);
  if (at < 0) fail_write(std::strerror(errno));
  return static_cast<std::size_t>(at) + buffer_.size();
}

void AtomicFile::seek(std::size_t position) {
  flush();
  if (::lseek(fd_, static_cast<off_t>(position), SEEK_SET) < 0) fail_write(std::strerror(errno));
}

void AtomicFile::commit() {
  flush();
  // Some disks tell that they are full only here.
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail_write(std::strerror(errno));
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail_write(std::strerror(errno));
  ::close(fd_);
  fd_ = -1;
}

}  // namespace tafoni
