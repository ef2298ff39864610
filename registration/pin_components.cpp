// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_components.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// Every so many samples tell the noise.
/// A surface whose slope changes between two samples, in µ; steeper changes are steps.
constexpr float kMostBend = 1.2F;
/// Residual of a straight continuation, in standard deviations of a sample: it adds up three samples.
constexpr float kBendSigmas = 6.0F;
/// Samples of a small component that are looked at for its neighbours; of a larger one every fourth.
constexpr std::size_t kLookedAt = 24;

bool usable(const RangeGrid& grid, std::size_t i) {
  return grid.valid[i] != 0 && std::isfinite(grid.x[i]) && std::isfinite(grid.y[i]) &&
         std::isfinite(grid.z[i]);
}

/// Joins neighbours along one grid direction.
class Links {
 public:
  Links(const RangeGrid& grid, const SheetOptions& options) : grid_(grid) {
    const auto step = static_cast<float>(
        std::max(options.step_factor * options.spacing_mm, 2.0 * kBendSigmas * options.noise_mm));
    far2_ = step * step;
    near2_ = 0.25F * far2_;
    const float bend = std::max(kMostBend * static_cast<float>(options.spacing_mm),
                                kBendSigmas * static_cast<float>(options.noise_mm));
    bend2_ = bend * bend;
  }

  /// `before` and `after` tell whether the samples one farther on either side exist.
  [[nodiscard]] bool joined(std::size_t i, std::size_t j, std::size_t stride, bool before, bool after) const {
    const Eigen::Vector3f d = grid_.point(j) - grid_.point(i);
    const float d2 = d.squaredNorm();
    if (d2 <= near2_) {
      return true;
    }
    if (!(d2 <= far2_)) {
      return false;
    }
    const auto leads = [&](std::size_t from, const Eigen::Vector3f& at, const Eigen::Vector3f& way) {
      return usable(grid_, from) && (at - grid_.point(from) - way).squaredNorm() <= bend2_;
    };
    return (before && leads(i - stride, grid_.point(i), d)) ||
           (after && leads(j + stride, grid_.point(j), -d));
  }

 private:
  const RangeGrid& grid_;
  float far2_ = 0, near2_ = 0, bend2_ = 0;
};

/// Consecutive whole cells of one row of cells.
struct Run {
  int row = 0, first = 0, last = 0;  ///< of cells: samples first … last + 1 of rows row and row + 1
  std::int32_t parent = 0;
};

std::int32_t root(std::vector<Run>& runs, std::int32_t k) {
  while (runs[static_cast<std::size_t>(k)].parent != k) {
    std::int32_t& parent = runs[static_cast<std::size_t>(k)].parent;
    parent = runs[static_cast<std::size_t>(parent)].parent;
    k = parent;
  }
  return k;
}

std::vector<std::vector<Run>> find_runs(const RangeGrid& grid, const SheetOptions& options) {
  const auto rows = static_cast<std::size_t>(grid.rows);
  const auto cols = static_cast<std::size_t>(grid.cols);
  const Links links(grid, options);
  std::vector<std::uint8_t> good(grid.size());
  std::vector<std::uint8_t> along(grid.size());  // to the next sample of the row
  parallel_for_each_index(
      rows,
      [&](std::size_t r) {
        for (std::size_t i = r * cols; i < (r + 1) * cols; ++i) {
          good[i] = usable(grid, i) ? 1 : 0;
        }
        for (std::size_t c = 0; c + 1 < cols; ++c) {
          const std::size_t i = r * cols + c;
          along[i] =
              good[i] != 0 && good[i + 1] != 0 && links.joined(i, i + 1, 1, c > 0, c + 2 < cols) ? 1 : 0;
        }
      },
      8);
  std::vector<std::vector<Run>> runs(rows > 0 ? rows - 1 : 0);
  parallel_for_each_index(
      runs.size(),
      [&](std::size_t r) {
        const auto down = [&](std::size_t c) {
          const std::size_t i = r * cols + c;
          return good[i] != 0 && good[i + cols] != 0 && links.joined(i, i + cols, cols, r > 0, r + 2 < rows);
        };
        bool left = cols > 0 && down(0);
        bool open = false;
        for (std::size_t c = 0; c + 1 < cols; ++c) {
          const bool right = down(c + 1);
          const std::size_t i = r * cols + c;
          const bool whole = left && right && along[i] != 0 && along[i + cols] != 0;
          if (whole && open) {
            runs[r].back().last = static_cast<int>(c);
          } else if (whole) {
            runs[r].push_back({static_cast<int>(r), static_cast<int>(c), static_cast<int>(c), 0});
          }
          open = whole;
          left = right;
        }
      },
      8);
  return runs;
}

