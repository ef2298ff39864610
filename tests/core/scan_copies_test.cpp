// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/scan_copies.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

namespace dubsar {
namespace {

using ::testing::ElementsAre;

/// Enough samples for several pieces of work.
RangeGrid ramp(int rows, int cols) {
  RangeGrid grid;
  grid.allocate(rows, cols);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    grid.x[i] = static_cast<float>(grid.col_of(i));
    grid.y[i] = static_cast<float>(grid.row_of(i));
    grid.z[i] = 0.1F * grid.x[i];
    grid.valid[i] = i % 7 != 0 ? 1 : 0;
  }
  return grid;
}

TEST(ScanCopies, TellsGridsByTheirSamplesAlone) {
  const RangeGrid grid = ramp(300, 200);
  const auto digest = sample_digest(grid);
  ASSERT_TRUE(digest);
  RangeGrid again = grid;
  again.x[7] = 99;  // of no sample
  again.confidence.assign(again.size(), 1.0F);
  again.source = "again.ply";
  EXPECT_EQ(sample_digest(again), digest);

  for (const std::size_t i : {std::size_t{1}, std::size_t{30001}, grid.size() - 1}) {
    for (auto* axis : {&again.x, &again.y, &again.z}) {
      const float there = std::exchange((*axis)[i], -5.0F);
      EXPECT_NE(sample_digest(again), digest);
      (*axis)[i] = there;
    }
    again.valid[i] ^= 1;
    EXPECT_NE(sample_digest(again), digest);
    again.valid[i] ^= 1;
  }
  std::swap(again.rows, again.cols);
  EXPECT_NE(sample_digest(again), digest);
}

TEST(ScanCopies, NothingOfAGridWithoutASample) {
  RangeGrid empty;
  empty.allocate(5, 5);
  EXPECT_FALSE(sample_digest(empty));
  EXPECT_FALSE(sample_digest(RangeGrid{}));
}

TEST(ScanCopies, AllButTheFirstAreCopiesWhereverTheyLie) {
  const RangeGrid one = ramp(20, 30);
  const RangeGrid other = ramp(30, 20);
  RangeGrid empty;
  empty.allocate(5, 5);
  RigidTransform moved;
  moved.translation_mm.x() = 3;
  const std::vector<PlacedScan> scans{
      {7, &one, nullptr, {}}, {4, &other, nullptr, {}}, {2, &one, nullptr, moved}, {5, &other, nullptr, {}},
      {9, &one, nullptr, {}}, {1, &empty, nullptr, {}}, {0, &empty, nullptr, {}}};
  const std::vector<ScanCopy> copies = copies_among(scans);
  EXPECT_THAT(copies, ElementsAre(ScanCopy{5, 4}, ScanCopy{7, 2}, ScanCopy{9, 2}));
  EXPECT_EQ(copied_from(copies, 9), 2);
  EXPECT_FALSE(copied_from(copies, 2));
}

}  // namespace
}  // namespace dubsar
