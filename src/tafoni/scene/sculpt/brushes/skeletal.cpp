// The stroke's points become anchors of one primitive each, or the vertices of one chain where the kind takes
// a chain; the kind's own sizes are parameters of the brush.
#include <algorithm>

#include "tafoni/core/error.h"
#include "tafoni/field/primitive.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_skeletal {
namespace {

struct Params {
  std::string kind = "sphere";
};

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos = ParamTable<Params>().text(
      "kind", &Params::kind,
      "Name of a primitive, whose own sizes are then parameters of the stroke; see tafoni list primitives");
  return infos;
}

const field::PrimitiveType& kind_of(const Values& values) {
  Params p;
  if (const auto found = values.find("kind"); found != values.end())
    p.kind = std::get<std::string>(found->second);
  return field::find_primitive(p.kind);
}

/// The kind's own shape, without the radius, which every stroke has.
std::vector<ParamInfo> more(const Values& values) {
  const field::PrimitiveType& kind = kind_of(values);
  if (kind.about.params.empty()) return {};
  return {kind.about.params.begin() + 1, kind.about.params.end()};
}

void apply(const Stroke& stroke, std::uint64_t, Dab& dab) {
  const field::PrimitiveType& kind = kind_of(stroke.values);
  if (kind.variable) {
    // A chain of vertices: the first point and the way to the others.
    std::vector<float> extras;
    for (std::size_t i = 1; i < stroke.points.size(); ++i) {
      const Vec3f d = to_float(stroke.points[i] - stroke.points[0]);
      extras.insert(extras.end(), {d.x, d.y, d.z});
    }
    if (extras.empty())
      fail(ErrorKind::usage, "skeletal: the primitive {} wants at least two points", kind.about.name);
    dab.add(kind.about.name, stroke.points[0], stroke.radius, extras);
    return;
  }
  std::vector<float> extras;
  for (const ParamInfo& info : more(stroke.values)) {
    const auto found = stroke.values.find(info.name);
    const Value& value = found == stroke.values.end() ? info.init : found->second;
    extras.push_back(static_cast<float>(std::get<double>(value)));
  }
  for (const Vec3d p : stroke.points) dab.add(kind.about.name, p, stroke.radius, extras);
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about =
          {.name = "skeletal",
           .doc =
               "One primitive of any registered kind at each point; a chain through the points for a curve",
           .source = "[Paris19 §5.2, §8.2]",
           .params = params()},
      .apply = apply,
      .more = more,
  };
  return type;
}

}  // namespace tafoni::scene::brush_skeletal
