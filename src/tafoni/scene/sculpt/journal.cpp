// The file holds a tree of strokes, each of which knows the one before it, and the head: the last one
// applied. A change takes the lock, takes over what other processes did, changes the tables and the copy of
// them in memory, and commits; where that fails the copy is put back as it was.
#include "tafoni/scene/sculpt/journal.h"

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>

#include <sqlite3.h>

#include "tafoni/core/error.h"
#include "tafoni/scene/sculpt/impl/database.h"

namespace tafoni::scene {
namespace {

using impl::fail_sqlite;
using impl::pragma;
using impl::Query;
using impl::Transaction;

constexpr std::int64_t application_id = 0x7461666f;  // "tafo"
constexpr std::int64_t schema_version = 1;
constexpr int lock_wait_ms = 5000;

// A stroke points to the one before it, and to the one that redo goes to from it. Row 0 is the empty
// beginning.
constexpr const char* schema = R"(
create table stroke (
  id integer primary key autoincrement,
  before integer not null,
  after integer not null default 0,
  muted integer not null default 0,
  text text not null
);
create table state (head integer not null);
insert into stroke (id, before, text) values (0, 0, '');
insert into state (head) values (0);
)";

struct Row {
  std::int64_t before = 0, after = 0;
  bool muted = false;
  std::shared_ptr<const Stroke> stroke;
};

}  // namespace

struct Journal::State : impl::Database {
  std::filesystem::path file;
  std::unordered_map<std::int64_t, Row> rows;
  std::int64_t head = 0;
  std::int64_t seen = -1;      ///< data_version at the last load
  std::vector<Entry> applied;  ///< ids ascend
  /// Rows as they were before the change that is under way.
  std::vector<std::pair<std::int64_t, std::optional<Row>>> former;
};

namespace {

/// Brings `applied` in line with the head. What stands before a stroke never changes, so that only the way
/// from the last common stroke is walked.
template <class State>
void follow(State& state) {
  std::vector<Journal::Entry> added;
  std::size_t kept = 0;
  for (std::int64_t id = state.head; id != 0;) {
    const auto at = std::lower_bound(state.applied.begin(), state.applied.end(), id,
                                     [](const Journal::Entry& e, std::int64_t v) { return e.id < v; });
    if (at != state.applied.end() && at->id == id) {
      kept = at - state.applied.begin() + 1;
      break;
    }
    const auto found = state.rows.find(id);
    // An id is larger than the one before it: a chain that is not so would never end.
    if (found == state.rows.end() || found->second.before >= id)
      fail_sqlite(state.name, SQLITE_CORRUPT, fmt::format("stroke {} is missing", id));
    added.push_back({id, found->second.stroke, found->second.muted});
    id = found->second.before;
  }
  state.applied.resize(kept);
  state.applied.insert(state.applied.end(), added.rbegin(), added.rend());
}

/// To be called within a transaction.
template <class State>
void load(State& state) {
  std::unordered_map<std::int64_t, Row> rows;
  Query query(state, "select id, before, after, muted, text from stroke");
  while (query.step()) {
    Row row{query.integer(1), query.integer(2), query.integer(3) != 0, nullptr};
    const std::int64_t id = query.integer(0);
    if (id != 0) {
      const std::string where = fmt::format("{}: stroke {}", state.name, id);
      const auto known = state.rows.find(id);
      try {
        row.stroke = known != state.rows.end() ? known->second.stroke
                                               : std::make_shared<Stroke>(parse_stroke(query.text(4), where));
      } catch (const Error& error) {
        const std::string_view what = error.what();
        if (what.starts_with(where)) throw Error(ErrorKind::input, error.what());
        fail(ErrorKind::input, "{}: {}", where, what);
      }
    }
    rows.emplace(id, std::move(row));
  }
  Query head(state, "select head from state");
  if (!rows.contains(0) || !head.step()) fail_sqlite(state.name, SQLITE_CORRUPT, "its beginning is missing");
  state.rows = std::move(rows);
  state.head = head.integer(0);
  state.applied.clear();
  state.seen = pragma(state, "pragma data_version");
  follow(state);
}

/// Under a lock of its own: another process may append between two queries.
template <class State>
void load_alone(State& state) {
  Transaction transaction(state, "begin");
  load(state);
  transaction.commit();
}

/// Makes the tables of a new file; of two processes that do so at once, one finds it done.
template <class State>
void prepare(State& state, bool create) {
  const auto fresh = [&] {
    return pragma(state, "pragma application_id") == 0 && pragma(state, "pragma schema_version") == 0;
  };
  if (create && fresh()) {
    Transaction transaction(state);
    if (fresh()) {
      state.run(schema);
      state.run(
          fmt::format("pragma application_id = {}; pragma user_version = {}", application_id, schema_version)
              .c_str());
    }
    transaction.commit();
  }
  if (pragma(state, "pragma application_id") != application_id) fail_sqlite(state.name, SQLITE_NOTADB, "");
  const std::int64_t version = pragma(state, "pragma user_version");
  if (version != schema_version)
    fail(ErrorKind::input,
         "{}: is a journal of version {}, and this program knows version {}; use a newer one", state.name,
         version, schema_version);
  Query sound(state, "pragma quick_check(1)");
  if (!sound.step() || sound.text(0) != "ok") fail_sqlite(state.name, SQLITE_CORRUPT, sound.text(0));
}

}  // namespace

