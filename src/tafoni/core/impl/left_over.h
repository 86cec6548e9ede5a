#pragma once
// Names of files and folders that are not finished, and what becomes of them when their process is killed.
// Whoever makes one holds a lock on it, which ends with the process: one without a lock is left over.

#include <filesystem>

namespace tafoni::impl {

/// A name in the folder that nothing has.
std::filesystem::path temporary_name(const std::filesystem::path& folder);

/// Makes a file of such a name and locks it; its descriptor, or -1 with errno.
int make_temporary_file(const std::filesystem::path& folder, std::filesystem::path& name);

/// Removes what is left over in a folder. Looks there once a process, so that writing many files costs
/// nothing more.
void clear_left_over(const std::filesystem::path& folder);

}  // namespace tafoni::impl
