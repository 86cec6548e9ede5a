#pragma once
// Which types a block of a scene can have, and their parameters.

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/params.h"

namespace tafoni::scene::impl {

/// Both throw Error{usage} naming the nearest known one.
const std::vector<ParamInfo>& params_of_generator(std::string_view name);
const std::vector<ParamInfo>& params_of_geology(std::string_view type);

/// Common parameters first, then those of the type.
std::vector<ParamInfo> join_params(std::span<const ParamInfo> common, std::span<const ParamInfo> own);

/// The value that a block has for `info`, a default where it says nothing.
Value load_value(std::span<const ParamInfo> common, const void* object, const Values& own,
                 const ParamInfo& info);

/// Stores a checked value: into `object` where `common` has the name, else into `own`, which keeps only what
/// differs from the default of `info`.
void store(std::span<const ParamInfo> common, void* object, Values& own, const ParamInfo& info,
           const Value& value);

}  // namespace tafoni::scene::impl
