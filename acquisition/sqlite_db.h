// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "core/result.h"

struct sqlite3;
struct sqlite3_stmt;

namespace dubsar {

/// One prepared statement. Bind by position from 1, read columns from 0. Belongs to its Database.
class SqlStatement {
 public:
  SqlStatement(sqlite3* db, sqlite3_stmt* statement, std::string where);

  SqlStatement& bind(int at, std::int64_t value);
  SqlStatement& bind(int at, int value) { return bind(at, static_cast<std::int64_t>(value)); }
  SqlStatement& bind(int at, double value);
  SqlStatement& bind(int at, std::string_view text);
  SqlStatement& bind_blob(int at, std::string_view bytes);

  /// True: a row stands ready. False: done; the statement is reset and can be bound anew.
  [[nodiscard]] Result<bool> step();
  /// Runs a statement that gives no rows.
  Status run();

  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double number(int column) const;
  [[nodiscard]] std::string text(int column) const;
  /// Binds the value of a column of another statement as it is.
  SqlStatement& bind_column(int at, const SqlStatement& from, int column);

 private:
  struct Finalizer {
    void operator()(sqlite3_stmt* statement) const;
  };
  sqlite3* db_;
  std::unique_ptr<sqlite3_stmt, Finalizer> statement_;
  std::string where_;
};

/// An SQLite database behind Result. Damaged content gives ErrorKind::kBadInput, what the disk refuses
/// ErrorKind::kStorage. Adds the SQL function dubsar_sum(a, b, …), an XXH64 over types and bytes of its
/// arguments, so that a row can carry the checksum of its content: SQLite itself does not notice a flipped
/// bit in a value.
class SqlDatabase {
 public:
  enum class Mode {
    kCreate,     ///< read and write, made when missing
    kReadOnly,   ///< sees what a writer has written ahead
    kImmutable,  ///< reads the file alone: no lock, no file beside it
    kMemory,     ///< path is only a name
  };
  [[nodiscard]] static Result<SqlDatabase> open(const std::filesystem::path& path, Mode mode);

  Status execute(const char* sql);
  [[nodiscard]] Result<SqlStatement> prepare(const char* sql);
  /// Replaces the content by that of another database, page by page.
  Status copy_from(SqlDatabase& source);
  /// Empty when SQLite finds its structure whole, else the first fault.
  [[nodiscard]] std::string structure_fault();
  /// The first faults that SQLite finds in its structure or, with a name, in that of a table and its indexes.
  [[nodiscard]] Result<std::vector<std::string>> structure_faults(int most, const char* table = nullptr);
  /// Whether a log stays as it is when this is closed. Otherwise the last one to close merges it into the
  /// file and removes it.
  void keep_log(bool keep);
  /// Of a copy in memory, whose tables are to be described otherwise.
  void allow_changes_of_schema();
  /// The first value of the first row; 0 without one.
  [[nodiscard]] Result<std::int64_t> integer_of(const char* sql);

 private:
  struct Closer {
    void operator()(sqlite3* db) const;
  };
  SqlDatabase(sqlite3* db, std::string where) : db_(db), where_(std::move(where)) {}
  std::unique_ptr<sqlite3, Closer> db_;
  std::string where_;
};

/// Rolls back when it goes without commit().
class SqlTransaction {
 public:
  [[nodiscard]] static Result<SqlTransaction> begin(SqlDatabase& db);
  Status commit();
  ~SqlTransaction();
  SqlTransaction(SqlTransaction&& other) noexcept : db_(std::exchange(other.db_, nullptr)) {}
  SqlTransaction& operator=(SqlTransaction&&) = delete;
  SqlTransaction(const SqlTransaction&) = delete;
  SqlTransaction& operator=(const SqlTransaction&) = delete;

 private:
  explicit SqlTransaction(SqlDatabase* db) : db_(db) {}
  SqlDatabase* db_;
};

}  // namespace dubsar
