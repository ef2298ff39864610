// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/big_array.h"
#include "core/range_grid.h"

namespace dubsar {

/// Finds the samples of a grid near a point by projecting the point along the viewing direction onto a raster
/// of buckets: the one lookup that registration, planning and triangulation share. Works for warped,
/// perspective and resampled grids alike, builds in one counting pass, and answers in a few memory reads
/// where a k-d tree walks. Built on all cores. Immutable after construction; safe to read from many threads.
/// Holds copies of what it needs: the grid may go.
class GridLookup {
 public:
  /// Only samples with keep[i] != 0 are entered when `keep` is not empty. cell_mm 0 takes 1.5 µ.
  explicit GridLookup(const RangeGrid& grid, const std::vector<std::uint8_t>& keep = {},
                      double cell_mm = 0.0);

  /// Index of the sample nearest to p (scanner frame, mm) within radius_mm in 3D, or -1. Ties: the lower
  /// index. A miss costs about as much as a hit, whatever the radius.
  [[nodiscard]] std::int64_t nearest(const Eigen::Vector3f& p_mm, float radius_mm) const {
    return find_nearest(p_mm, radius_mm).sample;
  }
  /// The same with where that sample lies.
  struct Found {
    std::int64_t sample = -1;
    Eigen::Vector3f point_mm{0, 0, 0};
  };
  [[nodiscard]] Found find_nearest(const Eigen::Vector3f& p_mm, float radius_mm) const;

  /// Has the memory that nearest() begins with brought near: for many points that are looked for after each
  /// other …
  void fetch_buckets(const Eigen::Vector3f& p_mm) const {
    for_each_row_near(p_mm, side_mm_, [&](int row, const Range& u) {
      __builtin_prefetch(&start_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                                 static_cast<std::size_t>(u.first)]);
    });
  }
  /// … and, once that has come, what it goes on with.
  void fetch_samples(const Eigen::Vector3f& p_mm, float radius_mm) const {
    for_each_row_near(p_mm, std::min(radius_mm, side_mm_), [&](int row, const Range& u) {
      __builtin_prefetch(&entries_[row_start(row, u.first)]);
    });
  }

  /// Calls visit(sample index) for each entered sample whose bucket lies within radius_mm of p across the
  /// viewing direction (a superset of those within radius_mm in 3D), in a fixed order.
  template <class Visit>
  void for_each_near(const Eigen::Vector3f& p_mm, float radius_mm, const Visit& visit) const {
    const Eigen::Vector2f uv = project(p_mm);
    const Range u = cells_between(uv.x() - radius_mm, uv.x() + radius_mm, width_);
    const Range v = cells_between(uv.y() - radius_mm, uv.y() + radius_mm, height_);
    for (int row = v.first; row <= v.last && u.first <= u.last; ++row) {
      for (std::uint32_t k = row_start(row, u.first); k < row_end(row, u.last); ++k) {
        visit(static_cast<std::size_t>(entries_[k].sample));
      }
    }
  }

  /// Cells along one side of the raster; first > last when there is none.
  struct Range {
    int first = 0;
    int last = -1;
  };
  /// Where in the lookup the samples within a radius of a point lie, rounding allowed for.
  struct Reach {
    Eigen::Vector3f p_mm{0, 0, 0};
    float radius_mm = 0;
    Range u, v;
    int middle_v = 0;
    float low_w = 0, high_w = 0;
  };
  [[nodiscard]] Reach reach_of(const Eigen::Vector3f& p_mm, float radius_mm) const {
    Reach reach{p_mm, radius_mm, {}, {}, 0, 0, 0};
    if (count_ == 0 || !p_mm.allFinite()) {
      return reach;
    }
    const Eigen::Vector2f uv = project(p_mm);
    const float far = radius_mm + kRounding * (extent_mm_ + p_mm.cwiseAbs().maxCoeff());
    const float w = w_axis_.dot(p_mm);
    reach.u = cells_between(uv.x() - far, uv.x() + far, width_);
    reach.v = cells_between(uv.y() - far, uv.y() + far, height_);
    reach.middle_v = cell_at(uv.y(), height_);
    reach.low_w = w - far;
    reach.high_w = w + far;
    return reach;
  }
  /// False when it is certain, at the cost of a few reads, that no entered sample lies within reach.
  [[nodiscard]] bool may_hold_samples(const Reach& reach) const {
    if (reach.u.first > reach.u.last || reach.v.first > reach.v.last) {
      return false;
    }
    for (int b = reach.v.first / kBlockCells; b <= reach.v.last / kBlockCells; ++b) {
      const Block* const row =
          &blocks_[static_cast<std::size_t>(b) * static_cast<std::size_t>(blocks_across_)];
      for (int a = reach.u.first / kBlockCells; a <= reach.u.last / kBlockCells; ++a) {
        if (row[a].low <= reach.high_w && row[a].high >= reach.low_w) {
          return true;
        }
      }
    }
    return false;
  }
  /// Has the memory that any_within() begins with brought near; only where may_hold_samples().
  void fetch(const Reach& reach) const {
    __builtin_prefetch(&entries_[row_start(reach.middle_v, reach.u.first)]);
  }
  /// True when accept(sample index) holds for an entered sample within reach: within the radius in 3D. Stops
  /// at the first; which samples it asks about, and in which order, is fixed. Only where may_hold_samples().
  template <class Accept>
  [[nodiscard]] bool any_within(const Reach& reach, const Accept& accept) const {
    const float radius2 = reach.radius_mm * reach.radius_mm;
    const auto in_row = [&](int row) {
      const std::uint32_t end = row_end(row, reach.u.last);
      for (std::uint32_t k = row_start(row, reach.u.first); k < end; ++k) {
        if (entries_[k].distance2(reach.p_mm) <= radius2 && accept(entries_[k].sample)) {
          return true;
        }
      }
      return false;
    };
    // From the middle row outwards: what is near in the raster is most often near in space.
    for (int below = reach.middle_v, above = below + 1; below >= reach.v.first || above <= reach.v.last;
         --below, ++above) {
      if ((below >= reach.v.first && in_row(below)) || (above <= reach.v.last && in_row(above))) {
        return true;
      }
    }
    return false;
  }

