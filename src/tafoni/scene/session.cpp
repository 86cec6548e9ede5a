// A session keeps the document, a builder that remembers what it made, the journals of strokes that are open,
// and a mesher with the boxes that changed since it last meshed.
#include "tafoni/scene/session.h"

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "tafoni/core/error.h"
#include "tafoni/scene/build/impl/base.h"
#include "tafoni/scene/build/impl/builder.h"
#include "tafoni/scene/build/impl/outside.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/scene/sculpt/impl/own_journal.h"
#include "tafoni/scene/sculpt/impl/sculpt.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene {

namespace fs = std::filesystem;

namespace {

std::vector<impl::Slot> read_slots(const impl::File& file, Progress&) {
  return impl::read_strokes(file.path);
}

}  // namespace

struct Session::State {
  Document document;
  fs::path file;
  impl::Builder builder;
  std::optional<impl::Built> built;
  std::map<fs::path, Journal> journals;
  std::unique_ptr<surface::IncrementalMesher> mesher;
  std::optional<surface::PolygonizeSettings> meshed;  ///< what the mesher was made for
  const void* meshed_inside = nullptr;                ///< the same, of the domain's mask
  std::vector<Box3d> unmeshed;                        ///< changed since the mesher's last update
  impl::FileDigests files;
  impl::Memo<std::vector<impl::Slot>, Progress, impl::File> texts{16, &read_slots};

  const Layer& sculpt(std::size_t index) const {
    if (index >= document.layers.size() || !find_layer_type(document.layers[index].type).takes_strokes)
      fail(ErrorKind::usage, "layer {} takes no strokes; only a sculpt layer does", index);
    return document.layers[index];
  }

  /// The journal of a layer, opened when it is first asked for; null for a layer without one.
  Journal* journal(const Layer& layer) {
    const std::string path = impl::stroke_files(layer).journal;
    if (path.empty()) return nullptr;
    const fs::path resolved = document.resolve(path);
    const auto found = journals.find(resolved);
    if (found != journals.end()) return &found->second;
    return &journals.emplace(resolved, Journal::open(resolved)).first->second;
  }

  std::vector<impl::Slot> text_slots(const Layer& layer) {
    const std::string path = impl::stroke_files(layer).strokes;
    if (path.empty()) return {};
    const fs::path resolved = document.resolve(path);
    return texts({resolved, files.of(resolved)}, silent()).value;
  }

  std::vector<impl::Slot> slots(const Layer& layer) {
    std::vector<impl::Slot> out = text_slots(layer);
    if (Journal* j = journal(layer))
      for (const Journal::Entry& entry : j->strokes()) out.push_back({entry.stroke, entry.muted});
    return out;
  }

  /// A stroke that cannot be cooked, or does nothing, must not reach the journal: it would trouble every
  /// build.
  void check(std::span<const Stroke> strokes) {
    const terrain::Terrain terrain = builder.terrain(document, silent());
    impl::SculptFrame frame;
    frame.origin = terrain.origin;
    frame.amplitude = document.terrain.amplitude;
    const auto over = [&](const Box3d& box) {
      return impl::over_domain(terrain, box) && box.hi.z > terrain.box.lo.z - impl::deepest_base &&
             box.lo.z < terrain.box.hi.z + impl::deepest_base;
    };
    impl::SculptCook trial;
    for (const Stroke& stroke : strokes) {
      const impl::Slot slot{std::make_shared<Stroke>(parse_stroke(to_text(stroke), "stroke")), false};
      if (impl::strokes_beside(*trial.cook({&slot, 1}, frame).value, over).count > 0)
        fail(ErrorKind::usage,
             "the stroke \"{}\" lies outside of {}, or more than {:g} km above or below it; give its points "
             "in the "
             "scene's CRS",
             shown_stroke(stroke), impl::terrain_place(terrain), impl::deepest_base / 1000);
    }
  }

  /// Whether a change of the layer's journal would be one of somebody else's.
  bool borrows(std::size_t index, const Journal& journal) const {
    return !file.empty() && (impl::other_scene(journal, file) || impl::is_shared(document, index));
  }

  /// The journal of a layer for changing it, its own; null for a layer without one.
  Journal* own_journal(std::size_t index) {
    Journal* there = journal(document.layers[index]);
    if (!there || !borrows(index, *there)) {
      if (there && !file.empty()) there->set_scene(impl::scene_from(*there, file));
      return there;
    }
    return give_journal(index);
  }

