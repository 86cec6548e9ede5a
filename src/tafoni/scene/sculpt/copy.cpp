#include "tafoni/scene/sculpt/copy.h"

#include <algorithm>
#include <vector>

#include <fmt/format.h>

#include "tafoni/core/files.h"
#include "tafoni/scene/sculpt/impl/own_journal.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene {

namespace fs = std::filesystem;

void save_copy(const Document& document, const fs::path& file, Progress& progress) {
  const inner::FileLock lock = impl::lock_scene(file);
  if (!document.file.empty() && same_file(document.file, file)) {
    const auto now = impl::changed_by_others(document, file);
    if (now && !same(*now, parse_scene(document.text, document.file))) impl::fail_changed(file);
    return save_scene(document, file);
  }
  Document copy = document;
  const std::vector<fs::path> former = impl::journals_of(file);
  std::vector<fs::path> made;
  try {
    for (std::size_t i = 0; i < copy.layers.size(); ++i) {
      const std::string path = impl::stroke_files(copy.layers[i]).journal;
      if (path.empty()) continue;
      const Journal from = Journal::open(document.resolve(path));
      made.push_back(impl::make_journal(copy, i, file, &from));
    }
    save_scene(copy, file);
  } catch (...) {
    std::error_code ignored;
    for (const fs::path& path : made) fs::remove(path, ignored);
    throw;
  }
  // An earlier copy's journals, unless they hold more than was copied now.
  const std::vector<fs::path> named = impl::journals_of(file);
  for (const fs::path& path : former) {
    const auto is_it = [&](const fs::path& other) { return same_file(other, path); };
    if (std::any_of(named.begin(), named.end(), is_it)) continue;
    bool repeats = false;
    for (const fs::path& other : made) {
      const Journal journal = Journal::open(other);
      repeats = repeats || impl::gives_way(path, file, &journal);
    }
    std::error_code ignored;
    if (repeats)
      fs::remove(path, ignored);
    else
      progress.warn(fmt::format("{}: its strokes stay in {}, which the scene names no more", file.string(),
                                path.string()));
  }
}

}  // namespace tafoni::scene
