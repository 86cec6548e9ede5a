// A block of a scene has parameters that all of its sort have, kept in members of a struct, and those of its
// type, kept as values by name. Here both are looked up, read and written as one list.
#include "tafoni/scene/document/impl/types.h"

#include <algorithm>

#include "tafoni/geology/kind.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {

const std::vector<ParamInfo>& params_of_layer(std::string_view type) {
  return find_layer_type(type).about.params;
}

namespace impl {

const std::vector<ParamInfo>& params_of_generator(std::string_view name) {
  return terrain::find_generator(name).about.params;
}

const std::vector<ParamInfo>& params_of_geology(std::string_view type) {
  return geology::find_geology(type).about.params;
}

std::vector<ParamInfo> join_params(std::span<const ParamInfo> common, std::span<const ParamInfo> own) {
  std::vector<ParamInfo> out(common.begin(), common.end());
  out.insert(out.end(), own.begin(), own.end());
  return out;
}

namespace {

bool has(std::span<const ParamInfo> infos, std::string_view name) {
  return std::any_of(infos.begin(), infos.end(), [&](const ParamInfo& info) { return info.name == name; });
}

}  // namespace

Value load_value(std::span<const ParamInfo> common, const void* object, const Values& own,
                 const ParamInfo& info) {
  if (has(common, info.name)) return info.load(info, object);
  const auto found = own.find(info.name);
  return found == own.end() ? info.init : found->second;
}

void store(std::span<const ParamInfo> common, void* object, Values& own, const ParamInfo& info,
           const Value& value) {
  if (has(common, info.name))
    info.store(info, object, value);
  else if (value == info.init)
    own.erase(info.name);
  else
    own.insert_or_assign(info.name, value);
}

}  // namespace impl
}  // namespace tafoni::scene
