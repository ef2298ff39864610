// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "sim/impression.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "core/units.h"

namespace dubsar::sim {

namespace {

/// Clay pushed sideways stands higher where it falls into an earlier hollow than on the free surface.
constexpr double kDamIntoHollow = 2.2;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

}  // namespace

Stroke long_wedge(const Eigen::Vector2d& head_mm, double angle_rad, double length_mm, double width_mm,
                  double depth_mm, double head_slope_rad) {
  const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  const double back = depth_mm / std::tan(head_slope_rad);
  Stroke stroke;
  stroke.foot_mm = head_mm + back * along;
  stroke.corners_mm = {(length_mm - back) * along, -back * along + 0.5 * width_mm * across,
                       -back * along - 0.5 * width_mm * across};
  stroke.depth_mm = depth_mm;
  return stroke;
}

Stroke winkelhaken(const Eigen::Vector2d& middle_mm, double angle_rad, double size_mm, double depth_mm) {
  const Eigen::Vector2d along(std::cos(angle_rad), std::sin(angle_rad));
  const Eigen::Vector2d across(-along.y(), along.x());
  Stroke stroke;
  stroke.foot_mm = middle_mm + 0.05 * size_mm * along;
  stroke.corners_mm = {0.68 * size_mm * along, -0.3 * size_mm * along + 0.52 * size_mm * across,
                       -0.3 * size_mm * along - 0.52 * size_mm * across};
  stroke.depth_mm = depth_mm;
  return stroke;
}

Impression::Impression(const TabletBody& body, const SurfaceFrame& origin, const Stroke& stroke,
                       double dam_mm)
    : dam_mm_(dam_mm) {
  const SurfaceFrame foot = body.walk(origin, stroke.foot_mm.x(), stroke.foot_mm.y());
  foot_ = foot.p_mm;
  normal_ = foot.n;
  depth_point_ = foot.p_mm - stroke.depth_mm * foot.n;
  for (std::size_t k = 0; k < 3; ++k) {
    exits_[k] = body.walk(foot, stroke.corners_mm[k].x(), stroke.corners_mm[k].y()).p_mm;
  }
  centre_ = (exits_[0] + exits_[1] + exits_[2]) / 3.0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d& a = exits_[k];
    const Eigen::Vector3d& b = exits_[(k + 1) % 3];
    faces_[k] = (a - depth_point_).cross(b - depth_point_).normalized();
    if (faces_[k].dot(centre_ - depth_point_) < 0) {
      faces_[k] = -faces_[k];
    }
    sides_[k] = (b - a).cross(normal_).normalized();
    if (sides_[k].dot(a - centre_) < 0) {
      sides_[k] = -sides_[k];
    }
  }
  dam_width_mm_ = std::clamp(0.45 * stroke.depth_mm, 0.1, 0.5);
  for (const Eigen::Vector3d& exit : exits_) {
    reach_mm_ = std::max(reach_mm_, (exit - centre_).norm());
  }
  reach_mm_ = std::max(reach_mm_, (depth_point_ - centre_).norm()) + 2.6 * dam_width_mm_ + 0.2;
}

double Impression::outside_mm(const Eigen::Vector3d& p) const {
  double farthest = -1e9;
  for (std::size_t k = 0; k < 3; ++k) {
    farthest = std::max(farthest, sides_[k].dot(p - exits_[k]));
  }
  return farthest;
}

double Impression::press(const Eigen::Vector3d& p, const Eigen::Vector3d& n, double height_mm,
                         int* face) const {
  *face = -1;
  // The far side of a thin tablet lies within reach too, but faces away.
  if (n.dot(normal_) < 0.2 || (p - centre_).squaredNorm() > reach_mm_ * reach_mm_) {
    return height_mm;
  }
  const double outside = outside_mm(p);
  if (outside > -2.0 * dam_width_mm_) {
    const double s = std::max(0.0, outside) / dam_width_mm_;
    // Faded to nothing at the reach, so that no step is left there.
    const double rise = dam_mm_ * std::max(0.0, std::exp(-s * s) - 0.0012);
    height_mm += height_mm < -2.0 * dam_mm_ ? kDamIntoHollow * rise : rise;
  }
  double floor = 1e9;
  int steepest = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const double climb = faces_[k].dot(n);
    const double side = faces_[k].dot(p - depth_point_);
    if (climb > 0.02) {
      if (side / climb < floor) {
        floor = side / climb;
        steepest = static_cast<int>(k);
      }
    } else if (side <= 0) {
      return height_mm;
    }
  }
  // `floor` is how far below p the three planes lie: the ray along n meets them exactly there.
  if (floor < 1e8 && -floor < height_mm) {
    *face = outside < dam_width_mm_ ? steepest : -1;
    return -floor;
  }
  return height_mm;
}

Wedge Impression::truth(const TabletBody& body) const {
  Wedge wedge;
  wedge.depth_point_mm = depth_point_;
  wedge.exit_points_mm = exits_;
  wedge.outer_vertices_mm = exits_;
  wedge.face_normals = faces_;
  wedge.depth_mm = body.depth_below(depth_point_);
  double longest = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d edge = exits_[k] - depth_point_;
    wedge.face_angles_rad[k] = angle_between(edge, exits_[(k + 1) % 3] - depth_point_);
    wedge.opening_angles_rad[k] = kPi - angle_between(faces_[(k + 2) % 3], faces_[k]);
    if (edge.norm() > longest) {
      longest = edge.norm();
      wedge.directional_edge = static_cast<int>(k);
    }
  }
  wedge.reliability = 1.0;
  wedge.confidence = 1.0;
  return wedge;
}

}  // namespace dubsar::sim
