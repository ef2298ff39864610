// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "bench/support/row_of_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <vector>

namespace dubsar {
namespace {

/// What a scan shows of the tablet's middle line, in the tablet's frame.
struct Shown {
  double low_mm = 1e9, high_mm = -1e9;
};

Shown shown_by(const bench::TrueScan& scan) {
  Shown out;
  for (std::size_t i = 0; i < scan.grid->size(); ++i) {
    const Eigen::Vector3d p_mm = scan.tablet_from_scanner * scan.grid->point(i).cast<double>();
    if (scan.grid->valid[i] != 0 && std::abs(p_mm.y()) < 1) {
      out.low_mm = std::min(out.low_mm, p_mm.x());
      out.high_mm = std::max(out.high_mm, p_mm.x());
    }
  }
  return out;
}

TEST(RowOfScans, EachSharesAQuarterWithTheNextAndNothingWithTheOneAfter) {
  bench::RowOptions options;
  options.spacing_mm = 0.5;
  for (const auto& row : bench::rows_of_scans(options)) {
    ASSERT_EQ(row.size(), 5U);
    std::vector<Shown> shown;
    std::ranges::transform(row, std::back_inserter(shown), shown_by);
    EXPECT_NEAR(shown.front().low_mm, -35, 1);
    EXPECT_NEAR(shown.back().high_mm, 35, 1);
    for (std::size_t k = 1; k < row.size(); ++k) {
      const double seam_mm = options.seam_mm(static_cast<int>(k));
      // A column is a spacing wide, and may slant by the 10 degrees of a hand.
      EXPECT_NEAR(shown[k - 1].high_mm - shown[k].low_mm, 0.25 * 17.5, 1) << k;
      EXPECT_NEAR(0.5 * (shown[k - 1].high_mm + shown[k].low_mm), seam_mm, 0.5) << k;
    }
    for (std::size_t k = 2; k < row.size(); ++k) {
      EXPECT_GT(shown[k].low_mm, shown[k - 2].high_mm) << k;
    }
  }
}

TEST(RowOfScans, ASecondSetHasAnotherScanAtEveryPlace) {
  bench::RowOptions options;
  options.spacing_mm = 0.5;
  const auto rows = bench::rows_of_scans(options);
  ASSERT_EQ(rows.size(), 2U);
  for (std::size_t k = 0; k < 5; ++k) {
    EXPECT_NE(rows[0][k].tablet_from_scanner.row_major(), rows[1][k].tablet_from_scanner.row_major()) << k;
    EXPECT_EQ(rows[0][(k + 1) % 5].tablet_from_scanner.row_major(),
              rows[1][k].tablet_from_scanner.row_major())
        << k;
  }
}

}  // namespace
}  // namespace dubsar
