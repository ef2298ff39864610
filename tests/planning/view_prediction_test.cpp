// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/view_prediction.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>

#include "core/units.h"

namespace dubsar {
namespace {

constexpr double kSpacingMm = 0.25;

TEST(ViewPrediction, AScanOfAnUnknownRigLookedNoDeeperThanItsReturns) {
  RangeGrid grid;
  grid.allocate(41, 41);
  grid.spacing_mm = kSpacingMm;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] = static_cast<float>(static_cast<double>(i % 41) * kSpacingMm);
    grid.y[i] = static_cast<float>(static_cast<double>(i / 41) * kSpacingMm);
    grid.z[i] = 40.0F + grid.x[i];
    grid.valid[i] = 1;
  }
  const Eigen::AlignedBox3d field = ScannerModel::that_took(grid, nullptr, 0.02).field_mm;
  const Eigen::Vector3d far = kSpacingMm * Eigen::Vector3d(3, 3, 9);
  const Eigen::Vector3d near = kSpacingMm * Eigen::Vector3d(3, 3, 0);
  EXPECT_TRUE(field.min().isApprox(Eigen::Vector3d(0, 0, 40) + far, 1e-6)) << field.min().transpose();
  EXPECT_TRUE(field.max().isApprox(Eigen::Vector3d(10, 10, 50) - near, 1e-6)) << field.max().transpose();
}

TEST(ViewPrediction, NoiseMakesGrazingLinksTooLong) {
  // At 60°, µ = 0.05 mm and 0.02 mm noise about one link in nine is too long.
  const double both = dense_sampling_chance(std::cos(rad_from_deg(60)), 0.05, 0.02);
  EXPECT_NEAR(std::sqrt(both), 1.0 - 1.0 / 9.0, 0.05);
  EXPECT_EQ(dense_sampling_chance(std::cos(rad_from_deg(71)), 0.05, 0.0), 0.0);
  EXPECT_EQ(dense_sampling_chance(std::cos(rad_from_deg(69)), 0.05, 0.0), 1.0);
  EXPECT_GT(dense_sampling_chance(std::cos(rad_from_deg(30)), 0.1, 0.02), 0.99);
}

}  // namespace
}  // namespace dubsar
