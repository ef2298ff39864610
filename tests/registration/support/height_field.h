// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>

#include "core/random.h"
#include "core/range_grid.h"
#include "core/rigid_transform.h"

namespace dubsar::testing {

using Height = std::function<double(double x, double y)>;

struct FieldScan {
  double spacing_mm = 0.4;
  double noise_mm = 0.01;
  double half_mm = 30;                                                    ///< of the scanner's square field
  double low_x_mm = -25, high_x_mm = 25, low_y_mm = -25, high_y_mm = 25;  ///< of the object, in its own frame
  std::uint64_t seed = 1;
};

/// A scan of the surface z = height(x, y) from a scanner whose rays run along its -z; model_from_scanner must
/// not turn it so far that the surface hides itself.
inline RangeGrid scan_field(const Height& height, const RigidTransform& model_from_scanner,
                            const FieldScan& scan) {
  RangeGrid grid;
  const int side = static_cast<int>(2 * scan.half_mm / scan.spacing_mm);
  grid.allocate(side, side);
  grid.spacing_mm = scan.spacing_mm;
  Random random(scan.seed);
  for (int row = 0; row < side; ++row) {
    for (int col = 0; col < side; ++col) {
      const double x = -scan.half_mm + col * scan.spacing_mm;
      const double y = -scan.half_mm + row * scan.spacing_mm;
      const auto above = [&](double z) {
        const Eigen::Vector3d p = model_from_scanner * Eigen::Vector3d(x, y, z);
        return p.z() - height(p.x(), p.y());
      };
      double z = 0;
      for (int k = 0; k < 60; ++k) {
        const double slope = (above(z + 1e-4) - above(z - 1e-4)) / 2e-4;
        const double step = above(z) / (std::abs(slope) > 0.2 ? slope : 0.2);
        z -= std::clamp(step, -2.0, 2.0);
        if (std::abs(step) < 1e-9) {
          break;
        }
      }
      const Eigen::Vector3d p = model_from_scanner * Eigen::Vector3d(x, y, z);
      const double noise = scan.noise_mm * random.normal();
      if (std::abs(above(z)) > 1e-6 || p.x() < scan.low_x_mm || p.x() > scan.high_x_mm ||
          p.y() < scan.low_y_mm || p.y() > scan.high_y_mm) {
        continue;
      }
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(x);
      grid.y[i] = static_cast<float>(y);
      grid.z[i] = static_cast<float>(z + noise);
      grid.valid[i] = 1;
    }
  }
  return grid;
}

/// Bumps and hollows of several sizes at places drawn from a seed: no part of it repeats.
inline Height bumpy(std::uint64_t seed, int bumps = 60) {
  struct Bump {
    double x, y, height, width;
  };
  std::vector<Bump> all;
  Random random(seed);
  for (int k = 0; k < bumps; ++k) {
    const double x = random.uniform(-28, 28);
    const double y = random.uniform(-28, 28);
    const double width = random.uniform(1.5, 6);
    all.push_back({x, y, random.uniform(-0.45, 0.45) * width, width});
  }
  return [all](double x, double y) {
    double z = 0;
    for (const Bump& b : all) {
      const double r2 = ((x - b.x) * (x - b.x) + (y - b.y) * (y - b.y)) / (b.width * b.width);
      z += b.height * std::exp(-r2);
    }
    return z;
  };
}

/// A turn by the given degrees about x, y, z in this order, then a shift.
inline RigidTransform pose_of(double x_deg, double y_deg, double z_deg, const Eigen::Vector3d& shift_mm) {
  constexpr double kRad = 3.14159265358979 / 180.0;
  return {(Eigen::AngleAxisd(z_deg * kRad, Eigen::Vector3d::UnitZ()) *
           Eigen::AngleAxisd(y_deg * kRad, Eigen::Vector3d::UnitY()) *
           Eigen::AngleAxisd(x_deg * kRad, Eigen::Vector3d::UnitX()))
              .toRotationMatrix(),
          shift_mm};
}

}  // namespace dubsar::testing
