// Every registered landform is a type of layer.
#include "tafoni/io/csv.h"
#include "tafoni/scene/build/impl/outside.h"
#include "tafoni/scene/layers/impl/site.h"

namespace tafoni::scene::layer_landform {
namespace {

landforms::Result make(const impl::LayerParts& parts, impl::Readers& readers) {
  const impl::Below& below = parts.below.value;
  landforms::Site site;
  site.origin = below.terrain.origin;
  site.heights = below.terrain.heights;
  site.valid = below.terrain.valid.get();
  site.influence = below.settings.influence;
  site.amplitude = below.settings.amplitude;
  site.terrain = below.open;
  site.geology = below.geology;
  site.region = parts.region.value.get();
  if (const auto points = parts.files.find("points"); points != parts.files.end()) {
    const auto& file = points->second.path;
    std::uint64_t beside = 0;
    for (const Vec3d p : io::parse_points_csv(io::read_text(file), file.string())) {
      site.points.push_back(p - site.origin);
      beside += !impl::over_domain(below.terrain, {site.points.back(), site.points.back()});
    }
    impl::warn_of_beside(below.terrain, file.string(), "points", beside, site.points.size(),
                         readers.progress);
  }
  site.seed = parts.seed;
  return landforms::find_landform(parts.words.type).generate(site, parts.words.values, readers.progress);
}

}  // namespace

const LayerKind& declaration() {
  static const LayerKind kind = [] {
    LayerKind out{.listed_as = "landforms"};
    for (const landforms::LandformType* landform : landforms::all_landforms())
      out.types.push_back({.about = landform->about, .make = make});
    return out;
  }();
  return kind;
}

}  // namespace tafoni::scene::layer_landform
