// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/openness.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "analysis/depth_maps.h"
#include "core/parallel.h"

namespace dubsar {
namespace {

/// Vertices of one block go through all the maps while they are in the cache.
constexpr std::size_t kGrain = 1U << 12U;
/// The offset against self-shadow, in pixels of the map: half a pixel's slope to either side, and a little
/// for the roundness within it.
constexpr float kSlopePx = 0.75F;
constexpr float kFlatPx = 0.25F;
/// A map keeps the highest of the points within a pixel: this many times the roughness above the others.
constexpr float kAboveRoughness = 2.5F;
/// What is rougher than this in pixels is no noise but a coarse mesh.
constexpr float kMostRoughPx = 0.6F;
/// Below this cosine a direction grazes the surface: the map cannot tell what is hidden, and little hangs on
/// it.
constexpr float kGrazing = 0.1F;

}  // namespace

std::vector<float> vertex_openness(const Mesh& mesh, const VertexGeometry& geometry,
                                   const OpennessOptions& options, const JobContext& job) {
  const std::size_t vertices = mesh.positions.size();
  const int pairs = std::clamp(options.directions, 2, 512) / 2;
  const DepthMapPlan plan = plan_depth_maps(mesh, geometry.box, geometry.mean_edge_mm,
                                            std::clamp(options.longest_map_px, 64, 4096));
  if (plan.side_px == 0) {
    return std::vector<float>(vertices, 0.0F);
  }
  const std::vector<Eigen::Vector3f> directions = half_sphere_directions(pairs);
  std::vector<std::unique_ptr<DepthMapPair>> maps(directions.size());
  parallel_for_each_index(
      maps.size(),
      [&](std::size_t i) {
        if (!job.cancelled()) {
          maps[i] = std::make_unique<DepthMapPair>(mesh, geometry.area_mm2, plan, directions[i]);
        }
      },
      1);
  if (job.cancelled()) {
    return {};
  }
  const float rough =
      std::min(kAboveRoughness * static_cast<float>(geometry.roughness_mm), kMostRoughPx * plan.pixel_mm);
  std::vector<float> openness(vertices);
  parallel_chunks(vertices, kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<float> seen(end - begin, 0.0F);
    std::vector<float> all(end - begin, 0.0F);
    for (const auto& map : maps) {
      for (std::size_t i = begin; i < end; ++i) {
        const float cosine = geometry.normal[i].dot(map->direction());
        const float facing = std::abs(cosine);
        if (!(facing > kGrazing) || !map->holds(mesh.positions[i])) {
          continue;
        }
        const float slope = std::sqrt(std::max(0.0F, 1.0F - facing * facing)) / facing;
        const float offset = plan.pixel_mm * (kFlatPx + kSlopePx * slope) + rough / facing;
        const DepthMapPair::Place at = map->place(mesh.positions[i]);
        const bool visible = cosine > 0 ? at.depth_mm + offset >= map->nearest_mm(at.pixel)
                                        : at.depth_mm - offset <= map->farthest_mm(at.pixel);
        all[i - begin] += facing;
        seen[i - begin] += visible ? facing : 0.0F;
      }
    }
    for (std::size_t i = begin; i < end; ++i) {
      openness[i] = all[i - begin] > 0 ? seen[i - begin] / all[i - begin] : 0.0F;
    }
  });
  return openness;
}

std::vector<float> equalized(const std::vector<float>& values) {
  constexpr std::size_t kSteps = 1024;
  std::vector<std::size_t> below(kSteps + 1, 0);
  const auto step = [](float v) {
    return static_cast<std::size_t>(std::clamp(v, 0.0F, 1.0F) * static_cast<float>(kSteps - 1));
  };
  for (const float v : values) {
    ++below[step(v) + 1];
  }
  for (std::size_t i = 1; i <= kSteps; ++i) {
    below[i] += below[i - 1];
  }
  std::vector<float> even(values.size());
  parallel_for_each_index(values.size(), [&](std::size_t i) {
    const std::size_t s = step(values[i]);
    // The middle of the values that share a step.
    even[i] = static_cast<float>(below[s] + below[s + 1]) / (2.0F * static_cast<float>(values.size()));
  });
  return even;
}

}  // namespace dubsar
