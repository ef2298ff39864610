// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/planning_stage.h"

#include <gtest/gtest.h>

#include "formats/red_map_json.h"
#include "tests/station/support/bumpy_scans.h"

namespace dubsar {
namespace {

std::vector<ScanPose> poses_with(double sigma_mm) {
  std::vector<ScanPose> poses;
  for (int k = 0; k < 3; ++k) {
    ScanPose pose;
    pose.id = k;
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = test::bumpy_pose(k);
    pose.sigma_mm = sigma_mm;
    poses.push_back(pose);
  }
  return poses;
}

/// The red map after these steps, all but the last as the online engine takes them.
std::string map_after(const std::vector<std::vector<ScanPose>>& steps) {
  PlanningStage stage;
  for (int k = 0; k < 3; ++k) {
    stage.add(prepare_scan(k, test::bumpy_scan(k), std::nullopt));
  }
  JobContext job;
  for (const auto& poses : steps) {
    EXPECT_TRUE(stage.place(poses, &poses == &steps.back(), job));
  }
  const auto map = stage.red_map(nullptr, job);
  EXPECT_TRUE(map);
  return map ? red_map_to_json(*map) : "";
}

TEST(PlanningStage, APoseThatOnlyBecameMoreCertainCountsAsItIsStored) {
  const auto rough = poses_with(0.6);
  const auto certain = poses_with(0.001);
  ASSERT_NE(map_after({rough}), map_after({certain})) << "certainty changes how far samples clear others";
  EXPECT_EQ(map_after({rough, certain}), map_after({certain}))
      << "whoever works it out from the stored poses gets the same";
}

TEST(PlanningStage, TheWayThereDoesNotMatter) {
  auto wandering = poses_with(0.01);
  wandering[1].model_from_scanner.translation_mm.x() += 0.7;
  wandering[2].status = PoseStatus::kUnsure;
  EXPECT_EQ(map_after({wandering, poses_with(0.01)}), map_after({poses_with(0.01)}));
}

}  // namespace
}  // namespace dubsar
