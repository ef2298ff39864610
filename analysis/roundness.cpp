// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/roundness.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace dubsar {

namespace {

/// Of fewer vertices the six numbers of a bend cannot be told.
constexpr std::uint32_t kFewest = 12;
/// Nearer to an inner edge than this, in spacings, wear and stitching round any face.
constexpr double kClearSpacings = 1.0;
/// Clay less deep than this share of the hollow is of its rim.
constexpr double kRimDepths = 0.1;

using Quadratic = Eigen::Matrix<double, 6, 1>;

double angle_between(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// How far the foot of p on face k lies from the nearest inner edge, in the plane.
double to_edge_mm(const WedgeFaces& faces, std::size_t k, const Eigen::Vector3d& p) {
  const FacePlane& own = faces.plane[k];
  double nearest = std::numeric_limits<double>::infinity();
  for (const std::size_t j : {(k + 1) % 3, (k + 2) % 3}) {
    const double cosine = own.normal.dot(faces.plane[j].normal);
    const double sine = std::sqrt(std::max(1.0 - cosine * cosine, 1e-4));
    nearest = std::min(nearest, (faces.plane[j].distance(p) - cosine * own.distance(p)) / sine);
  }
  return nearest;
}

/// By how many radians the clay of face k turns from its one side to its other, level with the free surface;
/// above zero where it turns as a hollow does. Least squares of a quadratic to its vertices' distances from
/// the plane. 0 where too few lie on it.
double turn_rad(const WedgePatch& patch, const WedgeFaces& faces, std::size_t k) {
  const FacePlane& plane = faces.plane[k];
  const Eigen::Vector3d level = Eigen::Vector3d::UnitZ().cross(plane.normal);
  if (!(level.norm() > 1e-3)) {
    return 0;
  }
  const Eigen::Vector3d across = level.normalized();
  const Eigen::Vector3d up = plane.normal.cross(across);
  Eigen::Matrix<double, 6, 6> moments = Eigen::Matrix<double, 6, 6>::Zero();
  Quadratic right = Quadratic::Zero();
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < patch.size(); ++i) {
    const Eigen::Vector3d p = patch.p[i].cast<double>();
    if (faces.face[i] != static_cast<std::int8_t>(k) || patch.height[i] > -kRimDepths * patch.depth_mm ||
        to_edge_mm(faces, k, p) < kClearSpacings * patch.spacing_mm) {
      continue;
    }
    const double x = across.dot(p - plane.middle);
    const double y = up.dot(p - plane.middle);
    Quadratic terms;
    terms << 1, x, y, x * x, x * y, y * y;
    const double weight = patch.area[i] * fit_weight(patch.weight[i]);
    moments += weight * terms * terms.transpose();
    right += weight * plane.distance(p) * terms;
    ++count;
  }
  if (count < kFewest || !(moments(0, 0) > 0)) {
    return 0;
  }
  const double mean = moments(0, 1) / moments(0, 0);
  const double variance = std::max(moments(0, 3) / moments(0, 0) - mean * mean, 0.0);
  const double width_mm = std::sqrt(12.0 * variance);  // of an even strip
  const Quadratic fitted = moments.ldlt().solve(right);
  const double turn = 2.0 * fitted(3) * width_mm;
  return std::isfinite(turn) ? turn : 0.0;
}

}  // namespace

Roundness roundness_of(const WedgePatch& patch, const WedgeFaces& faces) {
  Roundness out;
  double between = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    between += angle_between(faces.plane[k].normal, faces.plane[(k + 1) % 3].normal) / 3.0;
    out.turn_rad[k] = turn_rad(patch, faces, k);
  }
  std::array<double, 3> turn = out.turn_rad;
  std::ranges::sort(turn);
  out.share = turn[1] / std::max(between, 1e-3);
  return out;
}

}  // namespace dubsar