  /// Box around the entered samples; empty when there is none.
  [[nodiscard]] const Eigen::AlignedBox3f& box_mm() const { return box_mm_; }
  [[nodiscard]] double cell_mm() const { return cell_mm_; }

 private:
  [[nodiscard]] Eigen::Vector2f project(const Eigen::Vector3f& p_mm) const {
    return {u_axis_.dot(p_mm) - u_min_, v_axis_.dot(p_mm) - v_min_};
  }
  struct Entry {
    float x, y, z;
    std::uint32_t sample;
    [[nodiscard]] float distance2(const Eigen::Vector3f& p_mm) const {
      return (Eigen::Vector3f(x, y, z) - p_mm).squaredNorm();
    }
  };
  struct Bounds;
  /// What is entered: samples of a grid with keep[i] != 0, or all.
  struct Entering {
    const RangeGrid& grid;
    const std::vector<std::uint8_t>& keep;
  };
  [[nodiscard]] Range cells_between(float low_mm, float high_mm, int cells) const {
    // What was clipped lies in the rim, however far outside it is.
    const bool meets = high_mm * per_mm_ >= -1.0F && low_mm * per_mm_ <= static_cast<float>(cells);
    if (cells == 0 || !(meets || clipped_)) {
      return {};
    }
    return {cell_at(low_mm, cells), cell_at(high_mm, cells)};
  }
  [[nodiscard]] int cell_at(float mm, int cells) const {  ///< clamped to the raster
    return static_cast<int>(std::clamp(mm * per_mm_, 0.0F, static_cast<float>(cells - 1)));
  }
  [[nodiscard]] std::uint32_t row_start(int row, int from) const {
    return start_[static_cast<std::size_t>(row) * static_cast<std::size_t>(width_) +
                  static_cast<std::size_t>(from)];
  }
  [[nodiscard]] std::uint32_t row_end(int row, int to) const { return row_start(row, to + 1); }
  /// Calls visit(row, cells of it) for the rows of the raster within radius_mm of p across the viewing
  /// direction.
  template <class Visit>
  void for_each_row_near(const Eigen::Vector3f& p_mm, float radius_mm, const Visit& visit) const {
    if (count_ == 0 || !p_mm.allFinite()) {
      return;
    }
    const Eigen::Vector2f uv = project(p_mm);
    const Range u = cells_between(uv.x() - radius_mm, uv.x() + radius_mm, width_);
    const Range v = cells_between(uv.y() - radius_mm, uv.y() + radius_mm, height_);
    for (int row = v.first; row <= v.last && u.first <= u.last; ++row) {
      visit(row, u);
    }
  }
  /// Calls visit(sample, position, u, v) for what is entered among the grid's samples [begin, end).
  template <class Visit>
  void for_each_entered(const Entering& entering, std::size_t begin, std::size_t end,
                        const Visit& visit) const;
  void lay_raster(const Entering& entering, const Bounds& bounds);
  void fill_buckets(const Entering& entering);

  /// Side of a block, cells. Blocks know how deep their samples lie, so that a search steps over what is
  /// empty or at another depth.
  static constexpr int kBlockCells = 8;
  /// Rounding of a projected coordinate, per millimetre of the coordinates that it was made of.
  static constexpr float kRounding = 16 * std::numeric_limits<float>::epsilon();
  struct Block {
    float low = std::numeric_limits<float>::infinity();
    float high = -std::numeric_limits<float>::infinity();
    float extent = 0;  ///< largest coordinate of its samples, for bounds on rounding
  };
  struct Search;

  double cell_mm_ = 0.0;
  float side_mm_ = 0;  ///< cell_mm_ as it is used
  float per_mm_ = 0;   ///< cells per mm
  Eigen::AlignedBox3f box_mm_;
  float extent_mm_ = 0;   ///< largest coordinate of an entered sample
  bool clipped_ = false;  ///< far outliers were put into the buckets at the rim
  Eigen::Vector3f u_axis_, v_axis_, w_axis_;
  float u_min_ = 0, v_min_ = 0;
  int width_ = 0, height_ = 0, blocks_across_ = 0, blocks_down_ = 0;
  BigArray<std::uint32_t> start_;  ///< [width*height + 1], first entry of each bucket in entries_
  std::size_t count_ = 0;          ///< of entries_
  /// Bucket by bucket, sample indices ascending in each; with their coordinates: a bucket is one stretch of
  /// memory.
  BigArray<Entry> entries_;
  std::vector<Block> blocks_;  ///< [blocks_across*blocks_down], along w_axis_
};

}  // namespace dubsar
