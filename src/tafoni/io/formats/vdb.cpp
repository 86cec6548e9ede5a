// OpenVDB level sets. There inside is negative, here rock is positive, so values change sign on the way. They
// are read by code of our own (impl/vdb_*.h), since OpenVDB trusts what it reads, and written by OpenVDB.

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/impl/vdb_file.h"
#include "tafoni/io/impl/vdb_write.h"
#include "tafoni/io/impl/volume_chunks.h"

namespace tafoni::io::format_vdb {
namespace {

using impl::VdbGrid;
using impl::VdbTree;
using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;

constexpr int block = VdbTree::leaf_side;
static_assert(ScalarGrid::chunk_samples % block == 0);

/// The grid to read: a level set, or one with a usual name, or the first.
const VdbGrid& choose_grid(const impl::VdbFile& vdb, std::string_view file) {
  const VdbGrid* best = nullptr;
  int rank = -1;
  for (const VdbGrid& grid : vdb.grids) {
    const int own = grid.metadata.text("class") == "level set"         ? 2
                    : grid.name == "surface" || grid.name == "density" ? 1
                                                                       : 0;
    if (own > rank) best = &grid, rank = own;
  }
  if (best) return *best;
  std::string others;
  for (std::string type : vdb.others) {
    if (type.starts_with("Tree_") && type.ends_with("_5_4_3")) type = type.substr(5, type.size() - 11);
    others += (others.empty() ? " but of " : ", ") + type;
  }
  fail(ErrorKind::input, "{}: holds no grid of floats{}; write one as a level set or a fog volume.", file,
       others);
}

/// OpenVDB's value as ours.
struct Convert {
  float scale = -1, middle = 0;
  float operator()(float v) const { return (v - middle) * scale; }
};

/// A level set's values change sign. A fog's surface is where it is half dense, with values of at most a
/// cell. A grid of no class is a level set if it has negative values, else a fog.
Convert converter(const VdbGrid& grid, const VdbTree& tree) {
  const std::string kind = grid.metadata.text("class");
  const bool fog =
      kind == "fog volume" || (kind != "level set" && tree.background() >= 0 && !tree.has_negative());
  return fog ? Convert{static_cast<float>(2 * grid.spacing), 0.5f} : Convert{};
}

/// Where the samples lie: voxel `first` of the file's is sample (0, 0, 0).
struct Place {
  volume::GridFrame frame;
  Vec3d origin;
  Vec3i first;
};

/// The active voxels with a cell of what lies around, which closes the surface. Begins at a multiple of a
/// chunk's side, so that chunks are in step with leaves and tiles: one that a tile's border crossed would be
/// held sample by sample.
std::optional<VdbTree::Extent> with_rim(const VdbTree::Extent& active) {
  if (active.empty()) return std::nullopt;
  VdbTree::Extent out = active;
  for (int axis = 0; axis < 3; ++axis) {
    out.lo[axis] = (active.lo[axis] - 1) & ~std::int64_t{ScalarGrid::chunk_samples - 1};
    out.hi[axis] = active.hi[axis] + 1;
  }
  return out;
}

void take_samples(Place& place, const VdbTree::Extent& samples, std::string_view file) {
  constexpr std::int64_t least = std::numeric_limits<std::int32_t>::min(), most_side = 1 << 30;
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  std::int32_t first[3], size[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t lo = samples.lo[axis], hi = samples.hi[axis];
    if (lo < least || hi > most || hi - lo >= most_side)
      fail(ErrorKind::input,
           "{}: its voxels lie at indices from {} to {}, further apart or out than can be read; move them "
           "nearer to index 0 or resample the grid.",
           file, lo, hi);
    first[axis] = static_cast<std::int32_t>(lo);
    size[axis] = static_cast<std::int32_t>(hi - lo + 1);
  }
  place.first = {first[0], first[1], first[2]};
  place.frame.size = {size[0], size[1], size[2]};
}

Place place_of(const VdbGrid& grid, const VdbTree& tree, std::string_view file) {
  Place place;
  place.frame.spacing = grid.spacing;
  std::optional<VdbTree::Extent> samples = with_rim(tree.active());
  if (const std::optional<Vec3i> size = grid.metadata.size(impl::vdb_size_key)) {
    // Of our own making. Another program may have added to it beyond the frame.
    const std::optional<VdbTree::Extent> voxels = samples;
    const int own[3] = {size->x, size->y, size->z};
    samples = VdbTree::Extent{{0, 0, 0},
                              {own[0] - std::int64_t{1}, own[1] - std::int64_t{1}, own[2] - std::int64_t{1}}};
    for (int axis = 0; axis < 3; ++axis) {
      std::int64_t &lo = samples->lo[axis], &hi = samples->hi[axis];
      if (!voxels || hi < 1 || (tree.active().lo[axis] >= 0 && tree.active().hi[axis] <= hi)) continue;
      lo = std::min(lo, voxels->lo[axis]);
      hi = std::max(hi, voxels->hi[axis]);
    }
  }
  if (!samples) fail(ErrorKind::input, "{}: its grid has no active voxels, so it holds no surface.", file);
  take_samples(place, *samples, file);
  const Vec3d at =
      grid.origin + grid.spacing * Vec3d{1.0 * place.first.x, 1.0 * place.first.y, 1.0 * place.first.z};
  const std::optional<Vec3d> world = grid.metadata.place(impl::vdb_world_key);
  place.frame.origin = world ? at : Vec3d{0, 0, 0};
  place.origin = world ? *world : at;
  impl::check_frame(place.frame, place.origin, file);
  return place;
}

/// What load() needs.
struct Samples {
  VdbTree tree;
  Convert convert;
  Vec3i first = {};

