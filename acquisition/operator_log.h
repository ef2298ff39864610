// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "acquisition/session_store.h"
#include "core/pose_hint.h"
#include "core/result.h"

namespace dubsar {

/// A scan that the operator has fixed where it was registered. The model's frame may change afterwards, while
/// the scan is taken out: the pose alone says where it lies only among locks of one frame.
struct ScanLock {
  RigidTransform model_from_scanner;
  std::int64_t frame = 0;  ///< locks of one number were made in one frame; 0 in record_lock(): in its own
  bool stood = true;       ///< the scan was not taken out since, so that the model has kept the frame
  /// Registered scans beside it then, by id: its pose in the frame of each. None in locks of earlier
  /// versions.
  std::map<int, RigidTransform> beside_from_scanner{};
};

/// What the operator has said of where scans lie, as it stands now. By scan id.
struct OperatorWord {
  std::map<int, PoseHint> hints;
  std::map<int, ScanLock> locked;
};

// The operator's word is kept in the session's record of what happened, one event each, so that it is as
// durable as that, and the history stays. Errors are those of SessionStore::append_event, and kUsage for a
// scan that is not there or was taken out (`hint`, `lock`).
Status record_hint(SessionStore& store, int id, const PoseHint& hint);  ///< replaces an earlier one
Status record_hint_withdrawn(SessionStore& store, int id);
Status record_lock(SessionStore& store, int id, const ScanLock& lock);
Status record_unlock(SessionStore& store, int id);

/// Goes through the record. An event that cannot be read is left out and named in `damage`.
struct OperatorLog {
  OperatorWord word;
  std::vector<Error> damage;
};
[[nodiscard]] OperatorLog operator_log_of(std::span<const SessionEvent> events);
[[nodiscard]] Result<OperatorLog> read_operator_log(const SessionStore& store);

/// kUsage unless the scan is there, whole and not taken out.
[[nodiscard]] Status check_scan_stands(const SessionStore& store, int id);

}  // namespace dubsar
