// OpenVDB level sets. There inside is negative, here rock is positive, so values change sign on the way. The
// only file that knows OpenVDB, whose headers take long to compile.

#include <string>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/io/format.h"
#include "tafoni/io/mesh_file.h"
#include "tafoni/io/volume_file.h"

#ifdef TAFONI_OPENVDB

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <istream>
#include <limits>
#include <memory>
#include <optional>
#include <ostream>
#include <streambuf>
#include <vector>

#include <openvdb/io/Stream.h>
#include <openvdb/openvdb.h>
#include <openvdb/tools/Prune.h>

#include "tafoni/io/impl/reading.h"
#include "tafoni/io/impl/volume_chunks.h"

namespace tafoni::io::format_vdb {
namespace {

using openvdb::Coord;
using openvdb::FloatGrid;
using Leaf = FloatGrid::TreeType::LeafNodeType;
using volume::Precision;
using volume::SampleBox;
using volume::ScalarGrid;

constexpr int block = Leaf::DIM;  // 8
/// Parts of a cell's side: what a transform is off by less is rounding.
constexpr double same_place = 1e-6;
static_assert(ScalarGrid::chunk_samples % block == 0);
constexpr const char *size_key = "tafoni_size", *origin_key = "tafoni_origin", *local_key = "tafoni_local",
                     *crs_key = "crs", *generator_key = "tafoni_generator";

/// Registers OpenVDB's types, once.
void initialize() {
  static const bool done = (openvdb::initialize(), true);
  (void)done;
}

/// Runs work and says what OpenVDB throws as one sentence.
template <class Work>
auto guard(ErrorKind kind, std::string_view file, const Work& work) {
  try {
    initialize();
    return work();
  } catch (const Error&) {
    throw;
  } catch (const std::bad_alloc&) {
    fail(kind, "{}: does not fit into memory.", file);
  } catch (const std::exception& error) {
    fail(kind, "{}: OpenVDB says: {}; the file is damaged or cut off, or the disk is full.", file,
         error.what());
  }
}

// Writing.

struct TreeWriter {
  FloatGrid::TreeType& tree;
  float background;

  /// A chunk's samples, read into `values`, as leaves where they differ and as tiles where they do not.
  void add(const SampleBox& box, const std::vector<float>& values) {
    for (int z = box.lo.z; z <= box.hi.z; z += block)
      for (int y = box.lo.y; y <= box.hi.y; y += block)
        for (int x = box.lo.x; x <= box.hi.x; x += block) add_block(box, {x, y, z}, values);
  }

  void fill(const SampleBox& box, float value) {
    if (-value == background) return;
    const openvdb::CoordBBox where(box.lo.x, box.lo.y, box.lo.z, box.hi.x, box.hi.y, box.hi.z);
    tree.fill(where, -value, std::abs(value) < background);
  }

