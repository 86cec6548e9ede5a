#pragma once
// The air of a cave: an entrance passage, and what the grammar adds to it within the rock [Zawadzki §3].

#include "tafoni/grammar/derive.h"
#include "tafoni/landforms/site/ground.h"

namespace tafoni::landforms::impl {

/// Parameters of grammar-cave, besides those of the grammar itself; metres.
struct BodySettings : grammar::Settings {
  Rows rule;             ///< empty: productions at random
  double passage = 1.8;  ///< radius of the entrance passage
  double roof = 2.5;     ///< least rock over a cave
  double storeys = 0.5;  ///< most that a shape lies above or below the entrance, as a multiple of the size
};

/// How much wider than the passage its mouth is.
inline constexpr double flare = 1.4;

/// In a frame whose x leads into the hill from the mouth at zero.
struct CaveBody {
  grammar::Assembly shape;
  double passage_length = 0;
};

/// Continues `base` by the rules, or at random where there are none.
void derive(grammar::Assembly& base, const BodySettings& settings, const grammar::Assembly::Accept& accept,
            Progress& progress);

/// As short a passage as lets the grammar grow, but no shorter; without productions where there is no room in
/// the rock. `frame` places it in the site; `lift` is the height of the passage's axis over its floor.
CaveBody dig_body(const Ground& ground, const grammar::Pose& frame, double lift, const BodySettings& settings,
                  Progress& progress);

}  // namespace tafoni::landforms::impl
