#pragma once
// The layer of explicit primitives: a CSV turned into one cloud a kind.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/field/tree.h"

namespace tafoni::scene::impl {

struct PrimitivesSettings {
  std::string file;
  double falloff = 0;  ///< metres; 0 for the terrain's influence
  double noise = 0, wavelength = 4;
  std::int64_t octaves = 3;
};
const std::vector<ParamInfo>& primitives_params();

/// The primitives of the CSV text `text`, called `name` in messages, whose anchor (local) `keep` accepts;
/// null keeps all. `origin` is the world position of local zero. Throws Error{input} "NAME:LINE: …".
std::vector<field::NodePtr> make_primitives(std::string_view text, std::string_view name,
                                            const PrimitivesSettings& settings, Vec3d origin,
                                            double influence, std::uint64_t seed,
                                            const std::function<bool(Vec3d)>& keep);

}  // namespace tafoni::scene::impl
