// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "core/job.h"
#include "core/range_grid.h"
#include "core/result.h"
#include "core/sample_flags.h"
#include "core/scan_pose.h"

namespace dubsar {

/// A scan as the session's list has it; the samples are in its grid file.
struct StoredScan {
  int id = 0;
  std::string file;  ///< relative to the session folder, "grids/007.grid"
  int rows = 0;
  int cols = 0;
  std::int64_t samples = 0;  ///< valid ones
  double spacing_mm = 0;
  std::int64_t timestamp_ns = 0;
  std::string device;
  std::string source;  ///< original name, or empty
  std::string note;    ///< why it was dropped; empty otherwise
  std::string remark;  ///< of the device on this scan, when it was stored; empty where there was none
  bool dropped = false;
  bool damaged = false;  ///< its grid file is missing or not what was stored
};

struct SessionEvent {
  std::int64_t number = 0;   ///< ascending from 1
  std::int64_t time_ns = 0;  ///< since 1970
  std::string kind;
  std::string json;
};

/// What opening found. Damage is one error per damaged thing; everything else in the session stands.
struct SessionOpening {
  bool created = false;
  std::vector<Error> damage;
  std::vector<std::string> notes;  ///< what was recovered, one line each
  std::vector<std::string>
      brought_back;  ///< records that came from a copy ("events row 12", "9 rows of events")
  std::optional<Error> no_use_of_copy;  ///< why it gave no records, where some are lost
};

/// The answer of verify(). Names are relative to the session folder; every file of it is in one of the lists,
/// except for the lock, which holds nothing.
struct VerifyReport {
  std::vector<Error> damaged;  ///< missing ones too
  std::vector<Error> lost;     ///< records that were damaged before and that nothing has brought back since
  std::vector<std::string> whole;
  std::vector<std::string> unrecorded;  ///< files of the session that it keeps no checksum of
  std::vector<std::string> extra;       ///< what is no part of the session
  std::vector<std::string> set_aside;   ///< damaged originals that were kept when something was rebuilt
  /// Every stored byte is what it was. What is lost is not stored any more.
  [[nodiscard]] bool ok() const { return damaged.empty(); }
};

/// The answer of repair(). Names are relative to the session folder.
struct RepairReport {
  std::vector<std::string> restored;  ///< brought back from the copy, byte for byte
  std::vector<std::string> derived;   ///< set aside: their makers have to make them anew
  std::vector<Error> beyond;          ///< nothing here or in the copy could mend these
};

/// The durable folder of one tablet's scanning (contract "Session folder"): session.sqlite (WAL, every commit
/// synced, every row with its checksum), grids/NNN.grid, and mesh/, analysis/, export/ for what is derived.
/// What a function of this class reported as stored is there after kill -9, power loss or a full disk.
///
/// One program at a time may write; a second one is told who does. Readers come at any time and see the
/// session as it was when they opened it. All functions may be called from several threads. Errors:
/// kStorage when the disk refuses (the session is then as before the call), kBadInput for damage, kUsage for
/// what is not there or not allowed.
class SessionStore {
 public:
  enum class Access { kReadOnly, kReadWrite };
  /// What becomes of damaged tables when a session is opened for writing. Refused (kBadInput), nothing of the
  /// folder is changed, and a copy can still be asked for what stood there.
  enum class OnDamage { kRebuild, kRefuse };

  /// Opens the session in the folder for writing, or makes one: the folder is then new, empty or what is left
  /// of a session. A folder with other things in it is refused.
  ///
  /// Opening reads every grid for its checksum: of gigabytes, for minutes. It tells the job how far that is
  /// ("checking the session") and ends soon after it was cancelled (kCancelled), the session as it was; but
  /// where opening for writing has found tables to rebuild it goes on to its end, for no later opening would
  /// tell of that.
  [[nodiscard]] static Result<SessionStore> open_or_create(const std::filesystem::path& folder,
                                                           OnDamage on_damage = OnDamage::kRebuild,
                                                           const JobContext* job = nullptr);
  /// Opens a session that must exist. A damaged database is rebuilt from its readable rows, its last backup
  /// and the grids: for writing, with the bad file kept aside; for reading, in memory. The job is heeded as
  /// by open_or_create().
  [[nodiscard]] static Result<SessionStore> open(const std::filesystem::path& folder,
                                                 Access access = Access::kReadWrite,
                                                 OnDamage on_damage = OnDamage::kRebuild,
                                                 const JobContext* job = nullptr);
  /// Opens a session that must exist for writing, and takes what it has lost of its records, now or before,
  /// from a copy of it. That is one only where both have an event that is the same, or, where no event is
  /// left, a grid that is, and no grid that is not; where a session was gone on with after its loss, what was
  /// recorded since follows what comes back. Rows that the session has stay as they are.
  [[nodiscard]] static Result<SessionStore> open_with_copy(const std::filesystem::path& folder,
                                                           const std::filesystem::path& copy);
  /// True when the folder looks like a session, whole or damaged.
  [[nodiscard]] static bool is_session(const std::filesystem::path& folder);

