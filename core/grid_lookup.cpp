// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_lookup.h"

#include <tbb/task_arena.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

/// More buckets than this per sample and the raster is mostly air: outliers are clipped, then the cells grow
/// until it fits.
constexpr double kMaxCellsPerSample = 8.0;

constexpr float kFar = std::numeric_limits<float>::infinity();

/// Where nearly all of the values lie, with as much again on either side.
std::pair<float, float> window_of(std::vector<float>& values) {
  const std::size_t skipped = values.size() / 64;
  const float low = value_at_rank(values, skipped);
  const float high = value_at_rank(values, values.size() - 1 - skipped);
  return {low - (high - low), high + (high - low)};
}

float gap(float low, float high, float x, float slack) {
  return std::max({low - x - slack, x - high - slack, 0.0F});
}

/// Samples that are worth a thread of their own while the buckets are filled.
constexpr std::size_t kSamplesPerPart = 200000;
constexpr std::size_t kGrain = 16384;

}  // namespace

/// Of the entered samples.
struct GridLookup::Bounds {
  Vector2f low = Vector2f::Constant(kFar);
  Vector2f high = Vector2f::Constant(-kFar);
  Eigen::AlignedBox3f box_mm;
  std::size_t count = 0;

  void add(const Bounds& b) {
    low = low.cwiseMin(b.low);
    high = high.cwiseMax(b.high);
    box_mm.extend(b.box_mm);
    count += b.count;
  }
};

template <class Visit>
void GridLookup::for_each_entered(const Entering& entering, std::size_t begin, std::size_t end,
                                  const Visit& visit) const {
  const auto& [grid, keep] = entering;
  for (std::size_t i = begin; i < end; ++i) {
    if (grid.valid[i] == 0 || (!keep.empty() && keep[i] == 0)) {
      continue;
    }
    const Vector3f p = grid.point(i);
    const Vector2f uv(u_axis_.dot(p), v_axis_.dot(p));
    if (uv.allFinite() && p.allFinite()) {
      visit(i, p, uv);
    }
  }
}

GridLookup::GridLookup(const RangeGrid& grid, const std::vector<std::uint8_t>& keep, double cell_mm)
    : cell_mm_(cell_mm > 0 ? cell_mm : 1.5 * grid.spacing_mm) {
  const Eigen::Vector3d& w = grid.view.direction;
  const Eigen::Vector3d u = w.unitOrthogonal();
  u_axis_ = u.cast<float>();
  v_axis_ = w.cross(u).cast<float>();
  w_axis_ = w.cast<float>();
  const Entering entering{grid, keep};
  const Bounds bounds = parallel_reduce_ordered(
      grid.size(), kGrain, Bounds{},
      [&](std::size_t begin, std::size_t end) {
        Bounds part;
        for_each_entered(entering, begin, end, [&](std::size_t, const Vector3f& p, const Vector2f& uv) {
          part.add({uv, uv, {p, p}, 1});
        });
        return part;
      },
      [](Bounds& into, const Bounds& part) { into.add(part); });
  box_mm_ = bounds.box_mm;
  count_ = bounds.count;
  if (count_ == 0) {
    return;
  }
  extent_mm_ = std::max(box_mm_.min().cwiseAbs().maxCoeff(), box_mm_.max().cwiseAbs().maxCoeff());
  lay_raster(entering, bounds);
  fill_buckets(entering);
}

void GridLookup::lay_raster(const Entering& entering, const Bounds& bounds) {
  Vector2f low = bounds.low;
  Vector2f high = bounds.high;
  const double most_cells = kMaxCellsPerSample * static_cast<double>(count_) + 1024.0;
  const auto cells = [&] {
    const Eigen::Array2d span = (high.cast<double>() - low.cast<double>()).array();
    return (span / cell_mm_ + 1.0).prod();
  };
  if (!(cell_mm_ > 0) || cells() > most_cells) {
    const std::size_t step = std::max<std::size_t>(1, count_ / 4096);
    std::array<std::vector<float>, 2> some;
    std::size_t k = 0;
    for_each_entered(entering, 0, entering.grid.size(),
                     [&](std::size_t, const Vector3f&, const Vector2f& uv) {
                       if (k++ % step == 0) {
                         some[0].push_back(uv.x());
                         some[1].push_back(uv.y());
                       }
                     });
    for (int axis = 0; axis < 2; ++axis) {
      const auto [from, to] = window_of(some[static_cast<std::size_t>(axis)]);
      clipped_ = clipped_ || from > low[axis] || to < high[axis];
      low[axis] = std::max(low[axis], from);
      high[axis] = std::min(high[axis], to);
    }
  }
  const double longest = static_cast<double>((high - low).maxCoeff());
  if (!(cell_mm_ > 0)) {
    cell_mm_ = longest / 1024.0;
  }
  // Cells below the rounding of the coordinates tell nothing apart.
  cell_mm_ = std::max(
      {cell_mm_, 1e-6,
       static_cast<double>(kRounding * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff()))});
  while (cells() > most_cells) {
    cell_mm_ *= 1.5;
  }
  u_min_ = low.x();
  v_min_ = low.y();
  side_mm_ = static_cast<float>(cell_mm_);
  per_mm_ = 1.0F / side_mm_;
  width_ = static_cast<int>((static_cast<double>(high.x()) - u_min_) / cell_mm_) + 1;
  height_ = static_cast<int>((static_cast<double>(high.y()) - v_min_) / cell_mm_) + 1;
  blocks_across_ = (width_ + kBlockCells - 1) / kBlockCells;
  blocks_down_ = (height_ + kBlockCells - 1) / kBlockCells;
}

