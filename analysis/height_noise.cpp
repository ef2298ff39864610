// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/height_noise.h"

#include <cmath>
#include <utility>

#include "core/order_statistics.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

/// Vertices looked at, evenly spread over the mesh's order.
constexpr std::size_t kSamples = 200000;

float ring_mean(const VertexGraph& graph, std::span<const float> height_mm, std::uint32_t v) {
  float sum = 0;
  for (const std::uint32_t n : graph.ring(v)) {
    sum += height_mm[n];
  }
  return sum / static_cast<float>(graph.ring(v).size());
}

}  // namespace

double height_noise_mm(const VertexGraph& graph, std::span<const float> height_mm,
                       std::span<const std::uint8_t> free_surface) {
  std::vector<float> off;
  const std::size_t step = 1 + height_mm.size() / kSamples;
  for (std::size_t v = 0; v < height_mm.size(); v += step) {
    const auto vertex = static_cast<std::uint32_t>(v);
    if (free_surface[v] != 0 && graph.ring(vertex).size() > 3) {
      // The mean of six neighbours has noise of its own.
      const float scale = std::sqrt(1.0F + 1.0F / static_cast<float>(graph.ring(vertex).size()));
      off.push_back(std::abs(height_mm[v] - ring_mean(graph, height_mm, vertex)) / scale);
    }
  }
  if (off.empty()) {
    return 0;
  }
  return kSigmaOfMedian * static_cast<double>(median_of(std::move(off)));
}

std::vector<float> smooth_heights(const VertexGraph& graph, std::span<const float> height_mm, int rounds) {
  std::vector<float> now(height_mm.begin(), height_mm.end());
  std::vector<float> next(now.size());
  for (int round = 0; round < rounds; ++round) {
    parallel_for_each_index(now.size(), [&](std::size_t v) {
      const auto vertex = static_cast<std::uint32_t>(v);
      const auto count = static_cast<float>(graph.ring(vertex).size());
      next[v] = count > 0 ? (now[v] + count * ring_mean(graph, now, vertex)) / (1.0F + count) : now[v];
    });
    now.swap(next);
  }
  return now;
}

}  // namespace dubsar
