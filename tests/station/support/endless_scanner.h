// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdlib>
#include <filesystem>
#include <string>

#include "build_paths.h"
#include "core/job.h"
#include "station/engine.h"

namespace dubsar::test {

/// Scans of a small tablet from all sides, enough to be conclusive, made into `folder`.
[[nodiscard]] inline Status scan_all_round(const std::filesystem::path& folder) {
  Engine engine({"sim:?seed=1&size=12x10x8&spacing=0.4&noise=0.02", folder, true, 0, std::nullopt}, nullptr);
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  return result ? Status() : std::unexpected(result.error());
}

/// URI of a scanner that nothing drives and that has no end (plugins/endless.c): it gives the scans of a
/// folder, one by one. To be asked for before anything opens a device.
[[nodiscard]] inline std::string endless_scanner(const std::filesystem::path& scans) {
  ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/endless", 1);
  return "endless:" + scans.string();
}

/// URI of a rig whose geometry is known and that nothing drives (the same plugin): the simulated one.
[[nodiscard]] inline std::string unmoved_rig() {
  ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/endless", 1);
  return "unmoved:?seed=1&size=20x16x8&spacing=0.25&noise=0.02";
}

}  // namespace dubsar::test
