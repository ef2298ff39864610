// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/completion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

namespace dubsar {

namespace {

/// An end of an axis was seen when this share of the seen surface faces along it.
constexpr double kFacingCosine = 0.85;
constexpr double kLeastShareSeen = 0.02;
/// Sides stand upright where they lean by less than this from the axis.
constexpr double kUprightCosine = 0.2;
constexpr double kLeastShareUpright = 0.02;

struct Axis {
  Eigen::Vector3d along{0, 0, 1};
  double low_mm = 0, high_mm = 0;  ///< extent of what was seen
  bool low_seen = false, high_seen = false;
  double middle_mm = 0;
};

/// Area and area times centroid·axis of the faces whose normal passes the test.
template <class Test>
std::array<double, 3> areas(const Mesh& mesh, const Eigen::Vector3d& along, const Test& test) {
  double all = 0;
  double part = 0;
  double moment = 0;
  for (const auto& f : mesh.faces) {
    const Eigen::Vector3d a = mesh.positions[f[0]].cast<double>();
    const Eigen::Vector3d b = mesh.positions[f[1]].cast<double>();
    const Eigen::Vector3d c = mesh.positions[f[2]].cast<double>();
    const Eigen::Vector3d n = 0.5 * (b - a).cross(c - a);
    const double area = n.norm();
    all += area;
    if (area > 0 && test(n.dot(along) / area)) {
      part += area;
      moment += area * along.dot(a + b + c) / 3.0;
    }
  }
  return {all, part, moment};
}

Axis axis_of(const Eigen::Vector3d& along, const Mesh& surface, const Mesh& hull,
             std::span<const Eigen::Vector3d> corners_mm) {
  Axis axis;
  axis.along = along;
  axis.low_mm = axis.high_mm = along.dot(corners_mm.front());
  for (const Eigen::Vector3d& p : corners_mm) {
    axis.low_mm = std::min(axis.low_mm, along.dot(p));
    axis.high_mm = std::max(axis.high_mm, along.dot(p));
  }
  const auto up = areas(surface, along, [](double c) { return c > kFacingCosine; });
  const auto down = areas(surface, along, [](double c) { return c < -kFacingCosine; });
  axis.high_seen = up[1] > kLeastShareSeen * up[0];
  axis.low_seen = down[1] > kLeastShareSeen * down[0];
  axis.middle_mm = 0.5 * (axis.low_mm + axis.high_mm);
  if (axis.high_seen != axis.low_seen) {
    const auto upright = areas(hull, along, [](double c) { return std::abs(c) < kUprightCosine; });
    axis.middle_mm = upright[1] > kLeastShareUpright * upright[0] ? upright[2] / upright[1]
                     : axis.high_seen                             ? axis.low_mm
                                                                  : axis.high_mm;
  }
  return axis;
}

}  // namespace

std::vector<Eigen::Vector3d> mirrored_points(const Mesh& surface, const Mesh& hull,
                                             std::span<const Eigen::Vector3d> corners_mm,
                                             const ModelFaces& faces) {
  std::vector<Eigen::Vector3d> out;
  if (corners_mm.empty()) {
    return out;
  }
  std::array<Axis, 3> axes;
  bool open = false;
  for (int k = 0; k < 3; ++k) {
    Axis& axis = axes[static_cast<std::size_t>(k)];
    axis = axis_of(faces.model_from_faces.col(k), surface, hull, corners_mm);
    open = open || axis.low_seen != axis.high_seen;
  }
  if (!open) {
    return out;
  }
  for (const Eigen::Vector3d& p : corners_mm) {
    Eigen::Vector3d mirrored = Eigen::Vector3d::Zero();
    for (const Axis& axis : axes) {
      double at = axis.along.dot(p);
      if (axis.low_seen != axis.high_seen) {
        at = 2.0 * axis.middle_mm - at;
        // An end that was seen is where it is.
        at = axis.high_seen ? std::min(at, axis.high_mm) : std::max(at, axis.low_mm);
      }
      mirrored += at * axis.along;
    }
    out.push_back(mirrored);
  }
  return out;
}

}  // namespace dubsar
