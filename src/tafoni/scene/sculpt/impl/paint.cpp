// Each stroke lays its weight along its line, the full strength within the hard part of its radius and less
// towards the rim. Weights pile up as layers of paint do: what shows of the ground goes down by the weight of
// each, and an erasing stroke takes its share of what is there.
#include "tafoni/scene/sculpt/impl/paint.h"

#include <algorithm>
#include <cmath>

#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::impl {
namespace {

double distance_to_segment(Vec2d p, Vec3d a, Vec3d b) {
  const Vec2d d{b.x - a.x, b.y - a.y}, v{p.x - a.x, p.y - a.y};
  const double l2 = d.x * d.x + d.y * d.y;
  const double t = l2 > 0 ? std::clamp((v.x * d.x + v.y * d.y) / l2, 0.0, 1.0) : 0;
  return std::hypot(v.x - t * d.x, v.y - t * d.y);
}

/// A stroke's line in the frame of the mask, and the box that it can reach.
struct Line {
  std::vector<Vec3d> points;
  Box3d box;

  Line(const Stroke& stroke, Vec3d origin) {
    for (const Vec3d p : stroke.points) {
      points.push_back(p - origin);
      box.expand(points.back());
    }
    if (points.size() == 1) points.push_back(points.front());
    box = box.grown(stroke.radius);
  }
  double distance(Vec2d at, double most) const {
    for (std::size_t i = 0; i + 1 < points.size(); ++i)
      most = std::min(most, distance_to_segment(at, points[i], points[i + 1]));
    return most;
  }
};

float weight_at(double distance, const Stroke& stroke, const Painting& how) {
  const double soft = (1 - how.hardness) * stroke.radius;
  const double t =
      soft > 0 ? std::clamp((stroke.radius - distance) / soft, 0.0, 1.0) : (distance < stroke.radius ? 1 : 0);
  return static_cast<float>(std::min(stroke.strength, 1.0) * t * t * (3 - 2 * t));
}

void lay(const Stroke& stroke, const Painting& how, Vec3d origin, raster::Raster& mask) {
  const Line line(stroke, origin);
  const Vec2d nw = mask.placement.pixel(line.box.lo.x, line.box.hi.y),
              se = mask.placement.pixel(line.box.hi.x, line.box.lo.y);
  const auto within = [](double v, int n) { return static_cast<int>(std::clamp<double>(v, 0, n)); };
  const int rows = within(std::floor(se.y) + 1, mask.height()),
            columns = within(std::floor(se.x) + 1, mask.width());
  for (int row = within(std::ceil(nw.y), mask.height()); row < rows; ++row)
    for (int col = within(std::ceil(nw.x), mask.width()); col < columns; ++col) {
      const double distance = line.distance(mask.placement.center(col, row), stroke.radius);
      const float weight = weight_at(distance, stroke, how);
      float& value = mask.values.at(col, row);
      value = how.erase ? value * (1 - weight) : value + (1 - value) * weight;
    }
}

}  // namespace

void add_part(Digest& to, const PaintStrokes& paint) {
  for (const auto& stroke : paint.strokes) to.add(std::string_view(to_text(*stroke)));
}

std::vector<std::string> painted_masks(std::span<const Slot> slots) {
  std::vector<std::string> out;
  for (const Slot& slot : slots) {
    const BrushType& brush = find_brush(slot.stroke->brush);
    if (!slot.muted && brush.paint) out.push_back(brush.paint(*slot.stroke).mask);
  }
  return out;
}

PaintStrokes paint_strokes(std::span<const Slot> slots, std::string_view name) {
  PaintStrokes out;
  for (const Slot& slot : slots) {
    const BrushType& brush = find_brush(slot.stroke->brush);
    if (!slot.muted && brush.paint && brush.paint(*slot.stroke).mask == name)
      out.strokes.push_back(slot.stroke);
  }
  return out;
}

raster::Raster paint_mask(const PaintStrokes& paint, const raster::Raster& like, Vec3d origin) {
  raster::Raster out;
  out.placement = like.placement;
  out.values = raster::Grid<float>(like.width(), like.height(), 0.f);
  for (const auto& stroke : paint.strokes)
    lay(*stroke, find_brush(stroke->brush).paint(*stroke), origin, out);
  return out;
}

}  // namespace tafoni::scene::impl
