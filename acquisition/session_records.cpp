// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <zstd.h>

#include <algorithm>

#include "acquisition/lost_places.h"
#include "acquisition/pose_json.h"
#include "acquisition/session_impl.h"
#include "acquisition/session_query.h"
#include "acquisition/session_store.h"
#include "formats/atomic_file.h"
#include "formats/refusal.h"

namespace dubsar {

namespace fs = std::filesystem;
using session::checked_row;
using session::FileSum;
using session::for_each_row;
using session::in_transaction;

namespace {

/// Flags are nearly empty bytes: the quickest level packs them a hundredfold.
constexpr int kFlagsLevel = 1;
/// Larger than any grid; a damaged count must not ask for all memory.
constexpr std::int64_t kMaxFlags = std::int64_t{1} << 31;

/// Whether the packed bytes say that they are `count` flags, and are enough for them: a block of zstd takes
/// four bytes at least and gives 128 KiB at most (RFC 8878, 3.1.1.2).
bool may_hold(std::string_view packed, std::int64_t count) {
  constexpr std::size_t kLeastBlock = 4;
  constexpr std::size_t kMostFromABlock = std::size_t{128} << 10U;
  return count >= 0 && count <= kMaxFlags &&
         static_cast<std::size_t>(count) <= packed.size() / kLeastBlock * kMostFromABlock &&
         ZSTD_getFrameContentSize(packed.data(), packed.size()) == static_cast<std::uint64_t>(count);
}

Result<fs::path> name_of_file(const fs::path& relative) {
  fs::path normal = relative.lexically_normal();
  if (!session::in_a_folder_of_the_session(normal)) {
    return fail(ErrorKind::kUsage, "not a file of the session", relative.string());
  }
  return normal;
}

Status put_sum(SqlDatabase& db, const fs::path& name, const FileSum& sum) {
  Result<SqlStatement> put = db.prepare(session::insert_sql(session::table_named("files")).c_str());
  if (!put) {
    return std::unexpected(put.error());
  }
  return put->bind(1, name.generic_string()).bind(2, sum.bytes).bind(3, sum.hash).run();
}

Result<std::vector<ScanPose>> stored_poses(SqlDatabase& db) {
  std::vector<ScanPose> out;
  const Status read = for_each_row(
      db, "SELECT id, json FROM poses WHERE sum IS dubsar_sum(id,json) ORDER BY id",
      [&](const SqlStatement& row) -> Status {
        Result<ScanPose> pose = session::pose_from_json(static_cast<int>(row.integer(0)), row.text(1));
        if (!pose) {
          return std::unexpected(pose.error());
        }
        out.push_back(std::move(*pose));
        return {};
      });
  if (!read) {
    return std::unexpected(read.error());
  }
  return out;
}

/// And of scans that stand and are damaged, as they are stored.
Result<std::vector<ScanPose>> with_those_of_lost(SqlDatabase& db, const std::vector<ScanPose>& poses,
                                                 const std::vector<int>& damaged) {
  if (damaged.empty()) {
    return poses;
  }
  std::vector<int> lost;
  const Status read = for_each_row(db, "SELECT id FROM scans WHERE dropped = 0 ORDER BY id",
                                   [&](const SqlStatement& row) -> Status {
                                     const int id = static_cast<int>(row.integer(0));
                                     if (std::ranges::find(damaged, id) != damaged.end()) {
                                       lost.push_back(id);
                                     }
                                     return {};
                                   });
  if (!read) {
    return std::unexpected(read.error());
  }
  const Result<std::vector<ScanPose>> before = stored_poses(db);
  return before ? session::with_lost_places(poses, *before, lost) : before;
}

}  // namespace

Status SessionStore::save_poses(const std::vector<ScanPose>& poses) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const std::scoped_lock hold(impl_->mutex);
  return in_transaction(*impl_->db, [&]() -> Status {
    const Result<std::vector<ScanPose>> all = with_those_of_lost(*impl_->db, poses, impl_->damaged_grids);
    if (!all) {
      return std::unexpected(all.error());
    }
    if (Status cleared = impl_->db->execute("DELETE FROM poses"); !cleared) {
      return cleared;
    }
    Result<SqlStatement> put = impl_->db->prepare(session::insert_sql(session::table_named("poses")).c_str());
    if (!put) {
      return std::unexpected(put.error());
    }
    for (const ScanPose& pose : *all) {
      put->bind(1, pose.id).bind(2, session::json_from_pose(pose));
      if (Status done = put->run(); !done) {
        return done;
      }
    }
    return {};
  });
}

Result<std::vector<ScanPose>> SessionStore::poses() const {
  const std::scoped_lock hold(impl_->mutex);
  return stored_poses(*impl_->db);
}

Status SessionStore::save_flags(int id, const SampleFlags& flags) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  std::string packed(ZSTD_compressBound(flags.size()), '\0');
  const std::size_t size =
      ZSTD_compress(packed.data(), packed.size(), flags.data(), flags.size(), kFlagsLevel);
  if (ZSTD_isError(size) != 0) {
    return fail(ErrorKind::kInternal, "flags could not be packed", impl_->folder.string());
  }
  packed.resize(size);
  const std::scoped_lock hold(impl_->mutex);
  Result<SqlStatement> put = impl_->db->prepare(session::insert_sql(session::table_named("flags")).c_str());
  if (!put) {
    return std::unexpected(put.error());
  }
  put->bind(1, id).bind(2, static_cast<std::int64_t>(flags.size())).bind_blob(3, packed);
  return put->run();
}

