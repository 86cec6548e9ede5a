#pragma once
// The strokes of one sculpt layer on disk: a SQLite file, safe against a crash at any moment.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene {

/// Every change is one transaction that is on the disk when the call returns: a process killed at any moment
/// loses at most the stroke in flight. Undone strokes stay in the file. A stroke after an undo begins a new
/// branch; redo() goes along the branch last left, and go_to() to any stroke ever made.
///
/// Several processes may use one journal: a change applies to what is on the disk then. A journal says which
/// scene's strokes it keeps (sculpt/impl/owner.h). A file of no bytes is one without strokes. Throws
/// Error{input} for a file that is damaged, no journal, or of a newer version, and Error{output} where it
/// cannot be written: read-only, locked by another process for longer than five seconds, or the disk full.
/// After an error the journal is as before.
class Journal {
 public:
  struct Entry {
    std::int64_t id = 0;  ///< from 1, never used twice
    std::shared_ptr<const Stroke> stroke;
    bool muted = false;
    std::int64_t before = 0;  ///< the stroke that it was made after
  };

  /// Opens a journal that exists, for reading and, where permitted, for writing.
  static Journal open(const std::filesystem::path& file);
  /// The same; made if there is none yet. Throws Error{output} where that cannot be.
  static Journal open_or_create(const std::filesystem::path& file);
  /// Makes a new one, whole or not at all, with all that `from` holds, undone strokes too; without strokes
  /// where that is null. Takes the place of a file of no bytes; false where the name is taken by another.
  static bool make(const std::filesystem::path& file, const std::string& scene = {},
                   const Journal* from = nullptr);
  ~Journal();
  Journal(Journal&&) noexcept;
  Journal& operator=(Journal&&) noexcept;

  const std::filesystem::path& file() const;
  /// The strokes that are applied, in their order, muted ones included.
  const std::vector<Entry>& strokes() const;
  /// How many steps redo() can go.
  std::size_t redoable() const;
  /// Every stroke in the file, undone and abandoned ones included, by id.
  std::vector<Entry> history() const;

  /// Applies them in one transaction; gives the id of the last.
  std::int64_t append(std::span<const Stroke> strokes);
  std::int64_t append(const Stroke& stroke) { return append({&stroke, 1}); }
  /// Goes back or forth by up to `steps`; gives how many it went.
  std::size_t undo(std::size_t steps = 1);
  std::size_t redo(std::size_t steps = 1);
  /// Applies exactly the strokes that were applied right after `id` was made; 0 undoes all.
  void go_to(std::int64_t id);
  /// Whether it was not so before.
  bool mute(std::int64_t id, bool muted);
  /// Takes over what other processes changed; gives whether there was anything.
  bool refresh();

  /// The path, from the journal's folder, of the scene file whose strokes these are; empty where none is
  /// said.
  const std::string& scene() const;
  /// Says so from now on, unless others changed it meanwhile.
  void set_scene(const std::string& scene);

  /// What can be read of a file, damaged or not.
  struct Remains {
    std::vector<Entry> history;  ///< by id, up to the first damage
    std::vector<Entry> strokes;  ///< those of them that are applied
    std::string scene;
    std::string damage;  ///< one sentence; empty for a sound journal
  };
  /// Writes what there is to a new journal, unless `to` is empty. Throws Error{usage} where `to` exists, and
  /// Error{input} for a file of which nothing stands.
  static Remains salvage(const std::filesystem::path& file, const std::filesystem::path& to = {});

 private:
  struct State;
  explicit Journal(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace tafoni::scene
