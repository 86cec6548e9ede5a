#pragma once
// A cube of 16^3 cells of a lattice: its triangles and which of its samples are solid; and a cache of such.

#include <cstdint>
#include <functional>
#include <list>
#include <memory>
#include <mutex>
#include <unordered_map>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/query/impl/triangle_tree.h"

namespace tafoni::query::impl {

struct Tile {
  static constexpr int cells = 16, samples = cells + 1;

  TriangleTree triangles;
  std::vector<std::uint32_t> solid;  ///< bit i of word k * samples + j; empty where all samples are alike
  bool rock = false;                 ///< all of it, where they are

  /// How many of the corners of cell (i, j, k) are solid.
  int solid_corners(int i, int j, int k) const {
    if (solid.empty()) return rock ? 8 : 0;
    const std::uint32_t* at = solid.data() + k * samples + j;
    int count = 0;
    for (int row : {0, 1, samples, samples + 1}) count += __builtin_popcount((at[row] >> i) & 3u);
    return count;
  }
  std::size_t bytes() const {
    return triangles.bytes() + solid.capacity() * sizeof(std::uint32_t) + sizeof *this;
  }
};
using TilePtr = std::shared_ptr<const Tile>;

/// Tiles by index, the least recently used given up first. For any number of threads, but clear() and
/// drop(), which are for one that is alone.
class TileCache {
 public:
  explicit TileCache(std::size_t bytes) : limit_(bytes / shard_count) {}

  /// The tile, made by `make` if it is not held. Two threads may make the same one.
  TilePtr get(Vec3i index, const std::function<TilePtr(Vec3i)>& make);
  /// Gives up the tiles from lo to hi, both included.
  void drop(Vec3i lo, Vec3i hi);

  struct Stats {
    std::uint64_t tiles = 0, bytes = 0, made = 0;
  };
  Stats stats() const;

 private:
  struct Hash {
    std::size_t operator()(Vec3i v) const {
      const std::uint32_t x = v.x, y = v.y, z = v.z;
      return mix64(x | std::uint64_t{y} << 32) ^ mix64(z + 0x51ull);
    }
  };
  struct Entry {
    Vec3i index;
    TilePtr tile;
  };
  struct Shard {
    mutable std::mutex mutex;
    std::list<Entry> recent;  ///< last used first
    std::unordered_map<Vec3i, std::list<Entry>::iterator, Hash> by_index;
    std::uint64_t bytes = 0, made = 0;
  };
  static constexpr std::size_t shard_count = 16;
  static constexpr std::size_t entry_bytes = 128;  ///< of list and map, about

  std::size_t limit_;
  Shard shards_[shard_count];
};

}  // namespace tafoni::query::impl
