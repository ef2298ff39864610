// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/clearing.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/grid_noise.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::size_t kSamplesPerTask = 4096;

/// The vector over the neighbours in one grid direction; zero when neither is near.
Eigen::Vector3f span_of(const RangeGrid& grid, int row, int col, int d_row, int d_col, float step2_mm2) {
  const Eigen::Vector3f here = grid.point(grid.index(row, col));
  const auto neighbour = [&](int r, int c) {
    if (!grid.is_valid(r, c)) {
      return here;
    }
    const Eigen::Vector3f p = grid.point(grid.index(r, c));
    return (p - here).squaredNorm() <= step2_mm2 ? p : here;
  };
  return neighbour(row + d_row, col + d_col) - neighbour(row - d_row, col - d_col);
}

std::vector<std::uint8_t> unflagged_mask(const RangeGrid& grid, const SampleFlags& flags) {
  std::vector<std::uint8_t> keep(grid.size(), 0);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    keep[i] = grid.valid[i] != 0 && is_unflagged(flags[i]) ? 1 : 0;
  }
  return keep;
}

}  // namespace

double spacing_of(const RangeGrid& grid) {
  return grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
}

Eigen::Vector3f sample_normal(const RangeGrid& grid, std::size_t sample, float step_mm) {
  const int row = grid.row_of(sample);
  const int col = grid.col_of(sample);
  const float step2 = step_mm * step_mm;
  const Eigen::Vector3f n = span_of(grid, row, col, 0, 1, step2).cross(span_of(grid, row, col, 1, 0, step2));
  const float length = n.norm();
  if (!(length > 1e-12F)) {
    return Eigen::Vector3f::Zero();
  }
  const Eigen::Vector3f to_camera = grid.view.to_camera(grid.point(sample).cast<double>(), row).cast<float>();
  return n * ((n.dot(to_camera) < 0 ? -1.0F : 1.0F) / length);
}

double matching_radius_mm(const RangeGrid& a, double noise_a_mm, double sigma_a_mm, const RangeGrid& b,
                          double noise_b_mm, double sigma_b_mm, const ClearingOptions& options) {
  const double spacing_mm = std::max(spacing_of(a), spacing_of(b));
  const double variance =
      noise_a_mm * noise_a_mm + noise_b_mm * noise_b_mm + sigma_a_mm * sigma_a_mm + sigma_b_mm * sigma_b_mm;
  return std::min(options.spacing_factor * spacing_mm + options.sigma_factor * std::sqrt(variance),
                  options.max_spacing_factor * spacing_mm);
}

std::vector<SparseSample> sparse_samples(const RangeGrid& grid, const SampleFlags& flags) {
  std::vector<SparseSample> out;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if ((flags[i] & (kSparse | kNotTablet)) == kSparse && grid.valid[i] != 0) {
      out.push_back({static_cast<std::uint32_t>(i), grid.point(i), Eigen::Vector3f::Zero()});
    }
  }
  parallel_for_each_index(
      out.size(),
      [&](std::size_t k) {
        SparseSample& s = out[k];
        s.facing = grid.view.to_camera(s.position_mm.cast<double>(), grid.row_of(s.index)).cast<float>();
      },
      kSamplesPerTask);
  return out;
}

std::vector<std::uint32_t> matched_samples(std::span<const SparseSample> sparse,
                                           const RigidTransform& other_from_own, const GridLookup& others,
                                           double radius_mm, const ClearingOptions& options) {
  const RangeGrid& grid = others.grid();
  const Eigen::Matrix3f rotation = other_from_own.rotation.cast<float>();
  const Eigen::Vector3f translation = other_from_own.translation_mm.cast<float>();
  const auto radius = static_cast<float>(radius_mm);
  const float radius2 = radius * radius;
  const auto least_cosine = static_cast<float>(std::cos(options.max_normal_angle_rad));
  const auto step_mm = static_cast<float>(5.0 * spacing_of(grid));
  const auto compatible = [&](const Eigen::Vector3f& own_normal, std::size_t other) {
    if (own_normal.isZero()) {
      return true;
    }
    const Eigen::Vector3f n = sample_normal(grid, other, step_mm);
    return n.isZero() || n.dot(own_normal) >= least_cosine;
  };
  const auto matches = [&](const SparseSample& s) {
    const Eigen::Vector3f p = rotation * s.position_mm + translation;
    const std::int64_t nearest = others.nearest(p, radius);
    if (nearest < 0) {
      return false;
    }
    const Eigen::Vector3f normal = rotation * s.facing;
    if (compatible(normal, static_cast<std::size_t>(nearest))) {
      return true;
    }
    // The nearest one lies on another face; a farther one may still match.
    bool found = false;
    others.for_each_near(p, radius, [&](std::size_t j) {
      found = found || ((grid.point(j) - p).squaredNorm() <= radius2 && compatible(normal, j));
    });
    return found;
  };
  using Matched = std::vector<std::uint32_t>;
  return parallel_reduce_ordered(
      sparse.size(), kSamplesPerTask, Matched{},
      [&](std::size_t begin, std::size_t end) {
        Matched part;
        for (std::size_t k = begin; k < end; ++k) {
          if (matches(sparse[k])) {
            part.push_back(static_cast<std::uint32_t>(k));
          }
        }
        return part;
      },
      [](Matched& into, const Matched& part) { into.insert(into.end(), part.begin(), part.end()); });
}

std::int64_t clear_against(const PlacedScan& own, const PlacedScan& other, SampleFlags& flags,
                           const ClearingOptions& options) {
  const std::vector<SparseSample> sparse = sparse_samples(*own.grid, flags);
  const GridLookup lookup(*other.grid, unflagged_mask(*other.grid, *other.flags));
  const double radius_mm =
      matching_radius_mm(*own.grid, estimate_noise_mm(*own.grid), own.sigma_mm, *other.grid,
                         estimate_noise_mm(*other.grid), other.sigma_mm, options);
  std::int64_t cleared = 0;
  for (const std::uint32_t k : matched_samples(
           sparse, other.model_from_scanner.inverse() * own.model_from_scanner, lookup, radius_mm, options)) {
    std::uint8_t& f = flags[sparse[k].index];
    cleared += (f & kCleared) == 0 ? 1 : 0;
    f |= kCleared;
  }
  return cleared;
}

}  // namespace dubsar
