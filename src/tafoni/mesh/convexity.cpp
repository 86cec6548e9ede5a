#include "tafoni/mesh/convexity.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace tafoni::mesh {
namespace {

struct Half {
  std::uint64_t edge;  ///< lower vertex, then higher
  std::uint32_t triangle;
  bool forward;
};

}  // namespace

double Convexity::factor() const {
  const std::uint64_t bent = convex + concave;
  return bent == 0 ? 100 : 100 * static_cast<double>(convex) / static_cast<double>(bent);
}

Convexity convexity(const Mesh& mesh, double flat) {
  std::vector<Half> halves;
  halves.reserve(3 * mesh.triangles.size());
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto& v = mesh.triangles[t];
    if (std::max({v[0], v[1], v[2]}) >= mesh.positions.size()) continue;
    for (std::size_t c = 0; c < 3; ++c) {
      const std::uint64_t a = v[c], b = v[(c + 1) % 3];
      if (a != b) halves.push_back({std::min(a, b) << 32 | std::max(a, b), t, a < b});
    }
  }
  std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) { return a.edge < b.edge; });

  const auto position = [&](std::uint32_t v) { return to_double(mesh.positions[v]); };
  const auto normal = [&](std::uint32_t t) {
    const auto& v = mesh.triangles[t];
    const Vec3d a = position(v[0]);
    return normalized(cross(position(v[1]) - a, position(v[2]) - a));
  };
  Convexity out;
  for (std::size_t i = 0, end; i < halves.size(); i = end) {
    end = i + 1;
    while (end < halves.size() && halves[end].edge == halves[i].edge) ++end;
    if (end - i != 2 || halves[i].forward == halves[i + 1].forward) continue;
    const Half& along = halves[i].forward ? halves[i] : halves[i + 1];
    const Half& against = halves[i].forward ? halves[i + 1] : halves[i];
    const Vec3d n = normal(along.triangle), m = normal(against.triangle);
    const Vec3d edge = normalized(position(static_cast<std::uint32_t>(along.edge & 0xffffffff)) -
                                  position(static_cast<std::uint32_t>(along.edge >> 32)));
    const double bend = std::atan2(dot(cross(n, m), edge), dot(n, m));
    ++(std::abs(bend) <= flat ? out.flat : bend > 0 ? out.convex : out.concave);
  }
  return out;
}

}  // namespace tafoni::mesh
