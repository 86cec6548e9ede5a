// A file may be from anyone, so nothing in it is believed: its tables must be made as this program makes
// them, without triggers, views and computed columns, and every stroke must point to earlier and later ones
// alone.

#include "tafoni/scene/sculpt/impl/journal_tables.h"

#include <map>
#include <string_view>
#include <utility>

#include "tafoni/core/error.h"

namespace tafoni::scene::impl {
namespace {

constexpr std::int64_t application_id = 0x7461666f;  // "tafo"
constexpr std::int64_t schema_version = 1;

constexpr const char* strokes_and_state = R"(
create table stroke (
  id integer primary key autoincrement,
  before integer not null,
  after integer not null default 0,
  muted integer not null default 0,
  text text not null
);
create table state (head integer not null);
)";
// Journals of earlier programs lack it, and those programs overlook it.
constexpr const char* scene_table = "create table if not exists scene (file text not null)";

/// An empty database in memory.
struct InMemory : Database {
  InMemory() {
    name = "a journal in memory";
    check(sqlite3_open_v2(":memory:", &db, SQLITE_OPEN_READWRITE | SQLITE_OPEN_MEMORY, nullptr));
  }
};

using Schema = std::map<std::string, std::string>;

Schema schema_of(const Database& database) {
  Schema out;
  Query query(database, "select type || ' ' || name, sql from sqlite_master");
  while (query.step()) out.emplace(query.text(0), query.text(1));
  return out;
}

/// Throws Error{input} for a file that is no journal, of another version, or made by someone else.
void check_schema(const Database& database) {
  if (pragma(database, "pragma application_id") != application_id)
    fail_sqlite(database.name, SQLITE_NOTADB, "");
  const std::int64_t version = pragma(database, "pragma user_version");
  if (version != schema_version)
    fail(ErrorKind::input,
         "{}: is a journal of version {}, and this program knows version {}; use a newer one", database.name,
         version, schema_version);
  static const Schema known = [] {
    const InMemory made;
    make_tables(made);
    return schema_of(made);
  }();
  Schema schema = schema_of(database);
  schema.insert(*known.find("table scene"));
  if (schema != known) fail_sqlite(database.name, SQLITE_CORRUPT, "its tables are not those of a journal");
}

void check_pages(const Database& database) {
  Query sound(database, "pragma quick_check(1)");
  if (!sound.step() || sound.text(0) != "ok") fail_sqlite(database.name, SQLITE_CORRUPT, sound.text(0));
}

[[noreturn]] void fail_damaged(const Database& database, const std::string& what) {
  fail_sqlite(database.name, SQLITE_CORRUPT, what);
}

void read_row(const Database& database, const Query& query, const JournalRows& known, JournalRows& rows) {
  const std::int64_t id = query.integer(0);
  JournalRow row{query.integer(1), query.integer(2), query.integer(3) != 0, nullptr};
  if (id == 0) {
    rows[0].after = row.after;
    return;
  }
  // Strokes come by ascending ids, so that whatever a stroke stands on is here, and no chain has a circle.
  if (id < 0 || row.before < 0 || row.before >= id || !rows.contains(row.before))
    fail_damaged(database, fmt::format("stroke {} stands on {}, which is no earlier one", id, row.before));
  if (const auto found = known.find(id); found != known.end()) {
    row.stroke = found->second.stroke;
  } else {
    const std::string where = fmt::format("{}: stroke {}", database.name, id);
    try {
      row.stroke = std::make_shared<Stroke>(parse_stroke(query.text(4), where));
    } catch (const Error& error) {
      const std::string_view what = error.what();
      if (what.starts_with(where)) throw Error(ErrorKind::input, error.what());
      fail(ErrorKind::input, "{}: {}", where, what);
    }
  }
  rows.emplace(id, std::move(row));
}

/// Lets redo lead nowhere from where it would not lead to a stroke that stands on this one.
void check_after(const Database& database, JournalRows& rows, std::string& damage) {
  for (auto& [id, row] : rows) {
    if (row.after == 0) continue;
    const auto next = rows.find(row.after);
    if (next != rows.end() && next->first != 0 && next->second.before == id) continue;
    if (damage.empty())
      damage = fmt::format(
          "{}: is damaged (stroke {} leads on to {}, which does not stand on it); restore it "
          "from a copy",
          database.name, id, row.after);
    row.after = 0;
  }
}

void read_head(const Database& database, JournalTables& tables, std::string& damage) {
  std::int64_t head = -1;
  try {
    Query query(database, "select head from state");
    if (query.step()) head = query.integer(0);
    if (!tables.rows.contains(head) || query.step())
      fail_damaged(database, fmt::format("stroke {}, the last one, is missing", head));
  } catch (const Error& error) {
    if (damage.empty()) damage = error.what();
    head = tables.rows.rbegin()->first;
  }
  tables.head = head;
}

void read_scene(const Database& database, JournalTables& tables, std::string& damage) {
  try {
    if (Query there(database, "select 1 from sqlite_master where name = 'scene'"); !there.step()) return;
    Query query(database, "select file from scene");
    if (query.step()) tables.scene = query.text(0);
  } catch (const Error& error) {
    if (damage.empty()) damage = error.what();
  }
}

}  // namespace

