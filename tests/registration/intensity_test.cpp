// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Intensity helps where the clay shows too little, and never hurts.
#include <gtest/gtest.h>

#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

using testing::bumpy;
using testing::FieldScan;
using testing::pose_of;
using testing::scan_field;

/// How light the surface is at a place of the model, and what the scanner makes of it at a cell.
using Light = std::function<double(const Eigen::Vector3d& model_mm, int row, int col, Random& random)>;

std::shared_ptr<const RangeGrid> lit(const testing::Height& height, const RigidTransform& pose,
                                     std::uint64_t seed, const Light& light) {
  FieldScan scan;
  scan.seed = seed;
  RangeGrid grid = scan_field(height, pose, scan);
  grid.intensity.assign(grid.size(), 0.0F);
  Random random(seed + 1000);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      const Eigen::Vector3d p = pose * Eigen::Vector3d(grid.point(i).cast<double>());
      grid.intensity[i] =
          static_cast<float>(std::clamp(light(p, grid.row_of(i), grid.col_of(i), random), 0.0, 1.0));
    }
  }
  return std::make_shared<const RangeGrid>(std::move(grid));
}

/// A cushion on which nothing is written: it looks the same after a half turn.
double blank(double x, double y) {
  return -x * x / 70.0 - y * y / 160.0;
}

const RigidTransform& turned() {
  static const RigidTransform pose = pose_of(6, -4, 65, {2, 1, 0});
  return pose;
}

/// The second of two scans of the surface.
ScanPose second_pose(const testing::Height& height, const Light& light) {
  Registrar registrar;
  JobContext job;
  registrar.add(0, lit(height, {}, 1, light), nullptr, job);
  return registrar.add(1, lit(height, turned(), 2, light), nullptr, job);
}

double off_mm(const ScanPose& pose) {
  double worst = 0;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(20, 0, 0), Eigen::Vector3d(0, 20, 0)}) {
    worst = std::max(worst, (pose.model_from_scanner * p - turned() * p).norm());
  }
  return worst;
}

TEST(Intensity, TellsTheWayABlankTabletLies) {
  const auto stains = [](const Eigen::Vector3d& p, int, int, Random& random) {
    // Spots of a millimetre or two that never repeat.
    const double spots = std::sin(2.1 * p.x() + 1.7 * std::sin(0.9 * p.y())) *
                         std::sin(1.8 * p.y() + 2.3 * std::sin(0.7 * p.x() + 0.4));
    return 0.5 + 0.2 * spots + 0.03 * random.normal();
  };
  const ScanPose pose = second_pose(blank, stains);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  EXPECT_LT(off_mm(pose), 0.5);
}

TEST(Intensity, OfTheScannerItselfTellsNothing) {
  const auto stripes = [](const Eigen::Vector3d&, int row, int col, Random& random) {
    return 0.5 + 0.2 * std::sin(1.3 * col) + 0.1 * std::sin(0.9 * row) + 0.03 * random.normal();
  };
  EXPECT_NE(second_pose(blank, stripes).status, PoseStatus::kRegistered);
}

TEST(Intensity, ThatChangesDoesNotHurt) {
  const auto flicker = [](const Eigen::Vector3d&, int, int, Random& random) { return random.uniform(0, 1); };
  const ScanPose pose = second_pose(bumpy(11, 150), flicker);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  EXPECT_LT(off_mm(pose), 0.02);
}

}  // namespace
}  // namespace dubsar
