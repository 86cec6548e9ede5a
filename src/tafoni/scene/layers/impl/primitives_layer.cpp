#include "tafoni/scene/layers/impl/primitives_layer.h"

#include <map>

#include "tafoni/core/error.h"
#include "tafoni/io/csv.h"

namespace tafoni::scene::impl {

const std::vector<ParamInfo>& primitives_params() {
  using S = PrimitivesSettings;
  static const std::vector<ParamInfo> params =
      ParamTable<S>()
          .text("file", &S::file,
                "Path of a CSV with the columns kind, x, y, z, energy and those of the kinds")
          .real("falloff", &S::falloff, "m", 0, 1e4,
                "How far the field of a body reaches beyond it; 0 for the terrain's influence")
          .real("noise", &S::noise, "m", 0, 1e3, "Noise on the radii; must be below the least radius")
          .real("wavelength", &S::wavelength, "m", 1e-2, 1e4, "Wavelength of the noise")
          .integer("octaves", &S::octaves, "", 1, 12, "Octaves of the noise");
  return params;
}

std::vector<field::NodePtr> make_primitives(std::string_view text, std::string_view name,
                                            const PrimitivesSettings& settings, Vec3d origin,
                                            double influence, std::uint64_t seed,
                                            const std::function<bool(Vec3d)>& keep) {
  std::map<std::string_view, field::CloudBuilder> clouds;  // by kind, in an order of its own
  for (const io::Primitive& p : io::parse_primitives_csv(text, name)) {
    std::vector<Vec3d> vertices{p.position - origin};
    if (keep && !keep(vertices[0])) continue;
    for (Vec3d v : p.further) vertices.push_back(v - origin);
    try {
      const field::CloudSettings cloud{
          p.kind->about.name,
          settings.falloff > 0 ? settings.falloff : influence,
          {settings.noise, settings.wavelength, static_cast<int>(settings.octaves), seed}};
      const auto at = clouds.try_emplace(p.kind->about.name, cloud).first;
      if (p.kind->variable)
        field::add_curve(at->second, vertices, static_cast<double>(p.shape[0]),
                         static_cast<double>(p.energy));
      else
        at->second.add(vertices[0], p.energy, p.shape);
    } catch (const Error& error) {
      fail(ErrorKind::input, "{}:{}: {}", name, p.line, error.what());
    }
  }
  std::vector<field::NodePtr> nodes;
  for (auto& [kind, cloud] : clouds) nodes.push_back(cloud.finish());
  return nodes;
}

}  // namespace tafoni::scene::impl
