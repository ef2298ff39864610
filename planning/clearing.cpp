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

constexpr double kStepSpacings = 5.0;  ///< neighbours farther apart are no surface to take a normal from
constexpr int kTile = 16;              ///< side of a tile, cells of the grid
constexpr std::size_t kTilesPerTask = 64;

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

/// The sparse samples of the tile whose first cell this is.
void add_tile(const RangeGrid& grid, const SampleFlags& flags, int first_row, int first_col,
              SparseSamples& out) {
  const std::size_t first = out.samples.size();
  Eigen::AlignedBox3f box;
  for (int row = first_row; row < std::min(first_row + kTile, grid.rows); ++row) {
    for (int col = first_col; col < std::min(first_col + kTile, grid.cols); ++col) {
      const std::size_t i = grid.index(row, col);
      if ((flags[i] & (kSparse | kNotTablet)) == kSparse && grid.valid[i] != 0) {
        const Eigen::Vector3f p = grid.point(i);
        box.extend(p);
        out.samples.push_back(
            {static_cast<std::uint32_t>(i), p, grid.view.to_camera(p.cast<double>(), row).cast<float>()});
      }
    }
  }
  if (out.samples.size() > first) {
    out.box_mm.extend(box);
    // Grown by what rounding may take, here and where the ball is moved.
    out.tiles.push_back({static_cast<std::uint32_t>(first), box.center(),
                         0.5F * box.diagonal().norm() + 1e-5F * box.max().cwiseAbs().maxCoeff()});
  }
}

}  // namespace

double spacing_of(const RangeGrid& grid) {
  return grid.spacing_mm > 0 ? grid.spacing_mm : estimate_spacing_mm(grid);
}

double coarsest_spacing_mm(std::span<const PlacedScan> scans) {
  double spacing_mm = 0;
  for (const PlacedScan& scan : scans) {
    spacing_mm = std::max(spacing_mm, spacing_of(*scan.grid));
  }
  return spacing_mm;
}