Journal::Journal(std::unique_ptr<State> state) : state_(std::move(state)) {}
Journal::~Journal() = default;
Journal::Journal(Journal&&) noexcept = default;
Journal& Journal::operator=(Journal&&) noexcept = default;

namespace {

template <class State>
void open_state(State& state, const std::filesystem::path& file, bool create) {
  state.file = file;
  state.name = file.string();
  std::error_code code;
  const bool there = std::filesystem::exists(file, code);
  if (!there && !create)
    fail(ErrorKind::input, "{}: does not exist; make it with tafoni sculpt, or check the layer's journal key",
         state.name);
  if (std::filesystem::is_directory(file, code))
    fail(ErrorKind::input, "{}: is a folder, no sculpt journal", state.name);
  // Reading may have to roll back what a killed process left, so it asks for write access too; SQLite falls
  // back to reading alone where the file or the disk forbids writing.
  const int flags = SQLITE_OPEN_READWRITE | (create ? SQLITE_OPEN_CREATE : 0);
  int opened = sqlite3_open_v2(state.name.c_str(), &state.db, flags, nullptr);
  if (opened != SQLITE_OK && there) {
    sqlite3_close(state.db);
    state.db = nullptr;
    opened = sqlite3_open_v2(state.name.c_str(), &state.db, SQLITE_OPEN_READONLY, nullptr);
  }
  state.check(opened);
  sqlite3_extended_result_codes(state.db, 1);
  sqlite3_busy_timeout(state.db, lock_wait_ms);
  // EXTRA also syncs the folder, so that a finished stroke outlives a power cut.
  state.run("pragma synchronous = extra; pragma trusted_schema = off; pragma cell_size_check = on");
  prepare(state, create);
  load_alone(state);
}

/// Takes the lock, takes over what others did, lets `change` work on the tables, and commits.
template <class State, class F>
auto change_tables(State& state, F&& change) -> decltype(change()) {
  Transaction transaction(state);
  if (pragma(state, "pragma data_version") != state.seen) load(state);
  const auto head = state.head;
  state.former.clear();
  try {
    const auto result = change();
    transaction.commit();
    follow(state);
    return result;
  } catch (...) {
    for (auto at = state.former.rbegin(); at != state.former.rend(); ++at) {
      if (at->second)
        state.rows.at(at->first) = *at->second;
      else
        state.rows.erase(at->first);
    }
    state.head = head;
    throw;
  }
}

template <class State>
Row& touch(State& state, std::int64_t id) {
  Row& row = state.rows.at(id);
  state.former.emplace_back(id, row);
  return row;
}

template <class State>
void set_head(State& state, std::int64_t head) {
  Query(state, "update state set head = ?").bind(1, head).once();
  state.head = head;
}

template <class State>
void set_after(State& state, std::int64_t id, std::int64_t after) {
  if (state.rows.at(id).after == after) return;
  Query(state, "update stroke set after = ? where id = ?").bind(1, after).bind(2, id).once();
  touch(state, id).after = after;
}

}  // namespace

