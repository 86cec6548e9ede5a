#pragma once
// What a layer is made from, and what a build keeps of it.

#include <any>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tafoni/landforms/landform.h"
#include "tafoni/scene/build/impl/ground.h"
#include "tafoni/scene/build/impl/memo.h"
#include "tafoni/scene/build/impl/region.h"
#include "tafoni/scene/layers/layer.h"

namespace tafoni::scene::impl {

/// What all below a layer has come to, which the layer builds on.
struct Below {
  terrain::Terrain terrain;
  field::HeightfieldSettings settings;
  geology::GeologyPtr geology;
  field::NodePtr open;  ///< without the domain, whose walls are no cliffs
};

/// All that a layer may look at: what it makes is kept under a digest of these.
struct LayerParts {
  Keyed<Below> below;
  Layer words;  ///< without its name and its own seed, which decide nothing but `seed`
  std::uint64_t seed = 0;
  Keyed<RegionPtr> region;
  std::map<std::string, File> files;  ///< that its words name, by parameter, where they name one
};
inline auto parts(const LayerParts& layer) {
  const auto& [below, words, seed, region, files] = layer;
  return std::tie(below, words, seed, region, files);
}

/// LayerType::make() of the words' type.
landforms::Result make_layer(const LayerParts& parts, Readers& readers);
using Results = Memo<landforms::Result, Readers, LayerParts>;

/// What one layer of a build came to.
struct BuiltLayer {
  const LayerType* type = nullptr;
  Keyed<landforms::Result> made;
  bool reused = false;
  RegionPtr region;                 ///< null: everywhere
  std::shared_ptr<const void> own;  ///< what LayerType::changed() of the type compares, beyond `made`
};

/// What a build offers to a layer at its place in it.
struct LayerSite {
  const std::string& name;  ///< what messages call the layer
  const Keyed<Below>& below;
  Layer words;  ///< as LayerParts::words
  std::uint64_t seed;
  const Keyed<RegionPtr>& region;
  std::function<std::map<std::string, File>()> files;  ///< reads them, as LayerParts::files
  std::function<std::vector<Slot>()> strokes;          ///< of a layer whose type takes some
  Results& results;                                    ///< of earlier builds and this
  std::any& memory;                                    ///< of the layers of this type, to use as they like
  Readers& readers;
};

}  // namespace tafoni::scene::impl
