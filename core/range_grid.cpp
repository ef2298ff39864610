// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/range_grid.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "core/order_statistics.h"

namespace dubsar {

namespace {

Eigen::Vector3d towards(const std::optional<Eigen::Vector3d>& at_row_0_mm, const ScannerView& view,
                        const Eigen::Vector3d& p_mm, double row) {
  if (!at_row_0_mm) {
    return -view.direction;
  }
  return (*at_row_0_mm + row * view.motion_per_row_mm - p_mm).normalized();
}

double median_or_0(std::vector<float> values) {
  return values.empty() ? 0.0 : median_of(std::move(values));
}

}  // namespace

Eigen::Vector3d ScannerView::to_camera(const Eigen::Vector3d& p_mm, double row) const {
  return towards(camera_mm, *this, p_mm, row);
}

Eigen::Vector3d ScannerView::to_laser(const Eigen::Vector3d& p_mm, double row) const {
  return towards(laser_mm, *this, p_mm, row);
}

void RangeGrid::allocate(int row_count, int col_count) {
  rows = row_count;
  cols = col_count;
  const std::size_t n = static_cast<std::size_t>(rows) * static_cast<std::size_t>(cols);
  x.assign(n, 0.0F);
  y.assign(n, 0.0F);
  z.assign(n, 0.0F);
  valid.assign(n, 0);
}

std::size_t RangeGrid::valid_count() const {
  return std::accumulate(valid.begin(), valid.end(), std::size_t{0});
}

double estimate_spacing_mm(const RangeGrid& grid) {
  const Eigen::Vector3f view = grid.view.direction.cast<float>();
  // A few hundred thousand distances settle a median; a stride keeps huge grids cheap.
  const int stride = std::max(1, static_cast<int>(grid.size() / 400000));
  std::vector<float> along_rows;
  std::vector<float> along_cols;
  for (std::size_t i = 0; i < grid.size(); i += static_cast<std::size_t>(stride)) {
    if (grid.valid[i] == 0) {
      continue;
    }
    const int row = grid.row_of(i);
    const int col = grid.col_of(i);
    const auto lateral = [&](std::size_t j) {
      const Eigen::Vector3f d = grid.point(j) - grid.point(i);
      return (d - view * view.dot(d)).norm();
    };
    if (grid.is_valid(row, col + 1)) {
      along_rows.push_back(lateral(grid.index(row, col + 1)));
    }
    if (grid.is_valid(row + 1, col)) {
      along_cols.push_back(lateral(grid.index(row + 1, col)));
    }
  }
  return std::max(median_or_0(std::move(along_rows)), median_or_0(std::move(along_cols)));
}

double displacement_mm(const Eigen::AlignedBox3f& box_mm, const RigidTransform& from,
                       const RigidTransform& to) {
  double most = 0;
  for (int corner = 0; corner < 8 && !box_mm.isEmpty(); ++corner) {
    const Eigen::Vector3d p =
        box_mm.corner(static_cast<Eigen::AlignedBox3f::CornerType>(corner)).cast<double>();
    most = std::max(most, (from * p - to * p).norm());
  }
  return most;
}

RangeGrid decimated(const RangeGrid& grid, int stride) {
  if (stride <= 1) {
    return grid;
  }
  RangeGrid out;
  out.allocate((grid.rows + stride - 1) / stride, (grid.cols + stride - 1) / stride);
  out.spacing_mm = grid.spacing_mm * stride;
  out.view = grid.view;
  out.view.motion_per_row_mm *= stride;
  out.nominal = grid.nominal;
  out.pin_tip_diameter_mm = grid.pin_tip_diameter_mm;
  out.timestamp_ns = grid.timestamp_ns;
  out.device = grid.device;
  out.source = grid.source;
  out.intensity.resize(grid.intensity.empty() ? 0 : out.size());
  out.confidence.resize(grid.confidence.empty() ? 0 : out.size());
  out.rgb.resize(grid.rgb.empty() ? 0 : 3 * out.size());
  for (int row = 0; row < out.rows; ++row) {
    for (int col = 0; col < out.cols; ++col) {
      const std::size_t from = grid.index(row * stride, col * stride);
      const std::size_t to = out.index(row, col);
      out.x[to] = grid.x[from];
      out.y[to] = grid.y[from];
      out.z[to] = grid.z[from];
      out.valid[to] = grid.valid[from];
      if (!grid.intensity.empty()) {
        out.intensity[to] = grid.intensity[from];
      }
      if (!grid.confidence.empty()) {
        out.confidence[to] = grid.confidence[from];
      }
      for (std::size_t k = 0; k < 3 && !grid.rgb.empty(); ++k) {
        out.rgb[3 * to + k] = grid.rgb[3 * from + k];
      }
    }
  }
  return out;
}

}  // namespace dubsar