Journal Journal::open(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  open_state(*state, file, false);
  return Journal(std::move(state));
}

Journal Journal::open_or_create(const std::filesystem::path& file) {
  auto state = std::make_unique<State>();
  open_state(*state, file, true);
  return Journal(std::move(state));
}

const std::filesystem::path& Journal::file() const {
  return state_->file;
}

const std::vector<Journal::Entry>& Journal::strokes() const {
  return state_->applied;
}

std::size_t Journal::redoable() const {
  std::size_t steps = 0;
  for (std::int64_t id = state_->rows.at(state_->head).after; id != 0; id = state_->rows.at(id).after)
    ++steps;
  return steps;
}

std::vector<Journal::Entry> Journal::history() const {
  std::vector<Entry> out;
  for (const auto& [id, row] : state_->rows)
    if (id != 0) out.push_back({id, row.stroke, row.muted});
  std::sort(out.begin(), out.end(), [](const Entry& a, const Entry& b) { return a.id < b.id; });
  return out;
}

std::int64_t Journal::append(std::span<const Stroke> strokes) {
  State& s = *state_;
  return change_tables(s, [&] {
    Query insert(s, "insert into stroke (before, text) values (?, ?)");
    for (const Stroke& stroke : strokes) {
      insert.bind(1, s.head).bind(2, to_text(stroke)).once();
      const std::int64_t id = sqlite3_last_insert_rowid(s.db);
      s.former.emplace_back(id, std::nullopt);
      s.rows.emplace(id, Row{s.head, 0, false, std::make_shared<Stroke>(stroke)});
      set_after(s, s.head, id);
      s.head = id;
    }
    set_head(s, s.head);
    return s.head;
  });
}

std::size_t Journal::undo(std::size_t steps) {
  State& s = *state_;
  return change_tables(s, [&] {
    std::size_t gone = 0;
    std::int64_t head = s.head;
    for (; gone < steps && head != 0; ++gone) {
      const std::int64_t before = s.rows.at(head).before;
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
    std::int64_t head = s.head;
    for (; gone < steps && s.rows.at(head).after != 0; ++gone) head = s.rows.at(head).after;
    if (gone > 0) set_head(s, head);
    return gone;
  });
}

void Journal::go_to(std::int64_t id) {
  State& s = *state_;
  change_tables(s, [&] {
    if (!s.rows.contains(id)) fail(ErrorKind::usage, "{}: has no stroke {}", s.name, id);
    for (std::int64_t at = id; at != 0; at = s.rows.at(at).before) set_after(s, s.rows.at(at).before, at);
    set_head(s, id);
    return true;
  });
}

void Journal::mute(std::int64_t id, bool muted) {
  State& s = *state_;
  change_tables(s, [&] {
    if (id == 0 || !s.rows.contains(id)) fail(ErrorKind::usage, "{}: has no stroke {}", s.name, id);
    Query(s, "update stroke set muted = ? where id = ?").bind(1, std::int64_t{muted}).bind(2, id).once();
    touch(s, id).muted = muted;
    return true;
  });
  for (Entry& entry : s.applied)
    if (entry.id == id) entry.muted = muted;
}

bool Journal::refresh() {
  if (pragma(*state_, "pragma data_version") == state_->seen) return false;
  load_alone(*state_);
  return true;
}

}  // namespace tafoni::scene
