#pragma once
// What grammar-cave tells of a cave or a solid that it made, for those who measure it [Zawadzki §4].

#include <cstdint>
#include <optional>

#include "tafoni/landforms/facts.h"
#include "tafoni/math/vec.h"

namespace tafoni::landforms {

struct GrammarCaveMeasures {
  std::int64_t classic = 0, morphic = 0;  ///< productions by kind
  std::int64_t elements = 0;              ///< solids that went into it
  double size = 0;                        ///< metres: half the width of a middling shape
  std::int64_t detail = 0;                ///< L_D: samples a size
  Box3d box;                              ///< holds it; local

  std::int64_t productions() const { return classic + morphic; }
};

Facts facts_of(const GrammarCaveMeasures& measures);
/// Of what facts_of() told; nullopt where other facts are given.
std::optional<GrammarCaveMeasures> grammar_cave_measures(const Facts& facts);

}  // namespace tafoni::landforms
