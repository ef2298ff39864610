// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "triangulation/patch_shape.h"

#include <algorithm>

#include "core/dilated.h"
#include "core/parallel.h"

namespace dubsar {

namespace {

constexpr std::uint8_t kBoth = kCellFirst | kCellSecond;
/// In what group a sample was found.
constexpr std::uint8_t kInSmall = 1, kInLarge = 2;

/// Marks samples all around which triangles are kept: nothing that pairs with one lies outside the patch.
void mark_within(OwnedScan& scan) {
  const auto width = static_cast<std::size_t>(scan.surface->lattice.cols);
  const auto rows = static_cast<std::size_t>(scan.surface->lattice.rows);
  parallel_for_each_index(
      rows > 2 ? rows - 2 : 0,
      [&](std::size_t above) {
        for (std::size_t i = (above + 1) * width + 1; i + 1 < (above + 2) * width; ++i) {
          const int all =
              scan.cells[i] & scan.cells[i - 1] & scan.cells[i - width] & scan.cells[i - width - 1];
          if ((all & kBoth) == kBoth) {
            scan.near_kept[i] = kAllAroundKept;
          }
        }
      },
      16);
}

/// By node: how much of its block is kept.
void count_kept(OwnedScan& scan) {
  const Lattice& lattice = scan.surface->lattice;
  scan.some_kept.assign(lattice.size(), 0);
  scan.all_kept.assign(lattice.size(), 0);
  parallel_for_each_index(
      lattice.size(),
      [&](std::size_t node) {
        bool some = false;
        bool all = true;
        lattice.for_each_sample(node, [&](std::size_t i) {
          some = some || scan.kept[i] != 0;
          all = all && scan.kept[i] != 0;
        });
        scan.some_kept[node] = some ? 1 : 0;
        scan.all_kept[node] = all ? 1 : 0;
      },
      1024);
}

}  // namespace

void remove_specks(std::vector<std::uint8_t>& kept, const std::vector<std::uint8_t>& cells,
                   const std::vector<std::uint8_t>& starts, const Lattice& grid, int least) {
  const auto enough = static_cast<std::size_t>(std::max(least, 1));
  std::vector<std::uint8_t> seen(kept.size(), 0);
  std::vector<std::size_t> patch;
  bool is_large = false;
  const auto width = static_cast<std::size_t>(grid.cols);
  const auto visit_cell = [&](std::size_t cell) {
    if ((cells[cell] & kBoth) == 0) {
      return;
    }
    for (const std::size_t i : {cell, cell + 1, cell + width, cell + width + 1}) {
      if (kept[i] == 0) {
        continue;
      }
      if (seen[i] == 0) {
        seen[i] = kInSmall;
        patch.push_back(i);
      }
      is_large = is_large || seen[i] == kInLarge;
    }
  };
  // A patch is followed until it is large enough, or comes to what is known to be.
  for (std::size_t start = 0; start < kept.size(); ++start) {
    if (kept[start] == 0 || starts[start] == 0 || seen[start] != 0) {
      continue;
    }
    patch.assign(1, start);
    seen[start] = kInSmall;
    is_large = enough == 1;
    for (std::size_t at = 0; at < patch.size() && !is_large; ++at) {
      const std::size_t i = patch[at];
      const auto col = static_cast<std::size_t>(grid.sample_col(i));
      if (i >= width && col > 0) {
        visit_cell(i - width - 1);
      }
      if (i >= width && col + 1 < width) {
        visit_cell(i - width);
      }
      if (i + width < kept.size() && col > 0) {
        visit_cell(i - 1);
      }
      if (i + width < kept.size() && col + 1 < width) {
        visit_cell(i);
      }
      is_large = is_large || patch.size() >= enough;
    }
    for (const std::size_t i : patch) {
      seen[i] = is_large ? kInLarge : kInSmall;
      kept[i] = is_large ? kept[i] : 0;
    }
  }
}

void drop_scattered(std::vector<std::uint8_t>& fresh, std::span<const std::uint8_t> kept, const Lattice& grid,
                    int least) {
  const auto width = static_cast<std::size_t>(grid.cols);
  const auto height = static_cast<std::size_t>(grid.rows);
  const auto enough = static_cast<std::size_t>(std::max(least, 1));
  std::vector<std::uint8_t> seen(fresh.size(), 0);
  std::vector<std::size_t> group;
  bool is_large = false;
  const auto visit = [&](std::size_t i) {
    if (fresh[i] == 0 && (kept.empty() || kept[i] == 0)) {
      return;
    }
    if (seen[i] == 0) {
      seen[i] = kInSmall;
      group.push_back(i);
    }
    is_large = is_large || seen[i] == kInLarge;
  };
  for (std::size_t start = 0; start < fresh.size(); ++start) {
    if (fresh[start] == 0 || seen[start] != 0) {
      continue;
    }
    group.clear();
    is_large = false;
    visit(start);
    for (std::size_t at = 0; at < group.size() && !is_large; ++at) {
      const std::size_t i = group[at];
      const auto row = static_cast<std::size_t>(grid.sample_row(i));
      const auto col = static_cast<std::size_t>(grid.sample_col(i));
      for (std::size_t r = row - std::min<std::size_t>(row, 1); r <= std::min(row + 1, height - 1); ++r) {
        for (std::size_t c = col - std::min<std::size_t>(col, 1); c <= std::min(col + 1, width - 1); ++c) {
          visit(r * width + c);
        }
      }
      is_large = is_large || group.size() >= enough;
    }
    for (const std::size_t i : group) {
      seen[i] = is_large ? kInLarge : kInSmall;
      fresh[i] = is_large ? fresh[i] : 0;
    }
  }
}

void settle_patches(OwnedScan& scan) {
  const GridSurface g = scan.surface->surface();
  // Cells of removed specks lose their corners, so their triangles go too.
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(g.rows - 1, 0)),
      [&](std::size_t r) {
        for (int col = 0; col + 1 < g.cols; ++col) {
          std::uint8_t& cell = scan.cells[g.index(static_cast<int>(r), col)];
          for (int which = 0; (cell & kBoth) != 0 && which < 2; ++which) {
            const std::uint8_t bit = which == 0 ? kCellFirst : kCellSecond;
            if ((cell & bit) != 0) {
              const auto t = cell_triangle(g, static_cast<int>(r), col, cell, which);
              if (scan.kept[t[0]] == 0 || scan.kept[t[1]] == 0 || scan.kept[t[2]] == 0) {
                cell = static_cast<std::uint8_t>(cell & ~bit);
              }
            }
          }
        }
      },
      16);
  const std::vector<std::uint8_t> used = corners_of_cells(scan.cells, g.rows, g.cols);
  for (std::size_t i = 0; i < used.size(); ++i) {
    scan.kept[i] &= used[i];
  }
  scan.near_kept = dilated(scan.kept, g.rows, g.cols, kLookAroundSamples);
  mark_within(scan);
  count_kept(scan);
}

}  // namespace dubsar
