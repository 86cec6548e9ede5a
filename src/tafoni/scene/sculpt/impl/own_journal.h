#pragma once
// Whose strokes a journal keeps, and how a scene comes by a journal of its own.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "tafoni/core/inner/file_lock.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/sculpt/journal.h"

namespace tafoni::scene::impl {

/// The scene file whose strokes a journal keeps, where that is not `scene`: the one that it says, and one
/// that says none is called after. It must be there and name the journal: a scene that was moved or copied
/// together with its journal is still the same to it.
std::optional<std::filesystem::path> other_scene(const Journal& journal, const std::filesystem::path& scene);
/// How the journal says that the scene file is its own.
std::string scene_from(const Journal& journal, const std::filesystem::path& scene);
/// Whether another layer names the same journal.
bool is_shared(const Document& document, std::size_t layer);

/// Held while a layer gets a journal. Throws Error{output} where another program holds it for long.
inner::FileLock lock_scene(const std::filesystem::path& file);

/// What the scene file says, where that is not what the document was read from.
std::optional<Document> changed_by_others(const Document& document, const std::filesystem::path& file);
[[noreturn]] void fail_changed(const std::filesystem::path& file);

/// Takes over what others wrote to the scene file since the document was read from it. The layer keeps its
/// index. Throws Error{output} where that cannot be, for both were changed.
void take_over(Document& document, std::size_t layer, const std::filesystem::path& file);

/// Makes a journal beside the scene file that holds what `from` does, or nothing, and names it in the layer.
/// A journal of that scene which neither the document nor the file names, with no strokes but those of
/// `from`, gives way. Gives the journal's path.
std::filesystem::path make_journal(Document& document, std::size_t layer, const std::filesystem::path& file,
                                   const Journal* from);

/// The journals that the scene file names and that are there; none where it cannot be read.
std::vector<std::filesystem::path> journals_of(const std::filesystem::path& scene);
/// Whether a file is a journal of this scene that holds nothing which `from` has not, as a copy that was not
/// finished, or an earlier copy, leaves it. `from` may be null.
bool gives_way(const std::filesystem::path& journal, const std::filesystem::path& scene, const Journal* from);

}  // namespace tafoni::scene::impl