/// A counting sort in parts of the grid. What comes out is the same for any number of parts: buckets in
/// order, samples ascending in each.
void GridLookup::fill_buckets(const Entering& entering) {
  const auto across = static_cast<std::size_t>(width_);
  const std::size_t cells = across * static_cast<std::size_t>(height_);
  const std::size_t parts =
      std::clamp<std::size_t>(entering.grid.size() / kSamplesPerPart, 1,
                              static_cast<std::size_t>(tbb::this_task_arena::max_concurrency()));
  const std::size_t length = (entering.grid.size() + parts - 1) / parts;
  struct Part {
    std::vector<std::uint32_t> next;  ///< [cells] how many of the part, later where the next one goes
    std::vector<Block> blocks;
  };
  std::vector<Part> all(parts);
  const auto cell_of = [&](const Vector2f& uv, int& cu, int& cv) {
    cu = cell_at(uv.x() - u_min_, width_);
    cv = cell_at(uv.y() - v_min_, height_);
    return static_cast<std::size_t>(cv) * across + static_cast<std::size_t>(cu);
  };
  parallel_chunks(entering.grid.size(), length, [&](std::size_t begin, std::size_t end) {
    Part& part = all[begin / length];
    part.next.assign(cells, 0);
    part.blocks.assign(static_cast<std::size_t>(blocks_across_) * static_cast<std::size_t>(blocks_down_), {});
    for_each_entered(entering, begin, end, [&](std::size_t, const Vector3f& p, const Vector2f& uv) {
      int cu = 0;
      int cv = 0;
      ++part.next[cell_of(uv, cu, cv)];
      const float depth = w_axis_.dot(p);
      Block& block =
          part.blocks[static_cast<std::size_t>(cv / kBlockCells) * static_cast<std::size_t>(blocks_across_) +
                      static_cast<std::size_t>(cu / kBlockCells)];
      block.low = std::min(block.low, depth);
      block.high = std::max(block.high, depth);
      block.extent = std::max(block.extent, p.cwiseAbs().maxCoeff());
    });
  });
  std::erase_if(all, [](const Part& part) { return part.next.empty(); });  // a last one may have no sample
  blocks_ = std::move(all.front().blocks);
  for (std::size_t k = 1; k < all.size(); ++k) {
    for (std::size_t b = 0; b < blocks_.size(); ++b) {
      blocks_[b].low = std::min(blocks_[b].low, all[k].blocks[b].low);
      blocks_[b].high = std::max(blocks_[b].high, all[k].blocks[b].high);
      blocks_[b].extent = std::max(blocks_[b].extent, all[k].blocks[b].extent);
    }
  }
  start_ = BigArray<std::uint32_t>(cells + 1);
  std::uint32_t at = 0;
  for (std::size_t c = 0; c < cells; ++c) {
    start_[c] = at;
    for (Part& part : all) {
      at += std::exchange(part.next[c], at);
    }
  }
  start_[cells] = at;
  entries_ = BigArray<Entry>(count_);
  parallel_chunks(entering.grid.size(), length, [&](std::size_t begin, std::size_t end) {
    Part& part = all[begin / length];
    for_each_entered(entering, begin, end, [&](std::size_t i, const Vector3f& p, const Vector2f& uv) {
      int cu = 0;
      int cv = 0;
      entries_[part.next[cell_of(uv, cu, cv)]++] = {p.x(), p.y(), p.z(), static_cast<std::uint32_t>(i)};
    });
  });
}

/// One nearest() under way. Bounds hold for clipped samples too: bringing both ends of a distance into the
/// raster never makes it longer.
struct GridLookup::Search {
  const GridLookup& in;
  Vector3f p;
  float p_extent = 0;  ///< its largest coordinate
  float u = 0, v = 0;  ///< p in the raster, brought to its rim where it lies outside
  float w = 0;
  float off2 = 0;  ///< squared distance of p to the raster
  float best2 = 0;
  const Entry* best = nullptr;

  /// What rounding may take from a distance to samples with coordinates up to `extent_mm`.
  [[nodiscard]] float slack(float extent_mm) const { return kRounding * (extent_mm + p_extent); }

  /// The buckets of a row from one cell to another.
  void visit(int row, int from, int to) {
    const std::uint32_t end = in.row_end(row, to);
    for (std::uint32_t k = in.row_start(row, from); k < end; ++k) {
      const Entry& entry = in.entries_[k];
      const float d2 = entry.distance2(p);
      if (d2 < best2 || (d2 == best2 && best != nullptr && entry.sample < best->sample)) {
        best2 = d2;
        best = &entry;
      }
    }
  }

