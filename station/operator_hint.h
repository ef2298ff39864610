// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

#include "acquisition/operator_log.h"
#include "acquisition/session_store.h"
#include "core/pose_hint.h"
#include "core/result.h"

namespace dubsar {

/// A hint as the operator gives it: against another scan, or as a pose in the model frame.
struct GivenHint {
  PoseHint hint;
  std::optional<RigidTransform> model_from_scanner;
};

/// Checks a hint for a scan of the session and brings it into the form that the session keeps: a pose in the
/// model frame becomes one against the registered scan with the lowest number, so that it stays true when the
/// frame changes. Errors, each naming its mend: no such scan, the only scan, a locked scan, no other scan
/// named, points that settle nothing or that lie beside the scan's samples, a pose that puts the scan away
/// from the others (hint_reach.h), no registered scan to relate a pose to.
[[nodiscard]] Result<PoseHint> settled_hint(const SessionStore& store, int id, const GivenHint& given);

/// The lock of a scan of the session at its stored pose, with what tells later where that is (ScanLock).
/// kUsage unless it is registered.
[[nodiscard]] Result<ScanLock> lock_here(const SessionStore& store, int id);

}  // namespace dubsar