bool is_unmade(const Database& database) {
  // Not its size: a write that has begun has made a page.
  return pragma(database, "pragma application_id") == 0 &&
         pragma(database, "select count(*) from sqlite_master") == 0;
}

void make_tables(const Database& database) {
  database.run(strokes_and_state);
  database.run(scene_table);
  database.run(
      "insert into stroke (id, before, text) values (0, 0, ''); insert into state (head) values (0)");
  database.run(
      fmt::format("pragma application_id = {}; pragma user_version = {}", application_id, schema_version)
          .c_str());
}

std::string read_tables(const Database& database, const JournalRows& known, JournalTables& tables) {
  tables = {};
  std::string damage;
  const auto note = [&](const auto& read) {
    try {
      read();
    } catch (const Error& error) {
      // A lock, or a disk that does not answer, is no damage of the file.
      if (error.kind() != ErrorKind::input) throw;
      if (damage.empty()) damage = error.what();
    }
  };
  bool unmade = false;
  note([&] {
    unmade = is_unmade(database);
    if (!unmade) check_schema(database);
  });
  if (unmade || !damage.empty()) return damage;  // reading what others made may never end
  note([&] { check_pages(database); });
  bool begins = false;
  note([&] {
    Query query(database, "select id, before, after, muted, text from stroke order by id");
    while (query.step()) {
      begins = begins || query.integer(0) == 0;
      read_row(database, query, known, tables.rows);
    }
    if (!begins) fail_damaged(database, "its beginning is missing");
  });
  check_after(database, tables.rows, damage);
  read_head(database, tables, damage);
  read_scene(database, tables, damage);
  return damage;
}

void set_scene(const Database& database, const std::string& scene) {
  database.run(scene_table);
  database.run("delete from scene");
  Query(database, "insert into scene (file) values (?)").bind(1, scene).once();
}

std::string bytes_of(const JournalTables& tables) {
  const InMemory made;
  Transaction transaction(made);
  make_tables(made);
  Query insert(made, "insert or replace into stroke (id, before, after, muted, text) values (?, ?, ?, ?, ?)");
  for (const auto& [id, row] : tables.rows)
    insert.bind(1, id)
        .bind(2, row.before)
        .bind(3, row.after)
        .bind(4, std::int64_t{row.muted})
        .bind(5, row.stroke ? to_text(*row.stroke) : std::string())
        .once();
  Query(made, "update state set head = ?").bind(1, tables.head).once();
  if (!tables.scene.empty()) set_scene(made, tables.scene);
  transaction.commit();
  sqlite3_int64 size = 0;
  const std::unique_ptr<unsigned char, void (*)(void*)> bytes(sqlite3_serialize(made.db, "main", &size, 0),
                                                              &sqlite3_free);
  if (!bytes) fail(ErrorKind::internal, "a journal could not be made in memory");
  return {reinterpret_cast<const char*>(bytes.get()), static_cast<std::size_t>(size)};
}

}  // namespace tafoni::scene::impl
