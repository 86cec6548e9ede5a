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
constexpr int chunk_side = ScalarGrid::chunk_samples;

SampleBox box_around(const SampleBox& a, const SampleBox& b) {
  if (a.empty()) return b;
  return {{std::min(a.lo.x, b.lo.x), std::min(a.lo.y, b.lo.y), std::min(a.lo.z, b.lo.z)},
          {std::max(a.hi.x, b.hi.x), std::max(a.hi.y, b.hi.y), std::max(a.hi.z, b.hi.z)}};
}

Editor::Boxes boxes(const SampleBox& box) {
  return box.empty() ? Editor::Boxes() : Editor::Boxes{box};
}

/// World boxes outside of which edits change nothing.
Box3d reach_of(const ToolUse& use, double band) {
  return use.tool.bounds().grown(band);
}
template <class Blast>
Box3d reach_of(const Blast& edit) {
  return Box3d{edit.center, edit.center}.grown(edit.radius);
}

}  // namespace

void History::add(const Message& message, const std::vector<SampleBox>& changed) {
  SampleBox all;
  for (const SampleBox& box : changed) all = box_around(all, box);
  changed_.push_back(all);
  edits_.push_back(message);
  message_bytes_ += message.size();
}

void History::cut(std::size_t count) {
  for (std::size_t i = count; i < edits_.size(); ++i) message_bytes_ -= edits_[i].size();
  edits_.resize(count);
  changed_.resize(count);
  while (!kept_.empty() && kept_.back().version > version()) kept_.pop_back();
  if (!kept_.empty()) kept_.back().own.clear();
}

std::uint64_t chunks_of(const SampleBox& box) {
  const auto count = [](int lo, int hi) -> std::uint64_t { return hi / chunk_side - lo / chunk_side + 1; };
  return count(box.lo.x, box.hi.x) * count(box.lo.y, box.hi.y) * count(box.lo.z, box.hi.z);
}

/// The chunks that edits changed since a version.
History::Chunks History::chunks_since(std::uint64_t to) const {
  Chunks out;
  for (const SampleBox& box : changed_since(to))
    for (int c = box.lo.z / chunk_side; c <= box.hi.z / chunk_side; ++c)
      for (int b = box.lo.y / chunk_side; b <= box.hi.y / chunk_side; ++b)
        for (int a = box.lo.x / chunk_side; a <= box.hi.x / chunk_side; ++a) out.insert({a, b, c});
  return out;
}

void History::remember(const ScalarGrid& grid) {
  if (!keeps_past_ || (!kept_.empty() && version() < kept_.back().version + keep_every)) return;
  if (!kept_.empty()) kept_.back().own = chunks_since(kept_.back().version);
  kept_.push_back({version(), grid});
  if (kept_.size() <= most_kept) return;
  kept_[0].own.merge(kept_[1].own);
  kept_.erase(kept_.begin() + 1);
}

std::uint64_t History::bytes() const {
  constexpr std::uint64_t edit = sizeof(Message) + sizeof(SampleBox);
  constexpr std::uint64_t samples = std::uint64_t{chunk_side} * chunk_side * chunk_side;
  std::uint64_t chunks = kept_.empty() ? 0 : chunks_since(kept_.back().version).size();
  for (const Kept& kept : kept_) chunks += kept.own.size();
  const std::uint64_t sample =
      kept_.empty() || kept_[0].grid.precision() == volume::Precision::single ? 4 : 2;
  return edits_.size() * edit + message_bytes_ + chunks * samples * sample;
}

void History::check_rewind(std::uint64_t to) const {
  if (!keeps_past_)
    fail(ErrorKind::usage,
         "this terrain does not keep its past: open it with DestructibleTerrainSettings::rewind");
  if (to < 1 || to > version())
    fail(ErrorKind::usage, "the terrain cannot be rewound to version {}: it has versions 1 to {}", to,
         version());
}

