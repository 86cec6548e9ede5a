#pragma once
// The domains that faults and contacts cut rock along.

#include <memory>
#include <span>
#include <string>
#include <vector>

#include "tafoni/core/params.h"
#include "tafoni/geology/geology.h"

namespace tafoni::geology::impl {

/// World positions, metres and degrees.
struct DomainParams {
  std::string domain = "plane";
  std::vector<double> position = {0, 0, 0};
  double dip = 70;
  double azimuth = 90;
  double radius = 40;
  std::vector<double> size = {80, 80, 80};
  std::vector<double> polygon;
  double bottom = -20000;
  double top = 20000;
};

/// Adds the parameters of a domain to the table of a struct that derives from DomainParams.
template <class P>
void declare_domain(ParamTable<P>& table) {
  const Values polygon{{"domain", std::string("polygon")},
                       {"polygon", std::vector<double>{-100, -100, 100, -100, 0, 100}}};
  table
      .choice("domain", &P::domain, {"plane", "box", "sphere", "polygon", "field"},
              "What bounds the domain; a field is where the last child is above 0.5")
      .numbers("position", &P::position, "m", 3, -1e8, 1e8,
               "World position on the plane, or of the middle of the box or sphere")
      .only("where domain is plane, box or sphere")
      .real("dip", &P::dip, "deg", 0, 90,
            "Steepest descent of the plane, 0 for a level one; the domain lies above it")
      .only("where domain is plane")
      .real("azimuth", &P::azimuth, "deg", -360, 360,
            "Direction in which the plane descends, or of the box's north side, clockwise from north")
      .only("where domain is plane or box")
      .real("radius", &P::radius, "m", 0.01, 1e6, "Radius of the sphere")
      .only("where domain is sphere", {{"domain", std::string("sphere")}})
      .numbers("size", &P::size, "m", 3, 0.01, 1e6, "Width, length and height of the box")
      .only("where domain is box", {{"domain", std::string("box")}})
      .numbers("polygon", &P::polygon, "m", 0, -1e8, 1e8, "World x, y of each corner of the polygon in turn")
      .only("where domain is polygon", polygon)
      .real("bottom", &P::bottom, "m", -20000, 20000, "Lowest world elevation of the prism over the polygon")
      .only("where domain is polygon", polygon)
      .real("top", &P::top, "m", -20000, 20000, "Highest world elevation of the prism over the polygon")
      .only("where domain is polygon", polygon);
}

/// An open set of world positions.
class Domain {
 public:
  virtual ~Domain() = default;
  /// inside[i] is 1 strictly inside the domain, else 0.
  virtual void contains(std::span<const Vec3d> world, std::span<unsigned char> inside) const = 0;
};

/// Takes the last of `children` where the domain is a field; `keep` children must stay. Throws Error{usage}
/// that begins with `where`.
std::unique_ptr<const Domain> make_domain(const DomainParams& params, std::vector<GeologyPtr>& children,
                                          std::size_t keep, std::string_view where);

}  // namespace tafoni::geology::impl
