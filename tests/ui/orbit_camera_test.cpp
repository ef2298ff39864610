// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/view/orbit_camera.h"

#include <gtest/gtest.h>

namespace dubsar::ui {
namespace {

Eigen::AlignedBox3f slab() {
  return {Eigen::Vector3f(-30, -20, -10), Eigen::Vector3f(30, 20, 10)};
}

TEST(OrbitCamera, FitsTheBoxWhateverThePicturesShape) {
  for (const float aspect : {0.5F, 1.0F, 2.0F}) {
    OrbitCamera camera;
    camera.eye_from_model = Eigen::AngleAxisf(0.7F, Eigen::Vector3f(1, 2, 3).normalized());
    camera.fit(slab(), aspect);
    const Eigen::Matrix4f clip = camera.clip_from_model(aspect);
    for (int k = 0; k < 8; ++k) {
      const Eigen::Vector3f corner = slab().corner(static_cast<Eigen::AlignedBox3f::CornerType>(k));
      const Eigen::Vector4f at = clip * corner.homogeneous();
      EXPECT_LE(at.head<3>().cwiseAbs().maxCoeff(), 1.0F);
    }
  }
}

TEST(OrbitCamera, ZoomKeepsThePlaceUnderThePointer) {
  OrbitCamera camera;
  camera.fit(slab(), 1.5F);
  const Eigen::Vector2f size(1500, 1000);
  const Eigen::Vector2f at(0.4F, -0.3F);  // of the picture, from the middle, y up
  const Eigen::Vector3f point =
      camera.centre_mm + Eigen::Vector3f(at.x() * 1.5F, at.y(), 0) * camera.half_height_mm;
  const Eigen::Vector2f before = camera.pixel_of(point, size);
  camera.zoom(0.5F, at, 1.5F);
  EXPECT_LT((camera.pixel_of(point, size) - before).norm(), 0.1F);
}

TEST(OrbitCamera, ADragTurnsAboutTheMiddleAndBack) {
  OrbitCamera camera;
  camera.fit(slab(), 1);
  const OrbitCamera before = camera;
  camera.drag({0, 0}, {0.2F, 0.1F});
  EXPECT_GT(camera.eye_from_model.angularDistance(before.eye_from_model), 0.1F);
  EXPECT_EQ(camera.centre_mm, before.centre_mm);
  camera.drag({0.2F, 0.1F}, {0, 0});
  EXPECT_LT(camera.eye_from_model.angularDistance(before.eye_from_model), 1e-3F);
}

}  // namespace
}  // namespace dubsar::ui
