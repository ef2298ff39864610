// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/sqlite_db.h"

#include <sqlite3.h>
// The checksum's state lives on the stack: SQLite calls for every row.
#define XXH_STATIC_LINKING_ONLY
#include <xxhash.h>

#include <cstdio>

namespace dubsar {

namespace {

/// Another program (a backup, a shell) may hold the file for a moment.
constexpr int kBusyTimeoutMs = 3000;

Error error_of(sqlite3* db, int code, const std::string& where) {
  const std::string why = db != nullptr ? sqlite3_errmsg(db) : sqlite3_errstr(code);
  switch (code & 0xff) {
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return {ErrorKind::kBadInput, "the database is damaged (" + why + ")", where,
              "open the session for writing to have it rebuilt from its grids"};
    case SQLITE_FULL:
      return {ErrorKind::kStorage, "the disk is full", where,
              "free some space and go on; nothing stored is lost"};
    case SQLITE_READONLY:
    case SQLITE_PERM:
    case SQLITE_AUTH:
      return {ErrorKind::kStorage, "the session is write-protected", where,
              "give yourself the right to write there or copy the session"};
    case SQLITE_CANTOPEN:
      return {ErrorKind::kStorage, "cannot open the database (" + why + ")", where,
              "see that the folder exists and may be written to"};
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return {ErrorKind::kStorage, "another program holds the database", where,
              "close that program and try again"};
    case SQLITE_IOERR:
      return {ErrorKind::kStorage, "the disk refused (" + why + ")", where,
              "see whether it is full or failing; nothing stored is lost"};
    default:
      return {ErrorKind::kInternal, "database error " + std::to_string(code) + " (" + why + ")", where, {}};
  }
}

void checksum(sqlite3_context* context, int count, sqlite3_value** values) {
  XXH64_state_t state;
  XXH64_reset(&state, 0);
  const auto feed = [&](char type, const void* bytes, std::uint64_t size) {
    XXH64_update(&state, &type, 1);
    XXH64_update(&state, &size, sizeof size);
    if (size > 0) {
      XXH64_update(&state, bytes, size);
    }
  };
  for (int i = 0; i < count; ++i) {
    switch (sqlite3_value_type(values[i])) {
      case SQLITE_INTEGER: {
        const std::int64_t value = sqlite3_value_int64(values[i]);
        feed('i', &value, sizeof value);
        break;
      }
      case SQLITE_FLOAT: {
        const double value = sqlite3_value_double(values[i]);
        feed('f', &value, sizeof value);
        break;
      }
      case SQLITE_NULL:
        feed('n', nullptr, 0);
        break;
      default: {
        const void* bytes = sqlite3_value_blob(values[i]);
        feed('b', bytes, static_cast<std::uint64_t>(sqlite3_value_bytes(values[i])));
        break;
      }
    }
  }
  sqlite3_result_int64(context, static_cast<std::int64_t>(XXH64_digest(&state)));
}

/// A path as an SQLite URI file name. With an empty authority: of a path that begins with two slashes the
/// first part would be taken for one.
std::string uri_of(const std::filesystem::path& path, const char* query) {
  std::string out = "file://";
  for (const char c : std::filesystem::absolute(path).string()) {
    if (c == '%' || c == '?' || c == '#') {
      char escaped[4];
      std::snprintf(escaped, sizeof escaped, "%%%02X", static_cast<unsigned>(static_cast<unsigned char>(c)));
      out += escaped;
    } else {
      out += c;
    }
  }
  return out + query;
}

}  // namespace

void SqlStatement::Finalizer::operator()(sqlite3_stmt* statement) const {
  sqlite3_finalize(statement);
}

SqlStatement::SqlStatement(sqlite3* db, sqlite3_stmt* statement, std::string where)
    : db_(db), statement_(statement), where_(std::move(where)) {}

SqlStatement& SqlStatement::bind(int at, std::int64_t value) {
  sqlite3_bind_int64(statement_.get(), at, value);
  return *this;
}
SqlStatement& SqlStatement::bind(int at, double value) {
  sqlite3_bind_double(statement_.get(), at, value);
  return *this;
}
SqlStatement& SqlStatement::bind(int at, std::string_view text) {
  sqlite3_bind_text64(statement_.get(), at, text.empty() ? "" : text.data(), text.size(), SQLITE_TRANSIENT,
                      SQLITE_UTF8);
  return *this;
}
SqlStatement& SqlStatement::bind_blob(int at, std::string_view bytes) {
  sqlite3_bind_blob64(statement_.get(), at, bytes.empty() ? "" : bytes.data(), bytes.size(),
                      SQLITE_TRANSIENT);
  return *this;
}
SqlStatement& SqlStatement::bind_column(int at, const SqlStatement& from, int column) {
  sqlite3_bind_value(statement_.get(), at, sqlite3_column_value(from.statement_.get(), column));
  return *this;
}

Result<bool> SqlStatement::step() {
  const int code = sqlite3_step(statement_.get());
  if (code == SQLITE_ROW) {
    return true;
  }
  const auto fault = code == SQLITE_DONE ? std::optional<Error>() : error_of(db_, code, where_);
  sqlite3_reset(statement_.get());
  if (fault) {
    return std::unexpected(*fault);
  }
  return false;
}

Status SqlStatement::run() {
  const Result<bool> done = step();
  if (!done) {
    return std::unexpected(done.error());
  }
  sqlite3_reset(statement_.get());
  return {};
}

std::int64_t SqlStatement::integer(int column) const {
  return sqlite3_column_int64(statement_.get(), column);
}
double SqlStatement::number(int column) const {
  return sqlite3_column_double(statement_.get(), column);
}
std::string SqlStatement::text(int column) const {
  const void* bytes = sqlite3_column_blob(statement_.get(), column);
  const int size = sqlite3_column_bytes(statement_.get(), column);
  return bytes == nullptr ? std::string()
                          : std::string(static_cast<const char*>(bytes), static_cast<std::size_t>(size));
}

void SqlDatabase::Closer::operator()(sqlite3* db) const {
  sqlite3_close_v2(db);
}

Result<SqlDatabase> SqlDatabase::open(const std::filesystem::path& path, Mode mode) {
  std::string name;
  int flags = SQLITE_OPEN_URI | SQLITE_OPEN_FULLMUTEX | SQLITE_OPEN_EXRESCODE;
  switch (mode) {
    case Mode::kCreate:
      name = uri_of(path, "");
      flags |= SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
      break;
    case Mode::kReadOnly:
      name = uri_of(path, "");
      flags |= SQLITE_OPEN_READONLY;
      break;
    case Mode::kImmutable:
      name = uri_of(path, "?immutable=1");
      flags |= SQLITE_OPEN_READONLY;
      break;
    case Mode::kMemory:
      name = ":memory:";
      flags |= SQLITE_OPEN_READWRITE | SQLITE_OPEN_CREATE;
      break;
  }
  std::error_code ignored;  // SQLite would wait for somebody to write into a pipe
  if (mode != Mode::kMemory && std::filesystem::exists(path, ignored) &&
      !std::filesystem::is_regular_file(path, ignored)) {
    return std::unexpected(error_of(nullptr, SQLITE_NOTADB, path.string()));
  }
  sqlite3* raw = nullptr;
  const int code = sqlite3_open_v2(name.c_str(), &raw, flags, nullptr);
  SqlDatabase db(raw, path.string());
  if (code != SQLITE_OK) {
    return std::unexpected(error_of(raw, code, db.where_));
  }
  sqlite3_busy_timeout(raw, kBusyTimeoutMs);
  sqlite3_create_function(raw, "dubsar_sum", -1, SQLITE_UTF8 | SQLITE_DETERMINISTIC, nullptr, &checksum,
                          nullptr, nullptr);
  // A database that somebody tampered with must not run code or read past its pages.
  sqlite3_db_config(raw, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(raw, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  return db;
}

Status SqlDatabase::execute(const char* sql) {
  const int code = sqlite3_exec(db_.get(), sql, nullptr, nullptr, nullptr);
  if (code != SQLITE_OK) {
    return std::unexpected(error_of(db_.get(), code, where_));
  }
  return {};
}

Result<SqlStatement> SqlDatabase::prepare(const char* sql) {
  sqlite3_stmt* raw = nullptr;
  const int code = sqlite3_prepare_v2(db_.get(), sql, -1, &raw, nullptr);
  if (code != SQLITE_OK) {
    return std::unexpected(error_of(db_.get(), code, where_));
  }
  return SqlStatement(db_.get(), raw, where_);
}

Status SqlDatabase::copy_from(SqlDatabase& source) {
  sqlite3_backup* backup = sqlite3_backup_init(db_.get(), "main", source.db_.get(), "main");
  if (backup == nullptr) {
    return std::unexpected(error_of(db_.get(), sqlite3_extended_errcode(db_.get()), where_));
  }
  const int stepped = sqlite3_backup_step(backup, -1);
  const int code = sqlite3_backup_finish(backup);
  if (code != SQLITE_OK || stepped != SQLITE_DONE) {
    return std::unexpected(error_of(nullptr, code != SQLITE_OK ? code : stepped, source.where_));
  }
  return {};
}

std::string SqlDatabase::structure_fault() {
  const Result<std::vector<std::string>> faults = structure_faults(1);
  return !faults ? faults.error().what : faults->empty() ? std::string() : faults->front();
}

Result<std::vector<std::string>> SqlDatabase::structure_faults(int most, const char* table) {
  const std::string of = table != nullptr ? std::string(table) : std::to_string(most);
  Result<SqlStatement> check = prepare(("PRAGMA integrity_check(" + of + ")").c_str());
  if (!check) {
    return std::unexpected(check.error());
  }
  std::vector<std::string> out;
  Result<bool> row = check->step();
  if (row && !*row) {
    return std::vector<std::string>{"no answer"};
  }
  for (; row && *row && out.size() < static_cast<std::size_t>(most); row = check->step()) {
    out.push_back(check->text(0));
  }
  if (!row) {
    return std::unexpected(row.error());
  }
  return out.front() == "ok" ? std::vector<std::string>() : out;
}

void SqlDatabase::allow_changes_of_schema() {
  sqlite3_db_config(db_.get(), SQLITE_DBCONFIG_DEFENSIVE, 0, nullptr);
}

void SqlDatabase::keep_log(bool keep) {
  sqlite3_db_config(db_.get(), SQLITE_DBCONFIG_NO_CKPT_ON_CLOSE, keep ? 1 : 0, nullptr);
}

Result<std::int64_t> SqlDatabase::integer_of(const char* sql) {
  Result<SqlStatement> query = prepare(sql);
  if (!query) {
    return std::unexpected(query.error());
  }
  const Result<bool> row = query->step();
  if (!row) {
    return std::unexpected(row.error());
  }
  return *row ? query->integer(0) : 0;
}

Result<SqlTransaction> SqlTransaction::begin(SqlDatabase& db) {
  if (Status begun = db.execute("BEGIN IMMEDIATE"); !begun) {
    return std::unexpected(begun.error());
  }
  return SqlTransaction(&db);
}

Status SqlTransaction::commit() {
  Status done = db_->execute("COMMIT");
  if (done) {
    db_ = nullptr;
  }
  return done;
}

SqlTransaction::~SqlTransaction() {
  if (db_ != nullptr) {
    // A failed commit may have rolled back already; then this has nothing to do and its answer does not
    // matter.
    (void)db_->execute("ROLLBACK");
  }
}

}  // namespace dubsar
