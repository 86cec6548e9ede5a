#include "tafoni/scene/sculpt/impl/database.h"

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
      fail(ErrorKind::input, "{}: is no sculpt journal; check the layer's journal key", name);
    case SQLITE_CORRUPT:
      fail(ErrorKind::input, "{}: is damaged ({}); restore it from a copy", name, detail);
    case SQLITE_CANTOPEN:
      fail(ErrorKind::output, "{}: cannot be opened; check that its folder exists and may be written", name);
    default:
      fail(ErrorKind::input, "{}: {}", name, detail);
  }
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