 private:
  void add_block(const SampleBox& box, Vec3i lo, const std::vector<float>& values) {
    const Vec3i hi{std::min(lo.x + block - 1, box.hi.x), std::min(lo.y + block - 1, box.hi.y),
                   std::min(lo.z + block - 1, box.hi.z)};
    const auto row = [&](int y, int z) { return values.data() + box.index({lo.x, y, z}); };
    const float first = *row(lo.y, lo.z);
    bool same = true;
    for (int z = lo.z; z <= hi.z && same; ++z)
      for (int y = lo.y; y <= hi.y && same; ++y)
        same = std::all_of(row(y, z), row(y, z) + (hi.x - lo.x + 1), [&](float v) { return v == first; });
    if (same) return fill({lo, hi}, first);
    // Where the frame ends inside the leaf, the rest counts as outside, like all that lies beyond.
    auto* leaf = new Leaf(Coord(lo.x, lo.y, lo.z), background);
    for (int z = lo.z; z <= hi.z; ++z)
      for (int y = lo.y; y <= hi.y; ++y)
        for (int x = lo.x; x <= hi.x; ++x) {
          const float v = -row(y, z)[x - lo.x];
          const openvdb::Index at = Leaf::coordToOffset(Coord(x, y, z));
          if (std::abs(v) < background)
            leaf->setValueOn(at, v);
          else
            leaf->setValueOff(at, v);
        }
    tree.addLeaf(leaf);
  }
};

FloatGrid::Ptr to_vdb(const Volume& volume, Progress& progress) {
  const ScalarGrid& grid = volume.grid;
  const volume::GridFrame& frame = grid.frame();
  const Interval range = grid.range(frame.box());
  const float most = std::max(std::abs(range.lo), std::abs(range.hi));
  const float background = most > 0 ? most : static_cast<float>(frame.spacing);
  auto out = FloatGrid::create(background);
  TreeWriter writer{out->tree(), background};
  std::vector<float> values(std::size_t{ScalarGrid::chunk_samples} * ScalarGrid::chunk_samples *
                            ScalarGrid::chunk_samples);
  for (std::int64_t i = 0; i < impl::chunk_count(grid); ++i) {
    const SampleBox box = impl::chunk_box(grid, i);
    float same = 0;
    if (grid.uniform(impl::chunk_place(grid, i), &same)) {
      writer.fill(box, same);
    } else {
      grid.read(box, values.data());
      writer.add(box, values);
    }
    progress.advance();
  }
  openvdb::tools::prune(out->tree());
  const Vec3d at = volume.origin + frame.origin;
  auto transform = openvdb::math::Transform::createLinearTransform(frame.spacing);
  transform->postTranslate({at.x, at.y, at.z});
  out->setTransform(transform);
  out->setGridClass(openvdb::GRID_LEVEL_SET);
  out->setName("surface");
  out->setSaveFloatAsHalf(grid.precision() == Precision::half);
  out->insertMeta(size_key, openvdb::Vec3IMetadata({frame.size.x, frame.size.y, frame.size.z}));
  out->insertMeta(origin_key, openvdb::Vec3DMetadata({volume.origin.x, volume.origin.y, volume.origin.z}));
  out->insertMeta(local_key, openvdb::Vec3DMetadata({frame.origin.x, frame.origin.y, frame.origin.z}));
  return out;
}

/// A file as OpenVDB wants to write it. OpenVDB's own files do not tell that a disk is full.
class Sink : public std::streambuf {
 public:
  Sink(AtomicFile& file, const Progress& progress) : file_(file), progress_(progress) {}

 private:
  std::streamsize xsputn(const char* from, std::streamsize bytes) override {
    progress_.check();
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
};

class Archive : public openvdb::io::Archive {
 public:
  using openvdb::io::Archive::write;
  Ptr copy() const override { return std::make_shared<Archive>(*this); }
};

void write(AtomicFile& out, const Volume& volume, Progress& progress) {
  guard(ErrorKind::output, out.target().string(), [&] {
    const FloatGrid::Ptr grid = to_vdb(volume, progress);
    openvdb::MetaMap meta;
    const MeshMetadata& metadata = volume.metadata;
    meta.insertMeta("creator", openvdb::StringMetadata("tafoni"));
    meta.insertMeta("name", openvdb::StringMetadata(metadata.name));
    meta.insertMeta(crs_key, openvdb::StringMetadata(metadata.crs));
    meta.insertMeta(generator_key, openvdb::StringMetadata(impl::generator_json(metadata.generator)));
    Sink sink(out, progress);
    std::ostream stream(&sink);
    stream.exceptions(std::ios_base::badbit | std::ios_base::failbit);
    Archive().write(stream, openvdb::GridCPtrVec{grid}, true, meta);
    stream.seekp(0, std::ios_base::end);
  });
}

// Reading.

/// A file in memory, as OpenVDB wants to read it.
class Bytes : public std::streambuf {
 public:
  explicit Bytes(std::span<const std::byte> bytes) {
    char* begin = const_cast<char*>(reinterpret_cast<const char*>(bytes.data()));  // it is only read
    setg(begin, begin, begin + bytes.size());
  }

