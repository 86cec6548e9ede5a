// A tree stands in its file twice: first its nodes, from the root down, with their tiles and the leaves'
// masks, then the leaves' values in the same order, each with its mask again.

#include "tafoni/io/impl/vdb_tree.h"

#include <algorithm>
#include <bit>

#include "tafoni/core/parallel.h"

namespace tafoni::io::impl {
namespace {

constexpr int leaf_bits = 3, lower_bits = 4, upper_bits = 5;
constexpr int lower_total = leaf_bits + lower_bits, upper_total = lower_total + upper_bits;

/// A node's entries by their place; z fastest.
Vec3i entry_place(std::size_t entry, int bits) {
  const int mask = (1 << bits) - 1, i = static_cast<int>(entry);
  return {i >> (2 * bits), i >> bits & mask, i & mask};
}
/// The entry of a node of `total` bits a side, in entries of `bits` bits a side, that holds a voxel.
std::size_t entry_of(Vec3i voxel, int total, int bits) {
  const auto axis = [&](int v) {
    return static_cast<std::size_t>((v & ((1 << total) - 1)) >> (total - bits));
  };
  return (axis(voxel.x) << bits | axis(voxel.y)) << bits | axis(voxel.z);
}

std::uint64_t root_key(Vec3i voxel) {
  const auto axis = [](int v) { return static_cast<std::uint64_t>(v >> upper_total) & 0xfffff; };
  return axis(voxel.x) << 40 | axis(voxel.y) << 20 | axis(voxel.z);
}

Vec3i read_place(VdbBytes& in) {
  const auto at = in.get<Vec3i>();
  constexpr int within = (1 << upper_total) - 1;
  if (((at.x | at.y | at.z) & within) != 0) in.damaged("a node lies where none can");
  return at;
}

}  // namespace

VdbTree::VdbTree(VdbBytes& in, VdbCoding coding) : bytes_(in), coding_(coding) {
  if (in.get<std::uint32_t>() != 1) in.damaged("its tree has not one value a voxel");
  coding_.background = in.get<float>();
  const auto tiles = in.get<std::uint32_t>(), children = in.get<std::uint32_t>();
  for (std::uint32_t i = 0; i < tiles; ++i) {
    const Vec3i at = read_place(in);
    const auto value = in.get<float>();
    root_[root_key(at)] = {true, std::bit_cast<std::uint32_t>(value)};
    if (in.get<std::uint8_t>() != 0) add_active(at, std::int64_t{1} << upper_total, value);
  }
  for (std::uint32_t i = 0; i < children; ++i) {
    const Vec3i at = read_place(in);
    const std::uint32_t node = read_node<1>(in, at);
    if (!root_.emplace(root_key(at), RootEntry{false, node}).second)
      in.damaged("two nodes lie at the same place");
  }
  for (Leaf& leaf : leaves_) {
    const VdbMask again = in.take(leaf.on.size());
    if (!std::equal(again.begin(), again.end(), leaf.on.begin())) in.damaged("a leaf has two masks");
    leaf.values_at = in.position();
    skip_values(in, coding_, leaf.on);
    add_active_voxels(leaf);
  }
}

template <int Level>
std::uint32_t VdbTree::read_node(VdbBytes& in, Vec3i origin) {
  constexpr int bits = Level ? upper_bits : lower_bits, child_total = Level ? lower_total : leaf_bits;
  constexpr std::size_t entries = std::size_t{1} << (3 * bits);
  const VdbMask child = in.take(entries / 8), on = in.take(entries / 8);
  Node node{origin, child, std::vector<float>(entries)};
  read_values(in, coding_, on, node.entries);
  const auto place = [&](std::size_t i) { return origin + entry_place(i, bits) * (1 << child_total); };
  each_on(on, [&](std::size_t i) {
    if (!is_on(child, i)) add_active(place(i), std::int64_t{1} << child_total, node.entries[i]);
  });
  each_on(child, [&](std::size_t i) {
    std::uint32_t number;
    if constexpr (Level == 1)
      number = read_node<0>(in, place(i));
    else
      number = read_leaf_mask(in, place(i));
    node.entries[i] = std::bit_cast<float>(number);
  });
  std::vector<Node>& nodes = Level ? upper_ : lower_;
  nodes.push_back(std::move(node));
  return static_cast<std::uint32_t>(nodes.size() - 1);
}

std::uint32_t VdbTree::read_leaf_mask(VdbBytes& in, Vec3i origin) {
  leaves_.push_back({origin, in.take(leaf_voxels / 8), 0});
  return static_cast<std::uint32_t>(leaves_.size() - 1);
}

void VdbTree::add_active(Vec3i lo, std::int64_t side, float value) {
  const std::int64_t at[3] = {lo.x, lo.y, lo.z};
  const bool first = active_.empty();
  for (int axis = 0; axis < 3; ++axis) {
    active_.lo[axis] = first ? at[axis] : std::min(active_.lo[axis], at[axis]);
    active_.hi[axis] = first ? at[axis] + side - 1 : std::max(active_.hi[axis], at[axis] + side - 1);
  }
  negative_tile_ = negative_tile_ || value < 0;
}

void VdbTree::add_active_voxels(const Leaf& leaf) {
  // Of a leaf within what is known already nothing is new.
  const std::int64_t at[3] = {leaf.origin.x, leaf.origin.y, leaf.origin.z};
  bool within = !active_.empty();
  for (int axis = 0; axis < 3; ++axis)
    within = within && active_.lo[axis] <= at[axis] && at[axis] + leaf_side - 1 <= active_.hi[axis];
  if (within) return;
  each_on(leaf.on, [&](std::size_t i) { add_active(leaf.origin + entry_place(i, leaf_bits), 1, 0); });
}

std::uint64_t VdbTree::mixed_cubes(int side, Vec3i first, Vec3i size) const {
  const auto within = [&](Vec3i at) {
    const auto axis = [](std::int64_t v, int begin, int length) { return v >= begin && v - begin < length; };
    return axis(at.x, first.x, size.x) && axis(at.y, first.y, size.y) && axis(at.z, first.z, size.z);
  };
  struct Cube {
    bool any = false, mixed = false;
    std::uint32_t value = 0;  // as bits, so that zeros of both signs differ
  };
  const int cubes = (1 << lower_total) / side;
  std::uint64_t out = 0;
  for (const Node& node : lower_) {
    std::vector<Cube> found(std::size_t{1} * cubes * cubes * cubes);
    for (std::size_t i = 0; i < node.entries.size(); ++i) {
      const Vec3i at = entry_place(i, lower_bits) * (1 << leaf_bits);
      if (!within(node.origin + at)) continue;
      Cube& cube = found[(at.x / side * cubes + at.y / side) * cubes + at.z / side];
      const auto value = std::bit_cast<std::uint32_t>(node.entries[i]);
      cube.mixed = cube.mixed || is_on(node.child, i) || (cube.any && value != cube.value);
      cube.any = true;
      cube.value = value;
    }
    out += std::count_if(found.begin(), found.end(), [](const Cube& cube) { return cube.mixed; });
  }
  return out;
}

std::optional<std::size_t> VdbTree::leaf_at(Vec3i voxel, Tile* tile) const {
  const auto root = root_.find(root_key(voxel));
  if (root == root_.end()) {
    *tile = {coding_.background, upper_total};
    return {};
  }
  if (root->second.tile) {
    *tile = {std::bit_cast<float>(root->second.entry), upper_total};
    return {};
  }
  const Node& upper = upper_[root->second.entry];
  const std::size_t i = entry_of(voxel, upper_total, upper_bits);
  if (!is_on(upper.child, i)) {
    *tile = {upper.entries[i], lower_total};
    return {};
  }
  const Node& lower = lower_[upper.child_at(i)];
  const std::size_t k = entry_of(voxel, lower_total, lower_bits);
  if (is_on(lower.child, k)) return lower.child_at(k);
  *tile = {lower.entries[k], leaf_bits};
  return {};
}

void VdbTree::read_leaf(std::size_t leaf, LeafValues& out) const {
  VdbBytes in = bytes_;
  in.seek(leaves_[leaf].values_at);
  read_values(in, coding_, leaves_[leaf].on, out);
}

bool VdbTree::has_negative() const {
  if (negative_tile_) return true;
  std::vector<char> found(leaves_.size());
  parallel_for(std::ssize(leaves_), [&](std::int64_t i) {
    LeafValues values;
    read_leaf(i, values);
    for (std::size_t k = 0; k < values.size(); ++k) found[i] |= is_on(leaves_[i].on, k) && values[k] < 0;
  });
  return std::find(found.begin(), found.end(), 1) != found.end();
}

}  // namespace tafoni::io::impl
