#include "tafoni/scene/sculpt/impl/database.h"

#include <utility>

#include "tafoni/core/error.h"

namespace tafoni::scene::impl {

[[noreturn]] void fail_sqlite(const std::string& name, int code, const std::string& detail) {
  switch (code & 0xff) {
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      fail(ErrorKind::output, "{}: is in use by another program; try again when that has finished", name);
    case SQLITE_READONLY:
    case SQLITE_PERM:
      fail(ErrorKind::output, "{}: cannot be written; check the permissions of the file and its folder",
           name);
    case SQLITE_FULL:
      fail(ErrorKind::output, "{}: cannot grow, the disk is full; nothing was changed", name);
    case SQLITE_IOERR:
      fail(ErrorKind::output, "{}: cannot be written or read ({}); check the disk's space and health", name,
           detail);
    case SQLITE_NOTADB:
      fail(ErrorKind::input, "{}: is no sculpt journal; check the path, or the layer's journal key", name);
    case SQLITE_CORRUPT:
      fail(ErrorKind::input, "{}: is damaged ({}); restore it from a copy, or see tafoni journal", name,
           detail);
    case SQLITE_CANTOPEN:
      fail(ErrorKind::output, "{}: cannot be opened; check that its folder exists and may be written", name);
    default:
      fail(ErrorKind::input, "{}: {}", name, detail);
  }
}

void Database::open(const std::filesystem::path& file, int lock_wait_ms) {
  name = file.string();
  std::error_code code;
  if (std::filesystem::is_directory(file, code))
    fail(ErrorKind::input, "{}: is a folder, no sculpt journal", name);
  if (!std::filesystem::exists(file, code))
    fail(ErrorKind::input, "{}: does not exist; make it with tafoni sculpt, or check the layer's journal key",
         name);
  if (!std::filesystem::is_regular_file(file, code)) fail_sqlite(name, SQLITE_NOTADB, "");
  // Reading may have to roll back what a killed process left, so it asks for write access too; SQLite falls
  // back to reading alone where the file or the disk forbids writing.
  int opened = sqlite3_open_v2(name.c_str(), &db, SQLITE_OPEN_READWRITE, nullptr);
  if (opened != SQLITE_OK) {
    sqlite3_close(std::exchange(db, nullptr));
    opened = sqlite3_open_v2(name.c_str(), &db, SQLITE_OPEN_READONLY, nullptr);
  }
  check(opened);
  sqlite3_extended_result_codes(db, 1);
  sqlite3_busy_timeout(db, lock_wait_ms);
  // EXTRA also syncs the folder, so that a finished stroke outlives a power cut.
  run("pragma synchronous = extra; pragma trusted_schema = off; pragma cell_size_check = on");
}

void Database::check(int code) const {
  if (code != SQLITE_OK && code != SQLITE_ROW && code != SQLITE_DONE)
    fail_sqlite(name, code, db ? sqlite3_errmsg(db) : sqlite3_errstr(code));
}

Query::Query(const Database& database, const char* sql) : database_(database) {
  database_.check(sqlite3_prepare_v2(database.db, sql, -1, &statement_, nullptr));
}

std::int64_t pragma(const Database& database, const char* name) {
  Query query(database, name);
  return query.step() ? query.integer(0) : 0;
}

}  // namespace tafoni::scene::impl
