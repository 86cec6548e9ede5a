// The only file that knows OpenVDB. A volume's chunks become leaves where their samples differ, and tiles
// where they do not. A voxel is active where its value is within the background, and where a neighbour is on
// the other side of the surface, since OpenVDB meshes no others; what is all alike is not.

#include "tafoni/io/impl/vdb_write.h"

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"

#ifdef TAFONI_OPENVDB

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <ostream>
#include <streambuf>
#include <vector>

#include <fmt/core.h>
#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include "tafoni/io/impl/volume_chunks.h"

namespace tafoni::io::impl {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using VdbLeaf = FloatGrid::TreeType::LeafNodeType;
using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;

constexpr int leaf_block = VdbLeaf::DIM;  // 8
constexpr int vdb_chunk = ScalarGrid::chunk_samples;
static_assert(vdb_chunk % leaf_block == 0);

/// A chunk's samples with one more on each side, as OpenVDB has them; beyond the grid there is air.
class RimmedChunk {
 public:
  RimmedChunk(const ScalarGrid& grid, float background)
      : grid_(grid), background_(background), values_(std::size_t{side} * side * side) {}

  /// Chunks may lie one beyond the grid. Gives the value of all its samples if they are alike and none lies
  /// beside the surface.
  std::optional<float> load(Vec3i chunk) {
    if (const auto same = alike(chunk)) return same;
    first_ = chunk * vdb_chunk - Vec3i{1, 1, 1};
    const Vec3i last = first_ + Vec3i{side - 1, side - 1, side - 1};
    grid_.read({first_, last}, values_.data());
    const Vec3i n = grid_.frame().size;
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y) {
        float* row = values_.data() + index({0, y, z});
        const bool within =
            first_.y + y >= 0 && first_.y + y < n.y && first_.z + z >= 0 && first_.z + z < n.z;
        std::uint64_t bits = 0;
        for (int x = 0; x < side; ++x) {
          row[x] = within && first_.x + x >= 0 && first_.x + x < n.x ? -row[x] : background_;
          bits |= std::uint64_t{row[x] < 0} << x;
        }
        rock_[z * side + y] = bits;
      }
    find_beside();
    return {};
  }

  /// By its place in the chunk.
  float value(Vec3i at) const { return values_[index(at + Vec3i{1, 1, 1})]; }
  /// Whether one of the 26 samples about it is on the other side of the surface.
  bool beside(Vec3i at) const { return (beside_[at.z * vdb_chunk + at.y] >> at.x & 1) != 0; }

 private:
  static constexpr int side = vdb_chunk + 2;
  static std::ptrdiff_t index(Vec3i at) { return (at.z * side + at.y) * side + at.x; }

  std::optional<float> uniform(Vec3i chunk) const {
    const Vec3i n = grid_.chunks();
    if (chunk.x < 0 || chunk.y < 0 || chunk.z < 0 || chunk.x >= n.x || chunk.y >= n.y || chunk.z >= n.z)
      return background_;
    float value = 0;
    // The last chunks' samples may end before their leaves do.
    const Vec3i end = (chunk + Vec3i{1, 1, 1}) * vdb_chunk, size = grid_.frame().size;
    if (!grid_.uniform(chunk, &value) || (value > 0 && (end.x > size.x || end.y > size.y || end.z > size.z)))
      return {};
    return -value;
  }

  std::optional<float> alike(Vec3i chunk) const {
    const std::optional<float> own = uniform(chunk);
    if (!own) return {};
    for (int z = -1; z <= 1; ++z)
      for (int y = -1; y <= 1; ++y)
        for (int x = -1; x <= 1; ++x) {
          const std::optional<float> near = uniform(chunk + Vec3i{x, y, z});
          if (!near || (*near < 0) != (*own < 0)) return {};
        }
    return own;
  }

  /// Samples with one on the other side among the 26 about them: the corners of cells that the surface cuts.
  void find_beside() {
    constexpr std::uint64_t within = (std::uint64_t{1} << side) - 1;
    for (int z = 0; z < vdb_chunk; ++z)
      for (int y = 0; y < vdb_chunk; ++y) {
        std::uint64_t rock = 0, air = 0;
        for (int k = z; k < z + 3; ++k)
          for (int j = y; j < y + 3; ++j) rock |= rock_[k * side + j], air |= ~rock_[k * side + j] & within;
        beside_[z * vdb_chunk + y] = (rock | rock >> 1 | rock >> 2) & (air | air >> 1 | air >> 2);
      }
  }

