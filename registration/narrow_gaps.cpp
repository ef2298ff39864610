// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/narrow_gaps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdlib>
#include <utility>

#include "core/parallel.h"

namespace dubsar {

namespace {

/// Samples on either side of a gap that show the way to it.
constexpr int kAside = 3;
/// The way across a gap in plain surface turns from the way on either side by less than this (cosine) …
constexpr float kStraight = 0.85F;
/// … as most of those along a dead line do; across a depth step it turns by more than this (cosine).
constexpr float kOneSheet = 0.5F;
constexpr double kLeastStraightShare = 0.5;
/// A dead line stays where it is by so many samples.
constexpr int kMostDrift = 1;
/// Lines that are worked on at a time, so that columns are read by cache lines.
constexpr std::size_t kLinesAtATime = 64;

/// The rows of a grid, or its columns.
struct Lines {
  int count, length;
  std::size_t apart, step;  ///< from one line to the next, and from one sample to the next in a line
  [[nodiscard]] std::size_t at(std::size_t line, int k) const {
    return line * apart + static_cast<std::size_t>(k) * step;
  }
};

/// Between the samples `begin` and `end` of a line.
struct Gap {
  int begin, end;
  std::size_t run;  ///< that it is part of
};

using Gaps = std::vector<std::vector<Gap>>;  ///< of each line

/// A gap that runs straight through neighbouring lines.
struct Run {
  int begin, end;  ///< in the first of them
  int lines = 0;
  int straight = 0;  ///< of them that go on straight across
};

Gaps gaps_in(const Lines& lines, const std::vector<std::uint8_t>& keep, int most_across) {
  Gaps gaps(static_cast<std::size_t>(lines.count));
  parallel_chunks(gaps.size(), kLinesAtATime, [&](std::size_t begin, std::size_t end) {
    std::array<int, kLinesAtATime> last{};  // the sample before, and 1 more
    for (int k = 0; k < lines.length; ++k) {
      for (std::size_t line = begin; line < end; ++line) {
        if (keep[lines.at(line, k)] == 0) {
          continue;
        }
        int& before = last[line - begin];
        if (before > 0 && before < k && k - before <= most_across) {
          gaps[line].push_back({before - 1, k, 0});
        }
        before = k + 1;
      }
    }
  });
  return gaps;
}

/// Says of each gap which run it is part of.
std::vector<Run> joined(Gaps& gaps) {
  std::vector<Run> runs;
  for (std::size_t line = 0; line < gaps.size(); ++line) {
    std::size_t b = 0;
    for (Gap& gap : gaps[line]) {
      const std::size_t before = line > 0 ? gaps[line - 1].size() : 0;
      while (b < before && gaps[line - 1][b].end < gap.begin) {
        ++b;
      }
      gap.run = b < before ? gaps[line - 1][b].run : runs.size();
      if (gap.run == runs.size() || std::abs(runs[gap.run].begin - gap.begin) > kMostDrift ||
          std::abs(runs[gap.run].end - gap.end) > kMostDrift) {
        gap.run = runs.size();
        runs.push_back({gap.begin, gap.end});
      }
      ++runs[gap.run].lines;
    }
  }
  return runs;
}

/// How straight the surface goes on across the gap: the cosine of the larger turn on either side.
float straightness(const RangeGrid& grid, const std::vector<std::uint8_t>& keep, const Lines& lines,
                   std::size_t line, const Gap& gap) {
  const auto aside = [&](int k, int side) {
    for (int away = 0; away < kAside; ++away) {
      const int next = k + side;
      if (next < 0 || next >= lines.length || keep[lines.at(line, next)] == 0) {
        break;
      }
      k = next;
    }
    return grid.point(lines.at(line, k));
  };
  const Eigen::Vector3f from = grid.point(lines.at(line, gap.begin));
  const Eigen::Vector3f to = grid.point(lines.at(line, gap.end));
  const Eigen::Vector3f across = (to - from).normalized();
  return std::min(across.dot((from - aside(gap.begin, -1)).normalized()),
                  across.dot((aside(gap.end, 1) - to).normalized()));
}

/// The rows of a grid and its columns.
std::array<Lines, 2> lines_of(const RangeGrid& grid) {
  const auto cols = static_cast<std::size_t>(grid.cols);
  return {Lines{grid.rows, grid.cols, cols, 1}, Lines{grid.cols, grid.rows, 1, cols}};
}

}  // namespace

std::vector<std::uint8_t> narrow_gaps(const RangeGrid& grid, const std::vector<std::uint8_t>& keep,
                                      const NarrowGapOptions& options) {
  std::vector<std::uint8_t> missing;
  for (const Lines& lines : lines_of(grid)) {
    Gaps gaps = gaps_in(lines, keep, options.most_across);
    std::vector<Run> runs = joined(gaps);
    const auto long_enough = [&](const Gap& gap) { return runs[gap.run].lines >= options.least_along; };
    for (std::size_t line = 0; line < gaps.size(); ++line) {
      std::erase_if(gaps[line], [&](const Gap& gap) { return !long_enough(gap); });
      for (const Gap& gap : gaps[line]) {
        runs[gap.run].straight += straightness(grid, keep, lines, line, gap) >= kStraight ? 1 : 0;
      }
    }
    for (std::size_t line = 0; line < gaps.size(); ++line) {
      for (const Gap& gap : gaps[line]) {
        const Run& run = runs[gap.run];
        if (run.straight >= kLeastStraightShare * run.lines &&
            straightness(grid, keep, lines, line, gap) >= kOneSheet) {
          missing.resize(grid.size(), 0);
          for (int k = gap.begin + 1; k < gap.end; ++k) {
            missing[lines.at(line, k)] = 1;
          }
        }
      }
    }
  }
  return missing;
}

void bridge_gaps(const RangeGrid& grid, const std::vector<std::uint8_t>& hollow, double step_mm,
                 std::vector<std::uint8_t>& boundary) {
  const auto goes_on = [&](std::size_t i, std::size_t j, int steps) {
    return (grid.point(j) - grid.point(i)).norm() <= static_cast<float>(steps * step_mm);
  };
  const auto goes_on_towards = [&](std::size_t i, int dr, int dc) {
    int row = grid.row_of(i) + dr;
    int col = grid.col_of(i) + dc;
    int steps = 1;
    while (grid.inside(row, col) && hollow[grid.index(row, col)] != 0) {
      row += dr;
      col += dc;
      ++steps;
    }
    return grid.is_valid(row, col) && goes_on(i, grid.index(row, col), steps);
  };
  parallel_for_each_index(
      grid.size(),
      [&](std::size_t i) {
        if (boundary[i] != 0 && goes_on_towards(i, 0, 1) && goes_on_towards(i, 0, -1) &&
            goes_on_towards(i, 1, 0) && goes_on_towards(i, -1, 0)) {
          boundary[i] = 0;
        }
      },
      8192);
}

}  // namespace dubsar
