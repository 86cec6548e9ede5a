#pragma once
// Builds documents and keeps what it made, so that the next build makes again only what differs.

#include <any>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tafoni/io/volume_file.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/build/impl/digest.h"
#include "tafoni/scene/build/impl/ground.h"
#include "tafoni/scene/build/impl/memo.h"
#include "tafoni/scene/build/impl/region.h"
#include "tafoni/scene/layers/impl/site.h"
#include "tafoni/scene/sculpt/impl/paint.h"

namespace tafoni::scene::impl {

/// Where the strokes of a layer that takes some come from: slots_of(), or what a session has in memory.
using SlotSource = std::function<std::vector<Slot>(const Document&, const Layer&)>;

struct Built {
  std::shared_ptr<const BuiltScene> scene;
  Digest ground;    ///< of the terrain, its field and the lattice
  double base = 0;  ///< local z
  std::vector<BuiltLayer> layers;
};

/// Boxes, local metres, outside of which both scenes' fields have the same values, bit for bit. Infinite
/// where that cannot be told.
std::vector<Box3d> changed_boxes(const Built& before, const Built& now);

class Builder {
 public:
  Built build(const Document& document, const SlotSource& slots, Progress& progress);
  /// The terrain alone, with its own base.
  terrain::Terrain terrain(const Document& document, Progress& progress);

 private:
  struct Stage;
  void build_ground(Stage& stage);
  void build_geology(Stage& stage);
  void build_layers(Stage& stage);
  void lay_base(Stage& stage);
  BuiltLayer build_layer(Stage& stage, std::size_t index);
  Keyed<RegionPtr> region_of(const Stage& stage, const Layer& layer, Progress& progress);
  std::optional<File> file(const Document& document, const std::string& path);

  FileDigests files_;
  Readers::Volumes volumes_{2, &read_volume_file};
  Memo<RasterPtr, Readers, TerrainSection, std::uint64_t, std::optional<File>> elevations_{3,
                                                                                           &make_elevations};
  Memo<Ground, Progress, Keyed<RasterPtr>, TerrainSection, double, std::optional<File>> grounds_{
      3, &make_ground};
  Memo<geology::GeologyPtr, Progress, std::vector<GeologySettings>, std::uint64_t, Vec3d> geologies_{
      8, &make_geology};
  Memo<RegionPtr, Progress, Limits> regions_{32, &make_region};
  Results results_{64, &make_layer};
  std::map<const LayerType*, std::any> memories_;
};

}  // namespace tafoni::scene::impl
