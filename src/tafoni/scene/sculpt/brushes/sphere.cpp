#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene {
namespace {

void apply(const Stroke& stroke, std::uint64_t, Dab& dab) {
  for (const Vec3d p : stroke.points) dab.sphere(p, stroke.radius);
}

}  // namespace

const BrushType& brush_sphere() {
  static const BrushType type = [] {
    BrushType t;
    t.about.name = "sphere";
    t.about.doc = "A rough ball of rock or air at each point";
    t.about.source = "[Paris19 §5.2, §8.2]";
    t.apply = &apply;
    return t;
  }();
  return type;
}

}  // namespace tafoni::scene