Result<std::optional<SampleFlags>> SessionStore::load_flags(int id) const {
  const std::string where = "flags of scan " + std::to_string(id);
  std::int64_t count = 0;
  std::string packed;
  {
    const std::scoped_lock hold(impl_->mutex);
    auto row = checked_row(
        *impl_->db, "SELECT sum IS dubsar_sum(id,count,packed), count, packed FROM flags WHERE id = ?1", id,
        where);
    if (!row) {
      return std::unexpected(row.error());
    }
    if (!*row) {
      return std::optional<SampleFlags>();
    }
    count = (*row)->integer(1);
    packed = (*row)->text(2);
  }
  if (!may_hold(packed, count)) {
    return bad_input(where, "the stored count is not that of the stored flags", "flag the scan anew");
  }
  SampleFlags flags(static_cast<std::size_t>(count));
  const std::size_t got = ZSTD_decompress(flags.data(), flags.size(), packed.data(), packed.size());
  if (ZSTD_isError(got) != 0 || got != flags.size()) {
    return bad_input(where, "the stored flags cannot be unpacked", "flag the scan anew");
  }
  return std::optional(std::move(flags));
}

Status SessionStore::save_document(std::string_view name, std::string_view json) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const std::scoped_lock hold(impl_->mutex);
  Result<SqlStatement> put =
      impl_->db->prepare(session::insert_sql(session::table_named("documents")).c_str());
  if (!put) {
    return std::unexpected(put.error());
  }
  return put->bind(1, name).bind(2, json).run();
}

Result<std::optional<std::string>> SessionStore::load_document(std::string_view name) const {
  const std::scoped_lock hold(impl_->mutex);
  auto row =
      checked_row(*impl_->db, "SELECT sum IS dubsar_sum(name,json), json FROM documents WHERE name = ?1",
                  name, std::string(name));
  if (!row) {
    return std::unexpected(row.error());
  }
  return *row ? std::optional((*row)->text(1)) : std::nullopt;
}

Result<std::set<std::string>> SessionStore::lost_rows() const {
  const std::scoped_lock hold(impl_->mutex);
  Result<session::Losses> lost = session::standing_losses(*impl_->db);
  if (!lost) {
    return std::unexpected(lost.error());
  }
  lost->rows.insert(impl_->lost.rows.begin(), impl_->lost.rows.end());
  return std::move(lost->rows);
}

Result<std::vector<std::string>> SessionStore::document_names() const {
  const std::scoped_lock hold(impl_->mutex);
  std::vector<std::string> out;
  const Status read = for_each_row(*impl_->db, "SELECT name FROM documents ORDER BY name",
                                   [&](const SqlStatement& row) -> Status {
                                     out.push_back(row.text(0));
                                     return {};
                                   });
  if (!read) {
    return std::unexpected(read.error());
  }
  return out;
}

Status SessionStore::append_event(std::string_view kind, std::string_view json) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const std::scoped_lock hold(impl_->mutex);
  return in_transaction(*impl_->db, [&] { return session::insert_event(*impl_->db, kind, json); });
}

Result<std::vector<SessionEvent>> SessionStore::events() const {
  const std::scoped_lock hold(impl_->mutex);
  std::vector<SessionEvent> out;
  const Status read =
      for_each_row(*impl_->db, "SELECT number,time_ns,kind,json FROM events ORDER BY number",
                   [&](const SqlStatement& row) -> Status {
                     out.push_back({row.integer(0), row.integer(1), row.text(2), row.text(3)});
                     return {};
                   });
  if (!read) {
    return std::unexpected(read.error());
  }
  return out;
}

Status SessionStore::record_file(const fs::path& relative) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const Result<fs::path> name = name_of_file(relative);
  const Result<FileSum> sum =
      name ? session::sum_of_file(impl_->folder / *name) : std::unexpected(name.error());
  if (!sum) {
    return std::unexpected(sum.error());
  }
  const std::scoped_lock hold(impl_->mutex);
  return put_sum(*impl_->db, *name, *sum);
}

Status SessionStore::replace_file(const fs::path& relative,
                                  const std::function<Status(const fs::path&)>& write) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const Result<fs::path> name = name_of_file(relative);
  if (!name) {
    return std::unexpected(name.error());
  }
  const fs::path file = impl_->folder / *name;
  const fs::path staged = file.parent_path() / (std::string(kTemporaryPrefix) + file.filename().string());
  const auto give_up = [&](Error error) -> Status {
    std::error_code ignored;
    fs::remove(staged, ignored);
    if (error.where == staged.string()) {
      error.where = file.string();
    }
    return std::unexpected(std::move(error));
  };
  if (Status written = write(staged); !written) {
    return give_up(std::move(written.error()));
  }
  const Result<FileSum> sum = session::sum_of_file(staged);
  if (!sum) {
    return give_up(sum.error());
  }
  const std::scoped_lock hold(impl_->mutex);
  const Result<std::optional<FileSum>> before = session::recorded_sum(*impl_->db, name->generic_string());
  if (!before) {
    return give_up(before.error());
  }
  // Between these steps the file has no checksum; with one it would look damaged after a kill.
  Result<SqlStatement> take = impl_->db->prepare("DELETE FROM files WHERE path = ?1");
  if (Status taken = take ? take->bind(1, name->generic_string()).run() : std::unexpected(take.error());
      !taken) {
    return give_up(std::move(taken.error()));
  }
  std::error_code error;
  fs::rename(staged, file, error);
  if (error) {
    if (*before) {
      (void)put_sum(*impl_->db, *name, **before);  // the old one stays; without its sum it is told of as such
    }
    return give_up(
        refused(file, "cannot be written", error.value(), "check the folder and its rights").error());
  }
  if (Status synced = sync_folder(file.parent_path()); !synced) {
    return synced;
  }
  return put_sum(*impl_->db, *name, *sum);
}

}  // namespace dubsar
