// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>

#include "acquisition/session_impl.h"
#include "acquisition/session_query.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"

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

/// Nothing when the file is as it was stored.
std::optional<Error> fault_of_file(const fs::path& folder, const std::string& name, const FileSum& expected,
                                   const JobContext* job) {
  const std::string mend =
      "bring it back from a copy" + std::string(name.ends_with(".grid") ? " or scan again" : "");
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

/// Files of the derived folders, relative, in name order.
std::vector<std::string> derived_files(const fs::path& folder) {
  std::vector<std::string> out;
  for (const char* name : session::kFolders) {
    std::error_code ignored;
    fs::recursive_directory_iterator it(folder / name, fs::directory_options::skip_permission_denied,
                                        ignored);
    for (const fs::recursive_directory_iterator end; !ignored && it != end; it.increment(ignored)) {
      if (it->is_regular_file(ignored)) {
        out.push_back(it->path().lexically_relative(folder).generic_string());
      }
    }
  }
  std::ranges::sort(out);
  return out;
}

}  // namespace

Status SessionStore::Impl::reconcile() {
  const Result<std::vector<Recorded>> listed = recorded(*db, kScanFiles);
  if (!listed) {
    return std::unexpected(listed.error());
  }
  for (const Recorded& one : *listed) {
    if (std::optional<Error> fault = fault_of_file(folder, one.name, one.sum, nullptr)) {
      damaged_grids.push_back(one.id);
      opening.damage.push_back(std::move(*fault));
    }
  }
  // A program that was killed between storing a grid and listing it leaves a whole grid without a row.
  for (const int id : session::grid_ids(folder)) {
    if (std::ranges::find(*listed, id, &Recorded::id) != listed->end()) {
      continue;
    }
    const std::string name = session::grid_name(id);
    const Result<std::string> bytes = read_whole_file(folder / name);
    const Result<RangeGrid> grid = bytes ? decode_grid(std::as_bytes(std::span(*bytes)), name)
                                         : Result<RangeGrid>(std::unexpected(bytes.error()));
    if (!grid) {
      opening.damage.push_back(grid.error());
      continue;
    }
    const Status adopted = session::in_transaction(*db, [&]() -> Status {
      const FileSum sum{static_cast<std::int64_t>(bytes->size()), session::hash_of(*bytes)};
      if (Status put = session::insert_scan(*db, id, sum, *grid); !put) {
        return put;
      }
      return session::insert_event(*db, "scan adopted", "{\"id\":" + std::to_string(id) + "}");
    });
    if (!adopted) {
      return adopted;
    }
    opening.notes.push_back("took in " + name + ", which was stored and not yet listed");
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
    const std::string fault = impl_->db->structure_fault();
    const Result<std::vector<std::string>> rows = session::damaged_rows(*impl_->db);
    if (!fault.empty() || !rows) {
      report.damaged.push_back({ErrorKind::kBadInput, fault.empty() ? rows.error().what : fault,
                                session::kDatabase, "open the session for writing to have it rebuilt"});
    } else {
      for (const std::string& row : *rows) {
        report.damaged.push_back({ErrorKind::kBadInput, row + " is damaged", session::kDatabase,
                                  "open the session for writing to have it rebuilt"});
      }
    }
    for (const char* sql : {kScanFiles, kOtherFiles}) {
      Result<std::vector<Recorded>> more = recorded(*impl_->db, sql);
      if (!more) {
        return std::unexpected(more.error());
      }
      files.insert(files.end(), more->begin(), more->end());
    }
  }
  const Result<std::map<std::string, FileSum>> sums = session::read_sums(folder);
  if (!sums) {
    report.damaged.push_back(sums.error());
  } else {
    for (const auto& [name, sum] : *sums) {
      std::error_code error;
      // With a log beside it another program has written on; the file is then checked by its rows alone.
      if (name != session::kDatabase || fs::file_size(folder / "session.sqlite-wal", error) == 0 || error) {
        files.push_back({-1, name, sum});
      }
    }
  }
  const bool database_whole = report.damaged.empty();
  bool database_summed = false;
  for (std::size_t i = 0; i < files.size(); ++i) {
    const Recorded& one = files[i];
    job.progress("verify", static_cast<double>(i) / static_cast<double>(files.size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "verification cancelled", folder.string());
    }
    database_summed = database_summed || one.name == session::kDatabase;
    std::optional<Error> fault = fault_of_file(folder, one.name, one.sum, &job);
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
    report.whole.insert(report.whole.begin(), session::kDatabase);
  }
  for (const std::string& name : derived_files(folder)) {
    if (std::ranges::find(files, name, &Recorded::name) == files.end() &&
        !fs::path(name).filename().string().starts_with(kTemporaryPrefix)) {
      report.unrecorded.push_back(name);
    }
  }
  job.progress("verify", 1.0);
  return report;
}

}  // namespace dubsar
