// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/pose_json.h"

#include <gtest/gtest.h>

namespace dubsar::session {
namespace {

TEST(StoredPose, ReadsBackToTheBit) {
  ScanPose pose;
  pose.id = 7;
  pose.file = "scan \"7\".ply";
  pose.status = PoseStatus::kRegistered;
  pose.model_from_scanner = RigidTransform::from_twist({0.7, 1.0 / 3, -2}, {1e-7, -1.0 / 7, 1234.5});
  pose.rms_mm = 0.1 + 0.2;
  pose.locked = true;
  const auto back = pose_from_json(7, json_from_pose(pose));
  ASSERT_TRUE(back) << back.error().line();
  EXPECT_EQ(back->file, pose.file);
  EXPECT_EQ(back->model_from_scanner.row_major(), pose.model_from_scanner.row_major());
  EXPECT_EQ(back->rms_mm, pose.rms_mm);
  EXPECT_TRUE(back->locked);
  EXPECT_EQ(back->group_apart, -1);
}

TEST(StoredPose, KeepsItsGroup) {
  ScanPose pose;
  pose.status = PoseStatus::kUnsure;
  pose.group_apart = 0;
  EXPECT_EQ(pose_from_json(2, json_from_pose(pose)).value().group_apart, 0);
}

// A session from elsewhere: the value was copied level by level, which ended the program.
TEST(StoredPose, IsNoneWhereItIsNestedDeeply) {
  const std::string levels = std::string(100000, '[') + std::string(100000, ']');
  const auto pose = pose_from_json(3, R"({"status":"failed","locked":)" + levels + "}");
  ASSERT_FALSE(pose);
  EXPECT_EQ(pose.error().kind, ErrorKind::kBadInput);
  EXPECT_TRUE(pose_from_json(3, R"({"status":"failed","locked":[[[]]]})"));
}

}  // namespace
}  // namespace dubsar::session
