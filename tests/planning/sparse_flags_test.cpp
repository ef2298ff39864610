// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/sparse_flags.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "core/random.h"
#include "core/units.h"

namespace dubsar {
namespace {

RangeGrid height_field(int rows, int cols, double spacing_mm, const std::function<double(int, int)>& height) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  grid.spacing_mm = spacing_mm;
  for (int r = 0; r < rows; ++r) {
    for (int c = 0; c < cols; ++c) {
      const std::size_t i = grid.index(r, c);
      grid.x[i] = static_cast<float>(c * spacing_mm);
      grid.y[i] = static_cast<float>(r * spacing_mm);
      grid.z[i] = static_cast<float>(height(r, c));
      grid.valid[i] = 1;
    }
  }
  return grid;
}

RangeGrid plane(int rows, int cols) {
  return height_field(rows, cols, 0.1, [](int, int) { return 0.0; });
}

/// Steps 1 and 2 of seed 001, 3.3, sample by sample, as they read.
SampleFlags reference_flags(const RangeGrid& grid, const SampleFlags& before = {}) {
  const auto there = [&](int r, int c) {
    return grid.is_valid(r, c) && grid.point(grid.index(r, c)).allFinite() &&
           (before.empty() || (before[grid.index(r, c)] & kNotTablet) == 0);
  };
  const auto near = [&](int r, int c, int r2, int c2) {
    return there(r2, c2) && (grid.point(grid.index(r, c)) - grid.point(grid.index(r2, c2))).norm() <=
                                static_cast<float>(3.0 * grid.spacing_mm);
  };
  const auto potentially_sparse = [&](int r, int c) {
    return !there(r, c) || !near(r, c, r, c + 1) || !near(r, c, r, c - 1) || !near(r, c, r + 1, c) ||
           !near(r, c, r - 1, c);
  };
  SampleFlags flags(grid.size(), 0);
  for (int r = 0; r < grid.rows; ++r) {
    for (int c = 0; c < grid.cols; ++c) {
      const std::size_t i = grid.index(r, c);
      if (!before.empty()) {
        flags[i] = before[i] & kNotTablet;
      }
      if (!there(r, c)) {
        continue;
      }
      int around = 0;
      for (int dr = -1; dr <= 1; ++dr) {
        for (int dc = -1; dc <= 1; ++dc) {
          around += (dr != 0 || dc != 0) && potentially_sparse(r + dr, c + dc) ? 1 : 0;
        }
      }
      flags[i] |= potentially_sparse(r, c) ? kPotentiallySparse : 0;
      flags[i] |= around > 4 ? kSparse : 0;
    }
  }
  return flags;
}

SampleFlags streamed(const RangeGrid& whole) {
  RangeGrid grid;
  grid.cols = whole.cols;
  grid.spacing_mm = whole.spacing_mm;
  SparseFlagger flagger(whole.cols, whole.spacing_mm);
  SampleFlags flags;
  const auto cols = static_cast<std::ptrdiff_t>(whole.cols);
  for (int r = 0; r < whole.rows; ++r) {
    const auto append = [&](auto& to, const auto& from) {
      to.insert(to.end(), from.begin() + r * cols, from.begin() + (r + 1) * cols);
    };
    append(grid.x, whole.x);
    append(grid.y, whole.y);
    append(grid.z, whole.z);
    append(grid.valid, whole.valid);
    ++grid.rows;
    flagger.update(grid, flags);
  }
  flagger.finish(grid, flags);
  return flags;
}

void expect_all_agree(const RangeGrid& grid) {
  const SampleFlags expected = reference_flags(grid);
  EXPECT_EQ(flag_sparse(grid), expected);
  EXPECT_EQ(streamed(grid), expected);
}

int count(const SampleFlags& flags, std::uint8_t bit) {
  int n = 0;
  for (const std::uint8_t f : flags) {
    n += (f & bit) != 0 ? 1 : 0;
  }
  return n;
}

TEST(SparseFlags, AStraightBorderTurnsRedAndNothingElse) {
  const RangeGrid grid = plane(20, 30);
  const SampleFlags flags = flag_sparse(grid);
  for (int r = 0; r < 20; ++r) {
    for (int c = 0; c < 30; ++c) {
      // Diagonally inside a corner, five of the eight cells lie on the border.
      const bool inner_corner = (r == 1 || r == 18) && (c == 1 || c == 28);
      const bool border = r == 0 || c == 0 || r == 19 || c == 29 || inner_corner;
      EXPECT_EQ(is_red(flags[grid.index(r, c)]), border) << r << "," << c;
    }
  }
  expect_all_agree(grid);
}

TEST(SparseFlags, ASingleLostSampleTurnsNothingRed) {
  RangeGrid grid = plane(15, 15);
  grid.valid[grid.index(7, 7)] = 0;
  const SampleFlags flags = flag_sparse(grid);
  EXPECT_EQ(count(flags, kSparse), 4 * 14 + 4);
  EXPECT_EQ(count(flags, kPotentiallySparse), 4 * 14 + 4);
  expect_all_agree(grid);
}

TEST(SparseFlags, AHoleIsRinged) {
  RangeGrid grid = plane(20, 20);
  for (int r = 8; r < 12; ++r) {
    for (int c = 8; c < 12; ++c) {
      grid.valid[grid.index(r, c)] = 0;
    }
  }
  const SampleFlags flags = flag_sparse(grid);
  EXPECT_TRUE(is_red(flags[grid.index(9, 7)]));
  EXPECT_TRUE(is_red(flags[grid.index(12, 10)]));
  EXPECT_FALSE(is_red(flags[grid.index(9, 6)]));
  EXPECT_EQ(flags[grid.index(9, 9)], 0);
  expect_all_agree(grid);
}

TEST(SparseFlags, SlopesOf69And71DegreesLieOnBothSidesOfTheLimit) {
  for (const bool along_rows : {false, true}) {
    for (const double deg : {69.0, 71.0, -69.0, -71.0}) {
      const double rise_mm = 0.1 * std::tan(rad_from_deg(deg));
      const RangeGrid grid =
          height_field(12, 12, 0.1, [&](int r, int c) { return (along_rows ? c : r) * rise_mm; });
      const SampleFlags flags = flag_sparse(grid);
      EXPECT_EQ(is_red(flags[grid.index(6, 6)]), std::abs(deg) > 70) << deg;
      expect_all_agree(grid);
    }
  }
}

TEST(SparseFlags, BothSidesOfAnOcclusionStepAreRed) {
  for (const bool along_rows : {true, false}) {
    const RangeGrid grid =
        height_field(20, 20, 0.1, [&](int r, int c) { return (along_rows ? c : r) < 10 ? 0.0 : 1.5; });
    const SampleFlags flags = flag_sparse(grid);
    for (int k = 7; k < 13; ++k) {
      const std::size_t i = along_rows ? grid.index(10, k) : grid.index(k, 10);
      EXPECT_EQ(is_red(flags[i]), k == 9 || k == 10) << k;
    }
    expect_all_agree(grid);
  }
  // A step that runs across the grid, and one that ends in it.
  expect_all_agree(height_field(20, 20, 0.1, [](int r, int c) { return r + c < 20 ? 0.0 : 1.5; }));
  expect_all_agree(height_field(20, 20, 0.1, [](int r, int c) { return c < 10 || r < 8 ? 0.0 : 1.5; }));
}

TEST(SparseFlags, AGapOneSampleWideTurnsBothItsSidesRed) {
  for (const bool column : {true, false}) {
    RangeGrid grid = plane(15, 15);
    for (int k = 0; k < 15; ++k) {
      grid.valid[column ? grid.index(k, 7) : grid.index(7, k)] = 0;
    }
    const SampleFlags flags = flag_sparse(grid);
    for (int k = 5; k < 10; ++k) {
      EXPECT_EQ(is_red(flags[column ? grid.index(4, k) : grid.index(k, 4)]), k == 6 || k == 8) << k;
    }
    expect_all_agree(grid);
  }
}

TEST(SparseFlags, SingleGapsBesideEachOtherAndBesideTheBorder) {
  using Cells = std::vector<std::pair<int, int>>;
  for (const Cells& lost : {Cells{{7, 7}, {7, 8}}, Cells{{7, 7}, {8, 7}}, Cells{{7, 7}, {8, 8}},
                            Cells{{7, 7}, {7, 9}}, Cells{{7, 7}, {9, 9}}, Cells{{0, 7}}, Cells{{7, 0}},
                            Cells{{14, 14}}, Cells{{1, 1}}, Cells{{1, 7}}, Cells{{7, 13}}, Cells{{2, 2}}}) {
    RangeGrid grid = plane(15, 15);
    for (const auto& [row, col] : lost) {
      grid.valid[grid.index(row, col)] = 0;
    }
    expect_all_agree(grid);
  }
  // Two that meet at a corner leave a cell with six of eight around it that are not well sampled.
  RangeGrid grid = plane(15, 15);
  grid.valid[grid.index(7, 7)] = grid.valid[grid.index(8, 8)] = 0;
  const SampleFlags flags = flag_sparse(grid);
  EXPECT_TRUE(is_red(flags[grid.index(7, 8)]));
  EXPECT_TRUE(is_red(flags[grid.index(8, 7)]));
  EXPECT_FALSE(is_red(flags[grid.index(6, 7)]));
}

TEST(SparseFlags, AgreesWithTheReferenceOnRandomGrids) {
  Random random(7);
  for (int k = 0; k < 60; ++k) {
    const int rows = 1 + static_cast<int>(random.below(130));
    const int cols = 1 + static_cast<int>(random.below(40));
    const double rough_mm = random.uniform(0.0, 0.4);
    const double lost = random.uniform(0.0, 0.5);
    RangeGrid grid =
        height_field(rows, cols, 0.1, [&](int, int) { return rough_mm * random.uniform(-1.0, 1.0); });
    for (std::size_t i = 0; i < grid.size(); ++i) {
      grid.valid[i] = random.uniform() < lost ? 0 : 1;
      if (random.below(200) == 0) {
        grid.z[i] = random.below(2) == 0 ? std::numeric_limits<float>::quiet_NaN()
                                         : std::numeric_limits<float>::max();
      }
    }
    expect_all_agree(grid);
  }
}

TEST(SparseFlags, DegenerateGrids) {
  for (const auto& [rows, cols] : {std::pair{0, 0}, {1, 1}, {1, 9}, {9, 1}, {2, 2}, {0, 5}}) {
    expect_all_agree(plane(rows, cols));
  }
}

TEST(SparseFlags, PinsCountAsMissingAndAreNeverRed) {
  const RangeGrid grid = plane(60, 20);
  SampleFlags flags(grid.size(), 0);
  for (int r = 46; r < 51; ++r) {
    for (int c = 8; c < 12; ++c) {
      flags[grid.index(r, c)] = kNotTablet | kSparse;
    }
  }
  const SampleFlags expected = reference_flags(grid, flags);
  reflag_sparse(grid, flags);
  EXPECT_EQ(flags, expected);
  EXPECT_FALSE(is_red(flags[grid.index(48, 9)]));
  EXPECT_TRUE(is_red(flags[grid.index(48, 7)]));
}

TEST(SparseFlags, NewestProfilesDoNotFlashRedWhileStreaming) {
  const RangeGrid whole = plane(10, 20);
  RangeGrid grid = whole;
  SparseFlagger flagger(20, 0.1);
  SampleFlags flags;
  for (int rows = 1; rows <= 10; ++rows) {
    grid.allocate(rows, 20);
    std::copy_n(whole.x.begin(), grid.size(), grid.x.begin());
    std::copy_n(whole.y.begin(), grid.size(), grid.y.begin());
    std::copy_n(whole.valid.begin(), grid.size(), grid.valid.begin());
    const auto touched = flagger.update(grid, flags);
    EXPECT_EQ(touched.first, std::max(0, rows - 3));
    EXPECT_EQ(touched.last, rows);
    for (int c = 1; c < 19; ++c) {
      EXPECT_FALSE(rows > 1 && is_red(flags[grid.index(rows - 1, c)])) << rows << "," << c;
    }
    if (rows >= 3) {
      const SampleFlags expected = reference_flags(whole);
      for (std::size_t i = 0; i < grid.index(rows - 2, 0); ++i) {
        EXPECT_EQ(flags[i], expected[i]);
      }
    }
  }
  flagger.finish(grid, flags);
  EXPECT_TRUE(is_red(flags[grid.index(9, 10)]));
}

}  // namespace
}  // namespace dubsar
