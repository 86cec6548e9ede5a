// Writes a file without a name through a buffer, and gives it the target's name when it is complete. A name
// can be given but not taken over in one step, so one that is to replace a target is renamed.

#include "tafoni/core/atomic_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/core/impl/left_over.h"
#include "tafoni/core/inner/file_lock.h"

namespace tafoni {
namespace {

constexpr std::size_t buffer_bytes = std::size_t{1} << 20;

/// A plain file, or nothing yet. A device such as /dev/null has no "beside" and cannot be replaced.
bool replaceable(const std::filesystem::path& target) {
  std::error_code ignored;
  const auto status = std::filesystem::status(target, ignored);
  return !std::filesystem::exists(status) || std::filesystem::is_regular_file(status);
}

std::filesystem::path path_of(int fd) {
  return "/proc/self/fd/" + std::to_string(fd);
}

}  // namespace

AtomicFile::AtomicFile(std::filesystem::path target) : target_(std::move(target)) {
  std::error_code ignored;
  if (target_.filename().empty() || std::filesystem::is_directory(target_, ignored))
    fail(ErrorKind::output, "cannot write {}: it is a folder; name a file.", target_.string());
  if (!replaceable(target_))
    fail(ErrorKind::output, "cannot write {}: it is not a plain file; name one.", target_.string());
  // A link stays a link: what it points at is replaced.
  target_ = follow_links(target_);
  const std::filesystem::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
  if (std::filesystem::status(folder, ignored).type() == std::filesystem::file_type::not_found)
    fail(ErrorKind::output, "cannot write {}: there is no folder {}; make it, or give another path.",
         target_.string(), folder.string());
  impl::clear_left_over(folder);
  fd_ = ::open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0666);
  if (fd_ >= 0 && !std::filesystem::exists(path_of(fd_), ignored)) {
    ::close(fd_);
    fd_ = -1;
  }
  if (fd_ < 0) fd_ = impl::make_temporary_file(folder, temporary_);
  if (fd_ < 0) fail_write(std::strerror(errno));
  struct stat info {};
  if (::stat(target_.c_str(), &info) == 0) (void)::fchmod(fd_, info.st_mode & 07777);
  buffer_.reserve(buffer_bytes);
}

AtomicFile::~AtomicFile() {
  if (fd_ < 0) return;
  if (!temporary_.empty()) ::unlink(temporary_.c_str());
  ::close(fd_);
}

std::filesystem::path AtomicFile::path() const {
  return temporary_.empty() ? path_of(fd_) : temporary_;
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

void AtomicFile::finish() {
  flush();
  // Some disks tell that they are full only here.
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != EROFS) fail_write(std::strerror(errno));
}

bool AtomicFile::name_it(const std::filesystem::path& name) {
  if (temporary_.empty())
    return ::linkat(AT_FDCWD, path_of(fd_).c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0;
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, name.c_str(), RENAME_NOREPLACE) == 0) return true;
  if (errno != EINVAL && errno != ENOSYS) return false;
  // The disk cannot rename without replacing.
  if (::link(temporary_.c_str(), name.c_str()) != 0) return false;
  ::unlink(temporary_.c_str());
  return true;
}

bool AtomicFile::commit_new() {
  finish();
  if (!name_it(target_)) {
    if (errno == EEXIST) return false;
    fail_write(std::strerror(errno));
  }
  ::close(fd_);
  fd_ = -1;
  return true;
}

void AtomicFile::commit() {
  if (commit_new()) return;
  if (temporary_.empty()) {
    inner::try_lock(fd_);  // while it has a temporary name
    const std::filesystem::path name = impl::temporary_name(target_.parent_path());
    if (!name_it(name)) fail_write(std::strerror(errno));
    temporary_ = name;
  }
  if (::rename(temporary_.c_str(), target_.c_str()) != 0) fail_write(std::strerror(errno));
  ::close(fd_);
  fd_ = -1;
}

}  // namespace tafoni
