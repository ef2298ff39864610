// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "acquisition/session_store.h"
#include "core/result.h"
#include "core/rigid_transform.h"

namespace dubsar {

/// A scan of the session, and a frame that it is seen in.
struct ScanInFrame {
  int id = 0;
  RigidTransform frame_from_scanner;
};

/// Whether a hint's pose leaves a scan near the one that it is said to lie on: the gap between their boxes,
/// in the frame of the pose, is no larger than the larger of them. Where it is, the boxes of all registered
/// scans count: on a large object the two may lie at opposite ends. kBadInput names the number of the pose's
/// 16 that puts it away; the store's errors.
[[nodiscard]] Status check_hint_reach(const SessionStore& store, const ScanInFrame& hinted,
                                      const ScanInFrame& on, const std::string& where);

}  // namespace dubsar