double noise_of(const PlacedScan& scan) {
  return scan.noise_mm ? *scan.noise_mm : estimate_noise_mm(*scan.grid);
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

SampleNormals normals_of(const RangeGrid& grid) {
  return {grid, static_cast<float>(kStepSpacings * spacing_of(grid))};
}

double matching_radius_mm(const RangeGrid& a, double noise_a_mm, double sigma_a_mm, const RangeGrid& b,
                          double noise_b_mm, double sigma_b_mm, const ClearingOptions& options) {
  const double spacing_mm = std::max(spacing_of(a), spacing_of(b));
  const double variance =
      noise_a_mm * noise_a_mm + noise_b_mm * noise_b_mm + sigma_a_mm * sigma_a_mm + sigma_b_mm * sigma_b_mm;
  return std::min(options.spacing_factor * spacing_mm + options.sigma_factor * std::sqrt(variance),
                  options.max_spacing_factor * spacing_mm);
}

std::vector<std::uint8_t> unflagged_samples(const RangeGrid& grid, const SampleFlags& flags) {
  std::vector<std::uint8_t> keep(grid.size());
  parallel_for_each_index(
      keep.size(), [&](std::size_t i) { keep[i] = grid.valid[i] != 0 && is_unflagged(flags[i]) ? 1 : 0; },
      65536);
  return keep;
}

SparseSamples sparse_samples(const RangeGrid& grid, const SampleFlags& flags) {
  const auto across = static_cast<std::size_t>((grid.cols + kTile - 1) / kTile);
  const auto down = static_cast<std::size_t>((grid.rows + kTile - 1) / kTile);
  return parallel_reduce_ordered(
      across > 0 ? down : 0, 1, SparseSamples{},
      [&](std::size_t begin, std::size_t end) {
        SparseSamples part;
        for (std::size_t tile = begin * across; tile < end * across; ++tile) {
          add_tile(grid, flags, static_cast<int>(tile / across) * kTile,
                   static_cast<int>(tile % across) * kTile, part);
        }
        return part;
      },
      [](SparseSamples& into, const SparseSamples& part) {
        const auto before = static_cast<std::uint32_t>(into.samples.size());
        into.box_mm.extend(part.box_mm);
        into.samples.insert(into.samples.end(), part.samples.begin(), part.samples.end());
        for (SparseTile tile : part.tiles) {
          tile.first += before;
          into.tiles.push_back(tile);
        }
      });
}

std::vector<std::uint32_t> matched_samples(const SparseSamples& sparse, const RigidTransform& other_from_own,
                                           const GridLookup& others, const SampleNormals& normals,
                                           double radius_mm, const ClearingOptions& options) {
  const Eigen::Matrix3f rotation = other_from_own.rotation.cast<float>();
  const Eigen::Vector3f translation = other_from_own.translation_mm.cast<float>();
  const auto radius = static_cast<float>(radius_mm);
  const auto least_cosine = static_cast<float>(std::cos(options.max_normal_angle_rad));
  const auto matches = [&](const GridLookup::Reach& reach, const SparseSample& s) {
    const Eigen::Vector3f facing = rotation * s.facing;
    return others.any_within(reach, [&](std::uint32_t j) {
      const Eigen::Vector3f n = normals[j];
      return n.isZero() || n.dot(facing) >= least_cosine;
    });
  };
  struct Asked {
    std::uint32_t sample = 0;
    GridLookup::Reach reach;
  };
  const auto match_tile = [&](std::size_t first, std::size_t last, std::vector<Asked>& asked,
                              std::vector<std::uint32_t>& matched) {
    asked.clear();
    for (std::size_t k = first; k < last; ++k) {
      const GridLookup::Reach reach =
          others.reach_of(rotation * sparse.samples[k].position_mm + translation, radius);
      if (others.may_hold_samples(reach)) {
        others.fetch(reach);  // by the time that it is needed, it is here
        asked.push_back({static_cast<std::uint32_t>(k), reach});
      }
    }
    for (const Asked& a : asked) {
      if (matches(a.reach, sparse.samples[a.sample])) {
        matched.push_back(a.sample);
      }
    }
  };
  using Matched = std::vector<std::uint32_t>;
  return parallel_reduce_ordered(
      sparse.tiles.size(), kTilesPerTask, Matched{},
      [&](std::size_t begin, std::size_t end) {
        Matched part;
        std::vector<Asked> asked;
        for (std::size_t t = begin; t < end; ++t) {
          const SparseTile& tile = sparse.tiles[t];
          const bool bounded = tile.center_mm.allFinite() && std::isfinite(tile.radius_mm);
          if (bounded && !others.may_hold_samples(others.reach_of(rotation * tile.center_mm + translation,
                                                                  tile.radius_mm + radius))) {
            continue;
          }
          const std::size_t last =
              t + 1 < sparse.tiles.size() ? sparse.tiles[t + 1].first : sparse.samples.size();
          match_tile(tile.first, last, asked, part);
        }
        return part;
      },
      [](Matched& into, const Matched& part) { into.insert(into.end(), part.begin(), part.end()); });
}

std::int64_t clear_against(const PlacedScan& own, const PlacedScan& other, SampleFlags& flags,
                           const ClearingOptions& options) {
  const SparseSamples sparse = sparse_samples(*own.grid, flags);
  const GridLookup lookup(*other.grid, unflagged_samples(*other.grid, *other.flags));
  const double radius_mm = matching_radius_mm(*own.grid, noise_of(own), own.sigma_mm, *other.grid,
                                              noise_of(other), other.sigma_mm, options);
  std::int64_t cleared = 0;
  for (const std::uint32_t k :
       matched_samples(sparse, other.model_from_scanner.inverse() * own.model_from_scanner, lookup,
                       normals_of(*other.grid), radius_mm, options)) {
    std::uint8_t& f = flags[sparse.samples[k].index];
    cleared += (f & kCleared) == 0 ? 1 : 0;
    f |= kCleared;
  }
  return cleared;
}

}  // namespace dubsar
