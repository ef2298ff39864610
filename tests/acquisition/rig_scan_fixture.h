// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "acquisition/grid_builder.h"
#include "acquisition/rig_scan.h"
#include "tests/acquisition/rig_bench.h"
#include "tests/sim/scenes.h"

namespace dubsar::test {

/// Keeps the rows, and wants no more of them than `most_rows`.
class Collect : public ProfileSink {
 public:
  bool begin(const ScanInfo& info) override {
    builder.emplace(info);
    return true;
  }
  bool profile(const Profile& profile) override {
    builder->append(profile);
    return builder->grid().rows < most_rows;
  }
  void end(const ScanTally& ended) override { tally = ended; }
  std::optional<GridBuilder> builder;
  ScanTally tally;
  int most_rows = 1 << 30;
};

/// A rig of the bench before a plane, and the file that is to scan it: eleven rows, a tenth of a millimetre
/// apart.
class RigScanFixture : public testing::Test {
 protected:
  RigScanFixture() {
    set_up_small(bench, scene.scene);
    file.name = "bench rig";
    file.camera = "bench_camera:";
    file.stage = "bench_stage:";
    file.calibration = "calibration.json";
    file.start = -0.5;
    file.step = 0.1;
    file.rows = 11;
  }
  Result<RigScanner> make() {
    return RigScanner::make(file, bench.truth, camera_of(bench), stage_of(bench), "rig.toml");
  }
  std::string refusal() {
    const Result<RigScanner> made = make();
    EXPECT_FALSE(made.has_value());
    return made ? std::string() : made.error().line();
  }

  /// What the field has less to either side of the lens's axis than half of the picture.
  [[nodiscard]] double off_middle_mm() const {
    const CameraModel& camera = bench.truth.camera;
    return std::abs(2 * camera.cx_px - (camera.width - 1)) * 6.25 / camera.width;
  }

  sim::TestScene scene{sim::plane(20, 0.5F, 0.5F)};
  RigBench bench;
  RigFile file;
};

}  // namespace dubsar::test
