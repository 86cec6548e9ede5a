#pragma once
// Saving a scene under another name.

#include <filesystem>

#include "tafoni/core/progress.h"
#include "tafoni/scene/document/document.h"

namespace tafoni::scene {

/// save_scene() to a file that is to go its own way: each journal is copied, undone strokes too, to one
/// beside the file, so that strokes on either scene leave the other alone. Where the file is the document's
/// own, it keeps its journals; what others wrote to it since it was read is not overwritten. Warns of strokes
/// of a scene that was in the file before. Throws Error{input} for a journal that cannot be read, and
/// Error{output}.
void save_copy(const Document& document, const std::filesystem::path& file, Progress& progress = silent());

}  // namespace tafoni::scene
