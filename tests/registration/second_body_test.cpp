// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Two things in view, each turned by itself between the scans: no pose is right for both.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <string>

#include "bench/support/true_scans.h"
#include "core/random.h"
#include "core/units.h"
#include "registration/registrar.h"

namespace dubsar {
namespace {

constexpr double kSpacing_mm = 0.2;
constexpr float kApart_mm = 60.0F;

std::shared_ptr<const RangeGrid> one_scan_of(std::uint64_t seed) {
  return bench::true_scans(bench::random_tablet(seed, "text", kSpacing_mm),
                           {kSpacing_mm, 0.01, 12, {0}, seed, bench::Pins::kNone, 0})
      .front()
      .grid;
}

/// Two fragments beside each other, each turned on the table about its own middle, with noise of their own.
std::shared_ptr<const RangeGrid> both(double turn_left_deg, double turn_right_deg, std::uint64_t noise_seed) {
  static const std::shared_ptr<const RangeGrid> left = one_scan_of(71);
  static const std::shared_ptr<const RangeGrid> right = one_scan_of(73);
  auto out = std::make_shared<RangeGrid>();
  out->allocate(std::max(left->rows, right->rows), left->cols + right->cols);
  out->spacing_mm = left->spacing_mm;
  out->view = left->view;
  Random random(noise_seed);
  const auto put = [&](const RangeGrid& grid, int first_col, double turn_deg, float shift_mm) {
    Eigen::Vector3f middle = Eigen::Vector3f::Zero();
    for (std::size_t i = 0; i < grid.size(); ++i) {
      middle += grid.valid[i] != 0 ? grid.point(i) : Eigen::Vector3f(0, 0, 0);
    }
    middle /= static_cast<float>(grid.valid_count());
    const Eigen::Matrix3f turn =
        Eigen::AngleAxisf(static_cast<float>(rad_from_deg(turn_deg)), Eigen::Vector3f::UnitZ())
            .toRotationMatrix();
    for (int row = 0; row < grid.rows; ++row) {
      for (int col = 0; col < grid.cols; ++col) {
        if (grid.is_valid(row, col)) {
          const Eigen::Vector3f p = turn * (grid.point(grid.index(row, col)) - middle) + middle;
          const std::size_t to = out->index(row, first_col + col);
          out->x[to] = p.x() + shift_mm;
          out->y[to] = p.y();
          out->z[to] = p.z() + static_cast<float>(0.02 * random.normal());
          out->valid[to] = 1;
        }
      }
    }
  };
  put(*left, 0, turn_left_deg, 0.0F);
  put(*right, left->cols, turn_right_deg, kApart_mm);
  return out;
}

ScanPose second_of_two(const std::shared_ptr<const RangeGrid>& first,
                       const std::shared_ptr<const RangeGrid>& second) {
  JobContext job;
  Registrar registrar;
  registrar.add(0, first, nullptr, job);
  registrar.add(1, second, nullptr, job);
  EXPECT_TRUE(registrar.finalize(job));
  return registrar.poses().back();
}

TEST(SecondBody, OfTwoFragmentsThatMovedByThemselvesNeitherSetsThePose) {
  const ScanPose pose = second_of_two(both(0, 0, 1), both(10, -30, 2));
  EXPECT_NE(pose.status, PoseStatus::kRegistered);
  EXPECT_NE(pose.reason.find("two things in view moved against each other"), std::string::npos)
      << pose.reason;
  EXPECT_NE(pose.reason.find("by 40 degrees"), std::string::npos) << pose.reason;
}

TEST(SecondBody, TwoFragmentsThatStayedAreRegistered) {
  EXPECT_EQ(second_of_two(both(0, 0, 1), both(0, 0, 2)).status, PoseStatus::kRegistered);
}

}  // namespace
}  // namespace dubsar
