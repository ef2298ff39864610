// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/grid_axis.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstddef>

namespace dubsar {

namespace {

constexpr std::size_t kLeastSamples = 100;
/// What a grid strays less than this part of its extent lies flat.
constexpr double kLeastStray = 1e-4;

}  // namespace

std::optional<GridAxis> grid_axis(const RangeGrid& grid) {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  std::size_t count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] != 0) {
      middle += grid.point(i).cast<double>();
      ++count;
    }
  }
  if (count < kLeastSamples) {
    return std::nullopt;
  }
  middle /= static_cast<double>(count);
  Eigen::Matrix3d cells = Eigen::Matrix3d::Zero();  // of (1, row, column)
  Eigen::Matrix3d both = Eigen::Matrix3d::Zero();   // of those with the samples
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (int row = 0; row < grid.rows; ++row) {
    for (int col = 0; col < grid.cols; ++col) {
      const std::size_t i = grid.index(row, col);
      if (grid.valid[i] == 0) {
        continue;
      }
      const Eigen::Vector3d p = grid.point(i).cast<double>() - middle;
      const Eigen::Vector3d cell(1.0, row - 0.5 * grid.rows, col - 0.5 * grid.cols);
      cells += cell * cell.transpose();
      both += cell * p.transpose();
      spread += p * p.transpose();
    }
  }
  const Eigen::LDLT<Eigen::Matrix3d> solver(cells);
  if (!(solver.vectorD().minCoeff() > 0)) {
    return std::nullopt;  // one row or one column
  }
  const Eigen::Matrix3d slopes = solver.solve(both);
  const Eigen::Matrix3d left = (spread - both.transpose() * slopes) / static_cast<double>(count);
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> stray(left);
  const double least = kLeastStray * kLeastStray * spread.trace() / static_cast<double>(count);
  const double most = stray.eigenvalues()[2];
  if (!(most > least)) {
    return std::nullopt;
  }
  const Eigen::Vector3d axis = stray.eigenvectors().col(2);
  const auto across = [&](int k) {
    const Eigen::Vector3d slope = slopes.row(k).transpose();
    return Eigen::Vector3d((slope - slope.dot(axis) * axis).normalized());
  };
  return GridAxis{.axis = axis,
                  .clearness = std::sqrt(most / std::max(stray.eigenvalues()[1], 1e-6 * most)),
                  .along_rows = across(1),
                  .along_cols = across(2)};
}

}  // namespace dubsar