ScalarGrid History::grid_at(std::uint64_t to, const Place& place) const {
  // Runs of edits, (first, last] by version, are collected from the end back; each begins where a rewind led.
  std::vector<std::pair<std::uint64_t, std::uint64_t>> runs;
  const ScalarGrid* start = nullptr;
  while (!start) {
    const auto after = std::upper_bound(kept_.begin(), kept_.end(), to,
                                        [](std::uint64_t v, const Kept& kept) { return v < kept.version; });
    const Kept& kept = *(after - 1);
    std::uint64_t from = to;
    std::optional<std::uint64_t> led;
    for (; from > kept.version && !led; --from) {
      const Operation operation = decode(edits_[from - 2]);
      if (const auto* rewind = std::get_if<Rewind>(&operation)) led = rewind->version;
    }
    runs.emplace_back(led ? from + 1 : from, to);
    if (led)
      to = *led;
    else
      start = &kept.grid;
  }
  ScalarGrid grid = *start;
  const Editor editor(grid, place, *this);
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

/// Makes a change within the bounds, world, and takes back what it does to the floor.
template <class Change>
Editor::Boxes Editor::above_floor(const Box3d& bounds, const Change& change) const {
  // A sample more each way: the change has its bounds from numbers that are rounded otherwise.
  const Box3d box = bounds.grown(grid_.frame().spacing);
  SampleBox floor = grid_.samples_in({box.lo - place_.origin, box.hi - place_.origin});
  floor.hi.z = std::min(floor.hi.z, place_.first_layer - 1);
  std::vector<float> before(floor.empty() ? 0 : floor.count());
  if (!floor.empty()) grid_.read(floor, before.data());
  SampleBox changed = change();
  if (!floor.empty() && !changed.empty() && changed.lo.z < place_.first_layer) {
    grid_.write(floor, before.data());
    changed.lo.z = place_.first_layer;
  }
  return boxes(changed);
}

Editor::Boxes Editor::operator()(const ToolUse& use) const {
  volume::ToolData data = use.tool.data();
  for (Vec3d& p : data.points) p -= place_.origin;
  return above_floor(reach_of(use, place_.band),
                     [&] { return volume::apply(grid_, volume::Tool::from(data), use.edit, place_.band); });
}

Editor::Boxes Editor::operator()(const Explosion& e) const {
  return above_floor(reach_of(e), [&] {
    return volume::explode(grid_, e.center - place_.origin, e.radius, e.energy, place_.band);
  });
}

Editor::Boxes Editor::operator()(const Radial& r) const {
  const auto last = static_cast<double>(r.change.size() - 1);
  const auto change = [&](double share) {
    const double at = share * last;
    const std::size_t i = std::min(static_cast<std::size_t>(at), r.change.size() - 2);
    const double t = at - static_cast<double>(i);  // the two apart, since their difference may be no number
    return r.change[i] * (1 - t) + r.change[i + 1] * t;
  };
  return above_floor(reach_of(r), [&] {
    return volume::add_radial(grid_, r.center - place_.origin, r.radius, change, place_.band);
  });
}

Editor::Boxes Editor::operator()(const Rewind& rewind) const {
  history_.check_rewind(rewind.version);
  grid_ = history_.grid_at(rewind.version, place_);
  return history_.changed_since(rewind.version);
}

std::uint64_t work_of(const Operation& operation, const ScalarGrid& grid, const Place& place) {
  Box3d box;
  std::uint64_t each = 1;
  if (const auto* use = std::get_if<ToolUse>(&operation)) {
    box = reach_of(*use, place.band);
    const volume::ToolData data = use->tool.data();
    if (data.kind == volume::ToolData::Kind::hull) each = 2 * data.points.size() - 4;
  } else if (const auto* e = std::get_if<Explosion>(&operation)) {
    box = reach_of(*e);
  } else if (const auto* r = std::get_if<Radial>(&operation)) {
    box = reach_of(*r);
  } else {
    return 0;
  }
  const Vec3<std::uint64_t> n = [&] {
    const Vec3i size = grid.samples_in({box.lo - place.origin, box.hi - place.origin}).size();
    const auto count = [](int v) -> std::uint64_t { return std::max(v, 0); };
    return Vec3<std::uint64_t>{count(size.x), count(size.y), count(size.z)};
  }();
  return n.x * n.y * n.z * each;
}

}  // namespace tafoni::runtime::impl
