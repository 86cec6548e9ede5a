#pragma once
// Files as the disk knows them, whatever paths lead there.

#include <filesystem>

namespace tafoni {

/// Where a path leads once links are followed, be there a file or not. Throws Error{input} for links that
/// lead in a circle.
std::filesystem::path follow_links(const std::filesystem::path& path);

/// The path without "." and "..", where that leads to the same place; else, as behind a link to a folder, the
/// path without links.
std::filesystem::path tidy(const std::filesystem::path& path);
/// How `path` is named in a file that lies in `folder`; both absolute. Without links where it is a link that
/// "..", as the system takes it, does not come back from.
std::filesystem::path relative_to(const std::filesystem::path& folder, const std::filesystem::path& path);

/// Whether two paths are those of one file: by what they lead to where that exists, hard links included; else
/// by folder and name, and case counts only where the folder's disk tells it apart.
bool same_file(const std::filesystem::path& a, const std::filesystem::path& b);

/// A folder in another, for files that take their places together. Removed with what is left in it at the
/// end; of a process that was killed, by the next one that writes to the folder around it.
class TemporaryFolder {
 public:
  /// Throws Error{output}.
  explicit TemporaryFolder(const std::filesystem::path& around);
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
  int fd_ = -1;  ///< holds a lock, by which others know that the folder is in use
};

}  // namespace tafoni