  /// Gives a layer a journal of its own, with the strokes of the one that it names, and saves the scene. What
  /// other processes do meanwhile waits, and what they did before is taken over.
  Journal* give_journal(std::size_t index) {
    if (file.empty())
      fail(ErrorKind::usage,
           "the scene has no file yet, beside which strokes could be kept; save it under a name first");
    const inner::FileLock lock = impl::lock_scene(file);
    impl::take_over(document, index, file);
    Journal* there = journal(document.layers[index]);
    if (there && !borrows(index, *there)) return there;
    if (there) there->refresh();
    Document changed = document;
    const fs::path path = impl::make_journal(changed, index, file, there);
    try {
      save_scene(changed, file);
    } catch (...) {
      std::error_code ignored;
      fs::remove(path, ignored);
      throw;
    }
    document = load_scene(file);
    const fs::path named = document.resolve(impl::stroke_files(document.layers[index]).journal);
    return &journals.insert_or_assign(named, Journal::open(named)).first->second;
  }
};

Session::Session(Document document, fs::path file) : state_(std::make_unique<State>()) {
  check(document);
  state_->document = std::move(document);
  state_->file = std::move(file);
}
Session::~Session() = default;
Session::Session(Session&&) noexcept = default;
Session& Session::operator=(Session&&) noexcept = default;

Session Session::open(const fs::path& file) {
  return Session(load_scene(file), file);
}

const Document& Session::document() const {
  return state_->document;
}

const fs::path& Session::file() const {
  return state_->file;
}

void Session::change(const std::function<void(Document&)>& edit) {
  Document copy = state_->document;
  edit(copy);
  check(copy);
  state_->document = std::move(copy);
}

void Session::set(std::string_view assignment) {
  change([&](Document& d) { scene::set(d, assignment); });
}

std::size_t Session::add_layer(Layer layer, std::size_t at) {
  at = std::min(at, state_->document.layers.size());
  change([&](Document& d) { d.layers.insert(d.layers.begin() + at, std::move(layer)); });
  return at;
}

namespace {

Layer& layer_at(Document& document, std::size_t index) {
  if (index >= document.layers.size())
    fail(ErrorKind::usage, "there is no layer {}; the scene has {}", index, document.layers.size());
  return document.layers[index];
}

}  // namespace

void Session::remove_layer(std::size_t layer) {
  change([&](Document& d) {
    layer_at(d, layer);
    d.layers.erase(d.layers.begin() + layer);
  });
}

void Session::move_layer(std::size_t from, std::size_t to) {
  change([&](Document& d) {
    Layer moved = layer_at(d, from);
    d.layers.erase(d.layers.begin() + from);
    to = std::min(to, d.layers.size());
    d.layers.insert(d.layers.begin() + to, std::move(moved));
  });
}

void Session::mute_layer(std::size_t layer, bool muted) {
  change([&](Document& d) { layer_at(d, layer).settings.enabled = !muted; });
}

void Session::reseed_layer(std::size_t layer, std::int64_t seed) {
  if (seed < -1) fail(ErrorKind::usage, "a layer's seed is -1 or more, not {}", seed);
  change([&](Document& d) { layer_at(d, layer).settings.seed = seed; });
}

void Session::save() {
  State& s = *state_;
  if (s.file.empty()) fail(ErrorKind::usage, "the scene has no file yet; save it under a name first");
  const inner::FileLock lock = impl::lock_scene(s.file);
  if (const auto now = impl::changed_by_others(s.document, s.file); now && !same(*now, s.document))
    impl::fail_changed(s.file);
  save_scene(s.document, s.file);
  s.document = load_scene(s.file);
}

std::size_t Session::sculpt_layer(std::string_view name) {
  const auto& layers = state_->document.layers;
  for (std::size_t i = layers.size(); i-- > 0;) {
    if (!name.empty() && shown_name(layers[i]) != name) continue;
    if (find_layer_type(layers[i].type).takes_strokes) return i;
    if (!name.empty())
      fail(ErrorKind::usage, "the layer {} is of type {}, which takes no strokes; choose another name", name,
           layers[i].type);
  }
  Layer layer;
  layer.type = stroke_layer_type().about.name;
  layer.settings.name = name;
  return add_layer(std::move(layer));
}

std::vector<Journal::Entry> Session::strokes(std::size_t layer) {
  const Layer& l = state_->sculpt(layer);
  std::vector<Journal::Entry> out;
  for (const impl::Slot& slot : state_->text_slots(l)) out.push_back({0, slot.stroke, false});
  if (const Journal* journal = state_->journal(l))
    out.insert(out.end(), journal->strokes().begin(), journal->strokes().end());
  return out;
}

void Session::stroke(std::size_t layer, std::span<const Stroke> strokes) {
  State& s = *state_;
  s.sculpt(layer);
  if (strokes.empty()) return;
  s.check(strokes);
  if (const auto missing = missing_journal(layer)) {
    // One of two processes makes it; the other opens what it made.
    const inner::FileLock lock = impl::lock_scene(s.file.empty() ? *missing : s.file);
    Journal::make(*missing);
  }
  Journal* journal = s.own_journal(layer);
  if (!journal) journal = s.give_journal(layer);
  journal->append(strokes);
}

