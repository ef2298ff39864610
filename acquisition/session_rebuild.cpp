// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_rebuild.h"

#include <algorithm>

#include "acquisition/session_files.h"
#include "acquisition/session_links.h"
#include "acquisition/session_log.h"
#include "acquisition/session_tables.h"
#include "formats/atomic_file.h"
#include "formats/same_bytes.h"

namespace dubsar::session {

namespace fs = std::filesystem;

fs::path beside(const fs::path& path, const std::string& suffix) {
  return path.string() + suffix;
}

bool has_content(const fs::path& path) {
  std::error_code error;
  const auto size = fs::file_size(path, error);
  return !error && size > 0;
}

void note_rebuilding(const Error& fault, std::int64_t rows, SessionOpening& opening) {
  opening.damage.push_back(fault);
  opening.notes.push_back("rebuilt the database: " + std::to_string(rows) +
                          " rows saved from it and from its last backup");
}

Result<std::int64_t> fill_from_remains(const fs::path& folder, SqlDatabase& to) {
  if (Status schema = prepare_schema(to, folder.string()); !schema) {
    return std::unexpected(schema.error());
  }
  Result<SqlTransaction> transaction = SqlTransaction::begin(to);
  if (!transaction) {
    return std::unexpected(transaction.error());
  }
  std::int64_t rows = 0;
  // With the log first; without it, should the log be what is damaged.
  for (const auto mode : {SqlDatabase::Mode::kReadOnly, SqlDatabase::Mode::kImmutable}) {
    if (Result<SqlDatabase> from = SqlDatabase::open(folder / kDatabase, mode); from) {
      rows = salvage_rows(*from, to, true);
    }
  }
  if (Result<SqlDatabase> backup = SqlDatabase::open(folder / kBackup, SqlDatabase::Mode::kImmutable);
      backup) {
    rows = std::max(rows, salvage_rows(*backup, to, rows == 0));
  }
  if (Status done = transaction->commit(); !done) {
    return std::unexpected(done.error());
  }
  return rows;
}

Result<std::vector<std::string>> keep_aside(const fs::path& folder) {
  const std::string name = name_aside(folder / kDatabase).filename().string();
  std::vector<std::string> out;
  for (const std::string suffix : {"", kLogSuffix}) {
    const fs::path from = beside(folder / kDatabase, suffix);
    if (!has_content(from)) {
      continue;
    }
    const Result<std::string> bytes = read_whole_file(from);
    if (!bytes) {
      return std::unexpected(bytes.error());
    }
    if (Status kept = write_file_atomically(beside(folder / name, suffix), std::string_view(*bytes)); !kept) {
      return std::unexpected(kept.error());
    }
    out.push_back(name + suffix);
  }
  return out;
}

namespace {

/// A rebuilding that was broken off after it had taken the log away, and before it replaced the database, has
/// left a copy of both aside: the log is put back beside the database that it belongs to.
Status bring_back_log(const fs::path& folder) {
  const fs::path path = folder / kDatabase;
  std::error_code ignored;
  fs::path aside;  // the newest with a log: repairing leaves copies of the database alone
  for (int i = 1; fs::exists(beside(path, kAsideMark + std::to_string(i)), ignored); ++i) {
    const fs::path one = beside(path, kAsideMark + std::to_string(i));
    aside = has_content(beside(one, kLogSuffix)) ? one : aside;
  }
  const fs::path log = beside(aside, kLogSuffix);
  if (aside.empty() || has_content(beside(path, kLogSuffix)) || link_on_the_way(folder, aside.filename()) ||
      link_on_the_way(folder, log.filename()) || !have_same_bytes(aside, path)) {
    return {};
  }
  if (const Result<LogState> state = read_log(log); !state || state->commits == 0) {
    return {};
  }
  const Result<std::string> bytes = read_whole_file(log);
  return bytes ? write_file_atomically(beside(path, kLogSuffix), std::string_view(*bytes))
               : std::unexpected(bytes.error());
}

/// The log must be gone before a new database takes the place of the old one: SQLite would play it over the
/// wrong one. Synced, so that a power cut cannot keep the two from happening in that order.
Status take_log_away(const fs::path& folder) {
  for (const char* suffix : {"-shm", kLogSuffix}) {
    const fs::path path = beside(folder / kDatabase, suffix);
    std::error_code error;
    fs::remove(path, error);
    if (error) {
      return fail(ErrorKind::kStorage, "cannot take the old log away: " + error.message(), path.string(),
                  "see that the folder may be written to");
    }
  }
  return sync_folder(folder);
}

/// A database that is being made, with what SQLite puts beside it: gone at the beginning, and at the end
/// unless it has taken its place.
class FreshDatabase {
 public:
  explicit FreshDatabase(const fs::path& folder)
      : path_(folder / (std::string(kTemporaryPrefix) + "rebuilt.sqlite")) {
    remove();
  }
  ~FreshDatabase() { remove(); }
  FreshDatabase(const FreshDatabase&) = delete;
  FreshDatabase& operator=(const FreshDatabase&) = delete;
  [[nodiscard]] const fs::path& path() const { return path_; }

 private:
  void remove() const {
    for (const char* suffix : {"", "-wal", "-shm", "-journal"}) {
      std::error_code ignored;
      fs::remove(beside(path_, suffix), ignored);
    }
  }
  fs::path path_;
};

}  // namespace

Result<SqlDatabase> rebuild(const fs::path& folder, const Error& fault, SessionOpening& opening) {
  if (Status back = bring_back_log(folder); !back) {
    return std::unexpected(back.error());
  }
  const FreshDatabase fresh(folder);
  std::int64_t rows = 0;
  {
    Result<SqlDatabase> to = SqlDatabase::open(fresh.path(), SqlDatabase::Mode::kCreate);
    if (!to) {
      return to;
    }
    const Result<std::int64_t> filled = fill_from_remains(folder, *to);
    if (!filled) {
      return std::unexpected(filled.error());
    }
    rows = *filled;
  }
  const Result<std::vector<std::string>> aside = keep_aside(folder);
  if (!aside) {
    return std::unexpected(aside.error());
  }
  if (Status taken = take_log_away(folder); !taken) {
    return std::unexpected(taken.error());
  }
  std::error_code error;
  fs::rename(fresh.path(), folder / kDatabase, error);
  if (error) {
    return fail(ErrorKind::kStorage, "cannot put the rebuilt database in its place: " + error.message(),
                folder.string(), "see that the folder may be written to");
  }
  if (Status synced = sync_folder(folder); !synced) {
    return std::unexpected(synced.error());
  }
  note_rebuilding(fault, rows, opening);
  for (const std::string& name : *aside) {
    opening.notes.push_back(
        (name.ends_with(kLogSuffix) ? "kept the damaged log as " : "kept the damaged database as ") + name);
  }
  return SqlDatabase::open(folder / kDatabase, SqlDatabase::Mode::kCreate);
}

}  // namespace dubsar::session
