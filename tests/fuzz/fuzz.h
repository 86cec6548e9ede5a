#pragma once
// What a fuzz target gives to libFuzzer, or to mutate_main.cpp, and how it tells a refusal from a fault.

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <unistd.h>

#include "tafoni/core/error.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

/// Sound inputs, which are mutated; a first corpus for libFuzzer.
std::vector<std::string> fuzz_seeds();

/// How often accepts() said yes.
inline std::size_t accepted_inputs = 0;
/// False where this build cannot make a sound seed.
inline bool sound_seeds = true;

/// Whether `read` comes to its end. What it refuses is one error of the kinds given, and nothing else.
template <class F>
bool accepts(F&& read, std::initializer_list<tafoni::ErrorKind> refusals = {tafoni::ErrorKind::input}) {
  try {
    read();
    ++accepted_inputs;
    return true;
  } catch (const tafoni::Error& error) {
    for (const tafoni::ErrorKind kind : refusals)
      if (error.kind() == kind) return false;
    std::fprintf(stderr, "an error of another kind: %s\n", error.what());
    std::abort();
  }
}

inline void require(bool holds, int line = __builtin_LINE()) {
  if (holds) return;
  std::fprintf(stderr, "line %d does not hold\n", line);
  std::abort();
}

inline std::string_view as_text(const std::uint8_t* data, std::size_t size) {
  return {reinterpret_cast<const char*>(data), size};
}

/// The text up to the next `end`, which is taken off with it.
inline std::string_view take_until(std::string_view& text, char end) {
  const std::string_view out = text.substr(0, text.find(end));
  text.remove_prefix(std::min(out.size() + 1, text.size()));
  return out;
}

/// A folder of this process's own, in memory where there is such a place, for readers that take a path.
/// Removed at the end.
class FuzzFolder {
 public:
  FuzzFolder() { std::filesystem::create_directory(path_); }
  ~FuzzFolder() {
    std::error_code code;
    std::filesystem::remove_all(path_, code);
  }
  FuzzFolder(const FuzzFolder&) = delete;
  FuzzFolder& operator=(const FuzzFolder&) = delete;

  std::filesystem::path write(const std::string& name, std::string_view bytes) const {
    std::filesystem::path file = path_ / name;
    std::ofstream out(file, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    require(out.flush().good());
    return file;
  }
  std::filesystem::path operator/(const std::string& name) const { return path_ / name; }

 private:
  static std::filesystem::path parent() {
    std::error_code code;
    const std::filesystem::path memory = "/dev/shm";
    return std::filesystem::is_directory(memory, code) ? memory : std::filesystem::temp_directory_path();
  }
  std::filesystem::path path_ = parent() / ("tafoni_fuzz." + std::to_string(::getpid()));
};
