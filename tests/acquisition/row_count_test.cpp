// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/row_count.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(RowCount, FramesOfTheScanAreItsRows) {
  RowCount rows(10, 0.05, 21);
  EXPECT_FALSE(rows.place(500, 9.96));  // it gathers speed
  EXPECT_FALSE(rows.any());
  for (int k = 0; k < 21; ++k) {
    // A little off, as frames and stage are.
    const auto placed = rows.place(501 + k, 10 + 0.05 * (k + (k % 2 == 0 ? 0.2 : -0.2)));
    ASSERT_TRUE(placed);
    EXPECT_EQ(placed->row, k);
    EXPECT_EQ(placed->missed, 0U);
  }
  EXPECT_TRUE(rows.ends_within(0.5, 10.98));
  EXPECT_FALSE(rows.place(522, 11.05));  // it comes to rest
}

TEST(RowCount, RowsMissedAtTheStartAreCountedAndKeepTheirPlace) {
  // The first seven rows passed before the stage told where it was.
  RowCount rows(-20, 0.025, 100);
  const auto placed = rows.place(77, -20 + 7 * 0.025 + 0.004);
  ASSERT_TRUE(placed);
  EXPECT_EQ(placed->row, 7);
  EXPECT_EQ(placed->missed, 7U);
  EXPECT_EQ(rows.place(78, -20 + 8 * 0.025)->missed, 0U);
}

TEST(RowCount, FramesLostOnTheWayLeaveTheirRowsEmpty) {
  RowCount rows(0, 1, 10);
  EXPECT_EQ(rows.place(5, 0.1)->row, 0);
  const auto later = rows.place(9, 4.0);
  ASSERT_TRUE(later);
  EXPECT_EQ(later->row, 4);
  EXPECT_EQ(later->missed, 3U);
}

TEST(RowCount, NothingIsPlacedOfAStageThatStoodElsewhere) {
  RowCount rows(0, 1, 10);
  EXPECT_FALSE(rows.place(1, -3));
  EXPECT_FALSE(rows.place(2, 12));
  EXPECT_FALSE(rows.any());
  EXPECT_FALSE(rows.ends_within(0.5, 8));
}

}  // namespace
}  // namespace dubsar
