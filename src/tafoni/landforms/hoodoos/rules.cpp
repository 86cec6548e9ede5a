// Two growths, written as a user would: a Hoodoo is a foot of debris, a trunk of one fluted cylinder a bed,
// as wide as the bed is hard, and a cap; a Goblin is a stem with a head of ellipsoids. All numbers are chosen
// by eye, after photographs; sizes are multiples of s, the radius at the foot.

#include "tafoni/landforms/hoodoos/rules.h"

namespace tafoni::landforms::impl {

Rows default_rules() {
  return {
      // a is the phase of the flutes, b their number, c how much the trunk narrows toward the top.
      {{"symbol", "Hoodoo"},
       {"make", "Foot(); Trunk(a = random(0, 360), b = floor(random(3, 6)), c = random(0.45, 0.75))"}},
      {{"symbol", "Foot"},
       {"make",
        "cone(z = -s, dz = 1.7*s, base = 2*s, tip = 0.6*s, x = random(-0.3, 0.3)*s); "
        "cone(repeat = 3, turn = random(0, 360), x = 0.9*s, z = -s, dz = random(1.1, 1.6)*s, base = 1.3*s, "
        "tip = 0.3*s)"}},
      {{"symbol", "Trunk"},
       {"weight", "h < height && !(h > 0.7*height && rho > 0.6)"},
       {"make",
        "Bed(s = s*(1.3 - c*h/height)*(0.28 + 0.8*rho)); "
        "Trunk(z = bed, x = random(-0.06, 0.06)*s, y = random(-0.06, 0.06)*s)"}},
      {{"symbol", "Trunk"},
       {"weight", "h >= height || (h > 0.7*height && rho > 0.6)"},
       {"make", "Cap(s = s*(1.3 - c))"}},
      {{"symbol", "Bed"},
       {"make",
        "cylinder(base = max(0.66*s, 0.32*radius) - skin, dz = bed, radius = 0.15); "
        "cylinder(repeat = b, turn = 360*i/n, x = 0.58*s, z = 0.2*bed, dz = 0.6*bed, radius = 0.15,"
        " base = s*(0.4 + 0.12*sin(a + 97*i)) - skin)"}},
      {{"symbol", "Cap"},
       {"weight", "rho"},
       {"make",
        "cylinder(base = 0.5*s, dz = bed); "
        "box(repeat = 2, z = 0.6*bed, hx = s*random(0.6, 0.9), hy = s*random(0.5, 0.7), hz = 0.3*bed, turn = "
        "random(0, 180))"}},
      {{"symbol", "Cap"},
       {"weight", "1 - rho"},
       {"make",
        "cylinder(base = 0.4*s, dz = bed); ellipsoid(z = bed, hx = 0.6*s, hy = 0.5*s, hz = 0.6*bed, turn = "
        "random(0, 180))"}},
      // A goblin is squat and has a broad head.
      {{"symbol", "Goblin"},
       {"make", "cone(z = -s, dz = 1.3*s, base = 1.5*s, tip = 0.6*s); Stem(a = random(0, 360))"}},
      {{"symbol", "Stem"},
       {"weight", "h < 0.5*height"},
       {"make",
        "cylinder(base = 0.4*s - skin, dz = bed, radius = 0.15); "
        "ellipsoid(z = 0.5*bed, hx = s*(0.35 + 0.5*rho), hy = s*(0.3 + 0.45*rho), hz = 0.5*bed, radius = "
        "0.15, turn = a); "
        "Stem(z = bed, x = random(-0.1, 0.1)*s)"}},
      {{"symbol", "Stem"}, {"weight", "h >= 0.5*height"}, {"make", "Head(z = 0.2*s)"}},
      {{"symbol", "Head"},
       {"weight", "rho"},
       {"make",
        "cylinder(z = -0.3*s, base = 0.4*s - skin, dz = 0.6*s); "
        "ellipsoid(z = 0.15*s, hx = s*random(0.9, 1.2), hy = s*random(0.7, 0.9), hz = 0.4*s, turn = a); "
        "ellipsoid(repeat = 2, turn = a + 180*i + random(-40, 40), x = 0.5*s, z = random(0, 0.4)*s, hx = "
        "0.6*s,"
        " hy = 0.6*s, hz = 0.3*s)"}},
      {{"symbol", "Head"},
       {"weight", "1 - rho"},
       {"make",
        "ellipsoid(hx = s*random(0.75, 0.95), hy = s*random(0.6, 0.8), hz = 0.45*s, turn = a); "
        "cylinder(base = 0.35*s - skin, dz = 0.7*s); "
        "ellipsoid(z = 0.75*s, x = random(-0.15, 0.15)*s, hx = s*random(0.5, 0.7), hy = 0.5*s, hz = 0.35*s, "
        "turn = random(0, 180))"}},
  };
}

}  // namespace tafoni::landforms::impl
