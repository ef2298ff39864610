// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "formats/grid_ply.h"
#include "tests/registration/support/height_field.h"

namespace dubsar::test {

/// A surface that is the same under a half turn: registration must ask, and a click can answer.
inline testing::Height two_fold_surface() {
  const auto half = testing::bumpy(15, 40);
  return [half](double x, double y) { return half(x, y) + half(-x, -y); };
}

inline RigidTransform two_fold_pose(int number) {
  return number == 0 ? RigidTransform{} : testing::pose_of(5, 3, 20, {1, 1, 0});
}

/// Writes two scans of it, scan_0.ply and scan_1.ply.
inline std::filesystem::path write_two_fold_scans(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  for (int k = 0; k < 2; ++k) {
    testing::FieldScan scan;
    scan.seed = 1 + 8 * static_cast<std::uint64_t>(k);
    const std::string name = "scan_" + std::to_string(k) + ".ply";
    if (!write_grid_ply(folder / name, scan_field(two_fold_surface(), two_fold_pose(k), scan))) {
      return {};
    }
  }
  return folder;
}

/// "x,y,z=x,y,z" of a place of the surface, as it is clicked in scan 1 and in scan 0 when `turned` is where
/// the operator knows scan 1 to lie.
inline std::string two_fold_click(double x, double y, bool turned) {
  const Eigen::Vector3d p(x, y, two_fold_surface()(x, y));
  const RigidTransform half_turn = testing::pose_of(0, 0, 180, {0, 0, 0});
  const Eigen::Vector3d q = (turned ? half_turn * two_fold_pose(1) : two_fold_pose(1)).inverse() * p;
  const auto text = [](const Eigen::Vector3d& v) {
    return std::to_string(v.x()) + "," + std::to_string(v.y()) + "," + std::to_string(v.z());
  };
  return text(q) + "=" + text(p);
}

}  // namespace dubsar::test
