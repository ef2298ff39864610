// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/vertex_graph.h"

namespace dubsar {

struct BasinOptions {
  /// The textbook watershed, for comparison (seed 000, Fig. 6a): every local minimum is a basin, nothing is
  /// flooded.
  bool classical = false;
  /// A basin smaller than this is flooded by its biggest neighbour where they meet.
  std::uint32_t min_vertices = 12;
  /// So is one that is less deep below the place where they meet.
  float min_depth_mm = 0.02F;
};

/// Values of Basins::label below zero.
inline constexpr std::int32_t kFreeSurfaceLabel = -1;
inline constexpr std::int32_t kBasinBorder = -2;

/// Catchment basins of a height field; basins are numbered by rising height of their lowest vertex.
struct Basins {
  std::vector<std::int32_t> label;    ///< [V] basin, kFreeSurfaceLabel or kBasinBorder
  std::vector<std::uint32_t> lowest;  ///< [B] lowest vertex
  std::vector<std::uint32_t> start;   ///< [B + 1] into `vertex`
  std::vector<std::uint32_t> vertex;  ///< of all basins, each basin's in rising height
  [[nodiscard]] std::size_t count() const { return lowest.size(); }
  [[nodiscard]] std::span<const std::uint32_t> vertices_of(std::size_t basin) const {
    return {vertex.data() + start[basin], vertex.data() + start[basin + 1]};
  }
};

/// The modified watershed of seed 000, 3.3. Vertices off the free surface are visited in rising height (ties
/// by index). One whose 1-ring holds a single basin joins it; none: it joins the biggest basin of its 2-ring,
/// or starts one; two or more: it is a border, unless a basin there is under the minimum size, which is then
/// flooded. height_mm, free_surface: [V]. Vertices whose height is not finite stay unlabelled.
[[nodiscard]] Basins find_basins(const VertexGraph& graph, std::span<const float> height_mm,
                                 std::span<const std::uint8_t> free_surface, const BasinOptions& options);

}  // namespace dubsar
