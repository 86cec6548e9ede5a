// Keeps edits as messages and a few grids of the past, which share what does not differ. An old version is
// made from the nearest one that is kept, run by run where edits rewound.

#include "tafoni/runtime/impl/history.h"

#include <algorithm>
#include <optional>

#include "tafoni/core/error.h"
#include "tafoni/volume/edit.h"

namespace tafoni::runtime::impl {

using volume::SampleBox;
using volume::ScalarGrid;

namespace {

/// Edits between two grids that are kept: what a rewind makes again at most, while it is near.
constexpr std::uint64_t keep_every = 64;
/// The ground as opened and eight versions since, as DestructibleTerrainSettings::rewind promises.
constexpr std::size_t most_kept = 9;

SampleBox box_around(const SampleBox& a, const SampleBox& b) {
  if (a.empty()) return b;
  return {{std::min(a.lo.x, b.lo.x), std::min(a.lo.y, b.lo.y), std::min(a.lo.z, b.lo.z)},
          {std::max(a.hi.x, b.hi.x), std::max(a.hi.y, b.hi.y), std::max(a.hi.z, b.hi.z)}};
}

Editor::Boxes boxes(const SampleBox& box) {
  return box.empty() ? Editor::Boxes() : Editor::Boxes{box};
}

}  // namespace

void History::add(const Message& message, const std::vector<SampleBox>& changed) {
  SampleBox all;
  for (const SampleBox& box : changed) all = box_around(all, box);
  changed_.push_back(all);
  edits_.push_back(message);
}

void History::cut(std::size_t count) {
  edits_.resize(count);
  changed_.resize(count);
  while (!kept_.empty() && kept_.back().first > version()) kept_.pop_back();
}

void History::remember(const ScalarGrid& grid) {
  if (!keeps_past_ || (!kept_.empty() && version() < kept_.back().first + keep_every)) return;
  kept_.emplace_back(version(), grid);
  if (kept_.size() > most_kept) kept_.erase(kept_.begin() + 1);
}

void History::check_rewind(std::uint64_t to) const {
  if (!keeps_past_)
    fail(ErrorKind::usage,
         "this terrain does not keep its past: open it with DestructibleTerrainSettings::rewind");
  if (to < 1 || to > version())
    fail(ErrorKind::usage, "the terrain cannot be rewound to version {}: it has versions 1 to {}", to,
         version());
}

ScalarGrid History::grid_at(std::uint64_t to, Vec3d origin, double band) const {
  // Runs of edits, (first, last] by version, are collected from the end back; each begins where a rewind led.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs;
  const ScalarGrid* start = nullptr;
  while (!start) {
    const auto after = std::upper_bound(kept_.begin(), kept_.end(), to,
                                        [](std::uint64_t v, const auto& kept) { return v < kept.first; });
    const auto& kept = *(after - 1);
    std::uint64_t from = to;
    std::optional<std::uint64_t> led;
    for (; from > kept.first && !led; --from) {
      const Operation operation = decode(edits_[from - 2]);
      if (const auto* rewind = std::get_if<Rewind>(&operation)) led = rewind->version;
    }
    runs.emplace_back(led ? from + 1 : from, to);
    if (led)
      to = *led;
    else
      start = &kept.second;
  }
  ScalarGrid grid = *start;
  const Editor editor(grid, origin, band, *this);
  for (auto run = runs.rbegin(); run != runs.rend(); ++run)
    for (std::uint64_t v = run->first + 1; v <= run->second; ++v)
      (void)std::visit(editor, decode(edits_[v - 2]));
  return grid;
}

std::vector<SampleBox> History::changed_since(std::uint64_t to) const {
  std::vector<SampleBox> out;
  for (std::size_t i = to - 1; i < changed_.size(); ++i)
    if (!changed_[i].empty()) out.push_back(changed_[i]);
  return out;
}

Editor::Boxes Editor::operator()(const ToolUse& use) const {
  volume::ToolData data = use.tool.data();
  for (Vec3d& p : data.points) p -= origin_;
  return boxes(volume::apply(grid_, volume::Tool::from(data), use.edit, band_));
}

Editor::Boxes Editor::operator()(const Explosion& e) const {
  return boxes(volume::explode(grid_, e.center - origin_, e.radius, e.energy, band_));
}

Editor::Boxes Editor::operator()(const Radial& r) const {
  const auto last = static_cast<double>(r.change.size() - 1);
  const auto change = [&](double share) {
    const double at = share * last;
    const std::size_t i = std::min(static_cast<std::size_t>(at), r.change.size() - 2);
    const double t = at - static_cast<double>(i);  // the two apart, since their difference may be no number
    return r.change[i] * (1 - t) + r.change[i + 1] * t;
  };
  return boxes(volume::add_radial(grid_, r.center - origin_, r.radius, change, band_));
}

Editor::Boxes Editor::operator()(const Rewind& rewind) const {
  history_.check_rewind(rewind.version);
  grid_ = history_.grid_at(rewind.version, origin_, band_);
  return history_.changed_since(rewind.version);
}

std::uint64_t work_of(const Operation& operation, const ScalarGrid& grid, Vec3d origin, double band) {
  Box3d box;
  std::uint64_t each = 1;
  if (const auto* use = std::get_if<ToolUse>(&operation)) {
    box = use->tool.bounds().grown(band);
    const volume::ToolData data = use->tool.data();
    if (data.kind == volume::ToolData::Kind::hull) each = 2 * data.points.size() - 4;
  } else if (const auto* e = std::get_if<Explosion>(&operation)) {
    box = Box3d{e->center, e->center}.grown(e->radius);
  } else if (const auto* r = std::get_if<Radial>(&operation)) {
    box = Box3d{r->center, r->center}.grown(r->radius);
  } else {
    return 0;
  }
  const Vec3<std::uint64_t> n = [&] {
    const Vec3i size = grid.samples_in({box.lo - origin, box.hi - origin}).size();
    const auto count = [](int v) -> std::uint64_t { return std::max(v, 0); };
    return Vec3<std::uint64_t>{count(size.x), count(size.y), count(size.z)};
  }();
  return n.x * n.y * n.z * each;
}

}  // namespace tafoni::runtime::impl
