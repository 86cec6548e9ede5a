#include "tafoni/scene/layers/layer.h"

#include <algorithm>

#include "tafoni/core/error.h"
#include "tafoni/scene/layers/impl/site.h"

namespace tafoni::scene {

std::span<const LayerType* const> all_layer_types() {
  static const std::vector<const LayerType*> all = [] {
    std::vector<const LayerType*> out;
    for (const LayerKind* kind : all_layers())
      for (const LayerType& type : kind->types) out.push_back(&type);
    return out;
  }();
  return all;
}

const LayerType& find_layer_type(std::string_view name) {
  return find(all_layer_types(), name, "layer type");
}

const LayerType& stroke_layer_type() {
  for (const LayerType* type : all_layer_types())
    if (type->takes_strokes) return *type;
  fail(ErrorKind::internal, "no type of layer takes strokes");
}

namespace impl {

landforms::Result make_layer(const LayerParts& parts, Readers& readers) {
  return find_layer_type(parts.words.type).make(parts, readers);
}

BuiltLayer build_whole(const LayerSite& site) {
  const auto before = site.results.made();
  const Keyed<landforms::Result> made =
      site.results({site.below, site.words, site.seed, site.region, site.files()}, site.readers);
  BuiltLayer out;
  out.made = made;
  out.reused = site.results.made() == before;
  return out;
}

bool changed_whole(const BuiltLayer* before, const BuiltLayer* now, std::vector<Box3d>& out) {
  if (before && now) return before->made.key == now->made.key;
  for (const BuiltLayer* layer : {before, now}) {
    if (!layer) continue;
    const landforms::Result& made = layer->made.value;
    if (!made.reshaped.empty()) out.push_back(made.reshaped);
    for (const field::NodePtr& node : made.nodes) out.push_back(field::support(node));
  }
  return true;
}

}  // namespace impl
}  // namespace tafoni::scene
