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
  table
      .choice("domain", &P::domain, {"plane", "box", "sphere", "polygon", "field"},
              "what bounds the domain; field: where the last child is above 0.5")
      .numbers("position", &P::position, "m", 3, -1e8, 1e8,
               "a world position on the plane, or the middle of the box or sphere")
      .real("dip", &P::dip, "deg", 0, 90, "steepest descent of the plane; the domain lies above it")
      .real("azimuth", &P::azimuth, "deg", -360, 360,
            "direction in which the plane descends, or of the box's north side, clockwise from north")
      .real("radius", &P::radius, "m", 0.01, 1e6, "of the sphere")
      .numbers("size", &P::size, "m", 3, 0.01, 1e6, "width, length and height of the box")
      .numbers("polygon", &P::polygon, "m", 0, -1e8, 1e8, "world x, y of each corner of the polygon in turn")
      .real("bottom", &P::bottom, "m", -20000, 20000, "lowest world elevation of the polygon's prism")
      .real("top", &P::top, "m", -20000, 20000, "highest world elevation of the polygon's prism");
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
