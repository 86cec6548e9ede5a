#include "tafoni/field/impl/pose.h"

#include "tafoni/core/error.h"

namespace tafoni::field::impl {

void check(const Placement& p) {
  if (!std::isfinite(p.position.x + p.position.y + p.position.z + p.turn + p.tilt + p.scale))
    fail(ErrorKind::usage, "a placement has a number that is not finite");
  if (!(p.scale > 0)) fail(ErrorKind::usage, "a placement's scale is {}; it must be positive", p.scale);
}

std::vector<ParamInfo> placement_params() {
  struct Params {
    double x = 0, y = 0, z = 0, turn = 0, tilt = 0, scale = 1;
  };
  return ParamTable<Params>()
      .real("x", &Params::x, "m", -131000, 131000, "Where the tree's own origin comes to stand, east")
      .real("y", &Params::y, "m", -131000, 131000, "Where the tree's own origin comes to stand, north")
      .real("z", &Params::z, "m", -131000, 131000, "Where the tree's own origin comes to stand, up")
      .real("turn", &Params::turn, "rad", -7, 7, "About z, counter-clockwise from above, after the tilt")
      .real("tilt", &Params::tilt, "rad", -7, 7, "About y")
      .real("scale", &Params::scale, "", 1e-3, 1e3, "Factor of lengths and field values");
}

}  // namespace tafoni::field::impl
