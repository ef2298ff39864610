// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/rigid_transform.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "core/rigid_matrix.h"
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

TEST(RigidMatrix, IsTakenRowByRowAlone) {
  const auto rows = kA.row_major();
  const auto taken = rigid_from_row_major(rows);
  ASSERT_TRUE(taken);
  EXPECT_EQ(taken->rotation, kA.rotation);
  EXPECT_EQ(taken->translation_mm, kA.translation_mm);

  std::array<double, 16> columns{};
  for (std::size_t k = 0; k < 16; ++k) {
    columns[k] = rows[4 * (k % 4) + k / 4];
  }
  EXPECT_FALSE(rigid_from_row_major(columns)) << "its turn alone is one, and the translation would be lost";
}

TEST(RigidMatrix, TheLastRowIsLookedAt) {
  const auto with = [](std::size_t at, double value) {
    auto numbers = kA.row_major();
    numbers[at] = value;
    return rigid_from_row_major(numbers).has_value();
  };
  for (const double not_one : {0.0, 2.0, -1.0, 1.001, std::nan("")}) {
    EXPECT_FALSE(with(15, not_one)) << not_one;
  }
  for (const std::size_t at : {12U, 13U, 14U}) {
    EXPECT_FALSE(with(at, 0.1)) << at;
    EXPECT_FALSE(with(at, -0.1)) << at;
    EXPECT_FALSE(with(at, std::nan(""))) << at;
    EXPECT_TRUE(with(at, -1e-17)) << "what an inverse leaves of 0: " << at;
  }
  EXPECT_FALSE(with(0, 2.0)) << "no turn";
  EXPECT_FALSE(with(3, std::nan(""))) << "no translation";
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
