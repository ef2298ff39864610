// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/poses_conf.h"
#include "fuzz/fuzz_support.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  // What is taken for a pose is a rigid motion.
  if (const auto poses = dubsar::parse_conf_poses(dubsar::fuzz::text_of(data, size), "scans.conf", 1000.0)) {
    for (const dubsar::ScanPose& pose : *poses) {
      dubsar::fuzz::require(pose.model_from_scanner.is_rigid());
    }
  }
  return 0;
}