  void load(const SampleBox& box, impl::ChunkValues& chunk) const {
    VdbTree::Tile tile{};
    const Vec3i lo = box.lo + first, hi = box.hi + first;
    const auto one = [&](int a, int b) { return a >> tile.bits == b >> tile.bits; };
    if (!tree.leaf_at(lo, &tile) && one(lo.x, hi.x) && one(lo.y, hi.y) && one(lo.z, hi.z)) {
      chunk.same = convert(tile.value);
      return;
    }
    for (int z = box.lo.z; z <= box.hi.z; z += block)
      for (int y = box.lo.y; y <= box.hi.y; y += block)
        for (int x = box.lo.x; x <= box.hi.x; x += block) load_block(box, {x, y, z}, chunk.values);
  }

  /// Chunks that hold a leaf or unlike tiles; each of these lies in one chunk, since all begin at multiples
  /// of a leaf's side.
  std::uint64_t full_chunks(const volume::GridFrame& frame) const {
    return tree.mixed_cubes(ScalarGrid::chunk_samples, first, frame.size);
  }

 private:
  void load_block(const SampleBox& box, Vec3i lo, std::vector<float>& out) const {
    VdbTree::Tile tile{};
    const std::optional<std::size_t> leaf = tree.leaf_at(lo + first, &tile);
    VdbTree::LeafValues values;
    if (leaf)
      tree.read_leaf(*leaf, values);
    else
      values.fill(tile.value);
    for (int z = lo.z; z <= std::min(lo.z + block - 1, box.hi.z); ++z)
      for (int y = lo.y; y <= std::min(lo.y + block - 1, box.hi.y); ++y)
        for (int x = lo.x; x <= std::min(lo.x + block - 1, box.hi.x); ++x)
          out[box.index({x, y, z})] = convert(values[((x - lo.x) * block + (y - lo.y)) * block + (z - lo.z)]);
  }
};

MeshMetadata metadata_of(const impl::VdbMetadata& meta) {
  MeshMetadata out;
  out.name = meta.text("name");
  out.crs = meta.text(impl::vdb_crs_key);
  out.generator = impl::generator_from_text(meta.text(impl::vdb_generator_key));
  return out;
}

impl::VolumeSource open(std::span<const std::byte> bytes, std::string_view file) {
  const impl::VdbFile vdb = impl::read_vdb_file(bytes, file);
  const VdbGrid& grid = choose_grid(vdb, file);
  if (!grid.refused.empty()) fail(ErrorKind::input, "{}: {}", file, grid.refused);
  impl::VdbBytes in(bytes, file);
  in.seek(grid.tree_at);
  const auto samples = std::make_shared<Samples>(Samples{VdbTree(in, grid.coding), {}, {}});
  samples->convert = converter(grid, samples->tree);
  const Place place = place_of(grid, samples->tree, file);
  samples->first = place.first;
  return {.frame = place.frame,
          .origin = place.origin,
          .precision = grid.coding.half ? Precision::half : Precision::single,
          .metadata = metadata_of(vdb.metadata),
          .full_chunks = samples->full_chunks(place.frame),
          .load = [samples](std::int64_t, const SampleBox& box, impl::ChunkValues& chunk) {
            samples->load(box, chunk);
          }};
}

}  // namespace

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "vdb",
                .doc = "OpenVDB, as a level set (negative in rock) named surface; reads fog volumes too",
                .source = "[OpenVDB]"},
      .extensions = {"vdb"},
      .write_volume = impl::write_vdb,
      .open_volume = open,
  };
  return type;
}

}  // namespace tafoni::io::format_vdb
