// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>
#include <vector>

#include "core/result.h"
#include "core/scan_pose.h"
#include "station/scan_set.h"

namespace dubsar {

// Whether the stored poses follow what the operator has said of the scans: hints, locks, labels of pins,
// scans taken out and put back. The order of the session's events tells, never a clock. A hint or a scan that
// is given and taken back again leaves nothing to follow.

/// Saves poses for which all that was said was heeded, or with `only` what was said of those scans, and notes
/// it in the record: the first time, and where something was said since. Pages that show other places are
/// taken back first (session_pages.h). Errors: the store's.
Status save_followed_poses(SessionStore& store, const std::vector<ScanPose>& poses,
                           const std::vector<int>& only = {});

/// What the stored poses do not follow yet, one phrase each ("scan 3 has been taken out"). A session of an
/// earlier version has no such note: there the poses themselves tell, as far as they do. Errors: the store's.
[[nodiscard]] Result<std::vector<std::string>> not_followed(const ScanSet& set);

/// The same in one sentence; empty where there is nothing.
[[nodiscard]] Result<std::string> not_followed_sentence(const ScanSet& set);

}  // namespace dubsar
