// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdio>
#include <cstdlib>
#include <span>
#include <vector>

#include "bench/support/true_scans.h"
#include "core/job.h"
#include "registration/registrar.h"

namespace dubsar::bench {

/// What becomes of the scans, numbered as they come, registered without a hint.
[[nodiscard]] inline std::vector<ScanPose> registered_poses(std::span<const TrueScan> scans) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    registrar.add(static_cast<int>(k), scans[k].grid, nullptr, job);
  }
  if (!registrar.finalize(job)) {
    std::fprintf(stderr, "registration was stopped\n");
    std::exit(2);
  }
  return registrar.poses();
}

}  // namespace dubsar::bench
