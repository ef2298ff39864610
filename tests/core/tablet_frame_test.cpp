// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/tablet_frame.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>

namespace dubsar {
namespace {

/// A box, its faces cut into strips so that one element is not the whole face.
std::vector<SurfaceElement> box(const Eigen::Vector3f& size, const RigidTransform& model_from_tablet) {
  std::vector<SurfaceElement> surface;
  for (int axis = 0; axis < 3; ++axis) {
    for (const float side : {-1.0F, 1.0F}) {
      for (const float shift : {-0.5F, 0.5F}) {
        Eigen::Vector3f p = Eigen::Vector3f::Zero();
        p[axis] = side * size[axis] / 2;
        p[(axis + 1) % 3] = shift * size[(axis + 1) % 3];
        Eigen::Vector3f n = Eigen::Vector3f::Zero();
        n[axis] = side * size[(axis + 1) % 3] * size[(axis + 2) % 3] / 2;
        surface.push_back({(model_from_tablet * p.cast<double>()).cast<float>(),
                           (model_from_tablet.rotation * n.cast<double>()).cast<float>()});
      }
    }
  }
  return surface;
}

RigidTransform turned(double about_x, double about_y, double about_z) {
  RigidTransform t;
  t.rotation = (Eigen::AngleAxisd(about_x, Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(about_y, Eigen::Vector3d::UnitY()) *
                Eigen::AngleAxisd(about_z, Eigen::Vector3d::UnitZ()))
                   .toRotationMatrix();
  t.translation_mm = {30, -20, 400};
  return t;
}

TEST(TabletFrame, FindsTheAxesOfATurnedTablet) {
  for (const RigidTransform& model_from_tablet :
       {turned(0, 0, 0), turned(0.3, -0.2, 0.4), turned(-0.5, 0.4, -0.6)}) {
    const RigidTransform frame = tablet_frame(box({50, 40, 20}, model_from_tablet));
    const RigidTransform product = frame * model_from_tablet;
    EXPECT_LT(product.angle_rad(), 1e-3);
    EXPECT_LT(product.translation_mm.norm(), 1e-3);
  }
}

TEST(TabletFrame, IsRightHandedHoweverTheTabletLies) {
  for (int i = 0; i < 60; ++i) {
    const RigidTransform model_from_tablet = turned(0.37 * i, 0.21 * i, 0.11 * i);
    const RigidTransform frame = tablet_frame(box({50, 40, 20}, model_from_tablet));
    EXPECT_TRUE(frame.is_rigid(1e-9)) << i;
    const Eigen::Vector3d across = frame.rotation * model_from_tablet.rotation.col(2);
    EXPECT_NEAR(std::abs(across.z()), 1.0, 1e-5) << i;
  }
}

TEST(TabletFrame, LeavesABodyWithoutBroadFacesAsItIs) {
  EXPECT_EQ(tablet_frame(box({30, 30, 30}, turned(0.3, 0.2, 0.1))).rotation, Eigen::Matrix3d::Identity());
}

TEST(TabletFrame, TakesAnythingAtAll) {
  EXPECT_EQ(tablet_frame(Mesh{}).rotation, Eigen::Matrix3d::Identity());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  std::vector<SurfaceElement> surface = box({50, 40, 20}, turned(0.1, 0.2, 0.3));
  const RigidTransform clean = tablet_frame(surface);
  surface.push_back({{nan, 0, 0}, {0, 0, 1}});
  surface.push_back({{0, 0, 0}, {0, nan, 1}});
  surface.push_back({{1e9F, 0, 0}, {0, 0, 0}});
  EXPECT_EQ(tablet_frame(surface).rotation, clean.rotation);
  EXPECT_EQ(tablet_frame(surface).translation_mm, clean.translation_mm);
}

}  // namespace
}  // namespace dubsar
