// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/poses_conf.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace dubsar {
namespace {

using ::testing::HasSubstr;

TEST(PosesConf, TakesScanPointsIntoTheModel) {
  // A quarter turn about y: as it stands the quaternion turns x to -z, conjugated to z.
  const auto poses = parse_conf_poses(
      "camera 0 -0.1 -0.7 0 1 0 0\n\n"
      "mesh turned_cyl 0 0 0 0 0 0 1\r\n"
      "  bmesh a.ply\t0.001 -0.02 0.25 0 0.70710678 0 0.70710678\n",
      "a.conf", 1000.0);
  ASSERT_TRUE(poses) << poses.error().line();
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ(poses->front().file, "turned_cyl");
  const ScanPose& pose = poses->back();
  EXPECT_EQ(pose.file, "a.ply");
  EXPECT_EQ(pose.id, -1);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered);
  EXPECT_LT((pose.model_from_scanner * Eigen::Vector3d::Zero() - Eigen::Vector3d(1, -20, 250)).norm(), 1e-9);
  EXPECT_LT((pose.model_from_scanner.rotation * Eigen::Vector3d::UnitX() - Eigen::Vector3d::UnitZ()).norm(),
            1e-6);
}

TEST(PosesConf, LeavesNoPoseOutForAMarkBeforeItOrTheLinesOfAMacintosh) {
  const std::string first = "bmesh a.ply 0 0 0 0 0 0 1";
  const std::string second = "bmesh b.ply 0 0 1 0 0 0 1";
  for (const std::string& text : {"\xEF\xBB\xBF" + first + "\r\n" + second + "\r\n",
                                  first + "\r" + second + "\r", first + "\r" + second}) {
    const auto poses = parse_conf_poses(text, "a.conf", 1.0);
    ASSERT_TRUE(poses) << poses.error().line();
    ASSERT_EQ(poses->size(), 2U);
    EXPECT_EQ(poses->front().file, "a.ply");
    EXPECT_EQ(poses->back().file, "b.ply");
  }
  const auto cut = parse_conf_poses(first + "\rbmesh b.ply 0 0 1\r", "a.conf", 1.0);
  ASSERT_FALSE(cut);
  EXPECT_THAT(cut.error().line(), HasSubstr("line 2"));
}

TEST(PosesConf, NamesTheLineThatIsNoPose) {
  for (const char* line :
       {"bmesh a.ply 0 0 0 0 0 0", "bmesh a.ply 0 0 zero 0 0 0 1", "bmesh", "bmesh a.ply 0 0 0 0 0 0 2",
        "bmesh a.ply 0 0 nan 0 0 0 1", "bmesh a.ply 1e308 0 0 0 0 0 1", "bmesh a.ply 0 0 0 0 0 0 0"}) {
    const auto poses =
        parse_conf_poses("bmesh first.ply 0 0 0 0 0 0 1\n" + std::string(line) + "\n", "a.conf", 1000.0);
    ASSERT_FALSE(poses) << line;
    EXPECT_THAT(poses.error().line(), HasSubstr("a.conf")) << line;
    EXPECT_THAT(poses.error().line(), HasSubstr("line 2")) << line;
  }
  EXPECT_FALSE(parse_conf_poses("", "a.conf", 1.0));
  EXPECT_FALSE(parse_conf_poses("camera 0 0 0 0 0 0 1\n", "a.conf", 1.0));
}

}  // namespace
}  // namespace dubsar
