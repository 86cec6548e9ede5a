#pragma once
// Builds documents and keeps what it made, so that the next build makes again only what differs.

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/io/volume_file.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/build/impl/digest.h"
#include "tafoni/scene/build/impl/recent.h"
#include "tafoni/scene/sculpt/impl/sculpt.h"

namespace tafoni::scene::impl {

/// Where the strokes of a sculpt layer come from.
using SlotSource = std::function<std::vector<Slot>(const Document&, const Layer&)>;
/// From the layer's files.
std::vector<Slot> slots_of(const Document& document, const Layer& layer);

/// One layer of a build, with what it depended on.
struct BuiltLayer {
  Digest key;
  LayerResult result;
  std::shared_ptr<const Sculpted> sculpted;  ///< of a sculpt layer
  Digest frame;                              ///< of a sculpt layer: all but its strokes
};

struct Built {
  std::shared_ptr<const BuiltScene> scene;
  Digest ground;  ///< of the terrain, its field and the lattice
  std::vector<BuiltLayer> layers;
};

/// Boxes, local metres, outside of which both scenes' fields have the same values, bit for bit. Infinite
/// where that cannot be told.
std::vector<Box3d> changed_boxes(const Built& before, const Built& now);

class Builder {
 public:
  Built build(const Document& document, const SlotSource& slots, Progress& progress);

 private:
  struct Stage;
  void make_ground(Stage& stage, Progress& progress);
  void make_geology(Stage& stage);
  void run_layers(Stage& stage, Progress& progress);
  BuiltLayer run_layer(Stage& stage, std::size_t index, Progress& progress);
  raster::Raster read_terrain(const Document& document, Progress& progress);
  std::shared_ptr<const io::Volume> read_volume(const std::filesystem::path& file, Progress& progress);
  BuiltLayer sculpt(Stage& stage, const Layer& layer, std::uint64_t seed);
  std::shared_ptr<const landforms::Region> region_of(Stage& stage, const Layer& layer, Digest& digest);

  struct MadeTerrain {
    terrain::Terrain terrain;
    field::NodePtr open, domain;
  };
  FileDigests files_;
  Recent<Digest, std::shared_ptr<const io::Volume>> volumes_{2};
  Recent<Digest, std::shared_ptr<const raster::Raster>> rasters_{3};
  Recent<Digest, MadeTerrain> terrains_{3};
  Recent<Digest, geology::GeologyPtr> geologies_{8};
  Recent<Digest, std::shared_ptr<const landforms::Region>> regions_{32};
  Recent<Digest, LayerResult> results_{64};
  SculptCook cook_;
};

}  // namespace tafoni::scene::impl
