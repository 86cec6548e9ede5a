#pragma once
// A document at work: changed step by step and built again incrementally. What an editor stands on.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "tafoni/core/progress.h"
#include "tafoni/scene/build/build.h"
#include "tafoni/scene/document/document.h"
#include "tafoni/scene/products/mesh_scene.h"
#include "tafoni/scene/sculpt/journal.h"
#include "tafoni/surface/incremental_mesher.h"

namespace tafoni::scene {

/// What update() did: what the scene is now, where it changed, and what was made again.
struct Update {
  std::shared_ptr<const BuiltScene> scene;
  /// Local metres. Outside of these boxes the field has the same values as after the update before, bit for
  /// bit. Infinite boxes where that cannot be told, as after the first update.
  std::vector<Box3d> changed;
  std::vector<std::string> rerun;  ///< names of the layers that were made again
};

/// Not for use from several threads at once. A change that throws leaves everything as it was.
///
/// Strokes are in their layers' journals as soon as a call returns, and undo and redo are kept there; all
/// other changes are in memory until save(). Layers are cached by a digest of all they depend on: the terrain
/// and its files, geology, regions and masks, parameters, the seed and the layers below. The result of
/// update() is that of build() on the same document, bit for bit, whatever was done before.
class Session {
 public:
  /// Relative paths are relative to the document's directory. save() and the first stroke of a layer without
  /// a journal need a file: give one, or use open().
  explicit Session(Document document, std::filesystem::path file = {});
  static Session open(const std::filesystem::path& file);
  ~Session();
  Session(Session&&) noexcept;
  Session& operator=(Session&&) noexcept;

  const Document& document() const;
  const std::filesystem::path& file() const;

  /// `edit` works on a copy, which is checked before it takes the document's place.
  void change(const std::function<void(Document&)>& edit);
  /// As --set: "TARGET.NAME=VALUE".
  void set(std::string_view assignment);
  /// The layer's index from then on. Indices beyond the end mean the end.
  std::size_t add_layer(Layer layer, std::size_t at = ~std::size_t{0});
  void remove_layer(std::size_t layer);
  void move_layer(std::size_t from, std::size_t to);
  void mute_layer(std::size_t layer, bool muted);
  /// -1: made from the scene's seed, as layer_seed() says.
  void reseed_layer(std::size_t layer, std::int64_t seed);
  /// Writes the document to file(), comments and all. Throws Error{output} where another program changed the
  /// file since it was read.
  void save();

  /// The sculpt layer of a name, or the last one where `name` is empty; made at the end where there is none.
  /// Throws Error{usage} where another type of layer has the name.
  std::size_t sculpt_layer(std::string_view name = {});
  /// Those of the layer's text file have the id 0 and can be neither undone nor muted.
  std::vector<Journal::Entry> strokes(std::size_t layer);
  /// Checks all, then stores and applies all in one step of the disk. The first stroke of a layer makes its
  /// journal and saves the document, which names it; so does the first change of strokes that are
  /// borrowed_from() elsewhere. Throws Error{output} where other programs changed the scene file in another
  /// way since.
  void stroke(std::size_t layer, std::span<const Stroke> strokes);
  void stroke(std::size_t layer, const Stroke& one) { stroke(layer, {&one, 1}); }
  /// The scene file whose journal the layer names where that is another's, as after the file was copied, or
  /// where another layer names it too. The first change makes a copy for this layer.
  std::optional<std::filesystem::path> borrowed_from(std::size_t layer);
  /// The journal that the layer names where it is not there; a stroke begins it anew.
  std::optional<std::filesystem::path> missing_journal(std::size_t layer) const;
  /// Throws Error{usage} for strokes that stroke() refuses, before anything is changed.
  void check_strokes(std::span<const Stroke> strokes);
  /// How many strokes went or came back.
  std::size_t undo(std::size_t layer, std::size_t steps = 1);
  std::size_t redo(std::size_t layer, std::size_t steps = 1);
  std::size_t redoable(std::size_t layer);
  /// Journal::go_to() and Journal::history() of the layer.
  void go_to(std::size_t layer, std::int64_t id);
  std::vector<Journal::Entry> history(std::size_t layer);
  /// Whether it was not so before.
  bool mute_stroke(std::size_t layer, std::int64_t id, bool muted);

  /// Builds what changed, in the document, its files or its journals, since the last update.
  Update update(Progress& progress = silent());
  /// Brings the mesher up to the last update (made if there was none): only chunks of the lattice that the
  /// changed boxes touch are looked at. Gives the chunks whose mesh changed. The mesher lives as long as the
  /// session does not have to mesh on another lattice.
  std::vector<surface::ChunkChange> remesh(Progress& progress = silent());
  const surface::IncrementalMesher& mesher() const;
  /// remesh(), put together, coloured and simplified: what mesh_scene() makes of the scene, byte for byte.
  MeshResult mesh(Progress& progress = silent());

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::scene