void Session::check_strokes(std::span<const Stroke> strokes) {
  if (!strokes.empty()) state_->check(strokes);
}

std::optional<fs::path> Session::missing_journal(std::size_t layer) const {
  const State& s = *state_;
  const std::string path = impl::stroke_files(s.sculpt(layer)).journal;
  std::error_code code;
  if (path.empty() || fs::exists(s.document.resolve(path), code)) return {};
  return s.document.resolve(path);
}

std::optional<fs::path> Session::borrowed_from(std::size_t layer) {
  State& s = *state_;
  if (missing_journal(layer)) return {};
  const Journal* journal = s.journal(s.sculpt(layer));
  if (!journal || s.file.empty()) return {};
  if (auto other = impl::other_scene(*journal, s.file)) return other;
  return impl::is_shared(s.document, layer) ? std::optional(s.file) : std::nullopt;
}

std::size_t Session::undo(std::size_t layer, std::size_t steps) {
  state_->sculpt(layer);
  Journal* journal = state_->own_journal(layer);
  return journal ? journal->undo(steps) : 0;
}

std::size_t Session::redo(std::size_t layer, std::size_t steps) {
  state_->sculpt(layer);
  Journal* journal = state_->own_journal(layer);
  return journal ? journal->redo(steps) : 0;
}

std::size_t Session::redoable(std::size_t layer) {
  const Journal* journal = state_->journal(state_->sculpt(layer));
  return journal ? journal->redoable() : 0;
}

void Session::go_to(std::size_t layer, std::int64_t id) {
  state_->sculpt(layer);
  Journal* journal = state_->own_journal(layer);
  if (!journal) fail(ErrorKind::usage, "the layer has no stroke {}", id);
  journal->go_to(id);
}

std::vector<Journal::Entry> Session::history(std::size_t layer) {
  const Journal* journal = state_->journal(state_->sculpt(layer));
  return journal ? journal->history() : std::vector<Journal::Entry>();
}

bool Session::mute_stroke(std::size_t layer, std::int64_t id, bool muted) {
  state_->sculpt(layer);
  Journal* journal = state_->own_journal(layer);
  if (!journal) fail(ErrorKind::usage, "the layer has no stroke {}", id);
  return journal->mute(id, muted);
}

Update Session::update(Progress& progress) {
  State& s = *state_;
  for (auto& [path, journal] : s.journals) journal.refresh();
  impl::Built now = s.builder.build(
      s.document, [&s](const Document&, const Layer& layer) { return s.slots(layer); }, progress);
  Update out;
  out.scene = now.scene;
  out.changed = impl::changed_boxes(s.built.value_or(impl::Built{}), now);
  for (const LayerResult& layer : now.scene->layers)
    if (!layer.reused) out.rerun.push_back(layer.name);
  s.unmeshed.insert(s.unmeshed.end(), out.changed.begin(), out.changed.end());
  s.built = std::move(now);
  return out;
}

namespace {

bool same_lattice(const surface::PolygonizeSettings& a, const surface::PolygonizeSettings& b) {
  return a.voxel == b.voxel && a.boundary == b.boundary && a.region.lo == b.region.lo &&
         a.region.hi == b.region.hi && a.min_fragment_volume == b.min_fragment_volume;
}

}  // namespace

std::vector<surface::ChunkChange> Session::remesh(Progress& progress) {
  State& s = *state_;
  if (!s.built) update(progress);
  const BuiltScene& scene = *s.built->scene;
  const field::CompiledField field = scene.field_for(scene.boundary());
  const auto settings = polygonize_settings(scene, scene.voxel);
  const void* inside = scene.boundary() == surface::Boundary::open ? scene.terrain.inside.get() : nullptr;
  if (!s.mesher || !same_lattice(*s.meshed, settings) || s.meshed_inside != inside) {
    s.mesher = std::make_unique<surface::IncrementalMesher>(settings);
    s.meshed = settings;
    s.meshed_inside = inside;
  }
  auto changes = s.mesher->update(field, s.unmeshed, progress);
  s.unmeshed.clear();
  return changes;
}

const surface::IncrementalMesher& Session::mesher() const {
  if (!state_->mesher) fail(ErrorKind::usage, "nothing is meshed yet");
  return *state_->mesher;
}

MeshResult Session::mesh(Progress& progress) {
  remesh(progress);
  MeshResult result;
  result.mesh = state_->mesher->assemble();
  result.stats.vertices = result.mesh.positions.size();
  result.stats.triangles = result.mesh.triangles.size();
  finish_mesh(*state_->built->scene, result, progress);
  return result;
}

}  // namespace tafoni::scene
