// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A pebble and scans of it, for tests of what is red and where to look next.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "core/range_grid.h"
#include "core/rig.h"
#include "core/units.h"
#include "planning/cleared_map.h"
#include "planning/sparse_flags.h"

namespace dubsar::test {

inline constexpr double kSpacingMm = 0.25;

inline Rig turntable_rig() {
  Rig rig;
  rig.view.laser_mm = Eigen::Vector3d(0, 0, 250);
  rig.view.camera_mm = Eigen::Vector3d(0, 110, 250);
  rig.view.motion_per_row_mm = {0, kSpacingMm, 0};
  rig.spacing_mm = kSpacingMm;
  rig.has_turntable = true;
  rig.tilt_max_rad = rad_from_deg(70);
  return rig;
}

/// Distance along a ray to an ellipsoid with half axes a about the origin; none when it misses.
inline std::optional<double> hit_ellipsoid(const Eigen::Vector3d& from, const Eigen::Vector3d& ray,
                                           const Eigen::Vector3d& a) {
  const Eigen::Vector3d f = from.cwiseQuotient(a);
  const Eigen::Vector3d r = ray.cwiseQuotient(a);
  const double b = f.dot(r);
  const double c = f.squaredNorm() - 1;
  const double root = b * b - r.squaredNorm() * c;
  if (root < 0) {
    return std::nullopt;
  }
  return (-b - std::sqrt(root)) / r.squaredNorm();
}

/// A pebble seen straight down the scanner's axis, no shadows: what a laser from far off would bring.
inline RangeGrid scan_pebble(const RigidTransform& tablet_from_scanner) {
  const Eigen::Vector3d half(12, 9, 5);
  RangeGrid grid;
  grid.allocate(110, 110);
  grid.spacing_mm = kSpacingMm;
  grid.view = turntable_rig().view;
  grid.nominal = NominalPose{};
  grid.nominal->tablet_from_scanner = tablet_from_scanner;
  const Eigen::Vector3d ray = tablet_from_scanner.rotation * Eigen::Vector3d(0, 0, -1);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.cols; ++c) {
      const Eigen::Vector3d from((c - 55) * kSpacingMm, (r - 55) * kSpacingMm, 60);
      if (const auto distance = hit_ellipsoid(tablet_from_scanner * from, ray, half)) {
        const std::size_t i = grid.index(r, c);
        grid.x[i] = static_cast<float>(from.x());
        grid.y[i] = static_cast<float>(from.y());
        grid.z[i] = static_cast<float>(from.z() - *distance);
        grid.valid[i] = 1;
      }
    }
  }
  return grid;
}

inline RigidTransform turned(double about_x_deg, double about_y_deg) {
  RigidTransform t;
  t.rotation = (Eigen::AngleAxisd(rad_from_deg(about_x_deg), Eigen::Vector3d::UnitX()) *
                Eigen::AngleAxisd(rad_from_deg(about_y_deg), Eigen::Vector3d::UnitY()))
                   .toRotationMatrix();
  return t;
}

/// A pit in the middle of the obverse: no light comes back from it.
inline void leave_out_pit(double radius_mm, const RigidTransform& tablet_from_scanner, RangeGrid& grid) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector3d p = tablet_from_scanner * grid.point(i).cast<double>();
    grid.valid[i] = grid.valid[i] != 0 && (p.z() < 0 || p.head<2>().norm() > radius_mm);
  }
}

/// Nothing beyond this is in the field of the scanner.
inline void crop_to_field(double half_mm, RangeGrid& grid) {
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.valid[i] = grid.valid[i] != 0 && std::abs(grid.x[i]) <= half_mm && std::abs(grid.y[i]) <= half_mm;
  }
}

struct Session {
  ClearedMap map;
  std::vector<std::unique_ptr<RangeGrid>> grids;
  double half_field_mm = 1000;
  double pit_mm = 0;
  void scan(const RigidTransform& pose) {
    grids.push_back(std::make_unique<RangeGrid>(scan_pebble(pose)));
    crop_to_field(half_field_mm, *grids.back());
    leave_out_pit(pit_mm, pose, *grids.back());
    const SampleFlags flags = flag_sparse(*grids.back());
    map.add({static_cast<int>(grids.size()) - 1, grids.back().get(), &flags, pose, 0.0});
  }
};

}  // namespace dubsar::test
