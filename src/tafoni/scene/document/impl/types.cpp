#include "tafoni/scene/document/impl/types.h"

#include <algorithm>

#include "tafoni/core/error.h"
#include "tafoni/geology/kind.h"
#include "tafoni/landforms/landform.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/layers/impl/primitives_layer.h"
#include "tafoni/scene/layers/impl/volume_layer.h"
#include "tafoni/terrain/generator.h"

namespace tafoni::scene {

const std::vector<ParamInfo>& params_of_layer(std::string_view type) {
  struct Sculpt {
    std::string strokes, journal;
    bool settle = true;
  };
  static const std::vector<ParamInfo> sculpt =
      ParamTable<Sculpt>()
          .text("strokes", &Sculpt::strokes, "Path of a text file of strokes, which come first")
          .text("journal", &Sculpt::journal,
                "Path of the journal of strokes that tafoni sculpt and editors make")
          .boolean("settle", &Sculpt::settle,
                   "Limits the field of earlier layers to the terrain's amplitude, so that strokes fill "
                   "their caves as they fill open air");
  if (type == primitives_layer) return impl::primitives_params();
  if (type == sculpt_layer) return sculpt;
  if (type == volume_layer) return impl::volume_params();

  std::vector<std::string> known = {std::string(primitives_layer), std::string(sculpt_layer),
                                    std::string(volume_layer)};
  for (const landforms::LandformType* landform : landforms::all_landforms()) {
    if (landform->about.name == type) return landform->about.params;
    known.push_back(landform->about.name);
  }
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + name;
  const std::string near = nearest(type.substr(0, 100), known);
  fail(ErrorKind::usage, "unknown layer type \"{}\"; {}", type.substr(0, 100),
       near.empty() ? "known are " + list : fmt::format("did you mean \"{}\"?", near));
}

namespace impl {

const std::vector<ParamInfo>& params_of_generator(std::string_view name) {
  return terrain::find_generator(name).about.params;
}

const std::vector<ParamInfo>& params_of_geology(std::string_view type) {
  return geology::find_geology(type).about.params;
}

std::vector<ParamInfo> joined(std::span<const ParamInfo> common, std::span<const ParamInfo> own) {
  std::vector<ParamInfo> out(common.begin(), common.end());
  out.insert(out.end(), own.begin(), own.end());
  return out;
}

namespace {

bool has(std::span<const ParamInfo> infos, std::string_view name) {
  return std::any_of(infos.begin(), infos.end(), [&](const ParamInfo& info) { return info.name == name; });
}

}  // namespace

Value loaded(std::span<const ParamInfo> common, const void* object, const Values& own,
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
