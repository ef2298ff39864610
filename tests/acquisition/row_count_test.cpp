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

TEST(RowCount, RowsMissedAtTheEndAreCounted) {
  RowCount rows(0, 1, 10);
  EXPECT_EQ(rows.missed_until(30), 0U);  // of a scan of which nothing came, which is another failure
  EXPECT_TRUE(rows.place(5, 0.1));
  EXPECT_TRUE(rows.place(9, 4.2));
  // Rows 5 to 9 went by: the next frame was taken behind the scan.
  EXPECT_FALSE(rows.place(16, 11.2));
  EXPECT_EQ(rows.missed_until(11.2), 5U);
  EXPECT_EQ(rows.missed_until(6.8), 2U);
  EXPECT_TRUE(rows.place(13, 7.9));
  EXPECT_TRUE(rows.place(14, 9.1));
  EXPECT_EQ(rows.missed_until(9.1), 0U);
  EXPECT_EQ(rows.missed_until(10.2), 0U);
}

TEST(RowCount, TheRowThatAnAxisComesToRestOnIsNotMissed) {
  RowCount rows(0, 1, 10);
  EXPECT_TRUE(rows.place(5, 0));
  EXPECT_TRUE(rows.place(13, 8.1));
  EXPECT_EQ(rows.missed_until(9), 0U);
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
