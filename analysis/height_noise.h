// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "analysis/vertex_graph.h"

namespace dubsar {

/// Noise of the heights of the free surface, each vertex against the mean of its 1-ring: a robust standard
/// deviation, mm. Zero where there is no free surface.
[[nodiscard]] double height_noise_mm(const VertexGraph& graph, std::span<const float> height_mm,
                                     std::span<const std::uint8_t> free_surface);

/// Heights averaged over the 1-ring so many times.
[[nodiscard]] std::vector<float> smooth_heights(const VertexGraph& graph, std::span<const float> height_mm,
                                                int rounds);

}  // namespace dubsar
