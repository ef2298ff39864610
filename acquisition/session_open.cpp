// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <unistd.h>

#include <algorithm>
#include <cstdlib>

#include "acquisition/session_impl.h"
#include "acquisition/session_log.h"
#include "acquisition/session_rebuild.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"

namespace dubsar::session {

namespace fs = std::filesystem;

namespace {

/// An error is one line.
constexpr std::size_t kMostNamed = 8;

/// Every commit reaches the disk before it returns; a log beside the file keeps readers and the writer apart.
constexpr const char* kDurable = "PRAGMA journal_mode = WAL; PRAGMA synchronous = FULL;";

constexpr const char* kMerge = "PRAGMA wal_checkpoint(TRUNCATE)";

/// No database where there was one. An empty file with nothing beside it is what a program leaves that was
/// stopped before its first change; a log is begun by the second one.
bool is_gone(const fs::path& folder) {
  std::error_code unknown;
  return !has_content(folder / kDatabase) &&
         (fs::exists(folder / kBackup, unknown) || !grid_ids(folder).empty() ||
          has_content(beside(folder / kDatabase, kLogSuffix)));
}

Error gone_error(const std::string& where) {
  return {ErrorKind::kBadInput, "the database is missing or empty", where, {}};
}

/// What is wrong with a database that opens, or nothing.
std::optional<Error> fault_of(SqlDatabase& db, const std::string& where) {
  if (const Status schema = prepare_schema(db, where); !schema) {
    return schema.error();
  }
  if (const std::string fault = db.structure_fault(); !fault.empty()) {
    return Error{ErrorKind::kBadInput, "the database is damaged (" + fault + ")", where, {}};
  }
  const Result<std::vector<std::string>> rows = damaged_rows(db);
  if (!rows) {
    return rows.error();
  }
  if (!rows->empty()) {
    std::string list = rows->front();
    for (std::size_t i = 1; i < rows->size() && i < kMostNamed; ++i) {
      list += ", " + (*rows)[i];
    }
    list += rows->size() > kMostNamed ? ", and more" : "";
    return Error{ErrorKind::kBadInput, "the database is damaged (" + list + ")", where, {}};
  }
  return std::nullopt;
}

/// A log with a damaged middle is played up to there and no further. Says so, and for writing keeps database
/// and log as they were. Returns whether there is one.
Result<bool> tell_lost_commits(const fs::path& folder, SessionOpening& opening, bool keep) {
  const fs::path path = beside(folder / kDatabase, "-wal");
  const Result<LogState> log = read_log(path);
  if (!log || log->lost_commits == 0) {
    return false;
  }
  opening.damage.push_back(lost_commits_error(*log, path.string()));
  if (!keep) {
    return true;
  }
  const Result<std::vector<std::string>> aside = keep_aside(folder);
  if (!aside) {
    return std::unexpected(aside.error());
  }
  opening.notes.push_back("kept the damaged log as " + aside->back());
  return true;
}

/// Grids that prove that commits are missing: every scan's row is committed before the next grid is stored,
/// and whoever opens a session for writing takes in the one grid that a kill may have left without a row. So
/// of two whole ones without a row one had it. A row that the record names as lost proves nothing: whoever
/// rebuilt the tables may have been stopped before its grid was taken in again. `grids` lay there before the
/// tables were read: another program may be storing scans. 0 where they prove nothing.
std::int64_t unlisted_proof(const fs::path& folder, const std::vector<int>& grids, SqlDatabase& db,
                            const Losses& standing) {
  const auto is_unlisted = [&](int id) {
    const std::string row = row_name("scans", std::to_string(id));
    return !standing.rows.contains(row) && !has_row(db, row) && verify_grid_file(folder / grid_name(id));
  };
  const std::int64_t unlisted = std::ranges::count_if(grids, is_unlisted);
  return unlisted > 1 ? unlisted : 0;
}

/// Says so, once; the record says it from then on.
Status note_missing_log(const fs::path& folder, SqlDatabase& db, SessionOpening& opening, Losses& lost) {
  const Result<Losses> standing = standing_losses(db);
  if (!standing) {
    return std::unexpected(standing.error());
  }
  lost.unlisted = unlisted_proof(folder, grid_ids(folder), db, *standing);
  if (lost.unlisted == 0 || standing->more) {
    return {};
  }
  opening.damage.push_back(missing_log_error(lost.unlisted, folder));
  return note_losses(db, {{}, true});
}

/// Copies database and log to where the log can be played, for a session on a disk that cannot be written.
Status copy_elsewhere(const fs::path& folder, SqlDatabase& memory) {
  std::error_code error;
  const fs::path temporary = fs::temp_directory_path(error);
  std::string place = (temporary / "dubsar-session-XXXXXX").string();
  if (error || ::mkdtemp(place.data()) == nullptr) {
    return fail(ErrorKind::kStorage, "no temporary folder to read the session in", folder.string(),
                "set TMPDIR to a folder that can be written to");
  }
  for (const char* suffix : {"", "-wal"}) {
    if (!error) {
      fs::copy_file(beside(folder / kDatabase, suffix), beside(fs::path(place) / kDatabase, suffix), error);
    }
  }
  Status copied;
  if (error) {
    copied = fail(ErrorKind::kStorage, "cannot copy its database to " + place + ": " + error.message(),
                  folder.string(), "set TMPDIR to a folder with room");
  } else if (Result<SqlDatabase> db =
                 SqlDatabase::open(fs::path(place) / kDatabase, SqlDatabase::Mode::kCreate);
             db) {
    copied = memory.copy_from(*db);
  } else {
    copied = std::unexpected(db.error());
  }
  fs::remove_all(place, error);
  return copied;
}

/// The database as of now, in memory. A log with content has commits that the file lacks.
Status snapshot(const fs::path& folder, SqlDatabase& memory) {
  const fs::path path = folder / kDatabase;
  if (!has_content(beside(path, "-wal"))) {
    Result<SqlDatabase> file = SqlDatabase::open(path, SqlDatabase::Mode::kImmutable);
    return file ? memory.copy_from(*file) : std::unexpected(file.error());
  }
  Result<SqlDatabase> file = SqlDatabase::open(path, SqlDatabase::Mode::kReadOnly);
  if (Status copied = file ? memory.copy_from(*file) : std::unexpected(file.error());
      copied || copied.error().kind == ErrorKind::kBadInput) {
    return copied;
  }
  return copy_elsewhere(folder, memory);
}

}  // namespace

Result<SqlDatabase> open_for_writing(const fs::path& folder, SessionOpening& opening, bool& rebuilt,
                                     Losses& lost) {
  const fs::path path = folder / kDatabase;
  if (Status back = bring_back_log(folder); !back) {
    return std::unexpected(back.error());
  }
  const bool missing = is_gone(folder);
  opening.created = !missing && !has_content(path);
  const Result<Sums> sums = read_sums(folder);
  const Result<bool> commits_lost = tell_lost_commits(folder, opening, true);
  if (!commits_lost) {
    return std::unexpected(commits_lost.error());
  }
  Result<SqlDatabase> db = missing ? std::unexpected(gone_error(path.string()))
                                   : SqlDatabase::open(path, SqlDatabase::Mode::kCreate);
  if (db) {
    db->keep_log(true);  // it alone tells what is lost of it, until that is noted or all is replaced
  }
  const std::optional<Error> fault = db ? fault_of(*db, path.string()) : db.error();
  if (fault && fault->kind == ErrorKind::kBadInput) {
    db = std::unexpected(*fault);  // closes it
    db = rebuild(folder, *fault, sums, *commits_lost, opening);
    rebuilt = db.has_value();
  } else if (fault) {
    return std::unexpected(*fault);
  } else if (Status kept = keep_backup_aside(folder, sums, false, opening); !kept) {
    return std::unexpected(kept.error());
  }
  if (!db) {
    return db;
  }
  if (Status taken = take_sum_away(folder, sums.value_or(Sums())); !taken) {
    return std::unexpected(taken.error());
  }
  if (Status durable = db->execute(kDurable); !durable) {
    return std::unexpected(durable.error());
  }
  if (*commits_lost && !rebuilt) {
    if (Status noted = note_losses(*db, {{}, true}); !noted) {
      return std::unexpected(noted.error());
    }
    (void)db->execute(kMerge);  // what is left behind the damage would be told again after a kill
  }
  if (Status told = rebuilt ? Status() : note_missing_log(folder, *db, opening, lost); !told) {
    return std::unexpected(told.error());
  }
  db->keep_log(false);
  if (Status synced = sync_folder(folder); !synced) {
    return std::unexpected(synced.error());
  }
  return db;
}

Result<SqlDatabase> open_for_reading(const fs::path& folder, SessionOpening& opening, bool& rebuilt,
                                     Losses& lost) {
  Result<SqlDatabase> memory = SqlDatabase::open(folder / kDatabase, SqlDatabase::Mode::kMemory);
  if (!memory) {
    return memory;
  }
  const std::string where = (folder / kDatabase).string();
  if (const fs::path log = log_left_aside(folder); !log.empty()) {
    opening.damage.push_back(log_aside_error(folder, log));
  }
  const Result<bool> commits_lost = tell_lost_commits(folder, opening, false);
  if (!commits_lost) {
    return std::unexpected(commits_lost.error());
  }
  lost.more = *commits_lost;
  const bool gone = is_gone(folder);
  const std::vector<int> grids = grid_ids(folder);
  std::optional<Error> fault;
  if (gone) {
    fault = gone_error(where);  // an empty file opens without a fault, as a database without a row
  } else if (const Status copied = snapshot(folder, *memory); copied) {
    fault = fault_of(*memory, where);
  } else {
    fault = copied.error();
  }
  if (!fault) {
    const Result<Losses> standing = standing_losses(*memory);
    if (!standing) {
      return std::unexpected(standing.error());
    }
    lost.unlisted = lost.more ? 0 : unlisted_proof(folder, grids, *memory, *standing);
    if (lost.unlisted > 0) {
      lost.more = true;
      opening.damage.push_back(missing_log_error(lost.unlisted, folder));
    }
    return memory;
  }
  if (fault->kind != ErrorKind::kBadInput && !gone) {
    return std::unexpected(*fault);
  }
  memory = SqlDatabase::open(folder / kDatabase, SqlDatabase::Mode::kMemory);
  if (!memory) {
    return memory;
  }
  Result<Salvaged> salvaged = fill_from_remains(folder, read_sums(folder).value_or(Sums()), *memory);
  if (!salvaged) {
    return std::unexpected(salvaged.error());
  }
  note_rebuilding(folder, *fault, *salvaged, opening);
  rebuilt = true;
  salvaged->lost.more = salvaged->lost.more || lost.more;
  lost = std::move(salvaged->lost);
  return memory;
}

Status check_records(const fs::path& folder) {
  SessionOpening opening;
  bool rebuilt = false;
  Losses lost;
  const Result<SqlDatabase> db = open_for_reading(folder, opening, rebuilt, lost);
  if (!db) {
    return std::unexpected(db.error());
  }
  if (opening.damage.empty()) {
    return {};
  }
  return bad_input(folder.string(),
                   "its records are damaged, and nothing was changed: " + opening.damage.front().what,
                   "mend them first, from a copy where there is one (dubsar verify --repair --from COPY " +
                       word_of(folder) + ")");
}

void close_cleanly(const fs::path& folder, std::optional<SqlDatabase>& db) {
  const bool merged = db && db->execute(kMerge).has_value();
  db.reset();
  if (!merged || has_content(beside(folder / kDatabase, "-wal"))) {
    return;  // The log stays and is played at the next opening.
  }
  const Result<std::string> bytes = read_whole_file(folder / kDatabase);
  if (!bytes) {
    return;
  }
  // What was damaged meanwhile does not take the place of a backup that is whole: the next opening needs it.
  Result<SqlDatabase> closed = SqlDatabase::open(folder / kDatabase, SqlDatabase::Mode::kImmutable);
  if (!closed || fault_of(*closed, folder.string())) {
    return;
  }
  const FileSum sum{static_cast<std::int64_t>(bytes->size()), hash_of(*bytes)};
  // Until the new backup stands the old one does: a program that is killed here leaves no doubt about either.
  Sums sums = read_sums(folder).value_or(Sums());
  sums.erase(kDatabase);
  sums.emplace(kDatabase, sum);
  if (!sums.contains(kBackup)) {
    sums.emplace(kBackup, sum_of_file(folder / kBackup).value_or(kNotThereYet));
  }
  sums.emplace(kBackup, sum);
  if (write_sums(folder, sums) && write_file_atomically(folder / kBackup, std::string_view(*bytes))) {
    // Without these sums verify() still has those of the rows.
    (void)write_sums(folder, {{kDatabase, sum}, {kBackup, sum}});
  }
}

}  // namespace dubsar::session
