#pragma once
// The grammar of caves. Assemblies from the paper's six parameters, by a table of rules or at random
// [Zawadzki §3].

#include <cstdint>
#include <string>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/core/progress.h"
#include "tafoni/grammar/assembly.h"

namespace tafoni::grammar {

struct Settings {
  std::int64_t classic = 10;     ///< P_C: sums, differences and intersections
  std::int64_t morphic = 2;      ///< P_M
  std::string direction = "+X";  ///< L_B: "+X" … "-Z", or "random"
  double morph = 0.52;           ///< M_P, 0 to 1
  std::int64_t per_shape = 3;    ///< P_S: how many solids make up a shape; 0 and 1: a bare one
  std::vector<std::string> solids = {"cube", "ellipsoid", "cylinder", "torus", "pyramid", "cone", "sphere"};
  double size = 1;                          ///< metres: half the width of a middling shape
  std::vector<double> spread = {0.6, 1.4};  ///< least and greatest half width, as multiples of the size
  double flat = 1;                          ///< heights as a share of widths
  double overlap = 0.2;  ///< share of its extent by which an added shape is pushed into the base; 0: none, as
                         ///< in [Zawadzki]
  double branches = 0.2;                         ///< share of productions that do not continue the last part
  double differences = 0.15, intersections = 0;  ///< shares of the classic productions that follow the first
  bool turn = true;                              ///< shapes may be turned to make a label
  bool whole = false;  ///< morphs and intersections act on the whole base, to the letter, not on the part
                       ///< they touch
  std::uint64_t seed = 0;
};

/// L_B as a direction; zero for "random". Throws Error{usage} naming what can be written.
Vec3d direction_of(std::string_view text);
std::vector<std::string> direction_names();

/// The columns of a table of rules.
std::vector<ParamInfo> rule_columns();

/// Continues `base` (mostly empty) by P_C + P_M productions at random: the morphic ones are spread among the
/// classic ones, and a shape that finds no place, or would leave none in the direction L_B, is drawn anew a
/// few times before its production is dropped; a difference or an intersection becomes a sum before that. The
/// first production takes any direction. Throws Error{usage} for names and sizes of solids that are not
/// known.
void derive_at_random(Assembly& base, const Settings& settings, const Assembly::Accept& accept = nullptr,
                      Progress& progress = silent());

/// Continues `base` by a table of rules. The first row's symbol stands on the base at first. A symbol is
/// replaced by one of its rows, drawn by weight: the row's shape is added with the row's operation by a label
/// on the part where the symbol stands, and the row's `next` symbols stand on it then. Ends when P_C and P_M
/// are spent or no symbol is left. A shape may be a solid or another symbol, which is then derived by itself
/// and stored as one shape (P_S of its productions). Throws Error{usage} naming the row and what is wrong
/// with it, or that the table makes more symbols or larger shapes than anyone can mean.
void derive_by_rules(Assembly& base, const Rows& rules, const Settings& settings,
                     const Assembly::Accept& accept = nullptr, Progress& progress = silent());

}  // namespace tafoni::grammar
