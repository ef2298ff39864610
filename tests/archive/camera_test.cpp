// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/camera.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <set>

namespace dubsar {
namespace {

using Eigen::Vector3d;

constexpr Face kFaces[] = {Face::kObverse, Face::kReverse, Face::kLeft,
                           Face::kRight,   Face::kTop,     Face::kBottom};

TEST(FaceCamera, NeverMirrors) {
  for (const Face face : kFaces) {
    const Eigen::Matrix3d m = face_camera(face).view_from_model;
    EXPECT_NEAR(m.determinant(), 1.0, 1e-12) << to_string(face);
    EXPECT_LT((m * m.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-12) << to_string(face);
  }
}

TEST(FaceCamera, LooksAtItsFace) {
  const auto viewer = [](Face face) -> Vector3d { return face_camera(face).view_from_model.row(2); };
  EXPECT_EQ(viewer(Face::kObverse), Vector3d(0, 0, 1));
  EXPECT_EQ(viewer(Face::kReverse), Vector3d(0, 0, -1));
  EXPECT_EQ(viewer(Face::kLeft), Vector3d(-1, 0, 0));
  EXPECT_EQ(viewer(Face::kRight), Vector3d(1, 0, 0));
  EXPECT_EQ(viewer(Face::kTop), Vector3d(0, 1, 0));
  EXPECT_EQ(viewer(Face::kBottom), Vector3d(0, -1, 0));
}

// The views unroll the tablet: what two neighbours share meets on the sheet.
TEST(FaceCamera, NeighboursMeetAtTheirCommonRim) {
  const auto up = [](Face face) -> Vector3d { return face_camera(face).view_from_model.row(1); };
  const auto right = [](Face face) -> Vector3d { return face_camera(face).view_from_model.row(0); };
  const auto out = [](Face face) -> Vector3d { return face_camera(face).view_from_model.row(2); };
  EXPECT_EQ(up(Face::kBottom), out(Face::kObverse)) << "above the bottom edge lies the obverse";
  EXPECT_EQ(up(Face::kReverse), out(Face::kBottom)) << "above the reverse lies the bottom edge";
  EXPECT_EQ(up(Face::kObverse), out(Face::kTop)) << "above the obverse lies the top edge";
  EXPECT_EQ(right(Face::kLeft), out(Face::kObverse)) << "right of the left edge lies the obverse";
  EXPECT_EQ(right(Face::kObverse), out(Face::kRight)) << "right of the obverse lies the right edge";
}

TEST(FaceCamera, FollowsTheTabletFrame) {
  RigidTransform tablet_from_model;
  tablet_from_model.rotation << 0, 0, 1, 1, 0, 0, 0, 1, 0;  // model y looks out of the obverse
  const Vector3d viewer = face_camera(Face::kObverse, tablet_from_model).view_from_model.row(2);
  EXPECT_EQ(viewer, Vector3d(0, 1, 0));
}

TEST(FaceCamera, FilesHaveTheCustomaryNamesInOrder) {
  std::string names;
  for (const Face face : kSixViewOrder) {
    names += std::string(view_file_stem(face)) + " ";
  }
  EXPECT_EQ(names, "01_top 02_left 03_front 04_right 05_bottom 06_back ");
}

TEST(FreeCamera, IsARightHandedFrameForAnyInput) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Vector3d odd[] = {{0, 0, 0}, {0, 0, 5}, {1, 2, 3}, {nan, 0, 1}, {1e-300, 0, 0}, {0, 1, 0}};
  for (const Vector3d& to : odd) {
    for (const Vector3d& up : odd) {
      const Eigen::Matrix3d m = free_camera(to, up).view_from_model;
      EXPECT_NEAR(m.determinant(), 1.0, 1e-9) << to.transpose() << " / " << up.transpose();
    }
  }
  const Eigen::Matrix3d m = free_camera({0, 0, 2}, {0, 3, 1}).view_from_model;
  EXPECT_LT((m - Eigen::Matrix3d::Identity()).norm(), 1e-12);
}

}  // namespace
}  // namespace dubsar
