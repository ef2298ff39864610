// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/grid_lookup.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

namespace dubsar {

namespace {

/// More buckets than this per sample and the raster is mostly air: the cells grow until it fits.
constexpr double kMaxCellsPerSample = 8.0;

int clamp_to_int(float cells) {
  // A query may lie anywhere; the raster is far smaller than this.
  return static_cast<int>(std::clamp(std::floor(cells), -1.0e6F, 1.0e6F));
}

}  // namespace

int GridLookup::cell_u(float u) const {
  return clamp_to_int(u / static_cast<float>(cell_mm_));
}
int GridLookup::cell_v(float v) const {
  return clamp_to_int(v / static_cast<float>(cell_mm_));
}

GridLookup::GridLookup(const RangeGrid& grid, const std::vector<std::uint8_t>& keep, double cell_mm)
    : grid_(&grid), cell_mm_(cell_mm > 0 ? cell_mm : 1.5 * grid.spacing_mm) {
  const Eigen::Vector3d& w = grid.view.direction;
  const Eigen::Vector3d u = w.unitOrthogonal();
  u_axis_ = u.cast<float>();
  v_axis_ = w.cross(u).cast<float>();

  const auto entered = [&](std::size_t i) { return grid.valid[i] != 0 && (keep.empty() || keep[i] != 0); };
  Eigen::Vector2f low = Eigen::Vector2f::Constant(std::numeric_limits<float>::max());
  Eigen::Vector2f high = -low;
  std::size_t count = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (entered(i)) {
      const Eigen::Vector2f uv(u_axis_.dot(grid.point(i)), v_axis_.dot(grid.point(i)));
      low = low.cwiseMin(uv);
      high = high.cwiseMax(uv);
      ++count;
    }
  }
  if (count == 0) {
    start_.assign(1, 0);
    return;
  }
  u_min_ = low.x();
  v_min_ = low.y();
  const double span_u = static_cast<double>(high.x()) - low.x();
  const double span_v = static_cast<double>(high.y()) - low.y();
  const double most_cells = kMaxCellsPerSample * static_cast<double>(count) + 1024.0;
  if (!(cell_mm_ > 0)) {
    cell_mm_ = std::max(1e-6, std::max(span_u, span_v) / 1024.0);
  }
  while ((span_u / cell_mm_ + 1) * (span_v / cell_mm_ + 1) > most_cells) {
    cell_mm_ *= 1.5;
  }
  width_ = static_cast<int>(span_u / cell_mm_) + 1;
  height_ = static_cast<int>(span_v / cell_mm_) + 1;

  const auto cell_of = [&](std::size_t i) {
    const Eigen::Vector2f uv = project(grid.point(i));
    const int cu = std::clamp(cell_u(uv.x()), 0, width_ - 1);
    const int cv = std::clamp(cell_v(uv.y()), 0, height_ - 1);
    return static_cast<std::size_t>(cv) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(cu);
  };
  start_.assign(static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_) + 1, 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (entered(i)) {
      ++start_[cell_of(i) + 1];
    }
  }
  for (std::size_t c = 1; c < start_.size(); ++c) {
    start_[c] += start_[c - 1];
  }
  samples_.resize(count);
  std::vector<std::uint32_t> next(start_.begin(), start_.end() - 1);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (entered(i)) {
      samples_[next[cell_of(i)]++] = static_cast<std::uint32_t>(i);
    }
  }
}

std::int64_t GridLookup::nearest(const Eigen::Vector3f& p_mm, float radius_mm) const {
  if (samples_.empty() || !p_mm.allFinite()) {
    return -1;
  }
  const Eigen::Vector2f uv = project(p_mm);
  const int cu = cell_u(uv.x());
  const int cv = cell_v(uv.y());
  const auto cell = static_cast<float>(cell_mm_);
  float best2 = radius_mm * radius_mm;
  std::int64_t best = -1;
  const auto visit_cell = [&](int u, int v) {
    if (u < 0 || v < 0 || u >= width_ || v >= height_) {
      return;
    }
    const std::size_t c =
        static_cast<std::size_t>(v) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(u);
    for (std::uint32_t k = start_[c]; k < start_[c + 1]; ++k) {
      const float d2 = (grid_->point(samples_[k]) - p_mm).squaredNorm();
      if (d2 < best2 || (d2 == best2 && best >= 0 && samples_[k] < best)) {
        best2 = d2;
        best = samples_[k];
      }
    }
  };
  const int reach = static_cast<int>(std::min(radius_mm / cell, 1.0e6F)) + 1;
  for (int ring = 0; ring <= reach; ++ring) {
    // Nothing in this ring or beyond can be nearer than (ring - 1) cells.
    const float bound = static_cast<float>(ring - 1) * cell;
    if (ring > 1 && bound * bound > best2) {
      break;
    }
    if (cu + ring < 0 && cv + ring < 0) {
      continue;
    }
    if (ring == 0) {
      visit_cell(cu, cv);
      continue;
    }
    for (int u = std::max(cu - ring, 0); u <= std::min(cu + ring, width_ - 1); ++u) {
      visit_cell(u, cv - ring);
      visit_cell(u, cv + ring);
    }
    for (int v = std::max(cv - ring + 1, 0); v <= std::min(cv + ring - 1, height_ - 1); ++v) {
      visit_cell(cu - ring, v);
      visit_cell(cu + ring, v);
    }
  }
  return best;
}

}  // namespace dubsar
