#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

const std::vector<ParamInfo>& params() {
  static const std::vector<ParamInfo> infos =
      ParamTable<Painting>()
          .text("mask", &Painting::mask, "Name of the mask")
          .real("hardness", &Painting::hardness, "", 0, 1, "Part of the radius that gets the full weight")
          .boolean("erase", &Painting::erase, "Takes weight away");
  return infos;
}

Painting paint(const Stroke& stroke) {
  Painting out;
  assign(params(), &out, stroke.values, "paint");
  return out;
}

}  // namespace

const BrushType& brush_paint() {
  static const BrushType type = [] {
    BrushType t;
    t.about.name = "paint";
    t.about.doc = "Weight along a line, in a mask that layers take as mask = \"paint:NAME\"";
    t.about.source = "[Paris19 §8.2]";
    t.about.params = params();
    t.max_points = 10000;
    t.paint = &paint;
    return t;
  }();
  return type;
}

}  // namespace tafoni::scene
