// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What pin detection is made of: parting at steps, cones and balls, noise along rows.
#include <gtest/gtest.h>

#include <cmath>

#include "core/grid_noise.h"
#include "core/random.h"
#include "core/units.h"
#include "registration/pin_body.h"
#include "registration/pin_components.h"
#include "registration/pin_noise.h"
#include "tests/registration/support/slab_with_pins.h"

namespace dubsar {
namespace {

/// Two flat halves of a grid, the right one `step_mm` higher.
RangeGrid two_levels(double step_mm) {
  RangeGrid grid;
  grid.allocate(40, 60);
  grid.spacing_mm = 0.1;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] = 0.1F * static_cast<float>(grid.col_of(i));
    grid.y[i] = 0.1F * static_cast<float>(grid.row_of(i));
    grid.z[i] = grid.col_of(i) < 30 ? 0.0F : static_cast<float>(step_mm);
    grid.valid[i] = 1;
  }
  return grid;
}

TEST(Sheets, PartAtAStepAndNotAcrossASingleSample) {
  EXPECT_EQ(part_at_steps(two_levels(0.0), {0.1, 0.0}).components.size(), 1U);
  EXPECT_EQ(part_at_steps(two_levels(1.0), {0.1, 0.0}).components.size(), 2U);
  RangeGrid bridged = two_levels(0.5);
  bridged.z[bridged.index(20, 30)] = 0.25F;  // a mixed pixel within reach of both
  const Sheets sheets = part_at_steps(bridged, {0.1, 0.0});
  EXPECT_EQ(sheets.components.size(), 2U);
  EXPECT_FALSE(is_thin(sheets, bridged, 0, 29));
  EXPECT_TRUE(is_thin(sheets, bridged, 0, 30));
  EXPECT_EQ(samples_of(sheets, bridged, 0).size(), 40U * 30U);
}

TEST(Sheets, FollowASteepSlope) {
  RangeGrid grid = two_levels(0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.z[i] = 3.0F * grid.x[i];  // 72 degrees: neighbours are 3.2 µ apart
  }
  EXPECT_EQ(part_at_steps(grid, {0.1, 0.0}).components.size(), 1U);
}

TEST(Sheets, ConnectOverShortGaps) {
  RangeGrid grid = two_levels(0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const int col = grid.col_of(i);
    grid.valid[i] = (col < 20 || (col >= 24 && col < 28) || col >= 50) ? 1 : 0;
  }
  const Sheets sheets = part_at_steps(grid, {0.1, 0.0});
  ASSERT_EQ(sheets.components.size(), 3U);
  const std::vector<std::uint8_t> joined = connected_with_large(sheets, grid, {1, 0, 0}, 1.0, 0.1);
  EXPECT_EQ(joined, (std::vector<std::uint8_t>{1, 1, 0}));
}

TEST(Noise, IsReadOffTheRows) {
  testing::Slab slab;
  slab.noise_mm = 0.03;
  EXPECT_NEAR(estimate_noise_mm(slab_with_pins({}, slab)), 0.03, 0.004);
  EXPECT_EQ(estimate_noise_mm(RangeGrid{}), 0.0);
}

TEST(Noise, KnowsHowFarResidualsHangTogether) {
  Random random(5);
  std::vector<Residual> residuals;
  for (std::uint32_t row = 0; row < 40; ++row) {
    double last = random.normal();
    for (std::uint32_t col = 0; col < 60; ++col) {
      const double next = random.normal();
      residuals.push_back({row, col, 0.02 * (last + next) / std::sqrt(2.0)});
      last = next;
    }
  }
  RowNoiseSums sums;
  sums.add(residuals);
  const RowNoise noise = sums.noise();
  EXPECT_NEAR(noise.at(0), 4e-4, 4e-5);
  EXPECT_NEAR(noise.at(1), 2e-4, 4e-5);
  EXPECT_EQ(noise.at(2), 0.0);
  EXPECT_EQ(RowNoiseSums{}.noise().at(0), 0.0);
}

/// The half of a cone, and of the ball at its end, that faces +z.
std::vector<Eigen::Vector3d> half_pin(const Eigen::Vector3d& tip, const Eigen::Vector3d& arm, double radius,
                                      double slope, double noise_mm) {
  Random random(11);
  std::vector<Eigen::Vector3d> out;
  const Eigen::Vector3d u = arm.cross(Eigen::Vector3d::UnitZ()).normalized();
  const Eigen::Vector3d v = u.cross(arm);
  const double up = v.z() > 0 ? 1 : -1;
  for (int k = 0; k < 600; ++k) {
    const double angle = random.uniform(0.1, kPi - 0.1);
    const Eigen::Vector3d side = std::cos(angle) * u + up * std::sin(angle) * v;
    const double s = random.uniform(-radius, 5.0);
    const double r = s > 0 ? radius + slope * s : std::sqrt(radius * radius - s * s);
    const Eigen::Vector3d way = s > 0 ? side : Eigen::Vector3d((s * arm + r * side) / radius);
    out.push_back(tip + s * arm + r * side + noise_mm * random.normal() * way);
  }
  return out;
}

TEST(PinBody, ConeAndBallComeOutAsTheyAre) {
  const Eigen::Vector3d tip(3, -2, 1);
  const Eigen::Vector3d arm = Eigen::Vector3d(1, 0.4, 0.2).normalized();
  const std::vector<Eigen::Vector3d> points = half_pin(tip, arm, 0.5, 0.04, 0.01);
  const auto cone = fit_cone(points, Eigen::Vector3d::UnitZ(), 0.05);
  ASSERT_TRUE(cone);
  const Cone along = cone->axis.dot(arm) > 0 ? *cone : cone->reversed();
  EXPECT_GT(along.axis.dot(arm), std::cos(0.01));
  EXPECT_LT(along.from_axis(tip), 0.02);
  EXPECT_NEAR(along.radius_at(along.along(tip)), 0.5, 0.02);
  EXPECT_NEAR(along.slope, 0.04, 0.01);
  EXPECT_GT(along.coverage_rad, 2.5);
  const auto ball = fit_ball(points, tip + Eigen::Vector3d(0.1, -0.1, 0.1), along.axis,
                             Eigen::Vector3d::UnitZ(), 0.5, 0.05);
  ASSERT_TRUE(ball);
  EXPECT_LT((ball->center_mm - tip).norm(), 0.01);
  EXPECT_GT(ball->cylinder_ratio, 10);
}

TEST(PinBody, RefusesWhatHasNoShape) {
  EXPECT_FALSE(fit_cone({}, Eigen::Vector3d::UnitZ(), 0.05));
  const std::vector<Eigen::Vector3d> one(40, Eigen::Vector3d(1, 2, 3));
  EXPECT_FALSE(fit_cone(one, Eigen::Vector3d::UnitZ(), 0.05));
  EXPECT_FALSE(fit_ball(one, {1, 2, 3}, {1, 0, 0}, Eigen::Vector3d::UnitZ(), 0.5, 0.05));
}

}  // namespace
}  // namespace dubsar
