#pragma once
// Winding rivers with side valleys, and the country they are cut into, for generators.
//
// A valley's walls are a Face: the reach of a place is the least, over all points of all rivers, of the
// face's reach at the river's bed plus the distance to its bank. Beds of rock therefore stand at the same
// elevation on either side and in side valleys, and where two valleys come near each other a ridge remains.

#include <cstdint>
#include <memory>
#include <unordered_map>
#include <vector>

#include "tafoni/core/random.h"
#include "tafoni/raster/grid.h"
#include "tafoni/terrain/generator.h"
#include "tafoni/terrain/impl/face.h"

namespace tafoni::terrain::impl {

struct RiverPoint {
  Vec2d position;
  double bed, half_width;  ///< metres
  double along = 0;        ///< metres upstream of the river's mouth
};
using River = std::vector<RiverPoint>;  ///< from mouth to head

/// How a river runs: a sine-generated curve [Langbein66] about a direction that wanders.
struct Winding {
  double wavelength = 400;  ///< metres along the river
  double swing = 0.9;       ///< radians to either side
  double wander = 0.3;      ///< radians that the direction strays within a wavelength
};

struct SideValleys {
  double per_km = 6;              ///< of the parent's length
  double length[2] = {150, 450};  ///< metres
  double apart = 60;              ///< metres kept from other rivers
  double head = 200;              ///< bed at the head
  double steepening = 2;          ///< exponent of the bed's rise; 1: even
  int falls = 4;                  ///< dry falls on the way up
  double half_width[2] = {4, 1};  ///< at mouth and head
  Winding winding;
};

/// How closely rivers are followed on a map: a little finer than its pixels, 20000 steps about it at most.
inline double river_step(const GridSettings& grid) {
  const Vec2d extent = grid.extent();
  return std::max(0.7 * grid.pixel, (extent.x + extent.y) / 20000);
}

class Valleys {
 public:
  Valleys(Vec2d extent, double step, std::uint64_t seed);

  /// From below the map's southern edge to beyond the northern one, if `to_north`; else from the eastern to
  /// the western. `middle`: about where it crosses the map, as a share of it.
  void add_main(double middle, double bed, double gradient, double half_width, const Winding& winding,
                bool to_north);
  /// Gives side valleys to all the rivers there are; `generation` picks the random numbers.
  void add_sides(const SideValleys& sides, int generation);

  const std::vector<River>& rivers() const { return rivers_; }
  double margin() const { return margin_; }

 private:
  /// Side valley `i` of `wanted` of a river, or an empty one where there is no room for it.
  River side_valley(const SideValleys& sides, std::size_t parent, int i, int wanted, double hand,
                    Random& random) const;
  River walk(RiverPoint from, double heading, double length, const Winding& winding, Random random) const;
  bool on_map(Vec2d p) const;
  std::uint64_t cell(Vec2d p, int dx, int dy) const;
  void occupy(std::size_t river);
  /// Whether another river than `parent` lies near, or `parent` away from `mouth`.
  bool crowded(Vec2d p, double apart, std::size_t parent, Vec2d mouth) const;

  Vec2d extent_;
  double step_, margin_, cell_size_;
  std::uint64_t seed_;
  std::vector<River> rivers_;
  struct Visit {
    std::uint32_t river, point;
  };
  std::unordered_map<std::uint64_t, std::vector<Visit>> visits_;
};

/// The rivers spread over a grid: of every place the river point that makes its reach least.
class ValleyMap {
 public:
  ValleyMap(const std::vector<River>& rivers, const Face& face, const raster::Placement& placement, int width,
            int height);

  struct Place {
    double reach;     ///< metres; clamped to the river's bed on the river itself
    double off_bank;  ///< metres from the river's bank, negative on the river
    const RiverPoint* river;
  };
  Place at(Vec2d p) const;

 private:
  std::vector<RiverPoint> points_;
  std::vector<double> foot_;  ///< reach at the bed, less the half width
  raster::Placement placement_;
  raster::Grid<std::int32_t> best_;
};

}  // namespace tafoni::terrain::impl
