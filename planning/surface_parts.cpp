// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <algorithm>
#include <array>
#include <numeric>
#include <utility>
#include <vector>

#include "planning/clusters.h"
#include "planning/surface_cover.h"

namespace dubsar {

namespace {

/// A cell of space that holds elements: [first, last) of them.
struct Cell {
  std::array<std::int64_t, 3> at{};
  std::uint32_t first = 0, last = 0;
};

bool meet(const std::vector<SurfaceCover::Element>& elements, const Cell& a, const Cell& b, float reach_mm) {
  for (std::uint32_t i = a.first; i < a.last; ++i) {
    for (std::uint32_t j = b.first; j < b.last; ++j) {
      if ((elements[i].position_mm - elements[j].position_mm).squaredNorm() <= reach_mm * reach_mm) {
        return true;
      }
    }
  }
  return false;
}

}  // namespace

// Cell by cell, whose edge is the reach: of two cells side by side the first elements mostly meet.
void SurfaceCover::part_cells() {
  std::vector<Cell> cells;
  std::vector<std::uint32_t> cell_at(start_.size(), 0);  // one more than its place in cells; 0: empty
  for (std::size_t index = 0; index + 1 < start_.size(); ++index) {
    if (start_[index] < start_[index + 1]) {
      const auto i = static_cast<std::int64_t>(index);
      cells.push_back({{i % size_[0], i / size_[0] % size_[1], i / (size_[0] * size_[1])},
                       start_[index],
                       start_[index + 1]});
      cell_at[index] = static_cast<std::uint32_t>(cells.size());
    }
  }
  UnionFind sets(cells.size());
  const auto reach = static_cast<float>(reach_mm());
  for (std::uint32_t c = 0; c < cells.size(); ++c) {
    for (int n = 14; n < 27; ++n) {  // half of the 26 around it
      const std::array<std::int64_t, 3> at = {cells[c].at[0] + n % 3 - 1, cells[c].at[1] + n / 3 % 3 - 1,
                                              cells[c].at[2] + n / 9 - 1};
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        inside = inside && at[k] >= 0 && at[k] < size_[k];
      }
      const std::uint32_t other =
          inside ? cell_at[static_cast<std::size_t>((at[2] * size_[1] + at[1]) * size_[0] + at[0])] : 0;
      if (other != 0 && sets.find(c) != sets.find(other - 1) &&
          meet(elements_, cells[c], cells[other - 1], reach)) {
        sets.join(c, other - 1);
      }
    }
  }
  auto groups = sets.groups();
  const auto elements_in = [&](const std::vector<std::uint32_t>& group) {
    return std::accumulate(group.begin(), group.end(), std::size_t{0}, [&](std::size_t sum, std::uint32_t c) {
      return sum + (cells[c].last - cells[c].first);
    });
  };
  std::vector<std::pair<std::size_t, std::uint32_t>> by_size;
  for (std::uint32_t g = 0; g < groups.size(); ++g) {
    by_size.emplace_back(elements_in(groups[g]), g);
  }
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  for (std::uint32_t part = 0; part < by_size.size(); ++part) {
    parts_.push_back(by_size[part].first);
    for (const std::uint32_t c : groups[by_size[part].second]) {
      for (std::uint32_t i = cells[c].first; i < cells[c].last; ++i) {
        elements_[i].part = part;
      }
    }
  }
}

}  // namespace dubsar
