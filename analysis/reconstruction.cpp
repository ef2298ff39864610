// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/reconstruction.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "analysis/cell_samples.h"
#include "analysis/distance_band.h"
#include "analysis/multigrid.h"
#include "analysis/screened_poisson.h"
#include "analysis/surface_nets.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

using Eigen::Vector3f;
constexpr std::size_t kGrain = 1U << 15U;
/// What an utterly unreliable vertex still counts: beside a hole of one face clay is not far from where the
/// mesh says, and on a mesh full of faults little else is left.
constexpr float kLeastReliability = 0.25F;
/// Below this many vertices a cell edge, cells stay empty and the surface gets holes.
constexpr float kEdgesPerCell = 2.0F;
constexpr int kPaddingCells = 3;
/// Of a point off the free surface before its depth is known: a hollow of any size stays bridged.
constexpr float kFirstLookWeight = 0.002F;
constexpr float kFirstLookCells = 2.0F;  ///< of the grid, in those of the last one
/// Over which the surface is moved onto the free points: where it is curved it lies off them.
constexpr float kOffsetReachMm = 3.0F;
/// Further off than this, a point is not one that the surface should have met.
constexpr float kMostOffsetCells = 0.75F;

/// A grid around the box, `room_mm` wider on all sides, its sides rounded up for the multigrid.
NodeGrid grid_around(const Eigen::AlignedBox3f& box, float room_mm, float cell_mm) {
  NodeGrid grid;
  grid.cell_mm = cell_mm;
  const Vector3f size = box.sizes().array() + 2 * (room_mm + kPaddingCells * cell_mm);
  const auto nodes = [&](float length) {
    return Multigrid::rounded_up(static_cast<int>(std::ceil(length / cell_mm)) + 1);
  };
  grid.nx = nodes(size.x());
  grid.ny = nodes(size.y());
  grid.nz = nodes(size.z());
  grid.origin_mm =
      box.center() - 0.5F * cell_mm *
                         Vector3f(static_cast<float>(grid.nx - 1), static_cast<float>(grid.ny - 1),
                                  static_cast<float>(grid.nz - 1));
  return grid;
}

/// Σ weight·value / Σ weight around any place, under a tent of half-width reach_mm.
class LocalMean {
 public:
  LocalMean(const Eigen::AlignedBox3f& box, float reach_mm) {
    grid_.cell_mm = reach_mm;
    grid_.origin_mm = box.min().array() - reach_mm;
    grid_.nx = static_cast<int>(box.sizes().x() / reach_mm) + 4;
    grid_.ny = static_cast<int>(box.sizes().y() / reach_mm) + 4;
    grid_.nz = static_cast<int>(box.sizes().z() / reach_mm) + 4;
    sum_.assign(grid_.count(), 0.0F);
    weight_.assign(grid_.count(), 0.0F);
  }
  /// Beyond the box a place counts as on its border.
  void add(const Vector3f& p_mm, float weight, float value) {
    each_corner(p_mm, [&](std::size_t node, float share) {
      sum_[node] += share * weight * value;
      weight_[node] += share * weight;
    });
  }
  /// Nothing where nothing is near; within a reach of the box.
  [[nodiscard]] std::optional<float> at(const Vector3f& p_mm) const {
    float sum = 0;
    float weight = 0;
    each_corner(p_mm, [&](std::size_t node, float share) {
      sum += share * sum_[node];
      weight += share * weight_[node];
    });
    return weight > 0 ? std::optional(sum / weight) : std::nullopt;
  }

 private:
  template <class Body>
  void each_corner(const Vector3f& p_mm, const Body& body) const {
    const Vector3f top(static_cast<float>(grid_.nx - 2), static_cast<float>(grid_.ny - 2),
                       static_cast<float>(grid_.nz - 2));
    const Vector3f at = grid_.place(p_mm);
    const Vector3f low = at.array().floor().max(0.0F).min(top.array());
    const Vector3f t = (at - low).array().max(0.0F).min(1.0F);
    const std::size_t node =
        grid_.index(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z()));
    for (std::size_t k = 0; k < 8; ++k) {
      body(node + (k & 1U) + ((k >> 1U) & 1U) * grid_.row() + (k >> 2U) * grid_.plane(),
           ((k & 1U) != 0 ? t.x() : 1 - t.x()) * ((k & 2U) != 0 ? t.y() : 1 - t.y()) *
               ((k & 4U) != 0 ? t.z() : 1 - t.z()));
    }
  }
  NodeGrid grid_;
  std::vector<float> sum_, weight_;
};

