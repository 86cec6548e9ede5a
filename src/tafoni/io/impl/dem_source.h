#pragma once
// An opened elevation file: what it says of itself, and its heights by windows, in metres, NaN where missing.

#include <array>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/io/dem.h"
#include "tafoni/io/impl/gdal.h"

namespace tafoni::io::impl {

/// Metres: the deepest sea floor and the highest mountain lie at -10.9 and 8.8 km; beyond these nothing does.
constexpr double earth_lowest = -12'000, earth_highest = 9'500;

/// One resolution of the file: its own or an overview.
struct Level {
  int width = 0, height = 0;
  int block_height = 1;
};

/// What was missing or odd among the pixels read so far.
struct ReadReport {
  std::uint64_t pixels = 0, missing = 0;
  std::uint64_t not_finite = 0, absurd = 0, sentinel = 0;  ///< among the missing
  double sentinel_value = 0, absurd_value = 0;
};

/// Where heights are depths by what is said of them: in any case, or as far as most or all of them are
/// positive.
enum class DepthsWhere { any, most_positive, all_positive };

/// Why heights may be depths, positive down.
struct Depths {
  std::string why;
  DepthsWhere where = DepthsWhere::any;
};

class DemSource {
 public:
  virtual ~DemSource() = default;
  DemSource(const DemSource&) = delete;
  DemSource& operator=(const DemSource&) = delete;

  /// Of `options`, what says how the file is read and what its numbers mean.
  static std::unique_ptr<DemSource> open(const std::filesystem::path& path, const DemOptions& options);

  /// Reads the heights of rows [y, y + h) and columns [x, x + w) of `level` into out[w * h].
  void read(std::size_t level, int x, int y, int w, int h, double* out);

  int width() const { return levels.front().width; }
  int height() const { return levels.front().height; }
  /// Whether the file says which pixels are missing.
  bool marks_missing() const { return has_nodata || nan_marks_missing; }
  /// Metres between the heights that the file can tell apart; 0 where it stores reals.
  double step() const { return whole ? std::abs(scale * unit) : 0; }

  std::string name;          ///< the path, for error texts
  std::string driver, type;  ///< GDAL's
  GDALDataType stored_type = GDT_Unknown;
  bool bytes = false;    ///< 8-bit
  bool decoded = false;  ///< heights were coded as colours
  bool whole = false;    ///< whole numbers are stored
  int bands = 1, band = 1;
  std::vector<Level> levels;  ///< the first is the file's own, then coarser and coarser
  /// Where the file's pixels lie, in CRS units, as GDAL's geotransform says it; meaningful when
  /// `georeferenced`.
  std::array<double, 6> transform{0, 1, 0, 0, 0, 1};
  bool georeferenced = false;
  OGRSpatialReference crs;  ///< x, y order; empty when unknown
  std::string height_unit = "metre";
  bool unit_stated = false;
  bool says_of_heights = false;  ///< whether it names a unit, a scale or a mark for missing data
  std::optional<Depths> depths;
  double scale = 1, offset = 0;  ///< stored value -> the height unit
  double unit = 1;               ///< metres a height unit
  bool guess_marks = true;       ///< whether values that often stand for missing data may do so without a tag
  std::vector<std::string> notes;
  ReadReport report;

 protected:
  DemSource() = default;
  /// Reads stored values, NaN where a mask says that there are none.
  virtual void read_stored(std::size_t level, int x, int y, int w, int h, double* out) = 0;
  bool has_nodata = false;
  bool nan_marks_missing = false;  ///< NaN is the file's own word for missing, not a surprise
  double nodata = 0;

 private:
  bool is_nodata(double stored) const;
  /// The stored values among `values` that stand for missing data without a tag.
  std::vector<double> undeclared_marks(const double* values, std::size_t count);
  std::vector<double> heights_after_all_;  ///< such values near which there are heights
};

}  // namespace tafoni::io::impl
