// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "analysis/place_order.h"

#include <algorithm>
#include <cstddef>

#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr unsigned kBits = 6;
constexpr std::size_t kCells = std::size_t{1} << (3 * kBits);
constexpr std::size_t kMostParts = 16;

/// Bits of a number below 64 spread to every third place.
std::uint32_t spread(std::uint32_t v) {
  v = (v | (v << 8U)) & 0x0300F00FU;
  v = (v | (v << 4U)) & 0x030C30C3U;
  return (v | (v << 2U)) & 0x09249249U;
}

}  // namespace

std::vector<std::uint32_t> order_by_place(std::span<const Eigen::Vector3f> positions_mm,
                                          std::span<const std::array<std::uint32_t, 3>> faces,
                                          const Eigen::AlignedBox3f& box_mm) {
  const Eigen::Vector3f& low = box_mm.min();
  const float cells_per_mm =
      static_cast<float>(1U << kBits) * 0.999F / std::max(box_mm.sizes().maxCoeff(), 1e-6F);
  const auto cell_of = [&](std::size_t f) {
    const Eigen::Array3f at = (positions_mm[faces[f][0]] - low).array() * cells_per_mm;
    return spread(static_cast<std::uint32_t>(at.x())) | (spread(static_cast<std::uint32_t>(at.y())) << 1U) |
           (spread(static_cast<std::uint32_t>(at.z())) << 2U);
  };
  // Counting sort: each part counts, then knows where its faces of each cell go.
  const std::size_t grain = std::max<std::size_t>(kCells, (faces.size() + kMostParts - 1) / kMostParts);
  const std::size_t parts = (faces.size() + grain - 1) / grain;
  std::vector<std::vector<std::uint32_t>> next(parts);
  parallel_chunks(faces.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& counts = next[begin / grain];
    counts.assign(kCells, 0);
    for (std::size_t f = begin; f < end; ++f) {
      ++counts[cell_of(f)];
    }
  });
  std::uint32_t before = 0;
  for (std::size_t cell = 0; cell < kCells; ++cell) {
    for (std::vector<std::uint32_t>& counts : next) {
      const std::uint32_t here = counts[cell];
      counts[cell] = before;
      before += here;
    }
  }
  std::vector<std::uint32_t> order(faces.size());
  parallel_chunks(faces.size(), grain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t>& to = next[begin / grain];
    for (std::size_t f = begin; f < end; ++f) {
      order[to[cell_of(f)]++] = static_cast<std::uint32_t>(f);
    }
  });
  return order;
}

}  // namespace dubsar
