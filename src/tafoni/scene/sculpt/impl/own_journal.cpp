// A copied scene file names the journal of the scene that it was copied from. Nobody tells the program of the
// copy, so a journal says whose it is, and the scene that is not its own gets a copy before it changes
// anything.
#include "tafoni/scene/sculpt/impl/own_journal.h"

#include <algorithm>
#include <cctype>
#include <chrono>
#include <vector>

#include "tafoni/core/error.h"
#include "tafoni/core/files.h"
#include "tafoni/scene/layers/layer.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene::impl {

namespace fs = std::filesystem;

namespace {

constexpr std::chrono::seconds scene_lock_wait{5};
/// Bytes of a journal's name: SQLite adds eight, and no name may have more than 255.
constexpr std::size_t longest_name = 240;

fs::path journal_of(const Document& document, const Layer& layer) {
  const std::string path = stroke_files(layer).journal;
  return path.empty() ? fs::path() : document.resolve(path);
}

/// Whether a scene file names the journal; also where that cannot be told.
bool names(const fs::path& scene, const fs::path& journal) {
  try {
    const Document document = load_scene(scene);
    return std::any_of(document.layers.begin(), document.layers.end(), [&](const Layer& layer) {
      const fs::path named = journal_of(document, layer);
      return !named.empty() && same_file(named, journal);
    });
  } catch (const Error&) {
    return true;
  }
}

/// Scene files that a journal may be of, the likeliest first.
std::vector<fs::path> scenes_of(const Journal& journal) {
  const fs::path file = follow_links(journal.file());
  if (!journal.scene().empty()) return {tidy(file.parent_path() / journal.scene())};
  std::vector<fs::path> out;
  const std::string name = file.filename().string();
  for (std::size_t dot = name.rfind('.'); dot != std::string::npos && dot > 0; dot = name.rfind('.', dot - 1))
    out.push_back(file.parent_path() / (name.substr(0, dot) + ".toml"));
  return out;
}

/// A name for the n-th try, made of the scene's and the layer's, cut where there is no room for both.
std::string name_of_journal(const fs::path& scene, const Layer& layer, int n) {
  const std::string end = (n > 1 ? fmt::format("-{}", n) : "") + ".journal";
  std::string name = fmt::format("{}.{}", scene.stem().string(), shown_name(layer));
  std::replace_if(
      name.begin(), name.end(), [](unsigned char c) { return c == '/' || std::iscntrl(c) != 0; }, '_');
  std::size_t size = std::min(name.size(), longest_name - end.size());
  const auto within_letter = [&](std::size_t at) {
    return at < name.size() && (static_cast<unsigned char>(name[at]) & 0xc0) == 0x80;
  };
  while (within_letter(size)) --size;  // a letter of several bytes stays whole
  return name.substr(0, size) + end;
}

}  // namespace

bool gives_way(const fs::path& file, const fs::path& scene, const Journal* from) {
  try {
    const Journal there = Journal::open(file);
    const auto theirs = there.history(), ours = from ? from->history() : std::vector<Journal::Entry>();
    if (there.scene().empty() ? !theirs.empty() : there.scene() != scene_from(there, scene)) return false;
    return theirs.size() <= ours.size() &&
           std::equal(theirs.begin(), theirs.end(), ours.begin(), [](const auto& a, const auto& b) {
             return a.id == b.id && a.before == b.before && to_text(*a.stroke) == to_text(*b.stroke);
           });
  } catch (const Error&) {
    return false;
  }
}

std::vector<fs::path> journals_of(const fs::path& scene) {
  std::vector<fs::path> out;
  std::error_code code;
  if (!fs::is_regular_file(scene, code)) return out;
  try {
    const Document document = load_scene(scene);
    for (const Layer& layer : document.layers)
      if (const fs::path named = journal_of(document, layer); !named.empty() && fs::exists(named, code))
        out.push_back(named);
  } catch (const Error&) {
    return {};
  }
  return out;
}

