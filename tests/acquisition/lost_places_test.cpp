// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Where scans lay whose grids are lost, when the others are registered anew.

#include "acquisition/lost_places.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acquisition/session_damage_support.h"

namespace dubsar {
namespace {

using test::flip_byte;
using test::SessionDamageTest;
using testing::HasSubstr;
using testing::SizeIs;

ScanPose placed(int id, const RigidTransform& where) {
  ScanPose pose;
  pose.id = id;
  pose.status = PoseStatus::kRegistered;
  pose.model_from_scanner = where;
  return pose;
}

const RigidTransform kFirst = RigidTransform::from_twist({0.1, 0.2, -0.3}, {4, 5, 6});
const RigidTransform kSecond = RigidTransform::from_twist({-0.4, 0.1, 0.2}, {-3, 2, 1});
const RigidTransform kThird = RigidTransform::from_twist({0.3, -0.5, 0.1}, {7, -8, 9});

/// The session's scans 0, 2 and 3 in their places, and after that the grid of scan 2 is lost.
class LostPlaces : public SessionDamageTest {
 protected:
  void SetUp() override {
    SessionDamageTest::SetUp();
    ScanPose lost = placed(2, kSecond);
    lost.covariance = Eigen::Matrix<double, 6, 6>::Zero();
    (*lost.covariance)(0, 0) = 1e-6;
    (*lost.covariance)(3, 3) = 4e-4;
    ASSERT_TRUE(SessionStore::open(folder_).value().save_poses({placed(0, kFirst), lost, placed(3, kThird)}));
    flip_byte(folder_ / "grids/002.grid", 1234);
  }
  [[nodiscard]] std::vector<ScanPose> saved(const std::vector<ScanPose>& poses) const {
    SessionStore store = SessionStore::open(folder_).value();
    EXPECT_TRUE(store.save_poses(poses));
    return store.poses().value();
  }
};

TEST_F(LostPlaces, StayWhereAnyScanDoes) {
  const std::vector<ScanPose> poses = saved({placed(0, kSecond), placed(3, kThird)});
  ASSERT_THAT(poses, SizeIs(3));
  EXPECT_EQ(poses[1].id, 2);
  EXPECT_EQ(poses[1].status, PoseStatus::kRegistered);
  EXPECT_EQ(poses[1].model_from_scanner.row_major(), kSecond.row_major()) << "to the last digit";
}

TEST_F(LostPlaces, GoAlongIntoANewFrame) {
  const RigidTransform change = RigidTransform::from_twist({0.2, 0.9, -0.4}, {10, 20, 30});
  const std::vector<ScanPose> poses = saved({placed(0, change * kFirst), placed(3, change * kThird)});
  ASSERT_THAT(poses, SizeIs(3));
  const Eigen::Vector3d point(12, -7, 3);
  EXPECT_LT((poses[1].model_from_scanner * point - change * (kSecond * point)).norm(), 1e-9);
  ASSERT_TRUE(poses[1].covariance);
  const auto turned = poses[1].covariance->topLeftCorner<3, 3>();
  const Eigen::Vector3d axis = change.rotation.col(0);
  EXPECT_LT((turned - 1e-6 * axis * axis.transpose()).norm(), 1e-15);
  EXPECT_LT((poses[1].covariance->bottomRightCorner<3, 3>() - 4e-4 * axis * axis.transpose()).norm(), 1e-12);
}

TEST_F(LostPlaces, AreGoneWithAllThatTheyLayBeside) {
  const std::vector<ScanPose> poses = saved({ScanPose{}});
  ASSERT_THAT(poses, SizeIs(2));
  EXPECT_EQ(poses[1].status, PoseStatus::kFailed);
  EXPECT_THAT(poses[1].reason, HasSubstr("no scan that it lay beside"));
  const std::vector<ScanPose> later = saved({placed(0, kFirst)});
  EXPECT_EQ(later.at(1).status, PoseStatus::kFailed);
}

TEST_F(LostPlaces, AreNotThoseOfScansThatWereTakenOut) {
  ASSERT_TRUE(SessionStore::open(folder_).value().drop_scan(2));
  EXPECT_THAT(saved({placed(0, kFirst), placed(3, kThird)}), SizeIs(2));
}

}  // namespace
}  // namespace dubsar
