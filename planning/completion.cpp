// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/completion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/units.h"

namespace dubsar {

namespace {

/// An end of an axis was seen when this share of the seen surface faces along it.
constexpr double kFacingCosine = 0.85;
constexpr double kLeastShareSeen = 0.02;
/// A tip is closed where of the rays that come along the axis no more than so many meet the surface from
/// behind, and where in its outermost part it faces each eighth of the turn with at least that share.
constexpr double kMostFromBehind = 0.1;
constexpr double kTipOfExtent = 0.15;
constexpr std::size_t kTipSectors = 8;
constexpr double kLeastShareOfSector = 0.02;
constexpr int kTipRays = 32;  ///< each way
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

/// Whether the surface beyond `from_mm` along `out` faces all around it.
bool faces_all_around(const Mesh& surface, const Eigen::Vector3d& out, double from_mm) {
  const Eigen::Vector3d u = out.unitOrthogonal();
  const Eigen::Vector3d v = out.cross(u);
  std::array<double, kTipSectors> by_sector{};
  double all = 0;
  for (const auto& f : surface.faces) {
    const Eigen::Vector3d a = surface.positions[f[0]].cast<double>();
    const Eigen::Vector3d b = surface.positions[f[1]].cast<double>();
    const Eigen::Vector3d c = surface.positions[f[2]].cast<double>();
    const Eigen::Vector3d n = 0.5 * (b - a).cross(c - a);
    if (out.dot(a + b + c) / 3.0 < from_mm || !(n.norm() > 0)) {
      continue;
    }
    const double turn = (std::atan2(v.dot(n), u.dot(n)) + kPi) / (2 * kPi) * kTipSectors;
    by_sector[std::min(static_cast<std::size_t>(std::max(turn, 0.0)), kTipSectors - 1)] += n.norm();
    all += n.norm();
  }
  return all > 0 &&
         std::ranges::all_of(by_sector, [&](double area) { return area >= kLeastShareOfSector * all; });
}

/// Whether the end that `out` leads to is closed, though little of it faces that way.
bool is_closed_tip(const Mesh& surface, const MeshQuery& query, std::span<const Eigen::Vector3d> corners_mm,
                   const Eigen::Vector3d& out) {
  const Eigen::Vector3d u = out.unitOrthogonal();
  const Eigen::Vector3d v = out.cross(u);
  Eigen::AlignedBox3d box;  // along u, v and out
  for (const Eigen::Vector3d& p : corners_mm) {
    box.extend(Eigen::Vector3d(u.dot(p), v.dot(p), out.dot(p)));
  }
  const Eigen::Vector3d size = box.sizes();
  if (!faces_all_around(surface, out, box.max().z() - kTipOfExtent * size.z())) {
    return false;
  }
  int rays = 0;
  int behind = 0;
  for (int k = 0; k < kTipRays * kTipRays; ++k) {
    const double a = box.min().x() + (k % kTipRays + 0.5) / kTipRays * size.x();
    const double b = box.min().y() + (k / kTipRays + 0.5) / kTipRays * size.y();
    const Eigen::Vector3d from = a * u + b * v + (box.max().z() + 1.0) * out;
    if (const auto hit = query.first_hit(from.cast<float>(), (-out).cast<float>(), 0.0F,
                                         static_cast<float>(size.z() + 2.0))) {
      ++rays;
      behind += hit->normal.cast<double>().dot(out) > 0 ? 0 : 1;
    }
  }
  return rays > 0 && behind <= kMostFromBehind * rays;
}

Axis axis_of(const Eigen::Vector3d& along, const Mesh& surface, const MeshQuery& query, const Mesh& hull,
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
  if (axis.high_seen != axis.low_seen &&
      is_closed_tip(surface, query, corners_mm, axis.high_seen ? -along : along)) {
    axis.high_seen = axis.low_seen = true;
  }
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

std::vector<Eigen::Vector3d> mirrored_points(const Mesh& surface, const MeshQuery& query, const Mesh& hull,
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
    axis = axis_of(faces.model_from_faces.col(k), surface, query, hull, corners_mm);
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