  const ScalarGrid& grid_;
  float background_;
  Vec3i first_ = {};
  std::vector<float> values_;
  std::array<std::uint64_t, std::size_t{side}* side> rock_ = {};
  std::array<std::uint64_t, std::size_t{vdb_chunk}* vdb_chunk> beside_ = {};
};

/// A leaf's 8^3 samples from `at` of the chunk. Where they are alike and none lies beside the surface, none
/// is active either, and the leaf is pruned to a tile later.
void add_leaf(FloatGrid::TreeType& tree, const RimmedChunk& chunk, Vec3i at, Coord origin) {
  auto leaf = std::make_unique<VdbLeaf>(origin, tree.background());
  const float first = chunk.value(at);
  bool plain = true;
  const auto for_each = [&](const auto& visit) {
    for (int x = 0; x < leaf_block; ++x)
      for (int y = 0; y < leaf_block; ++y)
        for (int z = 0; z < leaf_block; ++z)
          visit(at + Vec3i{x, y, z}, static_cast<openvdb::Index>((x * leaf_block + y) * leaf_block + z));
  };
  for_each([&](Vec3i sample, openvdb::Index) {
    plain = plain && chunk.value(sample) == first && !chunk.beside(sample);
  });
  if (plain && first == tree.background()) return;
  for_each([&](Vec3i sample, openvdb::Index offset) {
    const float v = chunk.value(sample);
    if (!plain && (std::abs(v) < tree.background() || chunk.beside(sample)))
      leaf->setValueOn(offset, v);
    else
      leaf->setValueOff(offset, v);
  });
  tree.addLeaf(leaf.release());
}

/// Gives a chunk its leaves, or one tile; its background stands there already.
void add_chunk(FloatGrid::TreeType& tree, RimmedChunk& chunk, Vec3i place) {
  const Vec3i first = place * vdb_chunk;
  if (const std::optional<float> same = chunk.load(place)) {
    const int last = vdb_chunk - 1;
    if (*same != tree.background())
      tree.fill({Coord(first.x, first.y, first.z), Coord(first.x + last, first.y + last, first.z + last)},
                *same, false);
    return;
  }
  for (int z = 0; z < vdb_chunk; z += leaf_block)
    for (int y = 0; y < vdb_chunk; y += leaf_block)
      for (int x = 0; x < vdb_chunk; x += leaf_block)
        add_leaf(tree, chunk, {x, y, z}, Coord(first.x + x, first.y + y, first.z + z));
}

openvdb::Vec3d to_vdb(Vec3d v) {
  return {v.x, v.y, v.z};
}

FloatGrid::Ptr to_grid(const Volume& volume, Progress& progress) {
  const ScalarGrid& grid = volume.grid;
  const volume::GridFrame& frame = grid.frame();
  const Interval range = grid.range(frame.box());
  const float most = std::max(std::abs(range.lo), std::abs(range.hi));
  auto out = FloatGrid::create(most > 0 ? most : static_cast<float>(frame.spacing));
  RimmedChunk chunk(grid, out->background());
  // One more chunk on each side, where air lies beside rock that the frame cuts off.
  const Vec3i n = grid.chunks();
  for (int z = -1; z <= n.z; ++z)
    for (int y = -1; y <= n.y; ++y)
      for (int x = -1; x <= n.x; ++x) {
        add_chunk(out->tree(), chunk, {x, y, z});
        if (x >= 0 && y >= 0 && z >= 0 && x < n.x && y < n.y && z < n.z) progress.advance();
      }
  openvdb::tools::prune(out->tree());
  auto transform = openvdb::math::Transform::createLinearTransform(frame.spacing);
  transform->postTranslate(to_vdb(frame.origin));
  out->setTransform(transform);
  out->setGridClass(openvdb::GRID_LEVEL_SET);
  out->setName("surface");
  out->setSaveFloatAsHalf(grid.precision() == Precision::half);
  out->insertMeta(vdb_size_key, openvdb::Vec3IMetadata({frame.size.x, frame.size.y, frame.size.z}));
  out->insertMeta(vdb_world_key, openvdb::Vec3DMetadata(to_vdb(volume.origin)));
  out->insertMeta(vdb_crs_key, openvdb::StringMetadata(volume.metadata.crs));
  return out;
}

