#pragma once
// A thin layer over SQLite: every error is the sentence that the user gets to read.

#include <cstdint>
#include <filesystem>
#include <string>

#include <sqlite3.h>

namespace tafoni::scene::impl {

/// Throws Error: what SQLite's `code` means for the file `name`, and what to do.
[[noreturn]] void fail_sqlite(const std::string& name, int code, const std::string& detail);

/// An open database, which is closed at the end of its life.
struct Database {
  std::string name;  ///< for messages
  sqlite3* db = nullptr;

  Database() = default;
  ~Database() { sqlite3_close(db); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;
  /// Opens a file that exists, for reading and, where permitted, for writing; waits that long for others.
  void open(const std::filesystem::path& file, int lock_wait_ms);
  /// Throws where the code is that of an error.
  void check(int code) const;
  void run(const char* sql) const { check(sqlite3_exec(db, sql, nullptr, nullptr, nullptr)); }
};

/// A prepared statement, with its parameters and the row it stands at.
class Query {
 public:
  /// The database must outlive it.
  Query(const Database& database, const char* sql);
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  Query& bind(int at, std::int64_t v) {
    database_.check(sqlite3_bind_int64(statement_, at, v));
    return *this;
  }
  Query& bind(int at, const std::string& v) {
    database_.check(
        sqlite3_bind_text(statement_, at, v.data(), static_cast<int>(v.size()), SQLITE_TRANSIENT));
    return *this;
  }
  /// False when there are no more rows.
  bool step() {
    const int code = sqlite3_step(statement_);
    database_.check(code);
    return code == SQLITE_ROW;
  }
  void once() {
    step();
    database_.check(sqlite3_reset(statement_));
  }
  std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) const {
    const auto* v = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return v ? std::string(v, sqlite3_column_bytes(statement_, column)) : std::string();
  }

 private:
  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

std::int64_t pragma(const Database& database, const char* name);

/// What was read and changed under one lock; rolled back unless committed.
class Transaction {
 public:
  explicit Transaction(const Database& database, const char* begin = "begin immediate")
      : database_(database) {
    database.run(begin);
  }
  ~Transaction() {
    if (open_) sqlite3_exec(database_.db, "rollback", nullptr, nullptr, nullptr);
  }
  Transaction(const Transaction&) = delete;
  Transaction& operator=(const Transaction&) = delete;
  void commit() {
    database_.run("commit");
    open_ = false;
  }

 private:
  const Database& database_;
  bool open_ = true;
};

}  // namespace tafoni::scene::impl
