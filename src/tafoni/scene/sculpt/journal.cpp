// The file holds a tree of strokes, each of which knows the one before it, and the head: the last one
// applied. A change takes the lock, takes over what other processes did, changes the tables and the copy of
// them in memory, and commits; where that fails the copy is put back as it was.
#include "tafoni/scene/sculpt/journal.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>

#include <sqlite3.h>

#include "tafoni/core/atomic_file.h"
#include "tafoni/core/error.h"
#include "tafoni/scene/sculpt/impl/database.h"
#include "tafoni/scene/sculpt/impl/journal_tables.h"

namespace tafoni::scene {
namespace {

using impl::JournalRow;
using impl::pragma;
using impl::Query;
using impl::Transaction;

constexpr int lock_wait_ms = 5000;

}  // namespace

struct Journal::State : impl::Database {
  std::filesystem::path file;
  impl::JournalTables tables;
  std::int64_t seen = -1;      ///< data_version at the last load
  std::vector<Entry> applied;  ///< ids ascend
  /// Rows as they were before the change that is under way.
  std::vector<std::pair<std::int64_t, std::optional<JournalRow>>> former;
};

namespace {

Journal::Entry entry_of(std::int64_t id, const JournalRow& row) {
  return {id, row.stroke, row.muted, row.before};
}

/// Brings `applied` in line with the head. What stands before a stroke never changes, so that only the way
/// from the last common stroke is walked.
void follow(const impl::JournalTables& tables, std::vector<Journal::Entry>& applied) {
  std::vector<Journal::Entry> added;
  std::size_t kept = 0;
  for (std::int64_t id = tables.head; id != 0;) {
    const auto at = std::lower_bound(applied.begin(), applied.end(), id,
                                     [](const Journal::Entry& e, std::int64_t v) { return e.id < v; });
    if (at != applied.end() && at->id == id) {
      kept = at - applied.begin() + 1;
      break;
    }
    added.push_back(entry_of(id, tables.rows.at(id)));
    id = added.back().before;
  }
  applied.resize(kept);
  applied.insert(applied.end(), added.rbegin(), added.rend());
}

std::vector<Journal::Entry> history_of(const impl::JournalTables& tables) {
  std::vector<Journal::Entry> out;
  for (const auto& [id, row] : tables.rows)
    if (id != 0) out.push_back(entry_of(id, row));
  return out;
}

/// To be called within a transaction.
template <class State>
void load(State& state) {
  impl::JournalTables tables;
  if (const std::string damage = impl::read_tables(state, state.tables.rows, tables); !damage.empty())
    throw Error(ErrorKind::input, damage);
  state.tables = std::move(tables);
  state.applied.clear();
  state.seen = pragma(state, "pragma data_version");
  follow(state.tables, state.applied);
}

/// Under a lock of its own: another process may append between two queries.
template <class State>
void load_alone(State& state) {
  Transaction transaction(state, "begin");
  load(state);
  transaction.commit();
}

/// A process that was killed while it began to write leaves a file of SQLite's beside the journal, with
/// nothing to be rolled back in it. A change that changes nothing takes it away.
template <class State>
void clear_left_over(const State& state) {
  std::error_code code;
  if (!std::filesystem::exists(state.name + "-journal", code) || impl::is_unmade(state)) return;
  sqlite3_busy_timeout(state.db, 0);
  try {
    Transaction transaction(state);
    state.run(fmt::format("pragma user_version = {}", pragma(state, "pragma user_version")).c_str());
    transaction.commit();
  } catch (const Error&) {  // it is in use, or may not be written
  }
  sqlite3_busy_timeout(state.db, lock_wait_ms);
}

}  // namespace

Journal::Journal(std::unique_ptr<State> state) : state_(std::move(state)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;
Journal& Journal::operator=(Journal&&) noexcept = default;

namespace {

/// Takes the lock, takes over what others did, lets `change` work on the tables, and commits.
template <class State, class F>
auto change_tables(State& state, F&& change) -> decltype(change()) {
  Transaction transaction(state);
  if (pragma(state, "pragma data_version") != state.seen) load(state);
  if (impl::is_unmade(state)) impl::make_tables(state);
  const auto head = state.tables.head;
  state.former.clear();
  try {
    const auto result = change();
    transaction.commit();
    follow(state.tables, state.applied);
    return result;
  } catch (...) {
    for (auto at = state.former.rbegin(); at != state.former.rend(); ++at) {
      if (at->second)
        state.tables.rows.at(at->first) = *at->second;
      else
        state.tables.rows.erase(at->first);
    }
    state.tables.head = head;
    throw;
  }
}

template <class State>
JournalRow& touch(State& state, std::int64_t id) {
  JournalRow& row = state.tables.rows.at(id);
  state.former.emplace_back(id, row);
  return row;
}

template <class State>
void set_head(State& state, std::int64_t head) {
  Query(state, "update state set head = ?").bind(1, head).once();
  state.tables.head = head;
}

template <class State>
void set_after(State& state, std::int64_t id, std::int64_t after) {
  if (state.tables.rows.at(id).after == after) return;
  Query(state, "update stroke set after = ? where id = ?").bind(1, after).bind(2, id).once();
  touch(state, id).after = after;
}

/// A file of no bytes stands for nothing and gives way. Not so one of SQLite's beside the name: it would be
/// taken for the new journal's, and rolled back into it.
bool write_new(const std::filesystem::path& file, const impl::JournalTables& tables) {
  std::error_code code;
  const auto size = std::filesystem::file_size(file, code);
  const bool replaces = !code && size == 0;
  if (replaces) Journal::open(file);  // SQLite removes what it left with it
  if (std::filesystem::exists(file.string() + "-journal", code)) return false;
  AtomicFile out(file);
  out.write(impl::bytes_of(tables));
  if (!replaces) return out.commit_new();
  out.commit();
  return true;
}

}  // namespace

Journal Journal::open(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  state->file = file;
  state->open(file, lock_wait_ms);
  load_alone(*state);
  clear_left_over(*state);
  return Journal(std::move(state));
}

Journal Journal::open_or_create(const std::filesystem::path& file) {
  std::error_code code;
  if (!std::filesystem::exists(file, code)) make(file);
  return open(file);
}

bool Journal::make(const std::filesystem::path& file, const std::string& scene, const Journal* from) {
  impl::JournalTables tables;
  if (from) tables = from->state_->tables;
  tables.scene = scene;
  return write_new(file, tables);
}

const std::filesystem::path& Journal::file() const {
  return state_->file;
}

const std::vector<Journal::Entry>& Journal::strokes() const {
  return state_->applied;
}

std::size_t Journal::redoable() const {
  const impl::JournalRows& rows = state_->tables.rows;
  std::size_t steps = 0;
  for (std::int64_t id = rows.at(state_->tables.head).after; id != 0; id = rows.at(id).after) ++steps;
  return steps;
}

std::vector<Journal::Entry> Journal::history() const {
  return history_of(state_->tables);
}

std::int64_t Journal::append(std::span<const Stroke> strokes) {
  State& s = *state_;
  return change_tables(s, [&] {
    Query insert(s, "insert into stroke (before, text) values (?, ?)");
    for (const Stroke& stroke : strokes) {
      const std::int64_t head = s.tables.head;
      insert.bind(1, head).bind(2, to_text(stroke)).once();
      const std::int64_t id = sqlite3_last_insert_rowid(s.db);
      s.former.emplace_back(id, std::nullopt);
      s.tables.rows.emplace(id, JournalRow{head, 0, false, std::make_shared<Stroke>(stroke)});
      set_after(s, head, id);
      s.tables.head = id;
    }
    set_head(s, s.tables.head);
    return s.tables.head;
  });
}

std::size_t Journal::undo(std::size_t steps) {
  State& s = *state_;
  return change_tables(s, [&] {
    std::size_t gone = 0;
    std::int64_t head = s.tables.head;
    for (; gone < steps && head != 0; ++gone) {
      const std::int64_t before = s.tables.rows.at(head).before;
      set_after(s, before, head);
      head = before;
    }
    if (gone > 0) set_head(s, head);
    return gone;
  });
}

std::size_t Journal::redo(std::size_t steps) {
  State& s = *state_;
  return change_tables(s, [&] {
    std::size_t gone = 0;
    std::int64_t head = s.tables.head;
    for (; gone < steps && s.tables.rows.at(head).after != 0; ++gone) head = s.tables.rows.at(head).after;
    if (gone > 0) set_head(s, head);
    return gone;
  });
}

void Journal::go_to(std::int64_t id) {
  State& s = *state_;
  change_tables(s, [&] {
    const impl::JournalRows& rows = s.tables.rows;
    if (!rows.contains(id)) fail(ErrorKind::usage, "{}: has no stroke {}", s.name, id);
    for (std::int64_t at = id; at != 0; at = rows.at(at).before) set_after(s, rows.at(at).before, at);
    set_head(s, id);
    return true;
  });
}

bool Journal::mute(std::int64_t id, bool muted) {
  State& s = *state_;
  const bool changed = change_tables(s, [&] {
    if (id == 0 || !s.tables.rows.contains(id)) fail(ErrorKind::usage, "{}: has no stroke {}", s.name, id);
    Query(s, "update stroke set muted = ? where id = ?").bind(1, std::int64_t{muted}).bind(2, id).once();
    return std::exchange(touch(s, id).muted, muted) != muted;
  });
  for (Entry& entry : s.applied)
    if (entry.id == id) entry.muted = muted;
  return changed;
}

bool Journal::refresh() {
  if (pragma(*state_, "pragma data_version") == state_->seen) return false;
  load_alone(*state_);
  return true;
}

const std::string& Journal::scene() const {
  return state_->tables.scene;
}

void Journal::set_scene(const std::string& scene) {
  State& s = *state_;
  const std::string before = s.tables.scene;
  if (scene == before) return;
  change_tables(s, [&] {
    if (s.tables.scene == before) impl::set_scene(s, scene);
    return true;
  });
  load_alone(s);
}

Journal::Remains Journal::salvage(const std::filesystem::path& file, const std::filesystem::path& to) {
  impl::Database database;
  database.open(file, lock_wait_ms);
  impl::JournalTables tables;
  Remains out;
  {
    const Transaction transaction(database, "begin");
    out.damage = impl::read_tables(database, {}, tables);
  }
  out.history = history_of(tables);
  if (out.history.empty() && !out.damage.empty()) throw Error(ErrorKind::input, out.damage);
  follow(tables, out.strokes);
  out.scene = tables.scene;
  if (!to.empty() && !write_new(to, tables))
    fail(ErrorKind::usage, "{}: exists already; give a new name to save what stands", to.string());
  return out;
}

}  // namespace tafoni::scene
