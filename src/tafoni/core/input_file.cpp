// Opens without waiting, looks at what was opened, and only then reads.

#include "tafoni/core/input_file.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tafoni/core/error.h"

namespace tafoni {

InputFile::InputFile(std::filesystem::path path) : path_(std::move(path)) {
  // A pipe without a writer would be waited for, and a terminal become the program's own.
  fd_ = ::open(path_.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd_ < 0 && errno == ENOENT)
    fail(ErrorKind::input, "{}: does not exist; check the path.", path_.string());
  if (fd_ < 0)
    fail(ErrorKind::input, "{}: cannot be opened ({}); check the path.", path_.string(),
         std::strerror(errno));
  struct stat info = {};
  const bool known = ::fstat(fd_, &info) == 0;
  if (known && S_ISREG(info.st_mode)) {
    size_ = info.st_size;
    return;
  }
  ::close(fd_);
  if (known && S_ISDIR(info.st_mode))
    fail(ErrorKind::input, "{}: is a folder; give the path of a file.", path_.string());
  fail(ErrorKind::input, "{}: is a pipe or a device, not a regular file; give the path of a file.",
       path_.string());
}

InputFile::~InputFile() {
  ::close(fd_);
}

std::string InputFile::first(std::uint64_t most) const {
  std::string bytes(std::min(most, size_), '\0');
  std::size_t at = 0;
  while (at < bytes.size()) {
    const ssize_t got = ::pread(fd_, bytes.data() + at, bytes.size() - at, static_cast<off_t>(at));
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(ErrorKind::input, "{}: cannot be read ({}).", path_.string(), std::strerror(errno));
    if (got == 0) break;
    at += got;
  }
  bytes.resize(at);
  return bytes;
}

}  // namespace tafoni