/// A file as OpenVDB wants to write it. OpenVDB's own files do not tell that a disk is full. It gives each
/// file a random identity, in whose place there comes one that follows from all else, so that the same volume
/// gives the same bytes.
class Sink : public std::streambuf {
 public:
  Sink(AtomicFile& file, const Progress& progress) : file_(file), progress_(progress) {}

  void write_identity() {
    file_.seek(identity_at);
    const std::uint64_t more = hash_ * 0x9e3779b97f4a7c15ull;
    const std::string digits = fmt::format("{:016x}{:016x}", hash_, more ^ more >> 32);
    file_.write(fmt::format("{}-{}-{}-{}-{}", digits.substr(0, 8), digits.substr(8, 4), digits.substr(12, 4),
                            digits.substr(16, 4), digits.substr(20)));
    file_.seek(end_);
  }

 private:
  /// After the magic number, three versions and whether grids tell where they are.
  static constexpr std::size_t identity_at = 21, identity_bytes = 36;

  std::streamsize xsputn(const char* from, std::streamsize bytes) override {
    progress_.check();
    const std::size_t at = file_.position();
    for (std::streamsize i = 0; i < bytes; ++i)
      if (at + i < identity_at || at + i >= identity_at + identity_bytes)
        hash_ = (hash_ ^ static_cast<unsigned char>(from[i])) * 0x100000001b3ull;  // FNV-1a
    file_.write(from, bytes);
    end_ = std::max(end_, file_.position());
    return bytes;
  }
  int_type overflow(int_type c) override {
    const char byte = traits_type::to_char_type(c);
    xsputn(&byte, 1);
    return c;
  }
  pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode which) override {
    const off_type here = file_.position();
    const off_type base = from == std::ios_base::beg ? 0 : from == std::ios_base::cur ? here : off_type(end_);
    return by == 0 && base == here ? pos_type(base) : seekpos(pos_type(base + by), which);
  }
  pos_type seekpos(pos_type to, std::ios_base::openmode) override {
    file_.seek(off_type(to));
    return to;
  }

  AtomicFile& file_;
  const Progress& progress_;
  std::size_t end_ = 0;
  std::uint64_t hash_ = 0xcbf29ce484222325ull;
};

class Archive : public openvdb::io::Archive {
 public:
  using openvdb::io::Archive::write;
  Ptr copy() const override { return std::make_shared<Archive>(*this); }
};

}  // namespace

void write_vdb(AtomicFile& out, const Volume& volume, Progress& progress) {
  static const bool registered = (openvdb::initialize(), true);  // OpenVDB's types, once
  (void)registered;
  try {
    const FloatGrid::Ptr grid = to_grid(volume, progress);
    openvdb::MetaMap meta;
    const MeshMetadata& metadata = volume.metadata;
    meta.insertMeta("creator", openvdb::StringMetadata("tafoni"));
    meta.insertMeta("name", openvdb::StringMetadata(metadata.name));
    meta.insertMeta(vdb_crs_key, openvdb::StringMetadata(metadata.crs));
    meta.insertMeta(vdb_generator_key, openvdb::StringMetadata(generator_text(metadata.generator)));
    Sink sink(out, progress);
    std::ostream stream(&sink);
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    Archive().write(stream, openvdb::GridCPtrVec{grid}, true, meta);
    sink.write_identity();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(ErrorKind::output, "{}: does not fit into memory.", out.target().string());
  } catch (const std::exception& error) {
    fail(ErrorKind::output, "{}: OpenVDB says: {}.", out.target().string(), error.what());
  }
}

}  // namespace tafoni::io::impl

#else

namespace tafoni::io::impl {

void write_vdb(AtomicFile&, const Volume&, Progress&) {
  fail(ErrorKind::output,
       "this build has no OpenVDB, so it writes no .vdb; write .tvol, or build with libopenvdb-dev");
}

}  // namespace tafoni::io::impl

#endif
