#include "tafoni/scene/sculpt/copy.h"

#include <vector>

#include "tafoni/core/files.h"
#include "tafoni/scene/sculpt/impl/own_journal.h"
#include "tafoni/scene/sculpt/impl/stroke_files.h"

namespace tafoni::scene {

namespace fs = std::filesystem;

void save_copy(const Document& document, const fs::path& file) {
  if (!document.file.empty() && same_file(document.file, file)) return save_scene(document, file);
  const inner::FileLock lock = impl::lock_scene(file);
  Document copy = document;
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
}

}  // namespace tafoni::scene