/// Joins the runs that share samples of the row between them.
void join_runs(std::vector<Run>& runs, const std::vector<std::size_t>& row_start) {
  for (std::size_t r = 0; r + 2 < row_start.size(); ++r) {
    std::size_t a = row_start[r];
    std::size_t b = row_start[r + 1];
    while (a < row_start[r + 1] && b < row_start[r + 2]) {
      if (runs[a].first <= runs[b].last + 1 && runs[b].first <= runs[a].last + 1) {
        const std::int32_t x = root(runs, static_cast<std::int32_t>(a));
        const std::int32_t y = root(runs, static_cast<std::int32_t>(b));
        runs[static_cast<std::size_t>(std::max(x, y))].parent = std::min(x, y);
      }
      (runs[a].last < runs[b].last ? a : b) += 1;
    }
  }
}

}  // namespace

Sheets part_at_steps(const RangeGrid& grid, const SheetOptions& options) {
  Sheets out;
  out.label.assign(grid.size(), -1);
  std::vector<Run> runs;
  std::vector<std::size_t> row_start{0};
  for (const std::vector<Run>& row : find_runs(grid, options)) {
    runs.insert(runs.end(), row.begin(), row.end());
    row_start.push_back(runs.size());
  }
  for (std::size_t k = 0; k < runs.size(); ++k) {
    runs[k].parent = static_cast<std::int32_t>(k);
  }
  join_runs(runs, row_start);
  std::vector<std::size_t> cells(runs.size(), 0);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    cells[static_cast<std::size_t>(root(runs, static_cast<std::int32_t>(k)))] +=
        static_cast<std::size_t>(runs[k].last - runs[k].first + 1);
  }
  std::vector<std::int32_t> number(runs.size(), -1);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    const auto top = static_cast<std::size_t>(root(runs, static_cast<std::int32_t>(k)));
    if (cells[top] < static_cast<std::size_t>(std::max(1, options.least_cells))) {
      continue;
    }
    if (top == k) {
      number[k] = static_cast<std::int32_t>(out.components.size());
      out.components.push_back({cells[k], runs[k].row, runs[k].row + 1, runs[k].first, runs[k].last + 1});
    }
    number[k] = number[top];
    SheetComponent& component = out.components[static_cast<std::size_t>(number[k])];
    component.last_row = std::max(component.last_row, runs[k].row + 1);
    component.first_col = std::min(component.first_col, runs[k].first);
    component.last_col = std::max(component.last_col, runs[k].last + 1);
  }
  // Each row of samples is written from the cells above and below it, so that threads never meet.
  parallel_for_each_index(
      static_cast<std::size_t>(std::max(0, grid.rows)),
      [&](std::size_t r) {
        for (std::size_t side = r > 0 ? r - 1 : r; side <= r && side + 1 < row_start.size(); ++side) {
          for (std::size_t k = row_start[side]; k < row_start[side + 1]; ++k) {
            if (number[k] >= 0) {
              const std::size_t i = grid.index(static_cast<int>(r), runs[k].first);
              std::fill_n(out.label.begin() + static_cast<std::ptrdiff_t>(i),
                          runs[k].last - runs[k].first + 2, number[k]);
            }
          }
        }
      },
      16);
  return out;
}

