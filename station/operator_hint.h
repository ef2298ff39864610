// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

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
/// named, points that settle nothing or that lie beside the scan's samples, no registered scan to relate a
/// pose to.
[[nodiscard]] Result<PoseHint> settled_hint(const SessionStore& store, int id, const GivenHint& given);

/// The pose that a scan of the session can be locked at: its stored one. kUsage unless it is registered.
[[nodiscard]] Result<RigidTransform> lockable_pose(const SessionStore& store, int id);

}  // namespace dubsar
