// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// By which spacing each place is judged.
#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "planning/surface_cover.h"

namespace dubsar {

namespace {

/// Of a level's µ: edge of the cells that note where it has samples. With the cells around its own a place is
/// sampled where one lies within 0.75 to 2.1 µ of it, so that none between samples is missed.
constexpr double kEdgeInSpacings = 0.75;

struct Cell {
  std::int64_t x = 0, y = 0, z = 0;

  [[nodiscard]] std::uint64_t key() const {
    constexpr std::int64_t kHalf = 1 << 20;
    const auto part = [](std::int64_t at) {
      return static_cast<std::uint64_t>(std::clamp<std::int64_t>(at + kHalf, 0, 2 * kHalf - 1));
    };
    return (part(x) << 42U) | (part(y) << 21U) | part(z);
  }
};

Cell cell_at(const Eigen::Vector3f& p_mm, double edge_mm) {
  const auto at = [&](float x) {
    return static_cast<std::int64_t>(std::floor(static_cast<double>(x) / edge_mm));
  };
  return {at(p_mm.x()), at(p_mm.y()), at(p_mm.z())};
}

}  // namespace

void SurfaceCover::note_coarse(std::span<const PlacedScan> scans) {
  for (std::size_t level = 1; level < levels_.size(); ++level) {
    std::size_t most = 0;
    for (std::size_t s = 0; s < scans.size(); ++s) {
      most += levels_.of_scan(s) == level ? scans[s].grid->size() : 0;
    }
    CellSet& sampled = coarse_.emplace_back(most);
    const double edge_mm = kEdgeInSpacings * levels_.spacing_mm(level);
    for (std::size_t s = 0; s < scans.size(); ++s) {
      if (levels_.of_scan(s) != level) {
        continue;
      }
      const RangeGrid& grid = *scans[s].grid;
      const Eigen::Matrix3f rotation = scans[s].model_from_scanner.rotation.cast<float>();
      const Eigen::Vector3f translation = scans[s].model_from_scanner.translation_mm.cast<float>();
      for (std::size_t i = 0; i < grid.size(); ++i) {
        if (grid.valid[i] != 0 && is_unflagged((*scans[s].flags)[i]) && grid.point(i).allFinite()) {
          sampled.insert(cell_at(rotation * grid.point(i) + translation, edge_mm).key());
        }
      }
    }
  }
  parallel_for_each_index(
      coarse_.empty() ? 0 : elements_.size(),
      [&](std::size_t i) {
        elements_[i].level = static_cast<std::uint8_t>(level_at(elements_[i].position_mm));
      },
      512);
}

std::size_t SurfaceCover::level_at(const Eigen::Vector3f& p_mm) const {
  for (std::size_t level = coarse_.size(); level > 0; --level) {
    const Cell cell = cell_at(p_mm, kEdgeInSpacings * levels_.spacing_mm(level));
    for (int n = 0; n < 27; ++n) {
      const Cell beside{cell.x + n % 3 - 1, cell.y + n / 3 % 3 - 1, cell.z + n / 9 - 1};
      if (coarse_[level - 1].contains(beside.key())) {
        return level;
      }
    }
  }
  return 0;
}

double SurfaceCover::spacing_mm_at(const Eigen::Vector3d& p_mm) const {
  return levels_.spacing_mm(level_at(p_mm.cast<float>()));
}

double SurfaceCover::cell_mm_at(const Eigen::Vector3d& p_mm) const {
  return cells_mm_[level_at(p_mm.cast<float>())];
}

}  // namespace dubsar
