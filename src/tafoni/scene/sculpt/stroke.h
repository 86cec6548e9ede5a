#pragma once
// A stroke of sculpting [Paris19 §3.2, §8.2]: an operation, not voxels.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/math/vec.h"

namespace tafoni::scene {

struct Stroke {
  std::string brush;          ///< a registered brush (brush.h)
  std::vector<Vec3d> points;  ///< world, scene CRS, metres
  std::string mode = "carve";
  double radius = 5;       ///< metres
  double strength = 1;     ///< 1 carves through solid rock, or fills air
  double roughness = 0.2;  ///< greatest displacement of the walls, as a part of the radius
  std::int64_t seed = 0;
  Values values;  ///< of the brush; only what differs from its defaults

  bool adds() const { return mode == "add"; }
  friend bool operator==(const Stroke&, const Stroke&) = default;
};
/// What every stroke can say besides its points and its brush's own parameters.
const std::vector<ParamInfo>& stroke_params();

/// One line: the brush, then NAME=VALUE separated by blanks; the points are at=X,Y,Z or at=X,Y,Z/X,Y,Z/…,
/// text with blanks stands in "quotes". Throws Error{usage} "WHERE: …" for what no brush understands.
///
///     cave at=120,80,14/150,95,12 radius=4 chambers=1
Stroke parse_stroke(std::string_view line, std::string_view where);
/// The shortest line that reads back as the same stroke.
std::string to_text(const Stroke& stroke);

/// The beginning of that line, as messages show which stroke they mean.
std::string shown_stroke(const Stroke& stroke);

/// A file of strokes: one a line, where blank lines and lines that begin with # are skipped; or JSON, an
/// array of objects {"brush": …, "at": [[x, y, z], …], …}. Throws Error{input} "NAME:LINE: …".
std::vector<Stroke> parse_strokes(std::string_view text, std::string_view name);

}  // namespace tafoni::scene
