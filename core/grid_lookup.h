// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <limits>
#include <utility>
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
  /// index. A miss costs about as much as a hit, whatever the radius.
  [[nodiscard]] std::int64_t nearest(const Eigen::Vector3f& p_mm, float radius_mm) const;

  /// Calls visit(sample index) for each entered sample whose bucket lies within radius_mm of p across the
  /// viewing direction (a superset of those within radius_mm in 3D), in a fixed order.
  template <class Visit>
  void for_each_near(const Eigen::Vector3f& p_mm, float radius_mm, const Visit& visit) const {
    const Eigen::Vector2f uv = project(p_mm);
    const auto [lo_u, hi_u] = cells_between(uv.x() - radius_mm, uv.x() + radius_mm, width_);
    const auto [lo_v, hi_v] = cells_between(uv.y() - radius_mm, uv.y() + radius_mm, height_);
    for (int v = lo_v; v <= hi_v; ++v) {
      for (int u = lo_u; u <= hi_u; ++u) {
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
  /// First and last cell of an interval along one side of the raster; first > last when it misses the raster.
  [[nodiscard]] std::pair<int, int> cells_between(float low_mm, float high_mm, int cells) const;
  [[nodiscard]] int cell_at(float mm, int cells) const;  ///< clamped to the raster
  void lay_raster(const std::vector<Eigen::Vector2f>& uv, const std::vector<std::uint32_t>& entered);
  void fill_buckets(const std::vector<Eigen::Vector2f>& uv, const std::vector<std::uint32_t>& entered);

  /// Side of a block, cells. Blocks know how deep their samples lie, so that a search steps over what is
  /// empty or at another depth.
  static constexpr int kBlockCells = 8;
  struct Block {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
    float extent = 0;  ///< largest coordinate of its samples, for bounds on rounding
  };
  struct Search;

  const RangeGrid* grid_;
  double cell_mm_ = 0.0;
  float side_mm_ = 0;     ///< cell_mm_ as it is used
  float per_mm_ = 0;      ///< cells per mm
  float extent_mm_ = 0;   ///< largest coordinate of an entered sample
  bool clipped_ = false;  ///< far outliers were put into the buckets at the rim
  Eigen::Vector3f u_axis_, v_axis_, w_axis_;
  float u_min_ = 0, v_min_ = 0;
  int width_ = 0, height_ = 0, blocks_across_ = 0, blocks_down_ = 0;
  std::vector<std::uint32_t> start_;     ///< [width*height + 1], first entry of each bucket in samples_
  std::vector<std::uint32_t> samples_;   ///< sample indices, bucket by bucket, ascending in each
  std::vector<Eigen::Vector3f> points_;  ///< [samples_], their coordinates: a bucket is one stretch of memory
  std::vector<Block> blocks_;            ///< [blocks_across*blocks_down], along w_axis_
};

}  // namespace dubsar
