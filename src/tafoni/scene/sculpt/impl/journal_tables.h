#pragma once
// What the file of a sculpt journal holds: a tree of strokes, the last one applied, and whose they are.

#include <cstdint>
#include <map>
#include <memory>
#include <string>

#include "tafoni/scene/sculpt/impl/database.h"
#include "tafoni/scene/sculpt/stroke.h"

namespace tafoni::scene::impl {

/// A stroke points to the one before it, and to the one that redo goes to from it, 0 for none.
struct JournalRow {
  std::int64_t before = 0, after = 0;
  bool muted = false;
  std::shared_ptr<const Stroke> stroke;
};
/// By id. Row 0 is the empty beginning.
using JournalRows = std::map<std::int64_t, JournalRow>;

struct JournalTables {
  JournalRows rows{{0, {}}};
  std::int64_t head = 0;
  std::string scene;  ///< path of the scene file from the journal's folder; empty: not said
};

/// Reads into `tables` what stands before the first damage, of which it gives one sentence; empty for none.
/// What was read stands by itself: every link leads to a stroke, and none in a circle. Takes the strokes of
/// ids that were `known` over. A file of no bytes is a journal without strokes.
std::string read_tables(const Database& database, const JournalRows& known, JournalTables& tables);

/// Makes the tables of a new journal, which has no strokes, within a transaction.
void make_tables(const Database& database);
/// Whether there are no tables yet, as in a file of no bytes.
bool is_unmade(const Database& database);

void set_scene(const Database& database, const std::string& scene);

/// The bytes of a file that holds such tables.
std::string bytes_of(const JournalTables& tables);

}  // namespace tafoni::scene::impl
