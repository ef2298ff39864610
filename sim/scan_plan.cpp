// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/scan_plan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/random.h"
#include "core/units.h"

namespace dubsar::sim {

namespace {

constexpr double kHandDeg = 10;
constexpr double kHandMm = 5;
/// Heights over the rim, as seen from the tablet's middle: steep enough for the writing on the faces, flat
/// enough for the edges.
constexpr std::array<double, 2> kFewElevationsDeg = {34, -34};
constexpr std::array<double, 4> kManyElevationsDeg = {42, -42, 14, -14};
constexpr int kManyViews = 16;

/// Rotation of a scanner that looks at the tablet from `from`; its y axis leans towards the obverse.
Eigen::Matrix3d looking_from(const Eigen::Vector3d& from, double roll_rad) {
  const Eigen::Vector3d z = from.normalized();
  const Eigen::Vector3d up = std::abs(z.z()) > 0.95 ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitZ();
  Eigen::Matrix3d r;
  r.col(0) = up.cross(z).normalized();
  r.col(1) = z.cross(r.col(0));
  r.col(2) = z;
  return r * Eigen::AngleAxisd(roll_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
}

RigidTransform held(const Eigen::Matrix3d& rotation, Random& random) {
  const Eigen::Vector3d axis = random.normal3();
  const Eigen::Vector3d slip = random.normal3();
  const double angle = std::min(1.0, 0.5 * std::abs(random.normal())) * rad_from_deg(kHandDeg);
  const double distance = std::min(1.0, 0.5 * std::abs(random.normal())) * kHandMm;
  return {Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix() * rotation,
          distance * slip.normalized()};
}

}  // namespace

std::vector<PlannedView> plan_views(int count, std::uint64_t seed) {
  Random random(seed_for(seed, 61));
  std::vector<PlannedView> views;
  const int around = count - 2;
  for (int i = 0; i < count; ++i) {
    PlannedView view;
    if (i < 2) {
      const Eigen::Vector3d from(0, 0, i == 0 ? 1 : -1);
      view.name = i == 0 ? "obverse" : "reverse";
      view.tablet_from_scanner = held(looking_from(from, 0), random);
    } else {
      const int k = i - 2;
      const double elevation_deg = around < kManyViews ? kFewElevationsDeg[static_cast<std::size_t>(k) % 2]
                                                       : kManyElevationsDeg[static_cast<std::size_t>(k) % 4];
      const double azimuth = 2.0 * kPi * k / around;
      const double elevation = rad_from_deg(elevation_deg);
      const Eigen::Vector3d from(std::cos(elevation) * std::cos(azimuth),
                                 std::cos(elevation) * std::sin(azimuth), std::sin(elevation));
      // Every other pair upside down: the camera then looks into the wedges from the other side.
      const double roll = (k / 2) % 2 == 0 ? 0.0 : kPi;
      view.name = "rim " + std::to_string(static_cast<int>(std::lround(deg_from_rad(azimuth)))) +
                  (elevation_deg > 0 ? " from the obverse" : " from the reverse");
      view.tablet_from_scanner = held(looking_from(from, roll), random);
    }
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace dubsar::sim
