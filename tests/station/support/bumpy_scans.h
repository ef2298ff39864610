// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/rigid_transform.h"
#include "formats/grid_ply.h"
#include "tests/registration/support/height_field.h"

namespace dubsar::test {

/// Where scan `number` of the bumpy field was taken from. All of them see most of it.
inline RigidTransform bumpy_pose(int number) {
  static const std::vector<RigidTransform> poses{
      testing::pose_of(0, 0, 0, {0, 0, 0}),     testing::pose_of(10, -7, 80, {2, -2, 1}),
      testing::pose_of(-9, 8, -60, {-3, 2, 1}), testing::pose_of(6, 9, 140, {1, 3, 0}),
      testing::pose_of(-6, -9, 20, {3, 1, 2}),  testing::pose_of(8, 3, -110, {-1, -3, 1})};
  return poses.at(static_cast<std::size_t>(number));
}

/// Scan `number` of one bumpy field of 28 x 28 mm; another `field` is another object.
inline RangeGrid bumpy_scan(int number, std::uint64_t field = 11, double spacing_mm = 0.4) {
  testing::FieldScan scan;
  scan.spacing_mm = spacing_mm;
  scan.half_mm = 22;
  scan.low_x_mm = scan.low_y_mm = -14;
  scan.high_x_mm = scan.high_y_mm = 14;
  scan.seed = 100 + static_cast<std::uint64_t>(number);
  return testing::scan_field(testing::bumpy(field), bumpy_pose(number), scan);
}

inline std::string scan_name(int number) {
  return "scan_" + std::to_string(number) + ".ply";
}

/// Writes scans 0 … count-1 into a folder as range-grid PLY and returns the folder.
inline std::filesystem::path write_bumpy_scans(const std::filesystem::path& folder, int count) {
  std::filesystem::create_directories(folder);
  for (int k = 0; k < count; ++k) {
    if (!write_grid_ply(folder / scan_name(k), bumpy_scan(k))) {
      return {};
    }
  }
  return folder;
}

}  // namespace dubsar::test
