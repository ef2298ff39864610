// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/hint_starts.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/units.h"
#include "registration/point_pairs.h"

namespace dubsar {

namespace {

/// Turns about a click's normal that are tried: ICP takes it from half a step.
constexpr int kTurns = 36;
/// The normal is that of the clay around the click: a single sample may lie on the slope of a wedge, and the
/// click is good to a millimetre only.
constexpr double kNormalRadiusMm = 3.0;
/// Turns about the line through two clicks, to either side of what the normals say.
constexpr int kRolls = 5;
constexpr double kRollStepRad = 15.0 * kPi / 180.0;
/// Two points nearer than this do not settle the turn about the normal.
constexpr double kLeastBaseMm = 4.0;

Eigen::Vector3d normal_around(const ScanSurface& surface, const Eigen::Vector3d& point_mm) {
  const SurfaceLevel& level = *surface.medium;
  const double radius_mm = std::max(kNormalRadiusMm, 3.0 * level.spacing_mm);
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  Eigen::Vector3d nearest = surface.toward_camera;
  double nearest_mm = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < level.grid.size(); ++i) {
    if (level.usable[i] == 0) {
      continue;
    }
    const double away_mm = (level.grid.point(i).cast<double>() - point_mm).norm();
    if (away_mm < nearest_mm) {
      nearest_mm = away_mm;
      nearest = level.normals[i].cast<double>();
    }
    if (away_mm < radius_mm) {
      sum += level.normals[i].cast<double>();
    }
  }
  return (sum.norm() > 0.1 ? sum : nearest).normalized();
}

/// The pose that takes one right-handed frame to the other: origin on origin, axis on axis.
RigidTransform frame_on_frame(const Eigen::Matrix3d& from, const Eigen::Vector3d& from_mm,
                              const Eigen::Matrix3d& to, const Eigen::Vector3d& to_mm) {
  const Eigen::Matrix3d r = to * from.transpose();
  return {r, to_mm - r * from_mm};
}

/// Columns: along, across, normal.
Eigen::Matrix3d axes(const Eigen::Vector3d& along, const Eigen::Vector3d& normal) {
  Eigen::Matrix3d out;
  out.col(0) = along.normalized();
  out.col(1) = normal.cross(along).normalized();
  out.col(2) = out.col(0).cross(out.col(1));
  return out;
}

std::vector<RigidTransform> from_one_point(const PointPair& pair, const ScanSurface& scan,
                                           const ScanSurface& on) {
  const Eigen::Vector3d here = normal_around(scan, pair.point_mm);
  const Eigen::Vector3d there = normal_around(on, pair.on_point_mm);
  const Eigen::Matrix3d from = axes(here.unitOrthogonal(), here);
  std::vector<RigidTransform> out;
  for (int k = 0; k < kTurns; ++k) {
    const Eigen::Vector3d along =
        Eigen::AngleAxisd(2.0 * kPi * k / kTurns, there) * Eigen::Vector3d(there.unitOrthogonal());
    out.push_back(frame_on_frame(from, pair.point_mm, axes(along, there), pair.on_point_mm));
  }
  return out;
}

std::vector<RigidTransform> from_two_points(const PointPair& a, const PointPair& b, const ScanSurface& scan,
                                            const ScanSurface& on) {
  const auto frame = [](const ScanSurface& surface, const Eigen::Vector3d& p, const Eigen::Vector3d& q) {
    return axes(q - p, normal_around(surface, p) + normal_around(surface, q));
  };
  const Eigen::Matrix3d from = frame(scan, a.point_mm, b.point_mm);
  const Eigen::Matrix3d to = frame(on, a.on_point_mm, b.on_point_mm);
  std::vector<RigidTransform> out;
  // Near an edge of the tablet the normals are far from those that another view shows.
  for (int k = -kRolls; k <= kRolls; ++k) {
    const Eigen::Matrix3d roll =
        Eigen::AngleAxisd(k * kRollStepRad, Eigen::Vector3d(to.col(0))).toRotationMatrix();
    out.push_back(frame_on_frame(from, 0.5 * (a.point_mm + b.point_mm), roll * to,
                                 0.5 * (a.on_point_mm + b.on_point_mm)));
  }
  return out;
}

std::vector<RigidTransform> around(const RigidTransform& pose, const Eigen::Vector3d& center_mm) {
  std::vector<RigidTransform> out{pose};
  const Eigen::Vector3d center = pose * center_mm;
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {-0.5, 0.5}) {
      const Eigen::Matrix3d turn =
          Eigen::AngleAxisd(side * kMostRoughTurnRad, Eigen::Vector3d::Unit(axis)).toRotationMatrix();
      out.push_back({turn * pose.rotation, turn * (pose.translation_mm - center) + center});
    }
  }
  return out;
}

}  // namespace

std::vector<RigidTransform> starts_from_hint(const PoseHint& hint, const ScanSurface& scan,
                                             const ScanSurface& on) {
  if (hint.on_from_scanner) {
    return around(hint.on_from_scanner->orthonormalised(), scan.centroid_mm);
  }
  if (!check_point_pairs(hint.points, {})) {
    return {};
  }
  if (hint.points.size() >= 3) {
    return {*solve_point_pairs(hint.points, {})};
  }
  const PointPair& first = hint.points.front();
  const PointPair& last = hint.points.back();
  const double base_mm = (last.point_mm - first.point_mm).norm();
  return base_mm >= kLeastBaseMm ? from_two_points(first, last, scan, on) : from_one_point(first, scan, on);
}

}  // namespace dubsar
