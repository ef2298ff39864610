// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/range_grid.h"

namespace dubsar {

/// Finds the samples of a grid near a point by projecting the point along the viewing direction onto a raster
/// of buckets: the one lookup that registration, planning and triangulation share. Works for warped,
/// perspective and resampled grids alike, builds in one counting pass, and answers in a few memory reads
/// where a k-d tree walks. Immutable after construction; safe to read from many threads. Refers to the grid:
/// keep the grid alive and unmoved.
class GridLookup {
 public:
  /// Only samples with keep[i] != 0 are entered when `keep` is not empty. cell_mm 0 takes 1.5 µ.
  explicit GridLookup(const RangeGrid& grid, const std::vector<std::uint8_t>& keep = {},
                      double cell_mm = 0.0);

  /// Index of the sample nearest to p (scanner frame, mm) within radius_mm in 3D, or -1. Ties: the lower
  /// index.
  [[nodiscard]] std::int64_t nearest(const Eigen::Vector3f& p_mm, float radius_mm) const;

  /// Calls visit(sample index) for each entered sample whose bucket lies within radius_mm of p across the
  /// viewing direction (a superset of those within radius_mm in 3D), in a fixed order.
  template <class Visit>
  void for_each_near(const Eigen::Vector3f& p_mm, float radius_mm, const Visit& visit) const {
    const Eigen::Vector2f uv = project(p_mm);
    const int reach_lo_u = cell_u(uv.x() - radius_mm);
    const int reach_hi_u = cell_u(uv.x() + radius_mm);
    const int reach_lo_v = cell_v(uv.y() - radius_mm);
    const int reach_hi_v = cell_v(uv.y() + radius_mm);
    for (int v = reach_lo_v < 0 ? 0 : reach_lo_v; v <= reach_hi_v && v < height_; ++v) {
      for (int u = reach_lo_u < 0 ? 0 : reach_lo_u; u <= reach_hi_u && u < width_; ++u) {
        const std::size_t cell =
            static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
        for (std::uint32_t k = start_[cell]; k < start_[cell + 1]; ++k) {
          visit(static_cast<std::size_t>(samples_[k]));
        }
      }
    }
  }

  [[nodiscard]] const RangeGrid& grid() const { return *grid_; }
  [[nodiscard]] double cell_mm() const { return cell_mm_; }

 private:
  [[nodiscard]] Eigen::Vector2f project(const Eigen::Vector3f& p_mm) const {
    return {u_axis_.dot(p_mm) - u_min_, v_axis_.dot(p_mm) - v_min_};
  }
  [[nodiscard]] int cell_u(float u) const;
  [[nodiscard]] int cell_v(float v) const;

  const RangeGrid* grid_;
  double cell_mm_ = 0.0;
  Eigen::Vector3f u_axis_, v_axis_;
  float u_min_ = 0, v_min_ = 0;
  int width_ = 0, height_ = 0;
  std::vector<std::uint32_t> start_;    ///< [width*height + 1], first entry of each bucket in samples_
  std::vector<std::uint32_t> samples_;  ///< sample indices, bucket by bucket, ascending in each
};

}  // namespace dubsar
