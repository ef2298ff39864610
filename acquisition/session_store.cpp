// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/session_store.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "acquisition/session_impl.h"
#include "acquisition/session_links.h"
#include "acquisition/session_presence.h"
#include "acquisition/session_query.h"
#include "formats/atomic_file.h"
#include "formats/grid_file.h"

namespace dubsar {

namespace fs = std::filesystem;
using session::checked_row;
using session::FileSum;
using session::for_each_row;
using session::in_transaction;

namespace {

/// What devices remarked on scans, by id: it stands in the record of their storing, so that sessions of
/// earlier versions, which have none, need no other tables.
Result<std::map<int, std::string>> stored_remarks(SqlDatabase& db) {
  std::map<int, std::string> out;
  std::map<int, std::string> unknown;  // what could not be told of scans whose row was lost
  const Status read = for_each_row(
      db, "SELECT kind, json FROM events WHERE sum IS dubsar_sum(number,time_ns,kind,json) ORDER BY number",
      [&](const SqlStatement& row) -> Status {
        const std::string kind = row.text(0);
        if (kind != session::kScanStored && kind != session::kAdopted && kind != session::kBroughtBack) {
          return {};
        }
        const nlohmann::json detail = nlohmann::json::parse(row.text(1), nullptr, false);
        if (kind == session::kBroughtBack) {
          if (detail.is_object() && detail.value("all", nlohmann::json()) == true) {
            unknown.clear();
          }
          return {};
        }
        const auto id = detail.is_object() ? detail.find("id") : detail.end();
        const auto remark = detail.is_object() ? detail.find("remark") : detail.end();
        if (remark != detail.end() && remark->is_string() && id != detail.end() && id->is_number_integer()) {
          (kind == session::kScanStored ? out : unknown)[id->get<int>()] = remark->get<std::string>();
        }
        return {};
      });
  for (const auto& [id, remark] : unknown) {
    std::string& said = out[id];
    said += (said.empty() ? "" : "; ") + remark;
  }
  return read ? Result<std::map<int, std::string>>(std::move(out)) : std::unexpected(read.error());
}

}  // namespace

SessionStore::Impl::~Impl() {
  if (access == Access::kReadWrite && db && lock->is_of(folder)) {
    session::close_cleanly(folder, db);
  }
}

Status SessionStore::Impl::writable() const {
  if (access != Access::kReadWrite) {
    return fail(ErrorKind::kUsage, "the session was opened for reading only", folder.string());
  }
  if (!lock->is_of(folder)) {
    // Its tables are those that were opened, wherever they lie now; files would go to what lies here.
    return fail(ErrorKind::kStorage,
                "nothing is stored: since it was opened the session was moved, or its lock taken away",
                folder.string(), "open the session again where it lies now");
  }
  return {};
}

Result<int> SessionStore::Impl::next_id() {
  const Result<std::int64_t> last = db->integer_of("SELECT coalesce(max(id), -1) FROM scans");
  if (!last) {
    return std::unexpected(last.error());
  }
  // A damaged grid whose row is lost keeps its number too.
  const std::vector<int> there = session::grid_ids(folder);
  const std::int64_t newest = std::max<std::int64_t>(*last, there.empty() ? -1 : there.back());
  if (newest >= session::kLastScanId) {
    return bad_input(folder.string(), "no number is left after that of scan " + std::to_string(newest),
                     "go on in a new session");
  }
  return static_cast<int>(newest) + 1;
}

SessionStore::SessionStore(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SessionStore::~SessionStore() = default;
SessionStore::SessionStore(SessionStore&&) noexcept = default;
SessionStore& SessionStore::operator=(SessionStore&&) noexcept = default;

bool SessionStore::is_session(const fs::path& folder) {
  std::error_code error;
  return fs::exists(folder / session::kDatabase, error) || fs::exists(folder / session::kBackup, error) ||
         !session::grid_ids(folder).empty();
}

Result<SessionStore> SessionStore::open_or_create(const fs::path& folder, OnDamage on_damage,
                                                  const JobContext* job) {
  return open_for_writing(folder, on_damage, nullptr, job);
}

Result<SessionStore> SessionStore::open_with_copy(const fs::path& folder, const fs::path& copy) {
  const Status there = check_is_session(folder);
  return there ? open_for_writing(folder, OnDamage::kRebuild, &copy, nullptr)
               : std::unexpected(there.error());
}

Result<SessionStore> SessionStore::open_for_writing(const fs::path& folder, OnDamage on_damage,
                                                    const fs::path* copy, const JobContext* job) {
  if (Status made = session::make_folders(folder); !made) {
    return std::unexpected(made.error());
  }
  if (Status plain = session::check_written_names_are_no_links(folder); !plain) {
    return std::unexpected(plain.error());
  }
  auto impl = std::make_unique<Impl>();
  impl->folder = folder;
  Result<session::FolderLock> lock = session::FolderLock::take(folder);
  if (!lock) {
    return std::unexpected(lock.error());
  }
  impl->lock = std::move(*lock);
  if (on_damage == OnDamage::kRefuse && is_session(folder)) {
    if (Status whole = session::check_records(folder); !whole) {
      return std::unexpected(whole.error());
    }
  }
  if (Status apart = session::take_tables_apart(folder); !apart) {
    return std::unexpected(apart.error());
  }
  if (const int removed = session::remove_temporaries(folder); removed > 0) {
    impl->opening.notes.push_back("half-written files removed: " + std::to_string(removed));
  }
  Result<SqlDatabase> db = session::open_for_writing(folder, impl->opening, impl->rebuilt, impl->lost);
  if (!db) {
    return std::unexpected(db.error());
  }
  impl->db = std::move(*db);
  if (copy != nullptr) {
    if (Status back = session::bring_back_records(folder, *copy, *impl->db, impl->opening); !back) {
      return std::unexpected(back.error());
    }
  }
  if (Status reconciled = impl->reconcile(job); !reconciled) {
    return std::unexpected(reconciled.error());
  }
  return SessionStore(std::move(impl));
}

Result<SessionStore> SessionStore::open(const fs::path& folder, Access access, OnDamage on_damage,
                                        const JobContext* job) {
  if (Status there = check_is_session(folder); !there) {
    return std::unexpected(there.error());
  }
  if (access == Access::kReadWrite) {
    return open_or_create(folder, on_damage, job);
  }
  auto impl = std::make_unique<Impl>();
  impl->folder = folder;
  impl->access = access;
  Result<SqlDatabase> db = session::open_for_reading(folder, impl->opening, impl->rebuilt, impl->lost);
  if (!db) {
    return std::unexpected(db.error());
  }
  impl->db = std::move(*db);
  if (Status reconciled = impl->reconcile(job); !reconciled) {
    return std::unexpected(reconciled.error());
  }
  return SessionStore(std::move(impl));
}

const SessionOpening& SessionStore::opening() const {
  return impl_->opening;
}
const fs::path& SessionStore::folder() const {
  return impl_->folder;
}

double SessionStore::disk_free_gib() const {
  std::error_code error;
  const fs::space_info space = fs::space(impl_->folder, error);
  return error ? 0.0 : static_cast<double>(space.available) / static_cast<double>(1U << 30U);
}

Result<int> SessionStore::next_id() const {
  const std::scoped_lock hold(impl_->mutex);
  return impl_->next_id();
}

Result<RangeGrid> SessionStore::load_grid(int id) const {
  FileSum expected;
  const std::string name = session::grid_name(id);
  {
    const std::scoped_lock hold(impl_->mutex);
    auto row =
        checked_row(*impl_->db,
                    "SELECT sum IS dubsar_sum(id,file,bytes,hash,rows,cols,samples,spacing_mm,timestamp_ns,"
                    "device,source,dropped,note), bytes, hash FROM scans WHERE id = ?1",
                    id, name);
    if (!row) {
      return std::unexpected(row.error());
    }
    if (!*row) {
      return fail(ErrorKind::kUsage, "no scan " + std::to_string(id), impl_->folder.string());
    }
    expected = {(*row)->integer(1), (*row)->integer(2)};
  }
  const fs::path path = impl_->folder / name;
  const Result<std::string> bytes = read_whole_file(path);
  if (!bytes) {
    return std::unexpected(bytes.error());
  }
  if (FileSum{static_cast<std::int64_t>(bytes->size()), session::hash_of(*bytes)} != expected) {
    return bad_input(path.string(), "not the bytes that were stored",
                     "bring it back from a copy or scan again");
  }
  return decode_grid(std::as_bytes(std::span(*bytes)), path.string());
}

Result<std::vector<StoredScan>> SessionStore::scans() const {
  const std::scoped_lock hold(impl_->mutex);
  Result<std::map<int, std::string>> remarks = stored_remarks(*impl_->db);
  if (!remarks) {
    return std::unexpected(remarks.error());
  }
  std::vector<StoredScan> out;
  const Status read =
      for_each_row(*impl_->db,
                   "SELECT id,file,rows,cols,samples,spacing_mm,timestamp_ns,device,source,dropped,"
                   "note FROM scans ORDER BY id",
                   [&](const SqlStatement& row) -> Status {
                     StoredScan scan;
                     scan.id = static_cast<int>(row.integer(0));
                     scan.file = row.text(1);
                     scan.rows = static_cast<int>(row.integer(2));
                     scan.cols = static_cast<int>(row.integer(3));
                     scan.samples = row.integer(4);
                     scan.spacing_mm = row.number(5);
                     scan.timestamp_ns = row.integer(6);
                     scan.device = row.text(7);
                     scan.source = row.text(8);
                     scan.dropped = row.integer(9) != 0;
                     scan.note = row.text(10);
                     if (const auto said = remarks->find(scan.id); said != remarks->end()) {
                       scan.remark = std::move(said->second);
                     }
                     scan.damaged = std::ranges::binary_search(impl_->damaged_grids, scan.id);
                     out.push_back(std::move(scan));
                     return {};
                   });
  if (!read) {
    return std::unexpected(read.error());
  }
  return out;
}

namespace {

Status mark_scan(SqlDatabase& db, int id, bool dropped, std::string_view why, const fs::path& folder) {
  return in_transaction(db, [&]() -> Status {
    bool stood = false;
    {  // a row that was damaged since the session was opened must not get a checksum that fits
      auto row =
          checked_row(db,
                      "SELECT sum IS dubsar_sum(id,file,bytes,hash,rows,cols,samples,spacing_mm,timestamp_ns,"
                      "device,source,dropped,note), dropped FROM scans WHERE id = ?1",
                      id, session::grid_name(id));
      if (!row) {
        return std::unexpected(row.error());
      }
      if (!*row) {
        return fail(ErrorKind::kUsage, "no scan " + std::to_string(id), folder.string());
      }
      stood = (*row)->integer(1) != 0;
    }
    // What is so already stays as it is: the reason that it was dropped for, above all.
    if (stood == dropped) {
      return {};
    }
    if (Status marked = session::put_dropped(db, id, dropped, why); !marked) {
      return marked;
    }
    const nlohmann::json detail{{"id", id}, {"why", std::string(why)}};
    return session::insert_event(db, dropped ? session::kScanDropped : session::kScanRestored,
                                 detail.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace));
  });
}

}  // namespace

Status SessionStore::drop_scan(int id, std::string_view why) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const std::scoped_lock hold(impl_->mutex);
  return mark_scan(*impl_->db, id, true, why, impl_->folder);
}

Status SessionStore::restore_scan(int id) {
  if (Status writable = impl_->writable(); !writable) {
    return writable;
  }
  const std::scoped_lock hold(impl_->mutex);
  return mark_scan(*impl_->db, id, false, {}, impl_->folder);
}

Result<std::optional<int>> SessionStore::undo_last_scan() {
  if (Status writable = impl_->writable(); !writable) {
    return std::unexpected(writable.error());
  }
  const std::scoped_lock hold(impl_->mutex);
  const Result<std::int64_t> last =
      impl_->db->integer_of("SELECT coalesce(max(id), -1) FROM scans WHERE dropped = 0");
  if (!last) {
    return std::unexpected(last.error());
  }
  if (*last < 0) {
    return std::optional<int>();
  }
  const int id = static_cast<int>(*last);
  if (Status marked = mark_scan(*impl_->db, id, true, "undone", impl_->folder); !marked) {
    return std::unexpected(marked.error());
  }
  return std::optional(id);
}

}  // namespace dubsar
