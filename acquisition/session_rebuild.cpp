// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_rebuild.h"

#include <algorithm>

#include "acquisition/session_files.h"
#include "acquisition/session_links.h"
#include "acquisition/session_log.h"
#include "acquisition/session_structure.h"
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

bool is_no_file(const fs::path& path) {
  std::error_code ignored;
  const fs::file_status is = fs::symlink_status(path, ignored);
  return fs::exists(is) && !fs::is_regular_file(is);
}

/// Names under which database and log lie aside, one of the two at least.
std::vector<fs::path> kept_aside(const fs::path& database) {
  const auto is_there = [](const fs::path& path) {
    std::error_code ignored;
    return fs::exists(fs::symlink_status(path, ignored));
  };
  std::vector<fs::path> out;
  for (fs::path one;; out.push_back(one)) {
    one = beside(database, kAsideMark + std::to_string(out.size() + 1));
    if (!is_there(one) && !is_there(beside(one, kLogSuffix))) {
      return out;
    }
  }
}

struct Backup {
  bool there = false;
  bool fits = true;    ///< is what the list of checksums says, where that has it
  bool whole = false;  ///< every row can be read and is what was stored
};

Backup look_at_backup(const fs::path& folder, const Sums& sums, bool read_rows) {
  Backup out;
  if (is_no_file(folder / kBackup)) {
    return {true, false, false};
  }
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
  const auto [from, to] = sums.equal_range(kDatabase);
  return sums.count(kBackup) == 1 &&
         std::any_of(from, to, [&](const auto& one) { return one.second == sums.find(kBackup)->second; });
}

/// Poses and flags are of one time: older ones do not stand in for what was not there any more.
bool lacks_results(const Losses& lost) {
  return lost.more || std::ranges::any_of(lost.rows, [](const std::string& row) {
           return row.starts_with("poses ") || row.starts_with("flags ");
         });
}

bool may_take_results(const Salvaged& so_far, SqlDatabase& from, SqlDatabase& to) {
  const bool has_some =
      to.integer_of("SELECT (SELECT count(*) FROM poses) + (SELECT count(*) FROM flags)").value_or(0) > 0;
  return so_far.rows == 0 || (lacks_results(so_far.lost) && has_some && results_fit(from, to));
}

std::string aside_note(const std::string& name) {
  const char* what = name.ends_with(kLogSuffix)  ? "kept the damaged log as "
                     : name.starts_with(kSums)   ? "kept the damaged list of checksums as "
                     : name.starts_with(kBackup) ? "kept the damaged backup as "
                                                 : "kept the damaged database as ";
  return what + name;
}

/// Takes what can be read of the damaged database, with its log first; without it, should the log be what is
/// damaged.
Salvaged take_database(const fs::path& folder, SqlDatabase& to) {
  Salvaged out;
  out.lost.more = true;
  if (!has_content(folder / kDatabase)) {
    return out;  // SQLite takes the log of an empty database away, as soon as somebody reads
  }
  for (const auto mode : {SqlDatabase::Mode::kReadOnly, SqlDatabase::Mode::kImmutable}) {
    Result<SqlDatabase> from = SqlDatabase::open(folder / kDatabase, mode);
    if (!from) {
      continue;
    }
    out.rows = std::max(out.rows, salvage_rows(*from, to, may_take_results(out, *from, to)));
    if (mode == SqlDatabase::Mode::kReadOnly) {
      const DamagedRows damaged = damaged_rows_to_be_read(*from);
      out.lost.rows.insert(damaged.rows.begin(), damaged.rows.end());
      out.lost.more = !damaged.all_read || (!from->structure_fault().empty() && fault_may_cost_rows(*from));
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
    const bool results_too = has_all || may_take_results(out, *from, to);
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
  const std::vector<fs::path> before = kept_aside(database);
  const auto same =
      std::ranges::find_if(before, [&](const fs::path& one) { return !is_no_file(one) && is_kept_as(one); });
  const bool is_kept = same != before.end();
  const std::string name =
      (is_kept ? *same : beside(database, kAsideMark + std::to_string(before.size() + 1)))
          .filename()
          .string();
  std::vector<std::string> out;
  if (is_no_file(database)) {
    std::error_code error;
    fs::rename(database, folder / name, error);
    if (error) {
      return fail(ErrorKind::kStorage, "cannot set what is damaged aside: " + error.message(),
                  database.string(), "see that the folder may be written to");
    }
    out.push_back(name);
  }
  for (const std::string suffix : {"", kLogSuffix}) {
    const fs::path from = beside(database, suffix);
    if (!has_content(from)) {
      continue;
    }
    out.push_back(name + suffix);
    if (is_kept) {
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

fs::path log_left_aside(const fs::path& folder) {
  const fs::path path = folder / kDatabase;
  if (!has_content(path) || has_content(beside(path, kLogSuffix))) {
    return {};
  }
  fs::path aside;  // the newest with a log: repairing leaves copies of the database alone
  for (const fs::path& one : kept_aside(path)) {
    aside = has_content(beside(one, kLogSuffix)) ? one : aside;
  }
  const fs::path log = beside(aside, kLogSuffix);
  if (aside.empty() || link_on_the_way(folder, aside.filename()) || link_on_the_way(folder, log.filename()) ||
      !have_same_bytes(aside, path)) {
    return {};
  }
  const Result<LogState> state = read_log(log);
  return state && state->commits + state->lost_commits > 0 ? log : fs::path();
}

Error log_aside_error(const fs::path& folder, const fs::path& log) {
  return {ErrorKind::kBadInput, "its log lies aside: a rebuilding was broken off", log.filename().string(),
          "dubsar verify --repair " + word_of(folder) + " goes on with it"};
}

Status bring_back_log(const fs::path& folder) {
  const fs::path log = log_left_aside(folder);
  if (log.empty()) {
    return {};
  }
  const Result<std::string> bytes = read_whole_file(log);
  return bytes ? write_file_atomically(beside(folder / kDatabase, kLogSuffix), std::string_view(*bytes))
               : std::unexpected(bytes.error());
}

namespace {

/// The list of checksums while a new database takes the place of the old one: either is whole, and a backup
/// that has everything is known for it by a next rebuilding, should this one be broken off.
Status expect_either(const fs::path& folder, const Sums& sums, const fs::path& fresh) {
  if (!is_of_last_close(sums)) {
    return take_sum_away(folder, sums);
  }
  const Result<FileSum> sum = sum_of_file(fresh);
  if (!sum) {
    return std::unexpected(sum.error());
  }
  const FileSum& old = sums.find(kBackup)->second;
  return write_sums(folder, {{kDatabase, old}, {kDatabase, *sum}, {kBackup, old}});
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
  if (Status expected = expect_either(folder, sums.value_or(Sums()), fresh.path()); !expected) {
    return std::unexpected(expected.error());
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
