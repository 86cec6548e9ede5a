#pragma once
// Chambers: few chosen values, negative where it is open, subdivided [Ju01 §4].

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/volume/scalar_grid.h"

namespace tafoni::volume {

/// Values from -1, open, to 1, rock; x fastest, y to the north, z up.
struct ChamberLattice {
  Vec3i cells;
  std::vector<float> values;
};

/// Reads layers from the lowest up, separated by ';'. A layer's rows, from north to south, are separated by
/// '/' or new lines. A row is numbers separated by blanks, or a word of '#' for 1, '+' for 0.5, 'o' for 0,
/// '-' for -0.5 and '.' for -1. Throws Error{usage} naming `where`.
ChamberLattice parse_lattice(std::string_view text, std::string_view where);

struct ChamberPreset {
  std::string name, doc;
  std::string lattice;  ///< as parse_lattice() takes it
  double cell;          ///< metres a side of one of its cells, unless the user says
};
/// "storage" and "queen" are [Ju01]'s.
std::span<const ChamberPreset> chamber_presets();
/// Throws Error{usage} naming the nearest known one.
const ChamberPreset& find_chamber_preset(std::string_view name);

struct ChamberSettings {
  Vec3d position;        ///< local metres: the middle of the lowest layer
  double cell = 2.4;     ///< metres a side of a cell
  double turn = 0;       ///< radians, counter-clockwise from above
  double noise = 0;      ///< most that the first level is off, in cells; each level half of the one before
  double spacing = 0.5;  ///< metres between samples, at most
  std::uint64_t seed = 0;
};

class Chamber {
 public:
  Chamber(const ChamberLattice& lattice, const ChamberSettings& settings);

  /// About the distance to the wall, metres, negative inside. Positive at the border of the lattice, whatever
  /// the values there, and beyond.
  double value(Vec3d p) const;
  Box3d bounds() const;  ///< encloses all open space
  /// The samples in its own frame, whose origin is the lattice's lowest corner, unturned.
  const ScalarGrid& grid() const { return grid_; }
  const ChamberSettings& settings() const { return settings_; }
  Vec3d size() const { return size_; }  ///< metres a side

 private:
  ChamberSettings settings_;
  Vec3d size_;
  ScalarGrid grid_;
};

/// f = min(f, value(p)) at every sample inside of a chamber's border. Gives the box of what changed.
SampleBox carve(ScalarGrid& grid, const Chamber& chamber);

}  // namespace tafoni::volume
