// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rigid_transform.h"

#include <gtest/gtest.h>

#include "core/units.h"

namespace dubsar {
namespace {

const RigidTransform kA = RigidTransform::from_twist({0.3, -0.2, 0.5}, {1, 2, 3});
const RigidTransform kB = RigidTransform::from_twist({-0.1, 0.9, 0.2}, {-4, 0, 2});

TEST(RigidTransform, CompositionAndInverse) {
  const Eigen::Vector3d p(0.7, -1.1, 2.3);
  EXPECT_LT(((kA * kB) * p - kA * (kB * p)).norm(), 1e-12);
  EXPECT_LT((kA.inverse() * (kA * p) - p).norm(), 1e-12);
}

TEST(RigidTransform, RowMajorRoundTrip) {
  const RigidTransform back = RigidTransform::from_row_major(kA.row_major());
  EXPECT_EQ(back.rotation, kA.rotation);
  EXPECT_EQ(back.translation_mm, kA.translation_mm);
  EXPECT_EQ(kA.row_major()[3], 1.0);
}

TEST(RigidTransform, SmallAndLargeAngles) {
  EXPECT_NEAR(RigidTransform::from_twist({1e-9, 0, 0}, {0, 0, 0}).angle_rad(), 1e-9, 1e-15);
  EXPECT_NEAR(RigidTransform::from_twist({0, kPi - 1e-6, 0}, {0, 0, 0}).angle_rad(), kPi - 1e-6, 1e-9);
}

TEST(RigidTransform, MirrorAndNanAreNotRigid) {
  RigidTransform mirror;
  mirror.rotation(0, 0) = -1;
  EXPECT_FALSE(mirror.is_rigid());
  RigidTransform nan;
  nan.translation_mm.x() = std::nan("");
  EXPECT_FALSE(nan.is_rigid());
  EXPECT_TRUE(kA.is_rigid());
}

TEST(RigidTransform, OrthonormalisedMendsDrift) {
  RigidTransform drifted = kA;
  drifted.rotation *= 1.01;
  EXPECT_TRUE(drifted.orthonormalised().is_rigid(1e-12));
  EXPECT_LT((drifted.orthonormalised().rotation - kA.rotation).norm(), 1e-12);
}

}  // namespace
}  // namespace dubsar
