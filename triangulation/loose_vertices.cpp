// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/loose_vertices.h"

#include <algorithm>

namespace dubsar {

namespace {
constexpr float kCellSpacings = 4.0F;
}

LooseVertices::LooseVertices(const Sheet& sheet) : sheet_(&sheet) {
  float coarsest_mm = 0;
  for (std::size_t v = 0; v < sheet.marks.size(); ++v) {
    if ((sheet.marks[v] & kLooseMark) != 0) {
      coarsest_mm = std::max(coarsest_mm, sheet.spacing_mm[v]);
    }
  }
  if (!(coarsest_mm > 0)) {
    return;
  }
  cells_per_mm_ = 1.0F / (kCellSpacings * coarsest_mm);
  for (std::uint32_t v = 0; v < sheet.marks.size(); ++v) {
    if ((sheet.marks[v] & kLooseMark) != 0) {
      const Eigen::Vector3f& p = sheet.positions[v];
      cells_[key_of(cell_of(p.x()), cell_of(p.y()), cell_of(p.z()))].push_back(v);
    }
  }
}

int LooseVertices::cell_of(float mm) const {
  return static_cast<int>(std::floor(std::clamp(mm * cells_per_mm_, -1.0e6F, 1.0e6F)));
}

std::uint64_t LooseVertices::key_of(int x, int y, int z) const {
  const auto part = [](int c) { return static_cast<std::uint64_t>(c + (1 << 20)) & 0x1fffffU; };
  return (part(x) << 42U) | (part(y) << 21U) | part(z);
}

std::vector<std::uint32_t> LooseVertices::near(const Eigen::Vector3f& p_mm, float radius_mm) const {
  std::vector<std::uint32_t> found;
  if (cells_.empty()) {
    return found;
  }
  for (int x = cell_of(p_mm.x() - radius_mm); x <= cell_of(p_mm.x() + radius_mm); ++x) {
    for (int y = cell_of(p_mm.y() - radius_mm); y <= cell_of(p_mm.y() + radius_mm); ++y) {
      for (int z = cell_of(p_mm.z() - radius_mm); z <= cell_of(p_mm.z() + radius_mm); ++z) {
        const auto cell = cells_.find(key_of(x, y, z));
        if (cell == cells_.end()) {
          continue;
        }
        std::ranges::copy_if(cell->second, std::back_inserter(found), [&](std::uint32_t v) {
          return (sheet_->positions[v] - p_mm).squaredNorm() <= radius_mm * radius_mm;
        });
      }
    }
  }
  std::ranges::sort(found);
  return found;
}

}  // namespace dubsar
