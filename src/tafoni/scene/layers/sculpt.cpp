// The layer of strokes. It keeps every stroke and group that it cooked (sculpt/impl/sculpt.h), so that one
// stroke more, less or muted makes a small part of it again and changes the field in a small box.
#include "tafoni/scene/sculpt/impl/sculpt.h"

#include <memory>
#include <optional>

#include <fmt/core.h>

#include "tafoni/field/compiled.h"
#include "tafoni/scene/build/impl/outside.h"
#include "tafoni/scene/layers/impl/site.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene::layer_sculpt {
namespace {

using impl::Keyed;

struct Params : impl::StrokeFiles {
  bool settle = true;
};

const std::vector<ParamInfo>& params() {
  using P = Params;
  static const std::vector<ParamInfo> infos =
      ParamTable<P>()
          .text("strokes", static_cast<std::string P::*>(&P::strokes),
                "Path of a text file of strokes, which come before those of the journal; none has none")
          .text("journal", static_cast<std::string P::*>(&P::journal),
                "Path of the journal of strokes that tafoni sculpt and editors keep; none has none")
          .boolean("settle", &P::settle,
                   "Limits the field of earlier layers to the terrain's amplitude, so that strokes fill "
                   "their caves as they fill open air");
  return infos;
}

landforms::Result place(const Keyed<std::shared_ptr<const impl::Sculpted>>& sculpted, const double& amplitude,
                        const bool& settle) {
  landforms::Result out;
  // What limits values changes no sign.
  out.lowest = impl::box_of(*sculpted.value).lo.z;
  if (sculpted.value->node) {
    out.nodes = {sculpted.value->node};
    if (settle) {
      const auto limit = static_cast<float>(amplitude);
      out.reshape = [limit](field::NodePtr below) {
        return field::intersect(
            {field::unite({std::move(below), field::constant(-limit)}), field::constant(limit)});
      };
      out.reshaped = Box3d::everything();
    }
  }
  std::int64_t strokes = 0, muted = 0;
  for (const auto& group : sculpted.value->groups)
    for (const impl::Slot& slot : group->slots) ++(slot.muted ? muted : strokes);
  out.facts.count("strokes", strokes)
      .about("Strokes that act")
      .count("muted", muted)
      .about("Strokes that are left out until they are unmuted");
  return out;
}

/// Beyond a layer's result: what two of them must share to differ by their strokes alone.
struct Own {
  std::shared_ptr<const impl::Sculpted> sculpted;
  impl::Digest frame;
};

const Own& own(const impl::BuiltLayer& layer) {
  return *static_cast<const Own*>(layer.own.get());
}

void warn_of_idle(const impl::Sculpted& sculpted, const impl::LayerSite& site) {
  const impl::Below& below = site.below.value;
  const terrain::Terrain& terrain = below.terrain;
  Progress& progress = site.readers.progress;
  const auto beside =
      impl::strokes_beside(sculpted, [&](const Box3d& box) { return impl::over_domain(terrain, box); });
  if (beside.count > 0)
    impl::warn_of_beside(
        terrain, "layer " + site.name,
        fmt::format("strokes (\"{}\"{})", shown_stroke(*beside.first), beside.count > 1 ? " …" : ""),
        beside.count, beside.all, progress);
  std::optional<field::CompiledField> rock;
  const auto air = impl::strokes_in_air(sculpted, [&](const Box3d& box) {
    // Most lie no higher than some ground, which tells at once that they may carve.
    if (box.lo.z <= terrain.box.hi.z || !impl::over_domain(terrain, box)) return true;
    if (!rock) rock = field::compile(below.open);
    return rock->interval(box).hi > 0;
  });
  if (air.count > 0)
    progress.warn(fmt::format(
        "layer {}: {} of {} strokes that carve (\"{}\"{}) meet nothing but air, above all rock, and "
        "change nothing; check their heights",
        site.name, air.count == air.all ? "all" : fmt::format("{}", air.count), air.all,
        shown_stroke(*air.first), air.count > 1 ? " …" : ""));
}

impl::BuiltLayer build(const impl::LayerSite& site) {
  if (!site.memory.has_value()) site.memory = std::make_shared<impl::SculptCook>();
  impl::SculptCook& cook = *std::any_cast<std::shared_ptr<impl::SculptCook>&>(site.memory);
  Params p;
  assign(params(), &p, site.words.values, "sculpt");
  const impl::Below& below = site.below.value;
  const impl::SculptFrame frame{below.terrain.origin, below.settings.amplitude, site.seed, site.region};
  const auto before = cook.groups_cooked();
  const auto sculpted = cook.cook(site.strokes(), frame);
  impl::BuiltLayer out;
  out.reused = cook.groups_cooked() == before;
  warn_of_idle(*sculpted.value, site);
  out.made = impl::make_keyed(&place, sculpted, frame.amplitude, p.settle);
  out.own = std::make_shared<Own>(
      Own{sculpted.value, impl::digest_of(frame, p.settle, sculpted.value->node != nullptr)});
  return out;
}

bool changed(const impl::BuiltLayer* before, const impl::BuiltLayer* now, std::vector<Box3d>& out) {
  if (before && now) {
    if (before->made.key == now->made.key) return true;
    if (own(*before).frame != own(*now).frame) return false;
  }
  impl::changed_boxes(before ? own(*before).sculpted.get() : nullptr,
                      now ? own(*now).sculpted.get() : nullptr, out);
  if (!before || !now) {
    const Box3d& reshaped = (before ? before : now)->made.value.reshaped;
    if (!reshaped.empty()) out.push_back(reshaped);
  }
  return true;
}

}  // namespace

const LayerKind& declaration() {
  static const LayerKind kind{.types = {{
                                  .about = {.name = "sculpt",
                                            .doc = "Strokes of brushes, from a text file and from a journal",
                                            .source = "[Paris19 §3.2, §8.2]",
                                            .params = params()},
                                  .paths = {"strokes", "journal"},
                                  .takes_strokes = true,
                                  .build = build,
                                  .changed = changed,
                              }}};
  return kind;
}

}  // namespace tafoni::scene::layer_sculpt
