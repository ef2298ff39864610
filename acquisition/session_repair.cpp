// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <nlohmann/json.hpp>

#include "acquisition/session_impl.h"
#include "acquisition/session_query.h"
#include "acquisition/session_rebuild.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"
#include "formats/self_checked.h"

namespace dubsar {

namespace fs = std::filesystem;
using session::FileSum;

Result<std::optional<FileSum>> session::recorded_sum(SqlDatabase& db, const std::string& name) {
  Result<SqlStatement> query = db.prepare(
      "SELECT bytes, hash FROM scans WHERE file = ?1 UNION ALL SELECT bytes, hash FROM files WHERE path = "
      "?1");
  if (!query) {
    return std::unexpected(query.error());
  }
  query->bind(1, name);
  const Result<bool> row = query->step();
  if (!row) {
    return std::unexpected(row.error());
  }
  return *row ? std::optional(FileSum{query->integer(0), query->integer(1)}) : std::nullopt;
}

namespace {

/// The bytes of the copy's file, when they are those that were stored.
std::optional<std::string> good_bytes(const fs::path& file, const std::optional<FileSum>& expected) {
  const Result<std::string> bytes = read_whole_file(file);
  if (!bytes) {
    return std::nullopt;
  }
  if (expected) {
    const FileSum sum{static_cast<std::int64_t>(bytes->size()), session::hash_of(*bytes)};
    return sum == *expected ? std::optional(*bytes) : std::nullopt;
  }
  // What no table lists vouches for itself.
  const bool whole = file.extension() == ".grid"
                         ? verify_grid_bytes(std::as_bytes(std::span(*bytes)), file.string()).has_value()
                         : own_checksum_of(*bytes) == OwnChecksum::kFits;
  return whole ? std::optional(*bytes) : std::nullopt;
}

Status make_room(const fs::path& path) {
  std::error_code error;
  if (!fs::exists(path, error)) {
    return {};
  }
  const Result<fs::path> aside = session::move_aside(path);
  return aside ? Status() : std::unexpected(aside.error());
}

}  // namespace

Result<RepairReport> SessionStore::repair(const VerifyReport& found, const std::optional<fs::path>& copy,
                                          JobContext& job) {
  if (Status writable = impl_->writable(); !writable) {
    return std::unexpected(writable.error());
  }
  RepairReport out;
  const std::scoped_lock hold(impl_->mutex);
  for (std::size_t i = 0; i < found.damaged.size(); ++i) {
    job.progress("repair", static_cast<double>(i) / static_cast<double>(found.damaged.size()));
    if (job.cancelled()) {
      return fail(ErrorKind::kCancelled, "repair cancelled", impl_->folder.string());
    }
    const Error& fault = found.damaged[i];
    const std::string& name = fault.where;
    if (!session::in_a_folder_of_the_session(name)) {
      continue;  // a table: opening has seen to it
    }
    const fs::path path = impl_->folder / name;
    const Result<std::optional<FileSum>> expected = session::recorded_sum(*impl_->db, name);
    if (!expected) {
      return std::unexpected(expected.error());
    }
    if (const std::optional<std::string> bytes = copy ? good_bytes(*copy / name, *expected) : std::nullopt) {
      if (Status aside = make_room(path); !aside) {
        return std::unexpected(aside.error());
      }
      if (Status written = write_file_atomically(path, std::string_view(*bytes)); !written) {
        return std::unexpected(written.error());
      }
      std::erase_if(impl_->damaged_grids, [&](int id) { return session::grid_name(id) == name; });
      out.restored.push_back(name);
    } else if (*expected && !name.starts_with(std::string(session::kGrids) + "/")) {
      if (Status aside = make_room(path); !aside) {
        return std::unexpected(aside.error());
      }
      out.derived.push_back(name);
    } else {
      out.beyond.push_back(fault);
    }
  }
  job.progress("repair", 1.0);
  const nlohmann::json what{{"restored", out.restored}, {"made_anew", out.derived}};
  if (!out.restored.empty() || !out.derived.empty()) {
    const Status noted = session::in_transaction(*impl_->db, [&]() -> Status {
      return session::insert_event(*impl_->db, "repaired",
                                   what.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
    });
    if (!noted) {
      return std::unexpected(noted.error());
    }
  }
  return out;
}

Result<std::vector<std::string>> SessionStore::keep_damaged_records(const fs::path& folder,
                                                                    const VerifyReport& found) {
  std::vector<std::string> out;
  const Result<session::FolderLock> lock = session::FolderLock::take(folder);
  if (!lock) {
    return std::unexpected(lock.error());
  }
  for (const char* name : {session::kDatabase, session::kBackup, session::kSums}) {
    std::error_code ignored;
    const bool damaged = std::ranges::find(found.damaged, name, &Error::where) != found.damaged.end();
    if (!damaged || !fs::exists(folder / name, ignored)) {
      continue;
    }
    if (name == std::string_view(session::kDatabase)) {  // and its log, as rebuilding keeps the two
      Result<std::vector<std::string>> both = session::keep_aside(folder);
      if (!both) {
        return std::unexpected(both.error());
      }
      out.insert(out.end(), both->begin(), both->end());
      continue;
    }
    const Result<fs::path> aside = session::copy_aside(folder / name);
    if (!aside && !read_whole_file(folder / name)) {
      continue;  // opening tells it
    }
    if (!aside) {
      return std::unexpected(aside.error());
    }
    out.push_back(aside->filename().string());
  }
  return out;
}

}  // namespace dubsar