 private:
  pos_type seekoff(off_type by, std::ios_base::seekdir from, std::ios_base::openmode) override {
    const off_type base = from == std::ios_base::beg   ? 0
                          : from == std::ios_base::cur ? gptr() - eback()
                                                       : egptr() - eback();
    return seekpos(base + by, std::ios_base::in);
  }
  pos_type seekpos(pos_type to, std::ios_base::openmode) override {
    if (to < pos_type(0) || to > pos_type(egptr() - eback())) return pos_type(off_type(-1));
    setg(eback(), eback() + off_type(to), egptr());
    return to;
  }
};

/// The grid to read: a level set, or one with a usual name, or the first.
FloatGrid::Ptr choose_grid(const openvdb::GridPtrVec& grids, std::string_view file) {
  FloatGrid::Ptr best;
  int rank = -1;
  std::string others;
  for (const auto& base : grids) {
    const auto grid = openvdb::gridPtrCast<FloatGrid>(base);
    if (!grid) {
      others += (others.empty() ? "" : ", ") + base->valueType();
      continue;
    }
    const std::string name = grid->getName();
    const int own = grid->getGridClass() == openvdb::GRID_LEVEL_SET ? 2
                    : name == "surface" || name == "density"        ? 1
                                                                    : 0;
    if (own > rank) best = grid, rank = own;
  }
  if (!best)
    fail(ErrorKind::input, "{}: holds no grid of floats{}; write one as a level set or a fog volume.", file,
         others.empty() ? "" : " but of " + others);
  return best;
}

/// OpenVDB's value as ours.
struct Convert {
  float scale = -1, middle = 0;
  float operator()(float v) const { return (v - middle) * scale; }
};

/// A level set's values change sign. A fog's surface is where it is half dense, with values of at most a
/// cell. A grid of no class is a level set if it has negative values, else a fog.
Convert converter(const FloatGrid& grid, double spacing) {
  bool fog = grid.getGridClass() == openvdb::GRID_FOG_VOLUME;
  if (!fog && grid.getGridClass() != openvdb::GRID_LEVEL_SET) {
    fog = grid.background() >= 0;
    for (auto value = grid.cbeginValueOn(); value && fog; ++value) fog = *value >= 0;
  }
  return fog ? Convert{static_cast<float>(2 * spacing), 0.5f} : Convert{};
}

/// Where the samples lie: index `first` of the file's is sample (0, 0, 0).
struct Place {
  volume::GridFrame frame;
  Vec3d origin;
  Coord first{0, 0, 0};
};

Vec3d vector(const openvdb::Vec3d& v) {
  return {v.x(), v.y(), v.z()};
}

double spacing_of(const FloatGrid& grid, std::string_view file) {
  const openvdb::math::Transform& transform = grid.transform();
  bool plain = transform.isLinear();
  double spacing = 0;
  if (plain) {
    const openvdb::Mat4d m = transform.baseMap()->getAffineMap()->getMat4();
    spacing = m[0][0];
    for (int i = 0; i < 3; ++i)
      for (int k = 0; k < 3; ++k)
        plain = plain && std::abs(m[i][k] - (i == k ? spacing : 0)) <= same_place * std::abs(spacing);
    plain = plain && spacing > 0 && std::isfinite(spacing);
  }
  if (!plain)
    fail(ErrorKind::input,
         "{}: its grid is turned, mirrored or has cells of unequal sides; resample it to cubes along the "
         "axes.",
         file);
  return spacing;
}

/// Samples by their indices in the file, ends included; wider than those, so that nothing overflows.
struct Indices {
  std::int64_t lo[3], hi[3];
};

/// The active voxels with a cell of what lies around, which closes the surface. Begins at a leaf, so that
/// chunks and leaves stay in step.
std::optional<Indices> active_indices(const FloatGrid& grid) {
  const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
  if (box.empty()) return std::nullopt;
  Indices out;
  for (int axis = 0; axis < 3; ++axis) {
    out.lo[axis] = (std::int64_t{box.min()[axis]} - 1) & ~std::int64_t{block - 1};
    out.hi[axis] = std::int64_t{box.max()[axis]} + 1;
  }
  return out;
}

void take(Place& place, const Indices& samples, std::string_view file) {
  constexpr std::int64_t least = std::numeric_limits<std::int32_t>::min(), most_side = 1 << 30;
  constexpr std::int64_t most = std::numeric_limits<std::int32_t>::max();
  int size[3];
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t lo = samples.lo[axis], hi = samples.hi[axis];
    if (lo < least || hi > most || hi - lo >= most_side)
      fail(ErrorKind::input,
           "{}: its voxels lie at indices from {} to {}, further apart or out than can be read; move them "
           "nearer to index 0 or resample the grid.",
           file, lo, hi);
    place.first[axis] = static_cast<std::int32_t>(lo);
    size[axis] = static_cast<int>(hi - lo + 1);
  }
  place.frame.size = {size[0], size[1], size[2]};
}

Place place_of(const FloatGrid& grid, std::string_view file) {
  Place place;
  const double spacing = place.frame.spacing = spacing_of(grid, file);
  const std::optional<Indices> voxels = active_indices(grid);
  const auto size = grid.getMetadata<openvdb::Vec3IMetadata>(size_key);
  const auto origin = grid.getMetadata<openvdb::Vec3DMetadata>(origin_key);
  const auto local = grid.getMetadata<openvdb::Vec3DMetadata>(local_key);
  if (size && origin && local) {
    // Another program may have moved the grid, or added to it beyond the frame.
    Indices frame;
    for (int axis = 0; axis < 3; ++axis) {
      frame.lo[axis] = 0;
      frame.hi[axis] = std::int64_t{size->value()[axis]} - 1;
      if (!voxels || frame.hi[axis] < 1 ||
          (voxels->lo[axis] + block >= 0 && voxels->hi[axis] - 1 <= frame.hi[axis]))
        continue;
      frame.lo[axis] = std::min(frame.lo[axis], voxels->lo[axis]);
      frame.hi[axis] = std::max(frame.hi[axis], voxels->hi[axis]);
    }
    take(place, frame, file);
    const Vec3d first{1.0 * place.first[0], 1.0 * place.first[1], 1.0 * place.first[2]};
    place.frame.origin = vector(local->value()) + spacing * first;
    place.origin = vector(origin->value());
    const Vec3d at = vector(grid.indexToWorld(Coord(0, 0, 0)));
    if (length(at - (place.origin + vector(local->value()))) > same_place * spacing)
      place.origin = at - vector(local->value());
    return place;
  }
  if (!voxels) fail(ErrorKind::input, "{}: its grid has no active voxels, so it holds no surface.", file);
  take(place, *voxels, file);
  place.origin = vector(grid.indexToWorld(place.first));
  return place;
}

/// Reads chunks; one a thread at a time.
class TreeReader {
 public:
  TreeReader(const FloatGrid& grid, Convert convert, Coord first)
      : accessor_(grid.getConstAccessor()), convert_(convert), first_(first) {}

