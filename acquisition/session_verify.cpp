// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "acquisition/session_impl.h"
#include "acquisition/session_links.h"
#include "acquisition/session_log.h"
#include "acquisition/session_query.h"
#include "acquisition/session_rebuild.h"
#include "formats/atomic_file.h"
#include "formats/files_below.h"
#include "formats/grid_file.h"
#include "formats/json_node.h"
#include "formats/self_checked.h"

namespace dubsar {

namespace fs = std::filesystem;
using session::FileSum;

namespace {

/// A file that the database names, with what it looked like when it was stored.
struct Recorded {
  int id = -1;  ///< of a scan
  std::string name;
  FileSum sum;
};

Result<std::vector<Recorded>> recorded(SqlDatabase& db, const char* sql) {
  std::vector<Recorded> out;
  const Status read = session::for_each_row(db, sql, [&](const SqlStatement& row) -> Status {
    out.push_back({static_cast<int>(row.integer(0)), row.text(1), {row.integer(2), row.integer(3)}});
    return {};
  });
  if (!read) {
    return std::unexpected(read.error());
  }
  return out;
}

constexpr const char* kScanFiles = "SELECT id, file, bytes, hash FROM scans ORDER BY id";
constexpr const char* kOtherFiles = "SELECT -1, path, bytes, hash FROM files ORDER BY path";

std::string from_a_copy(const fs::path& folder, const char* end) {
  return "bring it back from a copy (dubsar verify --repair --from COPY " + session::word_of(folder) + end;
}

/// Nothing when the file is as it was stored.
std::optional<Error> fault_of_file(const fs::path& folder, const std::string& name, const FileSum& expected,
                                   const JobContext* job) {
  const bool in_a_folder = session::in_a_folder_of_the_session(name);
  if (!in_a_folder && name != session::kDatabase && name != session::kBackup) {
    return Error{ErrorKind::kBadInput, "named by the tables, and no file of a session", name,
                 "bring the session back from a copy: somebody changed this one"};
  }
  if (std::optional<Error> link = session::link_on_the_way(folder, name)) {
    return link;
  }
  const std::string mend = name.ends_with(".grid") ? from_a_copy(folder, ") or scan again")
                                                   : "dubsar verify --repair " + session::word_of(folder) +
                                                         (in_a_folder ? " makes it anew" : " mends it");
  std::error_code unknown;
  if (!fs::exists(folder / name, unknown)) {
    return unknown ? Error{ErrorKind::kStorage, "cannot read: " + unknown.message(), name,
                           "look at its rights and at the disk"}
                   : Error{ErrorKind::kBadInput, "missing", name, mend};
  }
  const Result<FileSum> sum = session::sum_of_file(folder / name, job);
  if (!sum) {
    return Error{sum.error().kind, sum.error().what, name, sum.error().mend.empty() ? std::string() : mend};
  }
  if (*sum != expected) {
    return Error{ErrorKind::kBadInput,
                 sum->bytes != expected.bytes ? "holds " + std::to_string(sum->bytes) +
                                                    " bytes, stored were " + std::to_string(expected.bytes)
                                              : std::string("not the bytes that were stored"),
                 name, mend};
  }
  return std::nullopt;
}

/// Of a file that no table names: rows of a scan that was not over carry their own, and what a person wrote
/// in the viewer. Of such a text that is cut off it may be gone; it is then no JSON any more. An error where
/// a grid cannot be read.
Result<OwnChecksum> own_checksum_in(const fs::path& file) {
  if (file.extension() == ".grid") {
    const Result<std::string> bytes = read_whole_file(file);
    if (!bytes) {
      return std::unexpected(bytes.error());
    }
    return verify_grid_bytes(std::as_bytes(std::span(*bytes)), file.string()) ? OwnChecksum::kFits
                                                                              : OwnChecksum::kFails;
  }
  if (file.extension() != ".json") {
    return OwnChecksum::kNone;
  }
  const Result<std::string> text = read_whole_file(file, kMaxJsonBytes);
  const OwnChecksum is = text ? own_checksum_of(*text) : OwnChecksum::kNone;
  const std::string name = file.filename().string();
  const bool by_a_person = name.ends_with("selections.json") || name.ends_with("corrections.json");
  return is == OwnChecksum::kNone && by_a_person && text && !nlohmann::json::accept(*text)
             ? OwnChecksum::kFails
             : is;
}

/// Sorts what no table names into its list.
void place_the_rest(const fs::path& folder, const std::vector<Recorded>& checked, VerifyReport& report) {
  const std::string log = std::string(session::kDatabase) + "-wal";
  const std::string own[] = {session::kDatabase, session::kSums, session::kLock, log,
                             std::string(session::kDatabase) + "-shm"};
  std::set<std::string> known(std::begin(own), std::end(own));
  std::ranges::transform(checked, std::inserter(known, known.end()), &Recorded::name);
  const FoundBelow found = everything_below(folder);
  for (const Error& error : found.unreadable) {
    const std::string name = fs::path(error.where).lexically_relative(folder).generic_string();
    if (session::in_a_folder_of_the_session(name)) {
      report.damaged.push_back({error.kind, error.what, name, error.mend});
    } else {
      report.extra.push_back(name);
    }
  }
  for (const fs::path& file : found.files) {
    const std::string name = file.lexically_relative(folder).generic_string();
    if (known.contains(name)) {
      continue;
    }
    std::error_code ignored;
    const bool plain = fs::symlink_status(folder / name, ignored).type() == fs::file_type::regular;
    const bool left_over = fs::path(name).filename().string().starts_with(kTemporaryPrefix);
    if (session::is_set_aside(name)) {
      report.set_aside.push_back(name);
    } else if (plain && !left_over &&
               (session::in_a_folder_of_the_session(name) || name == session::kBackup)) {
      const Result<OwnChecksum> kept = own_checksum_in(folder / name);
      if (!kept && !fs::exists(folder / name, ignored)) {
        continue;  // rows of a scan that another program has stored meanwhile
      }
      if (!kept || *kept == OwnChecksum::kFails) {
        report.damaged.push_back({kept ? ErrorKind::kBadInput : kept.error().kind,
                                  kept ? "its own checksum does not fit" : kept.error().what, name,
                                  from_a_copy(folder, ")")});
      } else {
        (*kept == OwnChecksum::kFits ? report.whole : report.unrecorded).push_back(name);
      }
    } else {
      report.extra.push_back(name);
    }
  }
}

/// What is wrong with the tables, with the log beside them, and with the list of checksums.
void check_records(SqlDatabase& db, const fs::path& folder, VerifyReport& report) {
  const std::string mend = "dubsar verify --repair " + session::word_of(folder) +
                           " rebuilds it from its rows, its backup and the grids";
  const std::string fault = db.structure_fault();
  const Result<std::vector<std::string>> rows = session::damaged_rows(db);
  if (!fault.empty() || !rows) {
    report.damaged.push_back(
        {ErrorKind::kBadInput, fault.empty() ? rows.error().what : fault, session::kDatabase, mend});
  } else {
    for (const std::string& row : *rows) {
      report.damaged.push_back({ErrorKind::kBadInput, row + " is damaged", session::kDatabase, mend});
    }
  }
  if (const fs::path aside = session::log_left_aside(folder); !aside.empty()) {
    report.damaged.push_back(session::log_aside_error(folder, aside));
  }
  const std::string log = std::string(session::kDatabase) + "-wal";
  const Result<session::LogState> state = session::read_log(folder / log);
  if (!state) {
    report.damaged.push_back(state.error());
  } else if (state->lost_commits > 0) {
    report.damaged.push_back(session::lost_commits_error(*state, log));
  }
}

}  // namespace

Result<SessionStore::Impl::Unlisted> SessionStore::Impl::unlisted() {
  // Of a scan whose row was lost the record still tells whether it was taken out, as far as it goes.
  Result<session::Losses> standing = session::standing_losses(*db);
  Result<std::map<int, session::DropState>> drops = session::dropped_by_record(*db);
  if (!standing || !drops) {
    return std::unexpected(standing ? drops.error() : standing.error());
  }
  standing->rows.merge(session::Losses(lost).rows);
  standing->more = standing->more || lost.more;
  return Unlisted{std::move(*standing), rebuilt || lost.unlisted > 0 || lost.any(), std::move(*drops)};
}

Status SessionStore::Impl::adopt(int id, const FileSum& sum, const RangeGrid& grid, const Unlisted& record) {
  const std::set<std::string>& lost_rows = record.standing.rows;
  const bool was_listed = lost_rows.contains(session::row_name("scans", std::to_string(id)));
  const auto event = lost_rows.lower_bound("events ");
  const bool may_be_out = record.standing.more || (event != lost_rows.end() && event->starts_with("events "));
  const bool unknown = (record.lacks || was_listed) && may_be_out;
  const auto known = record.drops.find(id);
  const bool dropped = known != record.drops.end() && known->second.dropped;
  nlohmann::ordered_json detail{{"id", id}};
  if (unknown) {
    detail["remark"] = "records of it are lost: it may have been taken out";
  }
  const Status done = session::in_transaction(*db, [&]() -> Status {
    if (Status put = session::insert_scan(*db, id, sum, grid); !put) {
      return put;
    }
    if (Status marked = dropped ? session::put_dropped(*db, id, true, known->second.why) : Status();
        !marked) {
      return marked;
    }
    return session::insert_event(*db, session::kAdopted, detail.dump());
  });
  if (!done) {
    return done;
  }
  std::string note = "took in " + session::grid_name(id);
  note += was_listed || unknown ? ", whose row was lost" : ", which was stored and not yet listed";
  note += dropped ? ": taken out, as its record says" : unknown ? "; it may have been taken out" : "";
  opening.notes.push_back(note);
  return {};
}

Status SessionStore::Impl::reconcile(const JobContext* job) {
  const Result<std::vector<Recorded>> listed = recorded(*db, kScanFiles);
  if (!listed) {
    return std::unexpected(listed.error());
  }
  // What was rebuilt for writing is whole from now on: no later opening would tell of it.
  const bool must_end = access == Access::kReadWrite && (rebuilt || !opening.damage.empty());
  const auto is_stopped = [&] { return !must_end && job != nullptr && job->cancelled(); };
  const auto stopped = [&] {
    return fail(ErrorKind::kCancelled, "stopped while the session was opened", folder.string());
  };
  for (std::size_t i = 0; i < listed->size(); ++i) {
    const Recorded& one = (*listed)[i];
    if (job != nullptr) {
      job->progress("checking the session", static_cast<double>(i) / static_cast<double>(listed->size()));
    }
    std::optional<Error> fault = fault_of_file(folder, one.name, one.sum, must_end ? nullptr : job);
    if (is_stopped()) {  // of a grid that was not read to its end nothing is known
      return stopped();
    }
    if (fault) {
      damaged_grids.push_back(one.id);
      opening.damage.push_back(std::move(*fault));
    }
  }
  std::optional<Unlisted> record;
  // A program that was killed between storing a grid and listing it leaves a whole grid without a row.
  for (const int id : session::grid_ids(folder)) {
    if (std::ranges::find(*listed, id, &Recorded::id) != listed->end()) {
      continue;
    }
    if (is_stopped()) {
      return stopped();
    }
    const std::string name = session::grid_name(id);
    const Result<std::string> bytes = read_whole_file(folder / name);
    const Result<RangeGrid> grid = bytes ? decode_grid(std::as_bytes(std::span(*bytes)), name)
                                         : Result<RangeGrid>(std::unexpected(bytes.error()));
    if (!grid) {
      opening.damage.push_back(grid.error());
      continue;
    }
    const FileSum sum{static_cast<std::int64_t>(bytes->size()), session::hash_of(*bytes)};
    if (!record) {  // once: nothing of this is changed by taking grids in
      Result<Unlisted> read = unlisted();
      if (!read) {
        return std::unexpected(read.error());
      }
      record = std::move(*read);
    }
    if (Status adopted = adopt(id, sum, *grid, *record); !adopted) {
      return adopted;
    }
  }
  return {};
}

Result<VerifyReport> SessionStore::verify(JobContext& job) const {
  VerifyReport report;
  const fs::path& folder = impl_->folder;
  std::vector<Recorded> files;
  {
    const std::scoped_lock hold(impl_->mutex);
    if (impl_->rebuilt && impl_->access == Access::kReadOnly) {
      report.damaged.push_back(impl_->opening.damage.front());
    }
    check_records(*impl_->db, folder, report);
    for (const char* sql : {kScanFiles, kOtherFiles}) {
      Result<std::vector<Recorded>> more = recorded(*impl_->db, sql);
      if (!more) {
        return std::unexpected(more.error());
      }
      files.insert(files.end(), more->begin(), more->end());
    }
    Result<session::Losses> lost = session::standing_losses(*impl_->db);
    if (!lost) {
      return std::unexpected(lost.error());
    }
    lost->rows.insert(impl_->lost.rows.begin(), impl_->lost.rows.end());
    lost->more = lost->more || impl_->lost.more;
    lost->unlisted = impl_->lost.unlisted;
    report.lost = session::told_losses(*lost, session::kDatabase, folder);
  }
  const bool database_whole = report.damaged.empty();  // as far as its rows tell
  // Grids that cannot be read and were never listed: seen while opening, in no table.
  for (const Error& seen : impl_->opening.damage) {
    const std::string name = fs::path(seen.where).lexically_relative(folder).generic_string();
    const std::string& where = name.empty() || name.starts_with("..") ? seen.where : name;
    if (where.ends_with(".grid") && std::ranges::find(files, where, &Recorded::name) == files.end()) {
      report.damaged.push_back({seen.kind, seen.what, where, seen.mend});
      files.push_back({-1, where, {}});
    }
  }
  const std::size_t first_unlisted = files.size();
  const Result<session::Sums> sums = session::read_sums(folder);
  if (!sums) {
    report.damaged.push_back({sums.error().kind, sums.error().what, session::kSums, sums.error().mend});
  } else if (!sums->empty()) {
    report.whole.emplace_back(session::kSums);
  }
  std::error_code unknown;
  const bool being_written =
      impl_->access == Access::kReadWrite || (fs::exists(folder / "session.sqlite-wal", unknown) &&
                                              fs::file_size(folder / "session.sqlite-wal", unknown) > 0);
  // Closing writes the sums before it writes the backup: a backup without sums has lost them since. The
  // program that is about to write both anew need not be told.
  if (impl_->access == Access::kReadOnly && fs::exists(folder / session::kBackup, unknown) &&
      !fs::exists(folder / session::kSums, unknown) && !unknown) {
    report.damaged.push_back({ErrorKind::kBadInput, "missing", session::kSums,
                              "dubsar verify --repair " + session::word_of(folder) + " makes it anew"});
  }
  bool database_summed = false;
  for (const char* name : {session::kDatabase, session::kBackup}) {
    // With a log beside it another program has written on; the file is then checked by its rows alone.
    if (sums && sums->contains(name) && (name != std::string(session::kDatabase) || !being_written)) {
      database_summed = database_summed || name == std::string(session::kDatabase);
      files.push_back({-1, name, sums->find(name)->second});
    }
  }
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Recorded& one = files[i];
    job.progress("verify", static_cast<double>(i) / static_cast<double>(files.size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "verification cancelled", folder.string());
    }
    if (i < first_unlisted && one.id < 0 && one.sum == FileSum{}) {
      continue;  // told above
    }
    std::optional<Error> fault = fault_of_file(folder, one.name, one.sum, &job);
    if (fault && i >= first_unlisted) {
      // Either of two sums will do.
      const auto [from, to] = sums->equal_range(one.name);
      bool not_there_yet = false;
      for (auto other = from; fault && other != to; ++other) {
        std::error_code error;
        not_there_yet = not_there_yet ||
                        (other->second == session::kNotThereYet && !fs::exists(folder / one.name, error));
        fault = fault_of_file(folder, one.name, other->second, &job);
      }
      if (fault && not_there_yet) {
        continue;
      }
    }
    if (fault && fault->kind == ErrorKind::kCancelled) {
      return std::unexpected(std::move(*fault));
    }
    if (fault) {
      report.damaged.push_back(std::move(*fault));
    } else if (one.name != session::kDatabase || database_whole) {
      report.whole.push_back(one.name);
    }
  }
  if (database_whole && !database_summed) {
    // A database at rest has bytes between its rows that nothing covers then.
    auto& list = being_written ? report.whole : report.unrecorded;
    list.insert(list.begin(), session::kDatabase);
  }
  place_the_rest(folder, files, report);
  job.progress("verify", 1.0);
  return report;
}

}  // namespace dubsar