  [[nodiscard]] Found found() const {
    return best == nullptr ? Found{} : Found{best->sample, {best->x, best->y, best->z}};
  }

  /// Squared distance beyond which everything lies that is outside cells low..high in both directions.
  [[nodiscard]] float beyond2(int low_u, int high_u, int low_v, int high_v) const {
    const float left = low_u <= 0 ? kFar : u - static_cast<float>(low_u) * in.side_mm_;
    const float right = high_u + 1 >= in.width_ ? kFar : static_cast<float>(high_u + 1) * in.side_mm_ - u;
    const float above = low_v <= 0 ? kFar : v - static_cast<float>(low_v) * in.side_mm_;
    const float below = high_v + 1 >= in.height_ ? kFar : static_cast<float>(high_v + 1) * in.side_mm_ - v;
    const float least = std::max(0.0F, std::min({left, right, above, below}) - slack(in.extent_mm_));
    return least * least + off2;
  }

  void visit_block(int bu, int bv) {
    const Block& block =
        in.blocks_[static_cast<std::size_t>(bv) * static_cast<std::size_t>(in.blocks_across_) +
                   static_cast<std::size_t>(bu)];
    const float leave = slack(block.extent);
    const float dw = gap(block.low, block.high, w, leave);
    const int first_u = bu * kBlockCells;
    const int last_u = std::min(first_u + kBlockCells, in.width_) - 1;
    const float du = gap(static_cast<float>(first_u) * in.side_mm_,
                         static_cast<float>(last_u + 1) * in.side_mm_, u, leave);
    const float rest2 = dw * dw + off2;
    if (!(rest2 + du * du <= best2)) {
      return;
    }
    for (int row = bv * kBlockCells; row < std::min((bv + 1) * kBlockCells, in.height_); ++row) {
      const float low_v = static_cast<float>(row) * in.side_mm_;
      const float dv = gap(low_v, low_v + in.side_mm_, v, leave);
      const float left2 = best2 - rest2 - dv * dv;
      if (left2 >= 0) {
        const float reach = std::sqrt(left2) * 1.0001F + leave;
        const int from = std::max(first_u, in.cell_at(u - reach, in.width_));
        const int to = std::min(last_u, in.cell_at(u + reach, in.width_));
        if (from <= to) {
          visit(row, from, to);
        }
      }
    }
  }
};

GridLookup::Found GridLookup::find_nearest(const Vector3f& p_mm, float radius_mm) const {
  if (count_ == 0 || !p_mm.allFinite() || !(radius_mm > 0)) {
    return {};
  }
  Search search{*this, p_mm};
  const Vector2f uv = project(p_mm);
  search.p_extent = p_mm.cwiseAbs().maxCoeff();
  search.u = std::clamp(uv.x(), 0.0F, static_cast<float>(width_) * side_mm_);
  search.v = std::clamp(uv.y(), 0.0F, static_cast<float>(height_) * side_mm_);
  search.w = w_axis_.dot(p_mm);
  search.best2 = radius_mm * radius_mm;
  if (!clipped_) {
    const float off = std::max(0.0F, (uv - Vector2f(search.u, search.v)).norm() - search.slack(extent_mm_));
    search.off2 = off * off;
    if (search.off2 > search.best2) {
      return {};
    }
  }
  // Most answers lie in the bucket of the point or beside it.
  const int cu = cell_at(search.u, width_);
  const int cv = cell_at(search.v, height_);
  // Of these, what lies beyond the radius need not be looked at.
  const float reach = radius_mm + search.slack(extent_mm_);
  const int left_u = std::max(cu - 1, cell_at(search.u - reach, width_));
  const int right_u = std::min(cu + 1, cell_at(search.u + reach, width_));
  const int low_v = std::max(cv - 1, cell_at(search.v - reach, height_));
  const int high_v = std::min(cv + 1, cell_at(search.v + reach, height_));
  for (int row = low_v; row <= high_v; ++row) {
    search.visit(row, left_u, right_u);
  }
  if (search.beyond2(cu - 1, cu + 1, cv - 1, cv + 1) > search.best2) {
    return search.found();
  }
  const int bu = cu / kBlockCells;
  const int bv = cv / kBlockCells;
  for (int ring = 0;; ++ring) {
    const int left = bu - ring;
    const int right = bu + ring;
    for (int b = std::max(bv - ring, 0); b <= std::min(bv + ring, blocks_down_ - 1); ++b) {
      const bool whole = b == bv - ring || b == bv + ring;
      for (int a = whole ? std::max(left, 0) : left; a <= std::min(right, blocks_across_ - 1);
           a += whole || ring == 0 ? 1 : 2 * ring) {
        if (a >= 0) {
          search.visit_block(a, b);
        }
      }
    }
    const float beyond2 = search.beyond2(left * kBlockCells, (right + 1) * kBlockCells - 1,
                                         (bv - ring) * kBlockCells, (bv + ring + 1) * kBlockCells - 1);
    if (!(beyond2 <= search.best2) || beyond2 == kFar) {
      return search.found();
    }
  }
}

}  // namespace dubsar
