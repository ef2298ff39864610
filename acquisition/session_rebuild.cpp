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

namespace {

struct Backup {
  bool there = false;
  bool fits = true;    ///< is what the list of checksums says, where that has it
  bool whole = false;  ///< every row can be read and is what was stored
};

Backup look_at_backup(const fs::path& folder, const Sums& sums, bool read_rows) {
  Backup out;
  out.there = has_content(folder / kBackup);
  if (!out.there) {
    return out;
  }
  const auto [from, to] = sums.equal_range(kBackup);
  if (from != to) {
    const Result<FileSum> sum = sum_of_file(folder / kBackup);
    out.fits = sum && std::any_of(from, to, [&](const auto& one) { return one.second == *sum; });
    out.whole = out.fits;
  }
  if (read_rows || from == to) {
    Result<SqlDatabase> db = SqlDatabase::open(folder / kBackup, SqlDatabase::Mode::kImmutable);
    const DamagedRows damaged = db ? damaged_rows_to_be_read(*db) : DamagedRows{{}, false};
    out.whole = damaged.all_read && damaged.rows.empty() && db->structure_fault().empty();
  }
  return out;
}

/// Nothing was written since the backup: closing gives it and the database the same bytes, and the next
/// opening takes the database's checksum away.
bool is_of_last_close(const Sums& sums) {
  return sums.count(kDatabase) == 1 && sums.count(kBackup) == 1 &&
         sums.find(kDatabase)->second == sums.find(kBackup)->second;
}

std::string aside_note(const std::string& name) {
  const bool log = name.ends_with(kLogSuffix);
  const bool list = name.starts_with(kSums);
  const char* what = log                         ? "log"
                     : list                      ? "list of checksums"
                     : name.starts_with(kBackup) ? "backup"
                                                 : "database";
  return std::string("kept the damaged ") + what + " as " + name;
}

/// Takes what can be read of the damaged database, with its log first; without it, should the log be what is
/// damaged.
Salvaged take_database(const fs::path& folder, SqlDatabase& to) {
  Salvaged out;
  out.lost.more = true;
  for (const auto mode : {SqlDatabase::Mode::kReadOnly, SqlDatabase::Mode::kImmutable}) {
    Result<SqlDatabase> from = SqlDatabase::open(folder / kDatabase, mode);
    if (!from) {
      continue;
    }
    out.rows = salvage_rows(*from, to, true);
    if (mode == SqlDatabase::Mode::kReadOnly) {
      const DamagedRows damaged = damaged_rows_to_be_read(*from);
      out.lost.rows.insert(damaged.rows.begin(), damaged.rows.end());
      out.lost.more =
          !has_content(folder / kDatabase) || !damaged.all_read || !from->structure_fault().empty();
    }
  }
  return out;
}

}  // namespace

Result<Salvaged> fill_from_remains(const fs::path& folder, const Sums& sums, SqlDatabase& to) {
  if (Status schema = prepare_schema(to, folder.string()); !schema) {
    return std::unexpected(schema.error());
  }
  Result<SqlTransaction> transaction = SqlTransaction::begin(to);
  if (!transaction) {
    return std::unexpected(transaction.error());
  }
  Salvaged out = take_database(folder, to);
  const Backup backup = look_at_backup(folder, sums, true);
  const bool has_all = backup.whole && backup.fits && is_of_last_close(sums);
  if (Result<SqlDatabase> from = SqlDatabase::open(folder / kBackup, SqlDatabase::Mode::kImmutable); from) {
    const bool has_results =
        to.integer_of("SELECT (SELECT count(*) FROM poses) + (SELECT count(*) FROM flags)").value_or(0) > 0;
    const bool results_too = out.rows == 0 || has_all || (has_results && results_fit(*from, to));
    out.rows = std::max(out.rows, salvage_rows(*from, to, results_too));
    if (out.lost.more) {  // it alone may name what is lost
      const DamagedRows damaged = damaged_rows_to_be_read(*from);
      out.lost.rows.insert(damaged.rows.begin(), damaged.rows.end());
    }
  }
  if (has_all) {
    out.lost = {};
  }
  std::erase_if(out.lost.rows, [&](const std::string& row) { return has_row(to, row); });
  if (Status done = transaction->commit(); !done) {
    return std::unexpected(done.error());
  }
  return out;
}

