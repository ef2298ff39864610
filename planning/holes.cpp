// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/holes.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <span>

#include "planning/clusters.h"
#include "planning/point_cells.h"

namespace dubsar {

namespace {

bool is_one_hole(const Rim& a, const Rim& b) {
  const double reach_mm = std::max(a.reach_mm, b.reach_mm);
  return (a.position_mm - b.position_mm).squaredNorm() <= reach_mm * reach_mm;
}

std::vector<std::vector<std::uint32_t>> connected(const std::vector<Rim>& rims) {
  double widest_mm = 1e-9;
  for (const Rim& rim : rims) {
    widest_mm = std::max(widest_mm, rim.reach_mm);
  }
  PointCells cells(widest_mm);
  for (std::uint32_t i = 0; i < rims.size(); ++i) {
    cells.add(rims[i].position_mm, i);
  }
  UnionFind sets(rims.size());
  for (std::uint32_t i = 0; i < rims.size(); ++i) {
    cells.for_each_within(rims[i].position_mm, [&](std::uint32_t j) {
      if (j > i && is_one_hole(rims[i], rims[j])) {
        sets.join(i, j);
      }
    });
  }
  return sets.groups();
}

/// The rim seen along the direction in which it is flattest, its points in order of their bearing.
Hole hole_of(const std::vector<Rim>& rims, std::span<const std::uint32_t> group) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const std::uint32_t i : group) {
    mean += rims[i].position_mm / static_cast<double>(group.size());
  }
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const std::uint32_t i : group) {
    const Eigen::Vector3d d = rims[i].position_mm - mean;
    spread += d * d.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(spread);
  const Eigen::Vector3d u = solver.eigenvectors().col(2);
  const Eigen::Vector3d v = solver.eigenvectors().col(1);
  std::vector<std::array<double, 3>> polygon;  // bearing, u, v
  double low = 0;
  double high = 0;
  for (const std::uint32_t i : group) {
    const Eigen::Vector3d d = rims[i].position_mm - mean;
    polygon.push_back({std::atan2(v.dot(d), u.dot(d)), u.dot(d), v.dot(d)});
    low = std::min(low, u.dot(d));
    high = std::max(high, u.dot(d));
  }
  std::sort(polygon.begin(), polygon.end());
  Hole hole;
  hole.rim.assign(group.begin(), group.end());
  hole.width_mm = high - low;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const auto& a = polygon[i];
    const auto& b = polygon[(i + 1) % polygon.size()];
    hole.area_mm2 += 0.5 * (a[1] * b[2] - b[1] * a[2]);
  }
  hole.area_mm2 = std::abs(hole.area_mm2);
  return hole;
}

}  // namespace

std::vector<Hole> holes_of(const std::vector<Rim>& rims) {
  std::vector<Hole> holes;
  for (const auto& group : connected(rims)) {
    holes.push_back(hole_of(rims, group));
  }
  return holes;
}

}  // namespace dubsar