bool is_thin(const Sheets& sheets, const RangeGrid& grid, std::size_t component, int side) {
  const SheetComponent& c = sheets.components[component];
  const auto width = static_cast<std::size_t>(c.last_col - c.first_col + 1);
  std::vector<int> above(width + 1,
                         0);  // side of the largest square that ends at each sample (its far corner)
  std::vector<int> here(width + 1, 0);
  for (int row = c.first_row; row <= c.last_row; ++row) {
    const std::size_t start = grid.index(row, c.first_col);
    for (std::size_t k = 0; k < width; ++k) {
      here[k + 1] = sheets.label[start + k] == static_cast<std::int32_t>(component)
                        ? 1 + std::min({here[k], above[k], above[k + 1]})
                        : 0;
      if (here[k + 1] > side) {
        return false;
      }
    }
    std::swap(above, here);
  }
  return true;
}

std::vector<std::uint8_t> connected_with_large(const Sheets& sheets, const RangeGrid& grid,
                                               const std::vector<std::uint8_t>& large, double reach_mm,
                                               double spacing_mm) {
  const std::size_t count = sheets.components.size();
  const int reach = std::max(1, static_cast<int>(std::ceil(reach_mm / spacing_mm)));
  const int hop = std::max(1, reach / 6);
  const auto near2 = static_cast<float>(reach_mm * reach_mm);
  std::vector<std::vector<std::int32_t>> neighbours(count);
  parallel_for_each_index(
      count,
      [&](std::size_t c) {
        if (large[c] != 0) {
          return;
        }
        const std::vector<std::uint32_t> samples = samples_of(sheets, grid, c);
        const std::size_t stride = std::clamp<std::size_t>(samples.size() / kLookedAt, 1, 4);
        std::vector<std::int32_t>& found = neighbours[c];
        for (std::size_t k = 0; k < samples.size(); k += stride) {
          const std::uint32_t i = samples[k];
          for (int dr = -reach; dr <= reach; dr += hop) {
            for (int dc = -reach; dc <= reach; dc += hop) {
              const int row = grid.row_of(i) + dr;
              const int col = grid.col_of(i) + dc;
              if (!grid.inside(row, col)) {
                continue;
              }
              const std::size_t j = grid.index(row, col);
              const std::int32_t other = sheets.label[j];
              if (other >= 0 && other != static_cast<std::int32_t>(c) &&
                  (found.empty() || found.back() != other) &&
                  (grid.point(j) - grid.point(i)).squaredNorm() < near2) {
                found.push_back(other);
              }
            }
          }
        }
        std::sort(found.begin(), found.end());
        found.erase(std::unique(found.begin(), found.end()), found.end());
      },
      4);
  std::vector<std::vector<std::size_t>> links(count);
  for (std::size_t c = 0; c < count; ++c) {
    for (const std::int32_t other : neighbours[c]) {
      links[c].push_back(static_cast<std::size_t>(other));
      links[static_cast<std::size_t>(other)].push_back(c);
    }
  }
  std::vector<std::uint8_t> out(count, 0);
  std::vector<std::size_t> open;
  for (std::size_t c = 0; c < count; ++c) {
    if (large[c] != 0) {
      out[c] = 1;
      open.push_back(c);
    }
  }
  while (!open.empty()) {
    const std::size_t c = open.back();
    open.pop_back();
    for (const std::size_t other : links[c]) {
      if (out[other] == 0) {
        out[other] = 1;
        open.push_back(other);
      }
    }
  }
  return out;
}

std::vector<std::uint32_t> samples_of(const Sheets& sheets, const RangeGrid& grid, std::size_t component) {
  const SheetComponent& c = sheets.components[component];
  std::vector<std::uint32_t> out;
  for (int row = c.first_row; row <= c.last_row; ++row) {
    for (int col = c.first_col; col <= c.last_col; ++col) {
      const std::size_t i = grid.index(row, col);
      if (sheets.label[i] == static_cast<std::int32_t>(component)) {
        out.push_back(static_cast<std::uint32_t>(i));
      }
    }
  }
  return out;
}

}  // namespace dubsar
