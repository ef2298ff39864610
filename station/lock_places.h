// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/operator_log.h"
#include "core/job.h"
#include "registration/registrar.h"

namespace dubsar {

/// The frame (ScanLock::frame) that a registration of scans has: that of the locks among them which the model
/// has kept, else that of the newest lock. Their scans come first, where their locks say; locked scans of
/// another frame are looked for like any other, and settle_locks() follows. Nothing without a lock.
[[nodiscard]] std::optional<std::int64_t> frame_of_locks(const std::map<int, ScanLock>& locked,
                                                         const std::function<bool(int)>& is_there);

struct SettledLocks {
  std::map<int, std::string> contradicted;  ///< scans that must not stand as registered, and why
  bool placed = false;                      ///< the registrar has a scan more in place
};

/// Fixes the locked scans of the registrar that are not fixed yet. A lock of another frame says where its
/// scan lies by the scans beside it; one that says nothing of them must mean the place that the scan was
/// found at. One that is contradicted is not fixed.
[[nodiscard]] SettledLocks settle_locks(Registrar& registrar, const std::map<int, ScanLock>& locked,
                                        JobContext& job);

/// What is said of them in the poses.
void tell_contradicted(std::vector<ScanPose>& poses, const std::map<int, std::string>& contradicted);

}  // namespace dubsar
