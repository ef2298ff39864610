// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/view_axis.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "acquisition/point_spacing.h"
#include "core/sphere_directions.h"
#include "core/units.h"

namespace dubsar {

namespace {

/// As many points show how a cloud folds; with more the directions take longer and say the same.
constexpr std::size_t kMostPoints = 20000;
constexpr std::size_t kDirections = 150;  ///< over half of the sphere
/// Cells are this many spacings wide, and a step of so many cells in one of them is a fold: a slope of 83
/// degrees.
constexpr double kCellSpacings = 2.0;
constexpr float kFoldCells = 8.0F;
/// Of the points: strays fold along every axis, so that only what comes on top counts.
constexpr double kAsFewFolds = 0.01;
/// Scans of one side vary least within this of their view where they can be seen along either.
constexpr double kNearLeastDeg = 35.0;

using Axis = Eigen::Vector3d;

/// The share of the points that lie behind others along an axis.
class Folds {
 public:
  Folds(const std::vector<Eigen::Vector3f>& points, float cell_mm) : points_(points), cell_mm_(cell_mm) {
    cells_.resize(points.size());
  }

  [[nodiscard]] double along(const Axis& axis) {
    const Eigen::Vector3f w = axis.cast<float>();
    const Eigen::Vector3f u = w.unitOrthogonal();
    const Eigen::Vector3f v = w.cross(u);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      const Eigen::Vector3f& p = points_[i];
      const auto row = static_cast<std::int64_t>(std::floor(v.dot(p) / cell_mm_));
      const auto col = static_cast<std::int64_t>(std::floor(u.dot(p) / cell_mm_));
      cells_[i] = {row * (std::int64_t{1} << 32) + col, w.dot(p)};
    }
    std::ranges::sort(cells_);
    std::size_t folded = 0;
    bool behind = false;
    for (std::size_t i = 1; i < cells_.size(); ++i) {
      const bool same = cells_[i].first == cells_[i - 1].first;
      behind = same && (behind || cells_[i].second - cells_[i - 1].second > kFoldCells * cell_mm_);
      folded += behind ? 1 : 0;
    }
    return static_cast<double>(folded) / static_cast<double>(points_.size());
  }

 private:
  const std::vector<Eigen::Vector3f>& points_;
  float cell_mm_;
  std::vector<std::pair<std::int64_t, float>> cells_;
};

Axis least_variation(const std::vector<Eigen::Vector3f>& points) {
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    centre += p.cast<double>();
  }
  centre /= static_cast<double>(points.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3f& p : points) {
    const Eigen::Vector3d d = p.cast<double>() - centre;
    spread += d * d.transpose();
  }
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(spread).eigenvectors().col(0);
}

Axis towards_z(Axis axis) {
  for (const int k : {2, 1, 0}) {
    if (std::abs(axis[k]) > 1e-6) {
      return axis[k] > 0 ? axis : Axis(-axis);
    }
  }
  return axis;
}

}  // namespace

Eigen::Vector3d view_axis(const std::vector<Eigen::Vector3f>& points) {
  Axis least = towards_z(least_variation(points));
  const double spacing_mm = nearest_neighbours(points).median_mm;
  if (!(spacing_mm > 0)) {
    return least;
  }
  const std::size_t stride = std::max<std::size_t>(1, points.size() / kMostPoints);
  std::vector<Eigen::Vector3f> some;
  some.reserve(points.size() / stride + 1);
  for (std::size_t i = 0; i < points.size(); i += stride) {
    some.push_back(points[i]);
  }
  Folds folds(some, static_cast<float>(kCellSpacings * spacing_mm * std::sqrt(static_cast<double>(stride))));
  const double along_least = folds.along(least);
  const double along_z = folds.along(Axis::UnitZ());
  const bool near = least.z() > std::cos(rad_from_deg(kNearLeastDeg));
  if (along_z <= kAsFewFolds && (near || along_least > along_z + kAsFewFolds)) {
    return Axis::UnitZ();  // as below, whatever the others show
  }
  double fewest = std::min(along_least, along_z);
  std::vector<std::pair<Axis, double>> tried{{least, along_least}, {Axis::UnitZ(), along_z}};
  for (const Axis& axis : sphere_directions(2 * kDirections)) {
    if (axis.z() > 0) {
      tried.emplace_back(axis, folds.along(axis));
      fewest = std::min(fewest, tried.back().second);
    }
  }
  const double most = fewest + kAsFewFolds;
  if (along_z <= most && (near || along_least > most)) {
    return Axis::UnitZ();
  }
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const auto& [axis, folded] : tried) {
    if (folded <= most) {
      sum += axis * axis.transpose();
    }
  }
  return towards_z(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(sum).eigenvectors().col(2));
}

}  // namespace dubsar
