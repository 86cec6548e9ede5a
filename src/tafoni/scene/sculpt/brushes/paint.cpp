#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_paint {
namespace {

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Painting>()
          .text("mask", &Painting::mask, "Name of the mask, which layers take as mask = \"paint:NAME\"")
          .real("hardness", &Painting::hardness, "", 0, 1,
                "Part of the radius that gets the full weight: 1 paints a hard edge, 0 fades from the middle "
                "on")
          .boolean("erase", &Painting::erase, "Takes weight away in place of adding some");
  return infos;
}

Painting paint(const Stroke& stroke) {
  Painting out;
  assign(params(), &out, stroke.values, "paint");
  return out;
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about = {.name = "paint",
                .doc = "Weight along a line, in a mask that layers take as mask = \"paint:NAME\"",
                .source = "[Paris19 §8.2]",
                .params = params()},
      .max_points = 10000,
      .paint = paint,
  };
  return type;
}

}  // namespace tafoni::scene::brush_paint
