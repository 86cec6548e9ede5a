// Paths are compared by device and inode, those of files to come by that of their folder.

#include "tafoni/core/files.h"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <string>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include "tafoni/core/error.h"
#include "tafoni/core/impl/left_over.h"
#include "tafoni/core/inner/file_lock.h"

namespace tafoni {

namespace fs = std::filesystem;

namespace {

fs::path folder_of(const fs::path& path) {
  return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

std::string with_case(std::string text, int (*change)(int)) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [&](unsigned char c) { return static_cast<char>(change(c)); });
  return text;
}

/// Whether a folder's disk takes names for the same that differ in case alone: tried with a file.
bool overlooks_case(const fs::path& folder) {
  fs::path name;
  const int fd = impl::make_temporary_file(folder, name);
  if (fd < 0) return false;
  struct stat info {};
  const fs::path other = folder / with_case(name.filename().string(), &std::toupper);
  const bool found = ::stat(other.c_str(), &info) == 0;
  ::unlink(name.c_str());
  ::close(fd);
  return found;
}

bool goes_up(const fs::path& path) {
  return std::find(path.begin(), path.end(), "..") != path.end();
}

/// As far as there is anything; the path itself where it cannot be told.
fs::path without_links(const fs::path& path) {
  std::error_code code;
  const fs::path real = fs::weakly_canonical(path, code);
  return code ? path : real;
}

bool same_place(const fs::path& a, const fs::path& b) {
  return without_links(a) == without_links(b);
}

}  // namespace

fs::path follow_links(const fs::path& path) {
  constexpr int most = 40;  // as many as Linux follows
  fs::path at = path;
  std::error_code code;
  for (int i = 0; i < most; ++i) {
    if (!fs::is_symlink(at, code)) return at;
    const fs::path to = fs::read_symlink(at, code);
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  fail(ErrorKind::input, "{}: is a link that leads in a circle; give the file itself", path.string());
}

fs::path tidy(const fs::path& path) {
  const fs::path plain = path.lexically_normal();
  return goes_up(path) && !same_place(path, plain) ? without_links(path) : plain;
}

fs::path relative_to(const fs::path& folder, const fs::path& path) {
  const fs::path plain = tidy(path).lexically_relative(tidy(folder));
  if (!goes_up(plain) || same_place(folder / plain, path)) return plain;
  return without_links(path).lexically_relative(without_links(folder));
}

bool same_file(const fs::path& a, const fs::path& b) {
  struct stat left {
  }, right{};
  const bool has_left = ::stat(a.c_str(), &left) == 0, has_right = ::stat(b.c_str(), &right) == 0;
  if (has_left != has_right) return false;
  if (has_left) return left.st_dev == right.st_dev && left.st_ino == right.st_ino;
  const fs::path x = follow_links(a), y = follow_links(b);
  std::error_code code;
  const fs::path folder = folder_of(x);
  const bool together = fs::equivalent(folder, folder_of(y), code) ||
                        fs::weakly_canonical(folder, code) == fs::weakly_canonical(folder_of(y), code);
  if (!together) return false;
  const std::string name = x.filename().string(), other = y.filename().string();
  if (name == other) return true;
  return with_case(name, &std::tolower) == with_case(other, &std::tolower) && overlooks_case(folder);
}

TemporaryFolder::TemporaryFolder(const fs::path& around) {
  const fs::path folder = around.empty() ? fs::path(".") : around;
  impl::clear_left_over(folder);
  for (bool made = false; !made;) {
    path_ = impl::temporary_name(folder);
    if (::mkdir(path_.c_str(), 0777) != 0)
      fail(ErrorKind::output, "cannot write to {}: {}; check permissions and space", folder.string(),
           std::strerror(errno));
    fd_ = ::open(path_.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
    made = fd_ < 0 || inner::try_lock(fd_) != inner::Locked::yes || inner::leads_to(path_, fd_);
    if (!made) ::close(fd_);  // another process found it left over before it was locked
  }
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code code;
  fs::remove_all(path_, code);
  if (fd_ >= 0) ::close(fd_);
}

}  // namespace tafoni
