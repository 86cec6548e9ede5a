// The passage is a cone and a niche that weather widened; the grammar goes on at its inner end. A shape is
// accepted where a sample of its box shows rock enough around it. Longer passages are tried until most
// productions find room.

#include "tafoni/landforms/grammar-cave/cave_body.h"

#include <algorithm>
#include <cmath>

#include "tafoni/math/whole.h"

namespace tafoni::landforms::impl {
namespace {

using grammar::Assembly;
using grammar::Pose;

// Chosen by eye.
constexpr double passage_lengths[] = {5, 8, 12, 17, 24, 34};  // metres; tried in turn
constexpr double enough = 0.8;      // share of the productions wanted, with which a passage is long enough
constexpr double before_mouth = 1;  // metres that the passage begins in the open
constexpr double niche_width = 1.3, niche_height = 0.6;  // of the mouth's width; of the lift
constexpr double margin = 1;  // metres that a shape keeps to where the layer may not act

/// Whether a shape has room: within the rock, `roof` metres below the ground, where the layer may act, and
/// level with the mouth but for `climb` metres.
class Room {
 public:
  Room(const Ground& ground, const Pose& frame, double roof, double climb)
      : ground_(ground),
        rock_(field::compile(ground.site().terrain)),
        frame_(frame),
        roof_(roof),
        climb_(climb) {}

  bool operator()(const Box3d& box) const {
    if (std::abs(box.center().z) > climb_) return false;
    const Vec3d size = box.size();
    std::vector<Vec3d> points;
    const auto layer = [&](double z, int i_most, int j_most) {
      for (int i = 0; i <= i_most; ++i)
        for (int j = 0; j <= j_most; ++j)
          points.push_back(
              frame_.placed(Vec3d{box.lo.x + size.x * i / i_most, box.lo.y + size.y * j / j_most, z}));
    };
    const auto metres = [](double way) { return std::clamp(ceil_to(way), 1, 64); };
    layer(box.hi.z + roof_, metres(size.x), metres(size.y));
    layer(box.center().z, 4, 4);
    layer(box.lo.z, 4, 4);
    if (!std::all_of(points.begin(), points.end(), [&](Vec3d p) { return ground_.usable(p, margin); }))
      return false;
    std::vector<float> values(points.size());
    rock_.values(points, values);
    return std::all_of(values.begin(), values.end(), [](float v) { return v > 0; });
  }

 private:
  const Ground& ground_;
  field::CompiledField rock_;
  Pose frame_;
  double roof_, climb_;
};

/// A cone that opens outward, on which the grammar goes on at its inner end.
Assembly begin_passage(double length, double radius, double lift) {
  const double wide = flare * radius;
  const auto& cone = grammar::find_solid("cone");
  grammar::Shape shape =
      shape_of(cone.make({{"base", wide}, {"tip", radius}, {"height", length + before_mouth}}));
  Pose pose = grammar::turn({0, 0, 1}, {1, 0, 0});
  pose.at = {(length - before_mouth) / 2, 0, lift};
  std::erase_if(shape.bonds, [](const grammar::Bond& bond) { return bond.direction.z < 0.99; });
  shape.form = placed(shape.form, pose);
  shape.bounds = pose.placed(shape.bounds);
  for (grammar::Bond& bond : shape.bonds) bond = pose.placed(bond);
  // Weather has widened it into a niche.
  const auto& ellipsoid = grammar::find_solid("ellipsoid");
  const grammar::Shape niche =
      shape_of(ellipsoid.make(ellipsoid.fit({0.5 * length, niche_width * wide, wide})));
  Pose at;
  at.at = {0.5 * length - before_mouth, 0, niche_height * lift};
  shape.form = grammar::combined(grammar::Operation::sum, shape.form, placed(niche.form, at));
  shape.bounds.expand(at.placed(niche.bounds));
  shape.elements += niche.elements;
  Assembly base;
  base.begin(shape);
  return base;
}

}  // namespace

void derive(Assembly& base, const BodySettings& settings, const Assembly::Accept& accept,
            Progress& progress) {
  if (settings.rule.empty())
    derive_at_random(base, settings, accept, progress);
  else
    derive_by_rules(base, settings.rule, settings, accept, progress);
}

CaveBody dig_body(const Ground& ground, const Pose& frame, double lift, const BodySettings& settings,
                  Progress& progress) {
  const Room room(ground, frame, settings.roof, lift + settings.storeys * settings.size);
  const auto count = [](const Assembly& a) { return a.classic() + a.morphic(); };
  CaveBody best;
  for (const double length : passage_lengths) {
    Assembly shape = begin_passage(length, settings.passage, lift);
    derive(shape, settings, room, progress);
    if (count(shape) > count(best.shape)) best = {std::move(shape), length};
    if (count(best.shape) > enough * static_cast<double>(settings.classic + settings.morphic)) break;
  }
  return best;
}

}  // namespace tafoni::landforms::impl
