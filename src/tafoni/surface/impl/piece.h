#pragma once
// The mesh of one chunk, complete in itself: it holds every vertex its triangles use, those on its faces
// too, and says where on the faces they lie, so that neighbours can be joined.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/field/chunks.h"
#include "tafoni/surface/impl/arena.h"
#include "tafoni/surface/impl/block.h"
#include "tafoni/surface/impl/four.h"
#include "tafoni/surface/impl/lattice.h"
#include "tafoni/surface/sample_source.h"

namespace tafoni::surface::impl {

struct BorderVertex {
  std::uint32_t place;   ///< edge within the face's plane; ascending in a face's list, equal on both sides
  std::uint32_t vertex;  ///< within the piece
};

/// An edge of the lattice that lies along an edge of a chunk, where up to four chunks meet.
struct LatticeEdge {
  Vec3i at;
  int axis = 0;
  friend bool operator==(const LatticeEdge&, const LatticeEdge&) = default;
};
struct LatticeEdgeHash {
  std::size_t operator()(const LatticeEdge& e) const {
    const std::uint32_t x = e.at.x, y = e.at.y, z = e.at.z, axis = e.axis;
    return hash_combine(x | std::uint64_t{y} << 32, z | std::uint64_t{axis} << 32);
  }
};
struct CornerVertex {
  LatticeEdge edge;
  std::uint32_t vertex;
};

/// A piece's connected part.
struct Part {
  double volume =
      0;  ///< flux of position / 3 outward, about local zero: summed over a closed surface its volume
  std::uint64_t triangles = 0;
  bool open = false;  ///< touches the border of the meshed cells
};

/// A piece's triangles, as indices of 16 bits where these are enough: half the memory to be touched.
class PieceTriangles {
 public:
  using Wide = std::array<std::uint32_t, 3>;

  PieceTriangles() = default;
  PieceTriangles(std::span<const Wide> wide) : wide_(wide) {}
  /// A copy in the arena, of triangles of so many vertices.
  PieceTriangles(std::span<const Wide> triangles, std::size_t vertices, Arena& arena);

  std::size_t size() const { return wide_.size() + narrow_.size(); }
  /// Calls body(triangle) for [begin, end).
  template <class Body>
  void for_each(std::size_t begin, std::size_t end, const Body& body) const {
    if (narrow_.empty())
      for (const auto& t : wide_.subspan(begin, end - begin)) body(t);
    else
      for (const auto& t : narrow_.subspan(begin, end - begin)) body(t);
  }
  template <class Body>
  void for_each(const Body& body) const {
    for_each(0, size(), body);
  }
  /// All of them where they were not copied to an arena.
  std::span<const Wide> wide() const { return wide_; }

 private:
  using Narrow = std::array<std::uint16_t, 3>;
  std::span<const Wide> wide_;  ///< one of the two is empty
  std::span<const Narrow> narrow_;
};

/// The sum of the facet vectors (mesh/inner/facets.h) of the triangles around a vertex, as z, x, y.
using FacetFour = Four;
/// The same in units of voxel^2 / 2^30: whole numbers, whose sum does not depend on the order.
using FacetSum = Vec3<std::int64_t>;

struct Piece {
  Vec3i chunk;
  std::span<Vec3f> positions, normals;  ///< in the maker's arena, as are the triangles
  PieceTriangles triangles;
  std::array<std::vector<BorderVertex>, 6> faces;  ///< x low, x high, y low, …; none of the corners
  std::vector<CornerVertex> corners;
  std::span<FacetSum> rim;  ///< of the vertices of faces and corners (rim.h); empty when not asked for
  std::vector<Part> parts;  ///< empty when not asked for
  std::vector<std::uint32_t> labels;  ///< part of each vertex; empty when there is one part
  std::vector<std::uint32_t> open;    ///< vertices on the border of the meshed cells
  std::span<std::uint32_t> edges;     ///< the edge of each vertex, ascending; empty when not asked for
  std::uint64_t cut_cells = 0;

