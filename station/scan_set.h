// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/operator_log.h"
#include "acquisition/session_store.h"
#include "core/job.h"
#include "core/pin_set.h"
#include "core/result.h"
#include "core/rig.h"
#include "station/station_scan.h"

namespace dubsar {

/// The scans that a verb works on: those of a session, or of a plain folder or file of range grids.
struct ScanSet {
  std::vector<StationScan> scans;  ///< by id
  std::vector<ScanPose> poses;     ///< as stored; empty for a folder
  std::optional<PinSet> pins;
  std::optional<Rig> rig;
  OperatorWord word;            ///< hints and locks of a session
  std::vector<Error> left_out;  ///< scans or files that cannot be read, one error each
  /// Of a folder: scans, and files that cannot be read, each of which keeps the number that it would have.
  int numbered = 0;
  std::optional<SessionStore> store;  ///< open when it is a session
  [[nodiscard]] bool is_session() const { return store.has_value(); }
};

struct ScanSetOptions {
  std::string unit{};                 ///< one of kLengthUnits; empty: the file's own word, else mm
  std::filesystem::path pins_file{};  ///< empty: the session's, or none
  SessionStore::Access access = SessionStore::Access::kReadWrite;  ///< of a session
  /// Files that are going to be written (empty: none): kUsage where one of them is a file of a folder's
  /// scans, readable or not, which cannot be made again.
  std::vector<std::filesystem::path> outputs{};
  /// A session of which no scan can be read is a set without scans, not an error: the rest of it is wanted.
  bool may_be_empty = false;
  /// The set was read before: what there is to say of its files was said.
  bool again = false;
};

/// Is given each scan as it is read, and owns it; what the set knows so far (poses, pins, the operator's
/// word) comes with it. An error stops the reading.
using ScanVisitor = std::function<Status(const ScanSet& set, StationScan scan)>;

/// The rig that the session was scanned with last; nothing when none was known. Errors: kBadInput.
[[nodiscard]] Result<std::optional<Rig>> session_rig(const SessionStore& store);

/// Reads a session or a folder. Damaged scans of a session are named in the log and left out, and so are bad
/// files of a folder; where none is good, that is the error.
[[nodiscard]] Result<ScanSet> load_scan_set(const std::filesystem::path& path, const ScanSetOptions& options,
                                            JobContext& job);

/// The same scan by scan: no more than one grid is in memory, but for what the visitor keeps; the set's own
/// scans have id and file only.
[[nodiscard]] Result<ScanSet> visit_scan_set(const std::filesystem::path& path, const ScanSetOptions& options,
                                             const ScanVisitor& visit, JobContext& job);

}  // namespace dubsar
