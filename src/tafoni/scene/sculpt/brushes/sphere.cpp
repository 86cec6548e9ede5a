#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::brush_sphere {
namespace {

void apply(const Stroke& stroke, std::uint64_t, Dab& dab) {
  for (const Vec3d p : stroke.points) dab.sphere(p, stroke.radius);
}

}  // namespace

const BrushType& declaration() {
  static const BrushType type{
      .about = {.name = "sphere",
                .doc = "A rough ball of rock or air at each point",
                .source = "[Paris19 §5.2, §8.2]"},
      .apply = apply,
  };
  return type;
}

}  // namespace tafoni::scene::brush_sphere
