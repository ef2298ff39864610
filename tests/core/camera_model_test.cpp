// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/camera_model.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

CameraModel webcam() {
  return {640, 480, 620, 618, 323, 239, 0.114, -0.194, -0.0011, -0.0022, -0.035};
}

TEST(CameraModel, UndistortUndoesDistort) {
  const CameraModel camera = webcam();
  for (double v = 0; v < camera.height; v += 37) {
    for (double u = 0; u < camera.width; u += 41) {
      const auto ray = camera.undistort({u, v});
      ASSERT_TRUE(ray.has_value());
      EXPECT_LT((camera.distort(*ray) - Eigen::Vector2d(u, v)).norm(), 1e-8);
    }
  }
}

TEST(CameraModel, ProjectsTheAxisToThePrincipalPoint) {
  const CameraModel camera = webcam();
  EXPECT_LT((camera.project({0, 0, 400}) - Eigen::Vector2d(camera.cx_px, camera.cy_px)).norm(), 1e-12);
}

TEST(CameraModel, RefusesWhatFoldsOver) {
  CameraModel camera = webcam();
  EXPECT_TRUE(camera.check("camera").has_value());
  camera.k1 = -3;
  ASSERT_FALSE(camera.check("camera").has_value());
  camera = webcam();
  camera.fx_px = 0;
  EXPECT_FALSE(camera.check("camera").has_value());
}

}  // namespace
}  // namespace dubsar