  std::uint32_t part_of(std::uint32_t vertex) const { return labels.empty() ? 0 : labels[vertex]; }
};

/// Fills `parts` and `labels`. `parents` is scratch.
void find_parts(Piece& piece, std::vector<std::uint32_t>& parents);

/// What a chunk's samples leave of its last piece, for making it anew: lattice edges of the chunk with no end
/// among the samples [lo, hi] carry the vertices that they did.
struct Kept {
  const Piece& piece;  ///< with its edges
  Vec3i lo, hi;        ///< samples within the chunk, both included
  /// Solid bits of all samples, 65 rows of two words a plane, valid wherever an active brick needs them; the
  /// samples themselves need to be valid in [lo, hi] and one beyond.
  const std::uint64_t* signs;

  bool holds(int i, int j, int k, int axis) const {
    return i + (axis == 0) < lo.x || i > hi.x || j + (axis == 1) < lo.y || j > hi.y ||
           k + (axis == 2) < lo.z || k > hi.z;
  }
};

/// What of a piece is asked for beside positions and triangles.
struct PieceParts {
  bool normals = false;
  bool facets = false;  ///< the rim's, and settle() can be called
  bool parts = false;
};

/// Makes pieces; one a thread, its memory reused from chunk to chunk.
class PieceMaker {
 public:
  PieceMaker(const CellSet& cells, double voxel, const PieceParts& wanted)
      : set_(cells), voxel_(voxel), wanted_(wanted), margin_(margin_for(cells.reach())) {}

  /// False when no cell of the chunk is cut. `source` has just evaluated `samples`. With `kept` pieces get
  /// edges, vertices that it holds are taken over, and what it points to is valid until the next call.
  bool make(const field::ChunkSamples& samples, SampleSource& source, Piece& out, const Kept* kept = nullptr);

  /// Makes the normals inside the piece that was made last agree with its triangles (settle_inside() in
  /// rim.h).
  void settle(Piece& piece);

  /// Where the pieces made so far live; the maker goes on in a new one.
  std::unique_ptr<Arena> take_arena() { return std::exchange(arena_, std::make_unique<Arena>()); }
  /// Vertices of the last piece that were not kept.
  std::size_t fresh_vertices() const { return fresh_.size(); }
  /// Makes the pieces made so far invalid, to use their memory again.
  void forget_pieces() { arena_->clear(); }

  /// Prepares and reports on the cells of a chunk; for BlockWalker.
  bool layer(int k) const { return k >= 0 && k < field::chunk_cells && layers_[k]; }
  const std::uint64_t* rows(int k) const { return cells_.data() + k * layer_words; }
  void vertices(int k, const PlaneOutput& out);
  void triangles(const PlaneOutput& out);

  double triangles_seconds = 0, normals_seconds = 0;

 private:
  static constexpr int words = 2;  ///< 65 samples
  static constexpr int layer_words = field::chunk_cells * words;

  bool choose_cells(const field::ChunkSamples& samples);
  void note_border(int k, EdgeKey key, std::uint32_t vertex);
  void find_normals(SampleSource& source, Piece& out);
  void add_facets(const PlaneOutput& out);
  void take_over(int k, const PlaneOutput& out);

  const CellSet& set_;
  double voxel_;
  PieceParts wanted_;
  float margin_;
  Vec3i first_;  ///< the chunk's first cell
  Plane plane_;
  const float* samples_ = nullptr;
  Piece* piece_ = nullptr;
  bool whole_ = true;

  std::unique_ptr<Arena> arena_ = std::make_unique<Arena>();
  std::array<bool, field::chunk_cells> layers_{};
  std::vector<std::uint64_t> cells_ = std::vector<std::uint64_t>(field::chunk_cells * layer_words);
  BlockWalker walker_;
  Buffer<float> positions_;
  Buffer<double> points_;
  Buffer<std::uint32_t> indices_;
  Buffer<FacetFour> facets_;  ///< of the vertices so far
  const Kept* kept_ = nullptr;
  std::size_t kept_at_ = 0;           ///< how far kept_'s edges are read
  std::vector<std::uint32_t> edges_;  ///< of the vertices so far
  std::vector<std::uint32_t> fresh_;  ///< vertices whose normals are to be found
  std::vector<Vec3f> normals_out_;
  std::vector<float> values_;
  std::vector<Vec3f> gradients_;
  std::vector<std::uint32_t> parents_;
};

}  // namespace tafoni::surface::impl
