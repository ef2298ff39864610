// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// How many samples of each scan are red, cleared and excused.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "planning/red_map.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

std::int64_t count(const SampleFlags& flags, std::uint8_t bit) {
  return std::ranges::count_if(flags, [&](std::uint8_t f) { return (f & bit) != 0; });
}

/// Against what each scan says of itself, and what the map of clearings says of the two.
TEST(RedCounts, EachSparseSampleIsRedClearedOrExcused) {
  test::Session session;
  session.scan(test::turned(0, 0));
  session.scan(test::turned(60, 0));
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_TRUE(result);
  ASSERT_EQ(result->map.scans.size(), 2U);
  for (std::size_t k = 0; k < 2; ++k) {
    SCOPED_TRACE(k);
    const RedScan& scan = result->map.scans[k];
    ASSERT_EQ(scan.id, static_cast<int>(k));
    const RangeGrid& grid = *session.grids[k];
    const SampleFlags own = flag_sparse(grid);
    EXPECT_EQ(scan.samples, static_cast<std::int64_t>(grid.valid_count()));
    EXPECT_EQ(scan.potentially_sparse, count(own, kPotentiallySparse));
    EXPECT_EQ(scan.sparse + scan.cleared + scan.excused, count(own, kSparse));
    const std::vector<int> by = session.map.cleared_by(scan.id);
    EXPECT_EQ(scan.cleared, std::ranges::count_if(by, [](int id) { return id >= 0; }));
    // Each sees a side of the other's rim from above, and neither the underside.
    EXPECT_GT(scan.cleared, 0);
    EXPECT_GT(scan.sparse, 0);
  }
}

}  // namespace
}  // namespace dubsar
