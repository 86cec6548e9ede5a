// The layer of explicit primitives: the rows of a CSV become one cloud a kind.
#include <map>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/field/inner/outside.h"
#include "tafoni/io/csv.h"
#include "tafoni/scene/build/impl/outside.h"
#include "tafoni/scene/layers/impl/site.h"

namespace tafoni::scene::layer_primitives {
namespace {

struct Params {
  std::string file;
  double falloff = 0, noise = 0, wavelength = 4;
  std::int64_t octaves = 3;
};

const std::vector<ParamInfo>& params() {
  using P = Params;
  static const std::vector<ParamInfo> infos =
      ParamTable<P>()
          .text("file", &P::file,
                "Path of a CSV with the columns kind, x, y, z, energy and those of the kinds")
          .real("falloff", &P::falloff, "m", 0, 1e4,
                "How far the field of a body reaches beyond it: more lets bodies melt into one another and "
                "into the ground; 0 takes the terrain's influence")
          .real("noise", &P::noise, "m", 0, 1e3,
                "How far noise displaces the surface of bodies, less than the least radius; 0 leaves them "
                "smooth")
          .real("wavelength", &P::wavelength, "m", 1e-2, 1e4,
                "Size of the bumps that noise makes: a small one roughens a body, a large one bends it")
          .only("where noise is above 0", {{"noise", 0.5}})
          .integer("octaves", &P::octaves, "", 1, 12,
                   "How many layers of noise, each with bumps of half the size, are added: more gives finer "
                   "detail")
          .only("where noise is above 0", {{"noise", 0.5}});
  return infos;
}

landforms::Result make(const impl::LayerParts& parts, impl::Readers& readers) {
  Params p;
  assign(params(), &p, parts.words.values, "primitives");
  const impl::Below& below = parts.below.value;
  const Vec3d origin = below.terrain.origin;
  const auto& file = parts.files.at("file").path;
  const std::string name = file.string();
  const landforms::Region* region = parts.region.value.get();
  std::map<std::string_view, field::CloudBuilder> clouds;  // by kind, in an order of its own
  for (const io::Primitive& row : io::parse_primitives_csv(io::read_text(file), name)) {
    std::vector<Vec3d> vertices{row.position - origin};
    if (region && !region->contains(vertices[0])) continue;
    for (const Vec3d v : row.further) vertices.push_back(v - origin);
    try {
      const field::CloudSettings settings{row.kind->about.name,
                                          p.falloff > 0 ? p.falloff : below.settings.influence,
                                          {p.noise, p.wavelength, static_cast<int>(p.octaves), parts.seed}};
      field::CloudBuilder& cloud = clouds.try_emplace(row.kind->about.name, settings).first->second;
      if (row.kind->variable)
        field::add_curve(cloud, vertices, row.shape[0], row.energy);
      else
        cloud.add(vertices[0], row.energy, row.shape);
    } catch (const Error& error) {
      fail(ErrorKind::input, "{}:{}: {}", name, row.line, error.what());
    }
  }
  landforms::Result out;
  std::uint64_t beside = 0, all = 0;
  for (auto& [kind, cloud] : clouds) {
    all += cloud.size();
    out.nodes.push_back(cloud.finish());
    beside += field::primitives_outside(out.nodes.back(), impl::columns_of(below.terrain));
  }
  impl::warn_of_beside(below.terrain, name, "primitives", beside, all, readers.progress);
  return out;
}

}  // namespace

const LayerKind& declaration() {
  static const LayerKind kind{.types = {{
                                  .about = {.name = "primitives",
                                            .doc = "Explicit primitives from a file",
                                            .source = "[Paris19 §5.2]",
                                            .params = params()},
                                  .paths = {"file"},
                                  .needs = {{"file", "the path of a CSV"}},
                                  .make = make,
                              }}};
  return kind;
}

}  // namespace tafoni::scene::layer_primitives
