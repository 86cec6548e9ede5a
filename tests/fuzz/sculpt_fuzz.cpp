// Any rows in the tables of a sculpt journal: SQLite reads the file, but what its rows say is ours to judge.
// The lines of an input are rows, id|before|after|muted|text; of one field, the last stroke applied; of two,
// a table and what is done to it; and "scene=PATH". A journal that is sound can be walked; of a damaged one
// what stands is sound.

#include <algorithm>
#include <charconv>
#include <iterator>
#include <memory>
#include <set>

#include "fuzz.h"
#include <sqlite3.h>

#include "tafoni/scene/sculpt/journal.h"

using namespace tafoni;
using scene::Journal;

std::vector<std::string> fuzz_seeds() {
  return {
      "0|0|1|0|\n1|0|2|0|sphere at=1,2,3\n2|1|3|1|cave at=1,2,3/4,5,6\n3|2|0|0|sphere at=3,2,1\n3\n"
      "scene=a.toml\n",
      "0|0|4|0|\n1|0|0|0|sphere at=1,2,3\n2|1|0|0|sphere at=2,2,3\n4|0|5|0|sphere at=4,2,3\n"
      "5|4|0|0|sphere at=5,2,3\n2\n",
      "0|0|0|0|\n0\nscene=\n", "0|0|1|0|\n1|0|0|null|sphere at=1,2,3\n1\n1\nstate|0\nscene|1\n"};
}

namespace {

class Sqlite {
 public:
  /// A copy of the journal in memory.
  explicit Sqlite(const std::string& bytes) {
    require(sqlite3_open(":memory:", &db_) == SQLITE_OK);
    auto* const copy = static_cast<unsigned char*>(sqlite3_malloc64(bytes.size()));
    std::memcpy(copy, bytes.data(), bytes.size());
    const auto size = static_cast<sqlite3_int64>(bytes.size());
    require(sqlite3_deserialize(db_, "main", copy, size, size,
                                SQLITE_DESERIALIZE_FREEONCLOSE | SQLITE_DESERIALIZE_RESIZEABLE) == SQLITE_OK);
  }
  ~Sqlite() { sqlite3_close(db_); }
  Sqlite(const Sqlite&) = delete;
  Sqlite& operator=(const Sqlite&) = delete;

  /// What SQLite refuses is not done.
  void run(const char* sql, std::initializer_list<std::string_view> fields = {}) {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(db_, sql, -1, &statement, nullptr) != SQLITE_OK) return;
    int at = 0;
    for (const std::string_view field : fields) bind(statement, ++at, field);
    sqlite3_step(statement);
    sqlite3_finalize(statement);
  }
  std::string bytes() const {
    sqlite3_int64 size = 0;
    const std::unique_ptr<unsigned char, void (*)(void*)> out(sqlite3_serialize(db_, "main", &size, 0),
                                                              &sqlite3_free);
    return {reinterpret_cast<const char*>(out.get()), static_cast<std::size_t>(size)};
  }

 private:
  /// A whole number, a number, nothing, or text.
  static void bind(sqlite3_stmt* statement, int at, std::string_view field) {
    const char* const end = field.data() + field.size();
    std::int64_t whole = 0;
    double number = 0;
    if (field.empty())  // whose bytes may lie nowhere, which would be nothing
      sqlite3_bind_text(statement, at, "", 0, SQLITE_STATIC);
    else if (field == "null")
      sqlite3_bind_null(statement, at);
    else if (const auto [at_end, code] = std::from_chars(field.data(), end, whole);
             at_end == end && code == std::errc())
      sqlite3_bind_int64(statement, at, whole);
    else if (std::from_chars(field.data(), end, number).ptr == end)
      sqlite3_bind_double(statement, at, number);
    else
      sqlite3_bind_text(statement, at, field.data(), static_cast<int>(field.size()), SQLITE_TRANSIENT);
  }

  sqlite3* db_ = nullptr;
};

void put_line(Sqlite& database, std::string_view line) {
  if (line.starts_with("scene=")) return database.run("insert into scene values (?)", {line.substr(6)});
  std::string_view field[5];
  std::size_t fields = 0;
  for (; fields < 5 && !line.empty(); ++fields) field[fields] = take_until(line, '|');
  if (fields >= 4)
    database.run("insert or replace into stroke (id, before, after, muted, text) values (?, ?, ?, ?, ?)",
                 {field[0], field[1], field[2], field[3], field[4]});
  if (fields == 1) database.run("insert into state values (?)", {field[0]});
  if (fields == 2) {
    const std::string table(field[0]), name = "\"" + table + "\"";
    if (table.find_first_of(std::string_view("\"\0", 2)) != std::string::npos) return;
    database.run((field[1] == "0" ? "delete from " + name : "drop table " + name).c_str());
  }
}

/// Ids ascend, each stroke stands on one that is there, and those applied are a chain from the beginning.
void check_strokes(const std::vector<Journal::Entry>& history, const std::vector<Journal::Entry>& applied) {
  std::set<std::int64_t> known = {0};
  for (const Journal::Entry& entry : history) {
    require(entry.stroke && entry.id > *known.rbegin() && known.contains(entry.before));
    known.insert(entry.id);
  }
  std::int64_t last = 0;
  for (const Journal::Entry& entry : applied) {
    require(known.contains(entry.id) && entry.before == last);
    last = entry.id;
  }
}

/// Goes all ways; the file must say the same in the end.
void walk(const std::filesystem::path& file) {
  Journal journal = Journal::open(file);
  const auto history = journal.history();
  const std::size_t there = journal.strokes().size(), further = journal.redoable();
  check_strokes(history, journal.strokes());
  require(further <= history.size());
  require(journal.redo(history.size() + 1) == further && journal.undo(history.size() + 1) == there + further);
  for (const Journal::Entry& entry : history) {
    journal.go_to(entry.id);
    require(journal.strokes().back().id == entry.id);
  }
  journal.append(scene::parse_stroke("sphere at=1,2,3", "fuzz"));
  const Journal again = Journal::open(file);
  require(again.history().size() == history.size() + 1 && again.redoable() == 0);
  check_strokes(again.history(), again.strokes());
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const FuzzFolder folder;
  static const std::string empty = [] {
    Journal::make(folder / "empty.journal");
    std::ifstream in(folder / "empty.journal", std::ios::binary);
    return std::string{std::istreambuf_iterator<char>(in), {}};
  }();
  Sqlite database(empty);
  database.run("delete from stroke");
  database.run("delete from state");
  for (std::string_view text = as_text(data, size); !text.empty();)
    put_line(database, take_until(text, '\n'));
  const std::filesystem::path file = folder.write("a.journal", database.bytes());

  bool sound = false;
  const bool stands = accepts([&] {
    const Journal::Remains remains = Journal::salvage(file);
    check_strokes(remains.history, remains.strokes);
    sound = remains.damage.empty();
  });
  require(accepts([&] { Journal::open(file); }) == sound);
  // Each step of a walk is on the disk before it returns, which takes its time: some must do.
  if (sound && size % 8 == 0) walk(file);
  if (stands && !sound) {
    const std::filesystem::path saved = folder / "saved.journal";
    std::filesystem::remove(saved);
    Journal::salvage(file, saved);
    const Journal journal = Journal::open(saved);
    check_strokes(journal.history(), journal.strokes());
  }
  return 0;
}
