#pragma once
// The files in which a layer that takes strokes keeps them.

#include <string>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/sculpt/impl/paint.h"

namespace tafoni::scene::impl {

struct StrokeFiles {
  std::string strokes;  ///< path of a text file, whose strokes come first
  std::string journal;  ///< path of a journal
};
StrokeFiles stroke_files(const Layer& layer);
void set_journal(Layer& layer, const std::string& path);

/// The strokes of the text file alone; none where the path is empty.
std::vector<Slot> read_strokes(const std::filesystem::path& file);
/// The strokes of both files. Warns where the journal is another scene's, whose strokes change these.
std::vector<Slot> slots_of(const Document& document, const Layer& layer, Progress& progress);

}  // namespace tafoni::scene::impl
