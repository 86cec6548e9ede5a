#pragma once
// Prism-fields [Boggus]: ground as an ordered array of layers, each with a top and
// a bottom at every sample of a regular grid; between them is matter. A point of a layer without matter is
// inactive, which makes shafts; several layers over each other make tunnels.

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "tafoni/math/vec.h"
#include "tafoni/volume/tool.h"

namespace tafoni::volume {

/// Column (i, j), 0 <= i < nx and 0 <= j < ny, stands at origin + (i dx, j dy), local metres. Elevations in
/// columns are floats above origin.z.
struct ColumnFrame {
  Vec3d origin;
  double dx = 1, dy = 1;  ///< metres
  int nx = 2, ny = 2;     ///< at least 2

  double x(int i) const { return origin.x + i * dx; }
  double y(int j) const { return origin.y + j * dy; }
  friend bool operator==(const ColumnFrame&, const ColumnFrame&) = default;
};

/// Columns from (i0, j0) to (i1, j1), both included.
struct ColumnBox {
  int i0 = 0, j0 = 0, i1 = -1, j1 = -1;

  bool empty() const { return i1 < i0 || j1 < j0; }
  int width() const { return i1 - i0 + 1; }
  int height() const { return j1 - j0 + 1; }
  void expand(int i, int j);
  void expand(const ColumnBox& box);
  friend bool operator==(const ColumnBox&, const ColumnBox&) = default;
};

/// Matter of one column from bottom to top, metres above the frame's origin.
struct Matter {
  float bottom = 0, top = 0;
  friend bool operator==(const Matter&, const Matter&) = default;
};

/// The matter of a box of columns, bottom first.
struct ColumnBlock {
  ColumnBox box;
  int stride = 0;                   ///< places a column has in `intervals`
  std::vector<std::int32_t> count;  ///< by column, i fastest
  std::vector<Matter> intervals;    ///< of column c from c * stride

  std::size_t column(int i, int j) const { return std::int64_t{j - box.j0} * box.width() + i - box.i0; }
  std::span<const Matter> at(int i, int j) const {
    const std::size_t c = column(i, j);
    return std::span(intervals).subspan(c * stride, count[c]);
  }
};

/// What becomes of a cell of the grid one of whose corners has no matter [Boggus fig. 6].
enum class DeadPoints {
  triangles,  ///< a cell with one dead corner is half full
  quads,      ///< a cell with a dead corner is empty
};

/// The ordered array P of prism-fields. In every column the active points of P[0], P[1], … lie over each
/// other with air between: top of P[i] < bottom of P[k] for i < k. A column's matter as a set is exactly the
/// difference or union of what it was with the tool's span (to float), less what is thinner than
/// min_thickness. Copies share memory until they differ. Editing one object is for one thread at a time.
class PrismFields {
 public:
  /// Empty. Throws Error{usage} for a frame without cells, of more than 2^31 columns or without spacing, or a
  /// thickness that is not above 0.
  explicit PrismFields(const ColumnFrame& frame, double min_thickness = 1e-3);

  const ColumnFrame& frame() const { return frame_; }
  double min_thickness() const { return thinnest_; }
  int layers() const { return static_cast<int>(layers_.size()); }
  /// What one point of a layer holds; bottom and top mean nothing where it is not active.
  bool active(int layer, int i, int j) const;
  Matter point(int layer, int i, int j) const;

  /// Removes or adds what lies inside the tool, at the columns inside its outline and nowhere else
  /// [Boggus §3]. Removing lowers tops, raises bottoms, deactivates a point whose top and
  /// bottom cross, and splits a layer the tool passes inside of: what is above goes to a layer above that has
  /// room in this column, of several to the one whose matter in the columns around overlaps most, and where
  /// there is none to a new P[i + 1]. Adding, which the paper only names, raises tops and lowers bottoms,
  /// joins the layers that it makes meet in the lowest of them, and puts matter that floats free in a layer
  /// between those below and above it. Layers left without matter are freed. Returns the columns that
  /// changed.
  ColumnBox apply(const Tool& tool, Edit mode);

  /// Makes a column's matter what is given: bottom first, apart from each other. What is thinner than
  /// min_thickness is left out. Layers left without matter are freed. Throws Error{usage} for what is out of
  /// order or not finite.
  void set_column(int i, int j, std::span<const Matter> matter);

  /// Reads the columns of `box`, which may reach beyond the frame, where there is nothing. Reuses `out`'s
  /// memory.
  void read(const ColumnBox& box, ColumnBlock& out) const;
  std::vector<Matter> column(int i, int j) const;

  /// The most intervals that any column has. Looks at all columns.
  int deepest() const;
  /// Numbers the matter of every column from the bottom, so that there are deepest() layers. apply() does so
  /// whenever more than twice as many layers have come together (and more than 8): sessions never end in
  /// more.
  void pack();

  /// Encloses all matter, local metres; empty where there is none. Looks at all columns.
  Box3d bounds() const;
  std::uint64_t bytes() const;  ///< of memory, what copies share included

  static constexpr int tile_columns = 32;

 private:
  struct Tile;
  struct Layer {
    std::vector<std::shared_ptr<Tile>> tiles;  ///< null where no point is active
    std::int64_t active = 0;
  };
  struct Place {
    std::size_t tile, at;
  };
  template <class Shape>
  ColumnBox apply_shape(const Shape& shape, const Box3d& bounds, Edit mode);
  bool remove(int i, int j, float lo, float hi);
  bool add(int i, int j, float lo, float hi);
  Place place(int i, int j) const;
  const Tile* tile(int layer, std::size_t t) const { return layers_[layer].tiles[t].get(); }
  void set(int layer, Place p, float bottom, float top);
  void insert_layer(int at);
  /// A layer in (below, above) that has room for the matter; it is made if there is none.
  int layer_for(int i, int j, Matter matter, int below, int above);
  double overlap_around(int layer, int i, int j, Matter matter) const;
  void free_empty();
  void settle();

  ColumnFrame frame_;
  float thinnest_;
  int tiles_x_, tiles_y_;
  int most_layers_ = 8;  ///< before pack()
  std::vector<Layer> layers_;
};

}  // namespace tafoni::volume
