#pragma once
// The files of one command, so that it never writes one that it reads, nor one twice.

#include <cstdint>
#include <filesystem>
#include <vector>

namespace tafoni::cli {

/// Files are compared as the disk knows them, and not by their paths. Empty paths are none. Throws
/// Error{usage} for a file that is to be both read and written, or written twice.
class CommandFiles {
 public:
  /// "-" is no file.
  void reads(const std::filesystem::path& path);
  /// Throws Error{output} for what could not be written.
  void writes(const std::filesystem::path& path);
  /// N x N tiles, NAME_X_Y for each.
  void writes_tiles(const std::filesystem::path& path, std::int64_t n);

 private:
  struct Output {
    std::filesystem::path path;
    std::int64_t tiles = 0;
  };
  static bool meet(const Output& a, const Output& b);
  static void check_input(const Output& output, const std::filesystem::path& input);
  void add(const Output& output);

  std::vector<std::filesystem::path> inputs_;
  std::vector<Output> outputs_;
};

/// What a tile of a mesh file is called.
std::filesystem::path tile_name(const std::filesystem::path& path, std::int64_t x, std::int64_t y);

/// For a command with one output.
void check_output(const std::filesystem::path& path, const std::vector<std::filesystem::path>& inputs);

}  // namespace tafoni::cli
