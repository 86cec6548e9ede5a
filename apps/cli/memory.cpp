// Read from what Linux tells of itself: /proc, the limits of the control group, and those of the process.
#include "memory.h"

#include <algorithm>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string>

#include <malloc.h>
#include <sys/resource.h>

namespace tafoni::cli {
namespace {

constexpr std::uint64_t no_limit = std::numeric_limits<std::uint64_t>::max();

/// The number behind "NAME" on a line of its own.
std::optional<std::uint64_t> number_of(const char* file, const std::string& name) {
  std::ifstream in(file);
  std::string word;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::uint64_t value = 0;
    if (words >> word >> value && word == name) return value;
  }
  return {};
}

/// Of files that count in kB.
std::uint64_t bytes_of(const char* file, const char* name) {
  return number_of(file, name).value_or(0) * 1024;
}

/// The only number in a file; nothing for "max" or no file.
std::optional<std::uint64_t> number_in(const char* file) {
  std::ifstream in(file);
  std::uint64_t value = 0;
  return in >> value ? std::optional(value) : std::nullopt;
}

std::uint64_t rest(std::optional<std::uint64_t> limit, std::optional<std::uint64_t> used) {
  if (!limit || !used) return no_limit;
  return *limit - std::min(*limit, *used);
}

}  // namespace

std::uint64_t free_memory() {
  std::uint64_t out = no_limit;
  if (const auto available = number_of("/proc/meminfo", "MemAvailable:")) out = *available * 1024;
  // What a control group holds of files, it gives up for memory.
  auto used = number_in("/sys/fs/cgroup/memory.current");
  if (used) *used -= std::min(*used, number_of("/sys/fs/cgroup/memory.stat", "inactive_file").value_or(0));
  out = std::min(out, rest(number_in("/sys/fs/cgroup/memory.max"), used));
  // The older layout of control groups.
  out = std::min(out, rest(number_in("/sys/fs/cgroup/memory/memory.limit_in_bytes"),
                           number_in("/sys/fs/cgroup/memory/memory.usage_in_bytes")));
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur != RLIM_INFINITY)
    out = std::min(out, rest(limit.rlim_cur, bytes_of("/proc/self/status", "VmSize:")));
  return out;
}

MemoryUse memory_use() {
  // What was given back to the heap is there for what comes next.
  malloc_trim(0);
  return {bytes_of("/proc/self/status", "VmRSS:"), bytes_of("/proc/self/status", "VmHWM:")};
}

std::uint64_t free_disk(const std::filesystem::path& file) {
  std::error_code code;
  const auto folder = std::filesystem::absolute(file, code).parent_path();
  const auto space = std::filesystem::space(folder, code);
  return code ? no_limit : space.available;
}

}  // namespace tafoni::cli
