// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/depth_raster.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// A raster with more cells than this per sample is mostly air (a stray sample far away): its cells grow.
constexpr double kMostCellsPerSample = 16.0;
/// Samples that one task goes over.
constexpr std::size_t kGrain = 16384;

}  // namespace

DepthRaster::DepthRaster(const RangeGrid& grid, double cell_mm) {
  const Eigen::Vector3d& w = grid.view.direction;
  const Eigen::Vector3d u = w.unitOrthogonal();
  u_axis_ = u.cast<float>();
  v_axis_ = w.cross(u).cast<float>();
  up_ = (-w).cast<float>();
  struct Bounds {
    Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
    Eigen::Vector2f high = Eigen::Vector2f::Constant(-std::numeric_limits<float>::max());
    std::size_t count = 0;
  };
  const Bounds bounds = parallel_reduce_ordered(
      grid.size(), kGrain, Bounds{},
      [&](std::size_t begin, std::size_t end) {
        Bounds part;
        for (std::size_t i = begin; i < end; ++i) {
          if (grid.valid[i] != 0) {
            const Eigen::Vector2f uv(u_axis_.dot(grid.point(i)), v_axis_.dot(grid.point(i)));
            part.low = part.low.cwiseMin(uv);
            part.high = part.high.cwiseMax(uv);
            ++part.count;
          }
        }
        return part;
      },
      [](Bounds& into, const Bounds& part) {
        into.low = into.low.cwiseMin(part.low);
        into.high = into.high.cwiseMax(part.high);
        into.count += part.count;
      });
  const auto& [low, high, count] = bounds;
  if (count == 0 || !(cell_mm > 0)) {
    return;
  }
  const double span_u = static_cast<double>(high.x()) - low.x();
  const double span_v = static_cast<double>(high.y()) - low.y();
  while ((span_u / cell_mm + 1) * (span_v / cell_mm + 1) >
         kMostCellsPerSample * static_cast<double>(count) + 1024.0) {
    cell_mm *= 1.5;
  }
  u_min_ = low.x();
  v_min_ = low.y();
  per_cell_ = static_cast<float>(1.0 / cell_mm);
  width_ = static_cast<int>(span_u / cell_mm) + 2;
  height_ = static_cast<int>(span_v / cell_mm) + 2;
  cells_.resize(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_));
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (grid.valid[i] == 0) {
      continue;
    }
    const Eigen::Vector3f p = grid.point(i);
    const auto cu = static_cast<std::size_t>(std::max(0.0F, (u_axis_.dot(p) - u_min_) * per_cell_));
    const auto cv = static_cast<std::size_t>(std::max(0.0F, (v_axis_.dot(p) - v_min_) * per_cell_));
    Cell& cell = cells_[cv * static_cast<std::size_t>(width_) + cu];
    if (cell.sample < 0 || height(p) > height(cell)) {
      cell = {p, static_cast<std::int32_t>(i)};
    }
  }
  fit_field(grid);
}

void DepthRaster::fit_field(const RangeGrid& grid) {
  struct Sums {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
    float low = std::numeric_limits<float>::max();
    float high = -std::numeric_limits<float>::max();
  };
  const auto cols = static_cast<std::size_t>(grid.cols);
  const auto [normal, right, low, high] = parallel_reduce_ordered(
      static_cast<std::size_t>(grid.rows), 16, Sums{},
      [&](std::size_t begin, std::size_t end) {
        Sums part;
        for (std::size_t row = begin; row < end; ++row) {
          for (std::size_t col = 0; col < cols; ++col) {
            const std::size_t i = row * cols + col;
            if (grid.valid[i] == 0) {
              continue;
            }
            const Eigen::Vector3f p = grid.point(i);
            const Eigen::Vector3d uv1(static_cast<double>(u_axis_.dot(p) - u_min_),
                                      static_cast<double>(v_axis_.dot(p) - v_min_), 1.0);
            part.normal += uv1 * uv1.transpose();
            part.right += uv1 * Eigen::RowVector2d(static_cast<double>(row), static_cast<double>(col));
            part.low = std::min(part.low, up_.dot(p));
            part.high = std::max(part.high, up_.dot(p));
          }
        }
        return part;
      },
      [](Sums& into, const Sums& part) {
        into.normal += part.normal;
        into.right += part.right;
        into.low = std::min(into.low, part.low);
        into.high = std::max(into.high, part.high);
      });
  low_height_ = low;
  high_height_ = high;
  const Eigen::Matrix<double, 3, 2> solution = normal.ldlt().solve(right);
  if (solution.allFinite()) {
    row_col_from_uv_ = solution.transpose().cast<float>();
    rows_cols_ = {static_cast<float>(grid.rows), static_cast<float>(grid.cols)};
  }
}

bool DepthRaster::in_field(const Eigen::Vector3f& p_mm) const {
  const float h = height(p_mm);
  if (!(h >= low_height_ && h <= high_height_)) {
    return false;
  }
  const Eigen::Vector2f rc =
      row_col_from_uv_ * Eigen::Vector3f(u_axis_.dot(p_mm) - u_min_, v_axis_.dot(p_mm) - v_min_, 1.0F);
  // Warped and perspective grids follow the affine map to a few cells.
  constexpr float kMargin = 0.03F;
  return (rc.array() >= (kMargin * rows_cols_).array()).all() &&
         (rc.array() <= ((1.0F - kMargin) * rows_cols_).array()).all();
}

bool DepthRaster::seen_through(const Eigen::Vector3f& p_mm, float margin_mm, int reach) const {
  const int u = static_cast<int>(std::floor((u_axis_.dot(p_mm) - u_min_) * per_cell_));
  const int v = static_cast<int>(std::floor((v_axis_.dot(p_mm) - v_min_) * per_cell_));
  if (u - reach < 0 || v - reach < 0 || u + reach >= width_ || v + reach >= height_) {
    return false;
  }
  const float limit = height(p_mm) - margin_mm;
  for (int dv = -reach; dv <= reach; ++dv) {
    for (int du = -reach; du <= reach; ++du) {
      const Cell& cell = cells_[static_cast<std::size_t>(v + dv) * static_cast<std::size_t>(width_) +
                                static_cast<std::size_t>(u + du)];
      if (cell.sample < 0 || height(cell) > limit) {
        return false;
      }
    }
  }
  return true;
}

bool DepthRaster::empty_around(const Eigen::Vector3f& p_mm, int reach) const {
  const float fu = std::floor((u_axis_.dot(p_mm) - u_min_) * per_cell_);
  const float fv = std::floor((v_axis_.dot(p_mm) - v_min_) * per_cell_);
  if (!(std::abs(fu) < 1e6F && std::abs(fv) < 1e6F)) {
    return true;
  }
  const int u = static_cast<int>(fu);
  const int v = static_cast<int>(fv);
  for (int y = std::max(v - reach, 0); y <= std::min(v + reach, height_ - 1); ++y) {
    for (int x = std::max(u - reach, 0); x <= std::min(u + reach, width_ - 1); ++x) {
      if (cells_[static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x)]
              .sample >= 0) {
        return false;
      }
    }
  }
  return true;
}

}  // namespace dubsar