  void read(const SampleBox& box, impl::ChunkValues& chunk) {
    std::optional<float> same;
    bool alike = true;
    for (int z = box.lo.z; z <= box.hi.z; z += block)
      for (int y = box.lo.y; y <= box.hi.y; y += block)
        for (int x = box.lo.x; x <= box.hi.x; x += block) {
          const std::optional<float> tile = read_block(box, {x, y, z}, chunk.values);
          alike = alike && tile && (!same || *same == *tile);
          same = tile;
        }
    if (alike) chunk.same = same;
  }

 private:
  /// The value of the whole block where it is a tile.
  std::optional<float> read_block(const SampleBox& box, Vec3i lo, std::vector<float>& out) {
    const Coord at(lo.x + first_.x(), lo.y + first_.y(), lo.z + first_.z());
    const Leaf* leaf = accessor_.probeConstLeaf(at);
    const float tile = leaf ? 0 : convert_(accessor_.getValue(at));
    for (int z = lo.z; z <= std::min(lo.z + block - 1, box.hi.z); ++z)
      for (int y = lo.y; y <= std::min(lo.y + block - 1, box.hi.y); ++y)
        for (int x = lo.x; x <= std::min(lo.x + block - 1, box.hi.x); ++x) {
          out[box.index({x, y, z})] =
              leaf ? convert_(leaf->getValue(Leaf::coordToOffset(at.offsetBy(x - lo.x, y - lo.y, z - lo.z))))
                   : tile;
        }
    return leaf ? std::nullopt : std::optional<float>(tile);
  }

