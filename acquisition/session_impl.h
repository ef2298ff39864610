// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/session_files.h"
#include "acquisition/session_lock.h"
#include "acquisition/session_losses.h"
#include "acquisition/session_store.h"
#include "acquisition/session_tables.h"
#include "acquisition/sqlite_db.h"

namespace dubsar {

struct SessionStore::Impl {
  std::filesystem::path folder;
  Access access = Access::kReadWrite;
  std::optional<session::FolderLock> lock;
  std::optional<SqlDatabase> db;  ///< for reading: a copy in memory
  bool rebuilt = false;           ///< db was put together from what a damaged one left
  session::Losses lost;           ///< what is, and is not noted in db; for writing: unlisted grids alone
  SessionOpening opening;
  std::vector<int> damaged_grids;  ///< ids, as seen while opening
  /// A grid that was stored and not listed, for the disk refused its row.
  struct Refused {
    int id = 0;
    std::string event;  ///< of its storing, JSON
  };
  std::optional<Refused> refused;
  mutable std::mutex mutex;  ///< of db, damaged_grids and refused

  ~Impl();
  /// kUsage when the session was opened for reading only; kStorage when it does not lie there any more.
  [[nodiscard]] Status writable() const;
  /// Under the mutex.
  [[nodiscard]] Result<int> next_id();
  /// The checks of opening that follow once db stands: rows, grids without a row, rows without their grid.
  /// kCancelled when the job was stopped: grids that were taken in by then stay so.
  [[nodiscard]] Status reconcile(const JobContext* job);
  /// What the record says of scans that have no row.
  struct Unlisted {
    session::Losses standing;
    bool lacks = false;  ///< of scans that it does not name, too; else a kill left those unlisted
    std::map<int, session::DropState> drops;
  };
  [[nodiscard]] Result<Unlisted> unlisted();
  /// Takes a whole grid in that has no row.
  [[nodiscard]] Status adopt(int id, const session::FileSum& sum, const RangeGrid& grid,
                             const Unlisted& record);
  /// Lists a grid and notes `event`, in one transaction. Under the mutex. Where it fails `in_the_balance`
  /// says whether the log may hold it all the same.
  [[nodiscard]] Status list_grid(int id, const session::FileSum& sum, const RangeGrid& grid,
                                 const std::string& event, bool* in_the_balance);
  /// Lists the grid that waits for it. Under the mutex.
  [[nodiscard]] Status list_refused();
};

namespace session {

/// What the tables say that a file was when it was stored; nothing where none names it.
[[nodiscard]] Result<std::optional<FileSum>> recorded_sum(SqlDatabase& db, const std::string& name);
/// Opens session.sqlite for writing, rebuilding it when it is damaged. What is lost is noted in it; `lost`
/// has the grids that prove it alone.
[[nodiscard]] Result<SqlDatabase> open_for_writing(const std::filesystem::path& folder,
                                                   SessionOpening& opening, bool& rebuilt, Losses& lost);
/// A copy of the database in memory, or what can be saved of it.
[[nodiscard]] Result<SqlDatabase> open_for_reading(const std::filesystem::path& folder,
                                                   SessionOpening& opening, bool& rebuilt, Losses& lost);
/// kBadInput, which names the mend, where tables or log are damaged: nothing was written then.
[[nodiscard]] Status check_records(const std::filesystem::path& folder);
/// Takes what the session has lost of its records from a copy of it. Errors: of its database; a copy that
/// does not do is told in `opening`.
[[nodiscard]] Status bring_back_records(const std::filesystem::path& folder,
                                        const std::filesystem::path& copy, SqlDatabase& db,
                                        SessionOpening& opening);
/// Closes db, leaving one file without a log beside it, its backup and their checksums.
void close_cleanly(const std::filesystem::path& folder, std::optional<SqlDatabase>& db);

}  // namespace session

}  // namespace dubsar
