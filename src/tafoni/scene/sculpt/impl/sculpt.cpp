// A brush turns a stroke into primitives; those of a group that lie on one level and are alike in kind, size
// and roughness share a cloud. The levels follow from which strokes overlap (sculpt.h).
#include "tafoni/scene/sculpt/impl/sculpt.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include "tafoni/core/error.h"
#include "tafoni/field/inner/outside.h"
#include "tafoni/field/primitive.h"
#include "tafoni/math/whole.h"
#include "tafoni/scene/sculpt/brush.h"

namespace tafoni::scene::impl {
namespace {

// In deep rock f = T. A primitive of energy 4 T has its surface where (1 - u^2)^3 = 1/4, a part `u` of its
// falloff from its body. Less energy would widen the flare where a hole meets the terrain's surface; more
// would make the field steeper than a lattice of a fifth of the radius can follow.
constexpr double energy_per_amplitude = 4;
const double surface_at = std::sqrt(1 - std::cbrt(1 / energy_per_amplitude));
// A narrow falloff keeps a stroke's surface where it was drawn; a narrower one, again, is too steep.
constexpr double falloff_per_radius = 0.4;
// Walls get dents a little wider than the stroke's radius, and in them finer ones down to an eighth of that.
constexpr double wavelength_per_radius = 1.3;
constexpr int octaves = 4;
// Boxes are wider by these than what they hold, for the rounding of primitives to float: a factor, and
// metres.
constexpr double box_factor = 1.001, box_margin = 0.01;

/// Primitives that share a cloud: of one kind, and of radii near enough for one falloff and one noise.
struct CloudClass {
  std::string kind;
  int size = 0;       ///< twice the binary logarithm of the radius, rounded
  int roughness = 0;  ///< hundredths of the radius
  auto operator<=>(const CloudClass&) const = default;

  double radius() const { return std::exp2(0.5 * size); }
  field::CloudSettings settings(std::uint64_t seed) const {
    field::CloudSettings out;
    out.kind = kind;
    out.falloff = falloff_per_radius * radius();
    out.noise = {0.01 * roughness * radius(), wavelength_per_radius * radius(), octaves, seed};
    return out;
  }
};

struct Item {
  Vec3d anchor;
  float energy = 0;
  std::vector<float> shape;
};

}  // namespace

struct CookedStroke {
  std::shared_ptr<const Stroke> stroke;  ///< keeps its address, a part of keys, its own
  std::map<CloudClass, std::vector<Item>> items;
  Box3d box;
  Box3d painted;           ///< of a stroke that paints: what it reaches
  bool far = false;        ///< some of it is farther off than a field reaches
  std::uint64_t more = 0;  ///< primitives beyond one for each of its points
  Digest digest;
};

namespace {

class Cooking : public Dab {
 public:
  Cooking(const Stroke& stroke, const SculptFrame& frame, CookedStroke& out)
      : stroke_(stroke), frame_(frame), out_(out) {}

  void add(std::string_view kind, Vec3d anchor, double radius, std::span<const float> extras) override {
    if (!(radius > 0) || !std::isfinite(radius)) fail(ErrorKind::usage, "a radius of {} m is none", radius);
    const field::PrimitiveType& type = field::find_primitive(kind);
    const landforms::Region* region = frame_.region.value.get();
    const double weight = region ? region->weight(anchor) : 1;
    if (!(weight > 0)) return;
    CloudClass key{std::string(kind), round_to(2 * std::log2(radius)), round_to(100 * stroke_.roughness)};
    const double falloff = falloff_per_radius * key.radius();
    const double body = type.volumetric ? radius - surface_at * falloff : radius / surface_at;
    const double energy = energy_per_amplitude * frame_.amplitude * stroke_.strength * weight;
    Item item{anchor, static_cast<float>(stroke_.adds() ? energy : -energy), {static_cast<float>(body)}};
    item.shape.insert(item.shape.end(), extras.begin(), extras.end());
    const double reach =
        type.extent(extras) + body + (type.volumetric ? falloff : 0) + 0.01 * key.roughness * key.radius();
    out_.box.expand(Box3d{anchor, anchor}.grown(box_factor * reach + box_margin));
    // No cloud takes it, and one stroke in the wrong place shall not stop every build.
    const double away = std::max({std::abs(anchor.x), std::abs(anchor.y), std::abs(anchor.z)});
    if (!(away + reach <= field::farthest)) {
      out_.far = true;
      return;
    }
    out_.items[std::move(key)].push_back(std::move(item));
  }

