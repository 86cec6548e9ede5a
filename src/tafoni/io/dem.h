#pragma once
// Elevation models in: anything GDAL reads, as a metric, north-up raster with every fix told to the user.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/math/vec.h"
#include "tafoni/raster/grid.h"

namespace tafoni::io {

/// How a file's numbers mean heights.
enum class HeightEncoding {
  automatic,    ///< told from what the file says and holds
  heights,      ///< as they stand, in the unit that the file names or else in metres
  heightmap,    ///< an engine's: 512 m from black to white, or from 0 to 1
  terrain_rgb,  ///< Mapbox's: tenths of a metre from -10000 m, in three bytes of colour
  terrarium     ///< Mapzen's: 1/256 m from -32768 m, in three bytes of colour
};

/// Which byte of a number comes first in a file without a header.
enum class ByteOrder {
  automatic,  ///< that in which the terrain is smoother
  little,     ///< the least significant
  big
};

struct DemOptions {
  /// X, Y, W, H in pixels of the file, counted from the row that is stored first, as gdal_translate -srcwin
  /// counts them.
  std::optional<std::array<int, 4>> window;
  double resolution = 0;  ///< metres; 0: the file's own. Coarser ones are area averages.
  int band = 0;           ///< from 1; 0: the band that holds elevations
  /// Metres: a hole no point of which is farther than this from data is filled, a larger one is left out of
  /// the domain. A negative distance means eight pixels.
  double fill_distance = -1;
  bool smooth = false;  ///< removes the terraces of 8-bit and stepped data, moving heights by half a step
  /// Metres a pixel of a file without georeference; 0 means 1 m.
  double pixel_size = 0;
  HeightEncoding encoding = HeightEncoding::automatic;
  /// Metres a unit of stored height, in place of what the file says; 0: the file's own. Negative for depths,
  /// which are positive downwards. Engines' heightmaps say nothing and count 512 m from black to white, or
  /// from 0 to 1.
  double height_scale = 0;
  double height_offset = 0;  ///< metres, added to every height
  /// Columns and rows of a file without a header; 0: as many of either as fill it.
  std::array<int, 2> raw_size{};
  ByteOrder byte_order = ByteOrder::automatic;
  /// WKT or EPSG:NUMBER, the CRS of a file whose coordinates name none; empty: metres, or degrees where they
  /// look like those.
  std::string own_crs;
  /// Where to bring the raster, WKT or EPSG:NUMBER, metres; empty: its own CRS, or the UTM zone of its middle
  /// when that is not metric.
  std::string crs;
};

/// Throws Error{input} for what DemOptions::own_crs cannot be.
void check_crs(const std::string& crs);

struct Dem {
  raster::Raster raster;           ///< metres, north-up, NaN outside the domain; at least 2 x 2
  std::vector<std::string> notes;  ///< every assumption and fix, one sentence each; also sent to warn()
  double missing = 0;              ///< share of pixels outside the domain
  std::size_t filled = 0;          ///< pixels filled from their surroundings
  double step = 0;                 ///< metres: the step of stepped heights; 0 when smooth
};

/// Reads `path` by windows. Memory: the window at the resolution asked for, up to four times that while holes
/// are mended or the grid is warped. Throws Error{input} for what is no elevation model, Error{usage} for
/// options that do not fit the file.
Dem read_dem(const std::filesystem::path& path, const DemOptions& options = {},
             Progress& progress = silent());

/// What a file holds, before anything is changed.
struct DemInfo {
  std::string driver;  ///< GDAL's long name
  std::string type;    ///< "Float32" …
  int width = 0, height = 0, bands = 0;
  int band = 1;           ///< the one that read_dem would take
  std::string crs;        ///< its name; empty when unknown
  std::string crs_wkt;    ///< empty when unknown
  std::string unit;       ///< of the two directions below: "metre", "degree", "US survey foot", "pixel"
  double dx = 1, dy = 1;  ///< pixel size in that unit; positive
  double angle = 0;       ///< radians, anticlockwise from east to the row direction
  bool north_up = true;   ///< row 0 is the north edge and columns go east
  double west = 0, south = 0, east = 0, north = 0;  ///< hull in that unit
  std::string height_unit;                          ///< "metre" when the file says nothing
  double scale = 1, offset = 0;
  double lowest = 0, highest = 0;  ///< metres, over pixels with data; 0 when there are none
  double missing = 0;              ///< share of pixels without data
  double step = 0;                 ///< metres: the step of stepped heights; 0 when smooth
  std::vector<std::string> notes;  ///< what read_dem would assume or fix
};

/// Reads the whole file once by strips, whatever the window and resolution of `options`. Throws Error as
/// read_dem does.
DemInfo inspect_dem(const std::filesystem::path& path, const DemOptions& options = {},
                    Progress& progress = silent());

/// Float32 GeoTIFF, compressed, NaN as nodata; appears whole or not at all. Throws Error{output}.
void write_geotiff(const std::filesystem::path& path, const raster::Raster& raster);

}  // namespace tafoni::io