std::optional<fs::path> other_scene(const Journal& journal, const fs::path& scene) {
  const std::vector<fs::path> scenes = scenes_of(journal);
  const auto is_this = [&](const fs::path& path) { return same_file(path, scene); };
  if (std::any_of(scenes.begin(), scenes.end(), is_this)) return {};
  std::error_code code;
  for (const fs::path& path : scenes)
    if (fs::is_regular_file(path, code) && names(path, journal.file())) return path;
  return {};
}

std::string scene_from(const Journal& journal, const fs::path& scene) {
  const fs::path folder = tidy(fs::absolute(follow_links(journal.file()))).parent_path();
  return relative_to(folder, tidy(fs::absolute(follow_links(scene)))).string();
}

bool is_shared(const Document& document, std::size_t layer) {
  const fs::path file = journal_of(document, document.layers[layer]);
  return std::any_of(document.layers.begin(), document.layers.end(), [&](const Layer& other) {
    const fs::path named = journal_of(document, other);
    return &other != &document.layers[layer] && !file.empty() && !named.empty() && same_file(file, named);
  });
}

inner::FileLock lock_scene(const fs::path& file) {
  if (auto lock = inner::FileLock::take(file, scene_lock_wait)) return std::move(*lock);
  fail(ErrorKind::output, "{}: is in use by another program; try again when that has finished",
       file.string());
}

std::optional<Document> changed_by_others(const Document& document, const fs::path& file) {
  if (document.text.empty() || document.file.empty() || !same_file(document.file, file)) return {};
  std::error_code code;
  if (!fs::exists(file, code)) return {};
  Document now = load_scene(file);
  return now.text == document.text ? std::nullopt : std::optional(std::move(now));
}

void fail_changed(const fs::path& file) {
  fail(ErrorKind::output, "{}: was changed by another program since it was opened; open it again",
       file.string());
}

void take_over(Document& document, std::size_t index, const fs::path& file) {
  std::optional<Document> changed = changed_by_others(document, file);
  if (!changed) return;
  Document& now = *changed;
  // What differs here from the file as it was may be the one new layer, and nothing else.
  Document before = parse_scene(document.text, file), mine = document;
  before.directory = mine.directory;
  const Layer layer = document.layers[index];
  const bool fresh = !same(before, mine);
  if (fresh) mine.layers.erase(mine.layers.begin() + index);
  if (!same(before, mine)) fail_changed(file);
  const auto is_there = [&] {
    return index < now.layers.size() && now.layers[index].type == layer.type &&
           now.layers[index].settings.name == layer.settings.name;
  };
  if (fresh && !is_there() && index <= now.layers.size())
    now.layers.insert(now.layers.begin() + index, layer);
  if (!is_there()) fail_changed(file);
  document = std::move(now);
}

fs::path make_journal(Document& document, std::size_t index, const fs::path& file, const Journal* from) {
  const fs::path real = tidy(fs::absolute(follow_links(file)));
  const fs::path from_here = tidy(fs::absolute(document.resolve(".")));
  Layer& layer = document.layers[index];
  std::error_code code;
  // What the file names until it is saved again must stay as it is: nobody knows whether it will be.
  const std::vector<fs::path> named_there = journals_of(real);
  for (int n = 1;; ++n) {
    const std::string name = name_of_journal(real, layer, n);
    const fs::path path = real.parent_path() / name;
    const bool used = std::any_of(document.layers.begin(), document.layers.end(), [&](const Layer& other) {
      const fs::path named = journal_of(document, other);
      return !named.empty() && same_file(named, path);
    });
    const bool used_there = std::any_of(named_there.begin(), named_there.end(),
                                        [&](const fs::path& named) { return same_file(named, path); });
    if (used || used_there) continue;
    if (gives_way(path, real, from)) fs::remove(path, code);
    if (!Journal::make(path, real.filename().string(), from)) continue;
    set_journal(layer, relative_to(from_here, path).string());
    return path;
  }
}

}  // namespace tafoni::scene::impl
