#include "tafoni/landforms/hive/hive_area.h"

#include <algorithm>

namespace tafoni::landforms::impl {
namespace {

/// Chosen by eye.
namespace hive_area_look {
// Squares tried along each side of the terrain, and how many heights to each side of a square's middle tell
// its relief.
constexpr int places = 16, within = 8;
}  // namespace hive_area_look

}  // namespace

Box3d find_hive_area(const Ground& ground, double size, double depth) {
  const Site& site = ground.site();
  Box3d area = ground.box();
  area.lo.z += site.influence - (depth > 0 ? depth : site.influence - 1);
  const double half = 0.5 * size;
  const auto fit = [&](double v, double lo, double hi) {
    return hi - lo > 2 * half ? std::clamp(v, lo + half, hi - half) : 0.5 * (lo + hi);
  };
  Vec3d middle = area.center();
  if (!site.points.empty()) {
    middle = site.points.front();
  } else {
    double best = -1;
    constexpr int places = hive_area_look::places, within = hive_area_look::within;
    for (int j = 0; j < places; ++j)
      for (int i = 0; i < places; ++i) {
        const double x = fit(area.lo.x + (i + 0.5) / places * (area.hi.x - area.lo.x), area.lo.x, area.hi.x),
                     y = fit(area.lo.y + (j + 0.5) / places * (area.hi.y - area.lo.y), area.lo.y, area.hi.y);
        double low = 1e30, high = -1e30;
        int outside = 0;
        for (int v = -within; v <= within; ++v)
          for (int u = -within; u <= within; ++u) {
            const double px = x + u * half / within, py = y + v * half / within;
            if (!ground.usable({px, py, area.center().z})) {
              ++outside;
              continue;
            }
            const double h = ground.height(px, py);
            low = std::min(low, h), high = std::max(high, h);
          }
        // Ground that may not be dug is of no use.
        const double relief =
            (high - low) * (1 - double{1} * outside / ((2 * within + 1) * (2 * within + 1)));
        if (relief > best) best = relief, middle.x = x, middle.y = y;
      }
  }
  const double x = fit(middle.x, area.lo.x, area.hi.x), y = fit(middle.y, area.lo.y, area.hi.y);
  area.lo.x = std::max(area.lo.x, x - half), area.hi.x = std::min(area.hi.x, x + half);
  area.lo.y = std::max(area.lo.y, y - half), area.hi.y = std::min(area.hi.y, y + half);
  return area;
}

}  // namespace tafoni::landforms::impl
