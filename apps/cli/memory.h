#pragma once
// What this machine has left.

#include <cstdint>
#include <filesystem>

namespace tafoni::cli {

/// Bytes that the process can still take: free memory, or what limits leave of it.
std::uint64_t free_memory();

/// Bytes of memory that the process holds, and that it has held at most.
struct MemoryUse {
  std::uint64_t now = 0, peak = 0;
};
MemoryUse memory_use();

/// Bytes free on the disk that would take a file; nothing is as good as no limit.
std::uint64_t free_disk(const std::filesystem::path& file);

}  // namespace tafoni::cli