 private:
  const Stroke& stroke_;
  const SculptFrame& frame_;
  CookedStroke& out_;
};

/// The same for all strokes of a layer, and different where it stands: not where it comes in the list.
std::uint64_t seed_of(const Stroke& stroke, std::uint64_t layer) {
  std::uint64_t seed = hash_combine(layer, stroke.seed);
  for (const double v : {stroke.points[0].x, stroke.points[0].y, stroke.points[0].z})
    seed = hash_combine(seed, std::bit_cast<std::uint64_t>(v));
  return seed;
}

/// S after a run: what it carves stops at -L, what it adds at L.
field::NodePtr after_run(field::NodePtr sum, const SculptRun& run, double amplitude) {
  if (run.clouds.empty()) return sum;
  std::vector<field::NodePtr> children = {std::move(sum)};
  children.insert(children.end(), run.clouds.begin(), run.clouds.end());
  const auto limit = static_cast<float>(energy_per_amplitude * amplitude);
  const auto added = field::blend(std::move(children));
  return run.adds ? field::intersect({added, field::constant(limit)})
                  : field::unite({added, field::constant(-limit)});
}

std::vector<int> levels_of(std::span<const Slot> slots,
                           const std::vector<std::shared_ptr<const CookedStroke>>& cooked) {
  std::vector<int> levels;
  for (std::size_t i = 0; i < slots.size(); ++i) {
    const bool adds = slots[i].stroke->adds();
    int level = adds ? 1 : 0;
    for (std::size_t j = 0; j < i; ++j)
      if (cooked[i]->box.overlaps(cooked[j]->box))
        level = std::max(level, slots[j].stroke->adds() == adds ? levels[j] : levels[j] + 1);
    levels.push_back(level);
  }
  return levels;
}

/// Lines of a few words each make hundreds of thousands of primitives; those of points that were given one by
/// one are as many as their file is long, and not counted.
void check_layer_size(std::uint64_t more) {
  constexpr std::uint64_t most = 4'000'000;  // half a gigabyte
  if (more > most)
    fail(ErrorKind::usage,
         "the strokes of a layer make at most {} million primitives, and here they make more; give fewer "
         "strokes or a larger radius",
         most / 1'000'000);
}

void cook_runs(SculptGroup& group, std::uint64_t seed) {
  std::vector<std::map<CloudClass, field::CloudBuilder>> builders;
  for (std::size_t place = 0; place < group.cooked.size(); ++place) {
    const int level = group.levels[place];
    if (std::ssize(builders) <= level) builders.resize(level + 1);
    if (!group.cooked[place]) continue;
    for (const auto& [kind, items] : group.cooked[place]->items) {
      auto at = builders[level].find(kind);
      if (at == builders[level].end()) at = builders[level].emplace(kind, kind.settings(seed)).first;
      for (const Item& item : items) at->second.add(item.anchor, item.energy, item.shape);
    }
  }
  for (std::size_t level = 0; level < builders.size(); ++level) {
    SculptRun run{level % 2 == 1, {}};
    for (auto& [kind, builder] : builders[level]) run.clouds.push_back(builder.finish());
    group.runs.push_back(std::move(run));
  }
}

}  // namespace

std::shared_ptr<const CookedStroke> SculptCook::cook_stroke(const std::shared_ptr<const Stroke>& stroke,
                                                            const SculptFrame& frame, Nothing&) {
  auto cooked = std::make_shared<CookedStroke>();
  cooked->stroke = stroke;
  cooked->digest.add(std::string_view(to_text(*stroke)));
  const BrushType& brush = find_brush(stroke->brush);
  Stroke local = *stroke;
  for (Vec3d& p : local.points) p -= frame.origin;
  if (!brush.apply)
    for (const Vec3d p : local.points) cooked->painted.expand(Box3d{p, p}.grown(stroke->radius));
  if (brush.apply) {
    Cooking dab(*stroke, frame, *cooked);
    brush.apply(local, seed_of(*stroke, frame.seed), dab);
    for (const auto& [kind, items] : cooked->items) cooked->more += items.size();
    cooked->more -= std::min<std::uint64_t>(cooked->more, stroke->points.size());
  }
  return cooked;
}

std::shared_ptr<const SculptGroup> SculptCook::cook_group(const std::vector<Slot>& slots,
                                                          const SculptFrame& frame, Strokes& strokes) {
  auto group = std::make_shared<SculptGroup>();
  group->slots = slots;
  group->digest = impl::digest_of(frame);
  std::vector<CookedPtr> all;
  Nothing nothing;
  for (const Slot& slot : slots) {
    try {
      all.push_back(strokes(slot.stroke, frame, nothing).value);
    } catch (const Error& error) {
      fail(error.kind(), "the stroke \"{}\": {}", shown_stroke(*slot.stroke), error.what());
    }
    group->more += all.back()->more;
    check_layer_size(group->more);
    group->cooked.push_back(slot.muted ? nullptr : all.back());
    group->digest.add(std::uint64_t{slot.muted}).add(all.back()->digest);
  }
  group->levels = levels_of(slots, all);
  cook_runs(*group, frame.seed);
  return group;
}

Keyed<std::shared_ptr<const Sculpted>> SculptCook::cook(std::span<const Slot> slots,
                                                        const SculptFrame& frame) {
  Digest digest = impl::digest_of(frame);
  auto out = std::make_shared<Sculpted>();
  std::uint64_t more = 0;
  for (std::size_t first = 0; first < slots.size(); first += group_size) {
    const auto some = slots.subspan(first, std::min(group_size, slots.size() - first));
    out->groups.push_back(groups_({some.begin(), some.end()}, frame, strokes_).value);
    more += out->groups.back()->more;
    check_layer_size(more);
    digest.add(out->groups.back()->digest);
    for (const SculptRun& run : out->groups.back()->runs)
      out->node = after_run(out->node, run, frame.amplitude);
  }
  return {out, digest};
}

Box3d box_of(const Sculpted& sculpted) {
  Box3d out;
  for (const auto& group : sculpted.groups)
    for (const auto& cooked : group->cooked)
      if (cooked) out.expand(cooked->box);
  return out;
}

IdleStrokes strokes_beside(const Sculpted& sculpted, const std::function<bool(const Box3d&)>& over) {
  IdleStrokes out;
  for (const auto& group : sculpted.groups)
    for (const auto& cooked : group->cooked) {
      if (!cooked) continue;
      ++out.all;
      Box3d box = cooked->box;
      box.expand(cooked->painted);
      // What a region leaves nothing of is as the user wants it.
      if (box.empty() || (!cooked->far && over(box))) continue;
      if (out.count++ == 0) out.first = cooked->stroke;
    }
  return out;
}

namespace {

/// Calls each(stroke, whether it adds) of the strokes that make primitives.
template <class Each>
void each_shape(const Sculpted& sculpted, const Each& each) {
  for (const auto& group : sculpted.groups)
    for (std::size_t place = 0; place < group->cooked.size(); ++place)
      if (const auto& cooked = group->cooked[place]; cooked && !cooked->box.empty())
        each(*cooked, group->levels[place] % 2 != 0);
}

}  // namespace

IdleStrokes strokes_in_air(const Sculpted& sculpted, const std::function<bool(const Box3d&)>& rock) {
  IdleStrokes out;
  std::vector<Box3d> added;
  each_shape(sculpted, [&](const CookedStroke& stroke, bool adds) {
    if (adds) added.push_back(stroke.box);
  });
  each_shape(sculpted, [&](const CookedStroke& stroke, bool adds) {
    if (adds) return;
    ++out.all;
    if (rock(stroke.box) ||
        std::any_of(added.begin(), added.end(), [&](const Box3d& box) { return box.overlaps(stroke.box); }))
      return;
    if (out.count++ == 0) out.first = stroke.stroke;
  });
  return out;
}

namespace {

void changed_boxes(const SculptGroup* before, const SculptGroup* now, std::vector<Box3d>& out) {
  struct Place {
    const CookedStroke* stroke = nullptr;
    int level = 0;
    bool operator==(const Place&) const = default;
  };
  const auto at = [](const SculptGroup* group, std::size_t place) -> Place {
    if (!group || place >= group->cooked.size() || !group->cooked[place]) return {};
    return {group->cooked[place].get(), group->levels[place]};
  };
  const std::size_t places = std::max(before ? before->cooked.size() : 0, now ? now->cooked.size() : 0);
  for (std::size_t place = 0; place < places; ++place) {
    const Place a = at(before, place), b = at(now, place);
    if (a == b) continue;
    for (const CookedStroke* stroke : {a.stroke, b.stroke})
      if (stroke && !stroke->box.empty()) out.push_back(stroke->box);
  }
}

}  // namespace

void changed_boxes(const Sculpted* before, const Sculpted* now, std::vector<Box3d>& out) {
  const std::size_t groups = std::max(before ? before->groups.size() : 0, now ? now->groups.size() : 0);
  for (std::size_t g = 0; g < groups; ++g) {
    const SculptGroup* a = before && g < before->groups.size() ? before->groups[g].get() : nullptr;
    const SculptGroup* b = now && g < now->groups.size() ? now->groups[g].get() : nullptr;
    if (a != b) changed_boxes(a, b, out);
  }
}

}  // namespace tafoni::scene::impl