  FloatGrid::ConstAccessor accessor_;
  Convert convert_;
  Coord first_;
};

MeshMetadata metadata_of(const openvdb::MetaMap& meta) {
  MeshMetadata out;
  const auto text = [&](const char* key) {
    const auto found = meta.getMetadata<openvdb::StringMetadata>(key);
    return found ? found->value() : std::string();
  };
  out.name = text("name");
  out.crs = text(crs_key);
  out.generator = impl::generator_values(text(generator_key));
  return out;
}

Volume read(std::span<const std::byte> bytes, std::string_view file, Progress& progress) {
  return guard(ErrorKind::input, file, [&] {
    Bytes buffer(bytes);
    std::istream in(&buffer);
    // OpenVDB would go on with what it could not read and take it for sizes.
    in.exceptions(std::ios_base::badbit | std::ios_base::failbit | std::ios_base::eofbit);
    openvdb::io::Stream stream(in, false);
    const FloatGrid::Ptr grid = choose_grid(*stream.getGrids(), file);
    const Place place = place_of(*grid, file);
    const Convert convert = converter(*grid, place.frame.spacing);
    Volume out =
        impl::empty_volume(place.frame, convert(grid->background()),
                           grid->saveFloatAsHalf() ? Precision::half : Precision::single, place.origin, file);
    out.metadata = metadata_of(*stream.getMetadata());
    progress.begin("reading " + std::string(file), impl::chunk_count(out.grid), "chunks");
    impl::fill_chunks(
        out.grid, file,
        [&](std::int64_t index, impl::ChunkValues& chunk) {
          TreeReader(*grid, convert, place.first).read(impl::chunk_box(out.grid, index), chunk);
        },
        progress);
    progress.end();
    return out;
  });
}

}  // namespace
}  // namespace tafoni::io::format_vdb

#else

namespace tafoni::io::format_vdb {
namespace {

constexpr const char* missing =
    "this build has no OpenVDB, so it neither reads nor writes .vdb; use .tvol, or build with libopenvdb-dev";

void write(AtomicFile&, const Volume&, Progress&) {
  fail(ErrorKind::output, "{}", missing);
}
Volume read(std::span<const std::byte>, std::string_view file, Progress&) {
  fail(ErrorKind::input, "{}: {}", file, missing);
}

}  // namespace
}  // namespace tafoni::io::format_vdb

#endif

namespace tafoni::io::format_vdb {

const FormatType& declaration() {
  static const FormatType type{
      .about = {.name = "vdb",
                .doc = "OpenVDB, as a level set (negative in rock) named surface; reads fog volumes too",
                .source = "[OpenVDB]"},
      .extensions = {"vdb"},
      .write_volume = write,
      .read_volume = read,
  };
  return type;
}

}  // namespace tafoni::io::format_vdb