/// Where the indicator is on average at the samples: the level of the surface.
float level_of(const std::vector<PoissonSample>& samples, const NodeGrid& grid,
               const std::vector<float>& value) {
  double sum = 0;
  double weight = 0;
  for (const PoissonSample& s : samples) {
    const Vector3f at = grid.place(s.position_mm);
    const Vector3f low = at.array().floor();
    const Vector3f t = at - low;
    const std::size_t node =
        grid.index(static_cast<int>(low.x()), static_cast<int>(low.y()), static_cast<int>(low.z()));
    float here = 0;
    for (std::size_t k = 0; k < 8; ++k) {
      here += value[node + (k & 1U) + ((k >> 1U) & 1U) * grid.row() + (k >> 2U) * grid.plane()] *
              ((k & 1U) != 0 ? t.x() : 1 - t.x()) * ((k & 2U) != 0 ? t.y() : 1 - t.y()) *
              ((k & 4U) != 0 ? t.z() : 1 - t.z());
    }
    sum += static_cast<double>(s.pin_mm2) * here;
    weight += s.pin_mm2;
  }
  return static_cast<float>(sum / weight);
}

/// Cells are no smaller than least_cell_mm. weights: [V].
HeightSurface surface_of(const Mesh& mesh, const VertexGeometry& geometry, const std::vector<float>& weights,
                         float least_cell_mm, const ReconstructionOptions& options, const JobContext& job) {
  const Eigen::AlignedBox3f& box = geometry.box;
  if (box.isEmpty()) {
    return {};
  }
  const Vector3f room = box.sizes().array() + 2 * options.above_mm;
  const float cell_mm = std::max({least_cell_mm, kEdgesPerCell * static_cast<float>(geometry.mean_edge_mm),
                                  std::cbrt(room.prod() / static_cast<float>(options.most_nodes))});
  const NodeGrid grid = grid_around(box, options.above_mm, cell_mm);
  const std::vector<CellSample> cells =
      gather_cell_samples(mesh.positions, geometry.normal, geometry.area_mm2, weights, grid);
  if (cells.empty()) {
    return {};
  }
  const float script_mm = std::max(options.script_mm, cell_mm);
  LocalMean mean_weight(box, script_mm);
  for (const CellSample& cell : cells) {
    mean_weight.add(cell.position_mm, cell.area_mm2, cell.weighted_area_mm2 / cell.area_mm2);
  }
  std::vector<PoissonSample> samples(cells.size());
  parallel_for_each_index(samples.size(), [&](std::size_t i) {
    const float mean = mean_weight.at(cells[i].position_mm).value_or(1.0F);
    samples[i] = {cells[i].position_mm, cells[i].area_normal_mm2 / mean, cells[i].weighted_area_mm2 / mean};
  });
  Indicator indicator = solve_screened_poisson(samples, grid, options.poisson, job);
  if (indicator.value.empty()) {
    return {};
  }
  const float level = level_of(samples, grid, indicator.value);
  parallel_for_each_index(
      indicator.value.size(), [&](std::size_t i) { indicator.value[i] -= level; }, kGrain);
  Mesh surface = surface_nets(grid, indicator.value, 0.0F);
  if (surface.faces.empty()) {
    return {};
  }
  std::vector<float> distance =
      distances_near(surface, grid, indicator.value, options.band_mm, options.above_mm);
  HeightSurface result(std::move(surface), grid, options.band_mm, options.above_mm, std::move(distance));
  // Smoothing draws the surface inwards where it is curved, and what weight the impressions have draws it
  // down: it is moved so that on average the free points around lie on it.
  LocalMean offset(box, std::max(kOffsetReachMm, cell_mm));
  for (const CellSample& cell : cells) {
    const float height = result.height_mm(cell.position_mm);
    if (std::abs(height) < kMostOffsetCells * cell_mm) {
      const float weight = cell.weighted_area_mm2 / cell.area_mm2;
      offset.add(cell.position_mm, weight * cell.weighted_area_mm2, height);
    }
  }
  result.shift([&](const Vector3f& p) { return offset.at(p).value_or(0.0F); });
  return result;
}

}  // namespace

HeightSurface reconstruct_surface(const Mesh& mesh, const VertexGeometry& geometry,
                                  const std::vector<std::uint8_t>& free_surface,
                                  const std::vector<float>& reliability, const ReconstructionOptions& options,
                                  const JobContext& job) {
  std::vector<float> weights(mesh.positions.size());
  const auto weigh = [&](const auto& weight_off_it) {
    parallel_for_each_index(
        weights.size(),
        [&](std::size_t i) {
          weights[i] = std::max(reliability[i], kLeastReliability) *
                       (free_surface[i] != 0 ? 1.0F : weight_off_it(mesh.positions[i]));
        },
        kGrain);
  };
  if (options.other_weight >= 1) {
    weigh([](const Vector3f&) { return 1.0F; });
    return surface_of(mesh, geometry, weights, options.cell_mm, options, job);
  }
  weigh([](const Vector3f&) { return kFirstLookWeight; });
  const HeightSurface first =
      surface_of(mesh, geometry, weights, kFirstLookCells * options.cell_mm, options, job);
  if (first.mesh().faces.empty()) {
    return {};
  }
  weigh([&](const Vector3f& p) {
    const float depth_mm = std::max(-first.height_mm(p), options.full_depth_mm);
    return options.other_weight * options.full_depth_mm / depth_mm;
  });
  return surface_of(mesh, geometry, weights, options.cell_mm, options, job);
}

}  // namespace dubsar
