// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "tests/registration/support/gauge.h"

#include <limits>

#include "registration/absolute_orientation.h"

namespace dubsar::testing {

std::vector<GaugeError> gauge_errors(const std::vector<ScanPose>& poses,
                                     const std::map<std::string, RigidTransform>& truth,
                                     const std::vector<std::shared_ptr<const RangeGrid>>& grids) {
  std::vector<Eigen::Vector3d> from;
  std::vector<Eigen::Vector3d> to;
  std::vector<GaugeError> out;
  for (const ScanPose& pose : poses) {
    const RangeGrid& grid = *grids[static_cast<std::size_t>(pose.id)];
    if (pose.status != PoseStatus::kRegistered || !truth.contains(pose.file)) {
      continue;
    }
    for (std::size_t i = 0; i < grid.size(); i += 37) {
      if (grid.valid[i] != 0) {
        from.push_back(pose.model_from_scanner * Eigen::Vector3d(grid.point(i).cast<double>()));
        to.push_back(truth.at(pose.file) * Eigen::Vector3d(grid.point(i).cast<double>()));
      }
    }
  }
  const RigidTransform gauge = absolute_orientation(from, to).value_or(RigidTransform{});
  for (const ScanPose& pose : poses) {
    GaugeError error{pose, std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
    if (pose.status == PoseStatus::kRegistered && truth.contains(pose.file)) {
      const RangeGrid& grid = *grids[static_cast<std::size_t>(pose.id)];
      Eigen::Vector3d middle = Eigen::Vector3d::Zero();
      double count = 0;
      for (std::size_t i = 0; i < grid.size(); ++i) {
        if (grid.valid[i] != 0) {
          middle += grid.point(i).cast<double>();
          ++count;
        }
      }
      middle /= std::max(1.0, count);
      const RigidTransform mine = gauge * pose.model_from_scanner;
      const RigidTransform& theirs = truth.at(pose.file);
      error.turn_rad = RigidTransform{mine.rotation * theirs.rotation.transpose(), {0, 0, 0}}.angle_rad();
      error.shift_mm = (mine * middle - theirs * middle).norm();
    }
    out.push_back(error);
  }
  return out;
}

}  // namespace dubsar::testing
