// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "station/session_scans.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(ScanTimes, WhatNoClockCanHaveMeantIsNotTold) {
  const test::TemporaryFolder folder;
  SessionStore store = SessionStore::open_or_create(folder.path() / "session").value();
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  RangeGrid grid;
  grid.allocate(2, 2);
  for (const std::int64_t time_s : {std::int64_t{1}, std::int64_t{4102444800}, std::int64_t{1700000000}}) {
    grid.timestamp_ns = time_s * kSecond_ns;  // since it was switched on; 2100; 2023
    grid.x[0] = static_cast<float>(time_s % 1000);
    ASSERT_TRUE(store.add_grid(grid));
  }
  const std::vector<ScanEntry> entries = scan_entries_of(store);
  ASSERT_EQ(entries.size(), 3U);
  const std::map<int, std::string> stored = stored_times(store);
  EXPECT_FALSE(entries[0].by_device);
  EXPECT_EQ(entries[0].when, stored.at(0));
  EXPECT_FALSE(entries[1].by_device);
  EXPECT_EQ(entries[1].when, stored.at(1));
  EXPECT_TRUE(entries[2].by_device);
  EXPECT_EQ(entries[2].when, "2023-11-14T22:13:20Z");
}

}  // namespace
}  // namespace dubsar