  /// Closes cleanly: writes the backup and the checksum of the database. Errors there lose nothing.
  ~SessionStore();
  SessionStore(SessionStore&&) noexcept;
  SessionStore& operator=(SessionStore&&) noexcept;

  [[nodiscard]] const SessionOpening& opening() const;
  [[nodiscard]] const std::filesystem::path& folder() const;
  [[nodiscard]] std::filesystem::path mesh_folder() const { return folder() / "mesh"; }
  [[nodiscard]] std::filesystem::path analysis_folder() const { return folder() / "analysis"; }
  [[nodiscard]] std::filesystem::path export_folder() const { return folder() / "export"; }
  [[nodiscard]] double disk_free_gib() const;

  /// Stores a grid, and what its device remarks on it, and returns its id (0, 1, …, never used twice) once
  /// both are durable. A scan that the disk refused before, and whose grid it has, comes into the list first.
  [[nodiscard]] Result<int> add_grid(const RangeGrid& grid, std::string_view remark = {});
  /// The id that add_grid() will give to the next grid.
  [[nodiscard]] Result<int> next_id() const;
  /// The grid of a scan, dropped or not; its bytes are checked against their checksum.
  [[nodiscard]] Result<RangeGrid> load_grid(int id) const;
  [[nodiscard]] Result<std::vector<StoredScan>> scans() const;  ///< by id, dropped ones included
  /// Marks a scan as taken out, with the operator's reason. Nothing is deleted. One that is out already keeps
  /// the reason that it has.
  Status drop_scan(int id, std::string_view why = {});
  Status restore_scan(int id);
  /// Drops the newest scan that stands and returns its id; nothing when there is none.
  Result<std::optional<int>> undo_last_scan();

  /// Replaces all poses at once. Scans that stand and are damaged stay where they lay beside the others;
  /// where none of those is registered any more, their place is lost, which their pose then says.
  Status save_poses(const std::vector<ScanPose>& poses);
  [[nodiscard]] Result<std::vector<ScanPose>> poses() const;  ///< by id

  Status save_flags(int id, const SampleFlags& flags);
  /// Nothing when none were saved.
  [[nodiscard]] Result<std::optional<SampleFlags>> load_flags(int id) const;

  /// A named JSON text (rig, options, pins, red map, checklist, sign-off, …); replaces what had the name.
  Status save_document(std::string_view name, std::string_view json);
  [[nodiscard]] Result<std::optional<std::string>> load_document(std::string_view name) const;
  [[nodiscard]] Result<std::vector<std::string>> document_names() const;
  /// What is lost of the records and nothing has brought back: "events row 12", "documents row tablet".
  [[nodiscard]] Result<std::set<std::string>> lost_rows() const;

  /// Adds to the record of what happened. Storing, dropping and restoring scans add events of their own.
  Status append_event(std::string_view kind, std::string_view json = "{}");
  [[nodiscard]] Result<std::vector<SessionEvent>> events() const;

  /// Notes size and checksum of a finished file of the session (such as mesh/model.ply), so that verify()
  /// covers it. Relative to the folder.
  Status record_file(const std::filesystem::path& relative);
  /// Makes a file of the session, or makes it anew, and notes its size and checksum. `write` gets the path to
  /// write it to: another name beside it, with the same extension. The old file and its checksum stay until
  /// the new one is whole. A program that is killed in the moment when one takes the other's place leaves a
  /// file without a checksum, and none that looks damaged. Errors: those of `write`, told of the file itself.
  Status replace_file(const std::filesystem::path& relative,
                      const std::function<Status(const std::filesystem::path&)>& write);

  /// Reads every byte of the session: structure and row checksums of the database, every grid, every recorded
  /// file.
  [[nodiscard]] Result<VerifyReport> verify(JobContext& job) const;

  /// Mends what verify() found damaged among the files: from a copy of the session where one is given and its
  /// file has the checksum that was stored. What stands in mesh/, analysis/ and export/ can be made anew and
  /// is set aside for that. Damaged originals are never overwritten. The tables are mended by opening for
  /// writing.
  [[nodiscard]] Result<RepairReport> repair(const VerifyReport& found,
                                            const std::optional<std::filesystem::path>& copy,
                                            JobContext& job);
  /// Keeps copies of a damaged database, backup or list of checksums aside, before opening for writing
  /// replaces them. Returns their names aside.
  [[nodiscard]] static Result<std::vector<std::string>> keep_damaged_records(
      const std::filesystem::path& folder, const VerifyReport& found);

 private:
  struct Impl;
  [[nodiscard]] static Result<SessionStore> open_for_writing(const std::filesystem::path& folder,
                                                             OnDamage on_damage,
                                                             const std::filesystem::path* copy,
                                                             const JobContext* job);
  explicit SessionStore(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace dubsar