void note_rebuilding(const fs::path& folder, const Error& fault, const Salvaged& salvaged,
                     SessionOpening& opening) {
  opening.damage.push_back(fault);
  opening.notes.push_back("rebuilt the database: " + std::to_string(salvaged.rows) +
                          " rows saved from it and from its last backup");
  for (Error& lost : told_losses(salvaged.lost, (folder / kDatabase).string(), folder)) {
    opening.damage.push_back(std::move(lost));
  }
}

Result<std::vector<std::string>> keep_aside(const fs::path& folder) {
  const fs::path database = folder / kDatabase;
  const bool has_log = has_content(beside(database, kLogSuffix));
  const auto is_kept_as = [&](const fs::path& one) {
    const fs::path log = beside(one, kLogSuffix);
    return have_same_bytes(one, database) &&
           (has_log ? have_same_bytes(log, beside(database, kLogSuffix)) : !has_content(log));
  };
  std::error_code ignored;
  fs::path kept;
  for (int i = 1; kept.empty() && fs::exists(beside(database, kAsideMark + std::to_string(i)), ignored);
       ++i) {
    const fs::path one = beside(database, kAsideMark + std::to_string(i));
    kept = !fs::is_symlink(one, ignored) && is_kept_as(one) ? one : fs::path();
  }
  const std::string name = (kept.empty() ? name_aside(database) : kept).filename().string();
  std::vector<std::string> out;
  for (const std::string suffix : {"", kLogSuffix}) {
    const fs::path from = beside(database, suffix);
    if (!has_content(from)) {
      continue;
    }
    out.push_back(name + suffix);
    if (!kept.empty()) {
      continue;
    }
    const Result<std::string> bytes = read_whole_file(from);
    if (!bytes) {
      return std::unexpected(bytes.error());
    }
    if (Status written = write_file_atomically(beside(folder / name, suffix), std::string_view(*bytes));
        !written) {
      return std::unexpected(written.error());
    }
  }
  return out;
}

Status keep_backup_aside(const fs::path& folder, const Result<Sums>& sums, bool read_rows,
                         SessionOpening& opening) {
  const Backup backup = look_at_backup(folder, sums.value_or(Sums()), read_rows);
  const bool backup_too = backup.there && (!backup.fits || !backup.whole);
  std::vector<const char*> names;
  if (backup_too) {
    names.push_back(kBackup);
  }
  if (!sums || (backup_too && sums->contains(kBackup))) {
    names.push_back(kSums);
  }
  for (const char* name : names) {
    const Result<fs::path> aside = copy_aside(folder / name);
    if (!aside && read_whole_file(folder / name)) {
      return std::unexpected(aside.error());
    }
    if (!aside) {  // nobody can read it, here or elsewhere: no reason to keep the writer out
      opening.damage.push_back(aside.error());
      continue;
    }
    opening.notes.push_back(aside_note(aside->filename().string()));
  }
  return {};
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

Result<SqlDatabase> rebuild(const fs::path& folder, const Error& fault, const Result<Sums>& sums,
                            bool commits_lost, SessionOpening& opening) {
  if (Status back = bring_back_log(folder); !back) {
    return std::unexpected(back.error());
  }
  const FreshDatabase fresh(folder);
  Salvaged salvaged;
  {
    Result<SqlDatabase> to = SqlDatabase::open(fresh.path(), SqlDatabase::Mode::kCreate);
    if (!to) {
      return to;
    }
    Result<Salvaged> filled = fill_from_remains(folder, sums.value_or(Sums()), *to);
    if (!filled) {
      return std::unexpected(filled.error());
    }
    salvaged = std::move(*filled);
    salvaged.lost.more = salvaged.lost.more || commits_lost;
    // Before anything else is written: a loss stands where it was in the order of events.
    if (Status noted = salvaged.lost.any() ? note_losses(*to, salvaged.lost) : Status(); !noted) {
      return std::unexpected(noted.error());
    }
  }
  const Result<std::vector<std::string>> aside = keep_aside(folder);
  if (!aside) {
    return std::unexpected(aside.error());
  }
  if (Status kept = keep_backup_aside(folder, sums, true, opening); !kept) {
    return std::unexpected(kept.error());
  }
  if (Status taken = take_sum_away(folder, sums.value_or(Sums())); !taken) {
    return std::unexpected(taken.error());
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
  note_rebuilding(folder, fault, salvaged, opening);
  for (const std::string& name : *aside) {
    opening.notes.push_back(aside_note(name));
  }
  return SqlDatabase::open(folder / kDatabase, SqlDatabase::Mode::kCreate);
}

}  // namespace dubsar::session
