#pragma once
// OpenVDB's tree of floats, 5-4-3, as its file holds it: which leaves and tiles there are, and where the
// leaves' values stand, which are read when they are asked for. A root has nodes of 32^3 nodes of 16^3 leaves
// of 8^3 voxels; what is no child is a tile of one value. Memory is at most some 20 times the file.

#include <array>
#include <bit>
#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "tafoni/io/impl/vdb_values.h"
#include "tafoni/math/vec.h"

namespace tafoni::io::impl {

class VdbTree {
 public:
  static constexpr int leaf_side = 8, leaf_voxels = leaf_side * leaf_side * leaf_side;
  using LeafValues = std::array<float, leaf_voxels>;  ///< z fastest

  /// Steps over a whole tree. `coding` lacks the background. Throws Error{input}.
  VdbTree(VdbBytes& in, VdbCoding coding);

  float background() const { return coding_.background; }
  std::size_t leaves() const { return leaves_.size(); }
  /// One value for a cube of 2^bits voxels a side, which begins at multiples of that.
  struct Tile {
    float value;
    int bits;
  };
  /// The leaf that holds a voxel, or none where a tile does, which is then put into *tile.
  std::optional<std::size_t> leaf_at(Vec3i voxel, Tile* tile) const;
  /// Any thread. Throws Error{input}.
  void read_leaf(std::size_t leaf, LeafValues& out) const;
  /// How many of the cubes of `side` voxels a side, which divides a lower node's and is a multiple of a
  /// leaf's, hold a leaf or tiles of unlike values. Looks at the leaves and tiles that begin within `size`
  /// voxels from `first` alone, a multiple of the side.
  std::uint64_t mixed_cubes(int side, Vec3i first, Vec3i size) const;

  /// Active voxels, tiles' too, by their indices, ends included; none where lo > hi.
  struct Extent {
    std::int64_t lo[3], hi[3];
    bool empty() const { return lo[0] > hi[0]; }
  };
  const Extent& active() const { return active_; }
  /// Whether an active voxel or tile has a value below 0. Reads every leaf.
  bool has_negative() const;

 private:
  struct Leaf {
    Vec3i origin;
    VdbMask on;
    std::size_t values_at = 0;
  };
  /// 16^3 or 32^3 entries: a tile's value, or a child's number as the bits of a float.
  struct Node {
    Vec3i origin;
    VdbMask child;
    std::vector<float> entries;
    std::uint32_t child_at(std::size_t i) const { return std::bit_cast<std::uint32_t>(entries[i]); }
  };
  struct RootEntry {
    bool tile;
    std::uint32_t entry;
  };

  template <int Level>
  std::uint32_t read_node(VdbBytes& in, Vec3i origin);
  std::uint32_t read_leaf_mask(VdbBytes& in, Vec3i origin);
  void add_active(Vec3i lo, std::int64_t side, float value);
  void add_active_voxels(const Leaf& leaf);

  VdbBytes bytes_;
  VdbCoding coding_;
  std::map<std::uint64_t, RootEntry> root_;  // by whose keys no stranger can slow it down
  std::vector<Node> upper_, lower_;
  std::vector<Leaf> leaves_;
  Extent active_{{1, 1, 1}, {0, 0, 0}};
  bool negative_tile_ = false;
};

}  // namespace tafoni::io::impl
