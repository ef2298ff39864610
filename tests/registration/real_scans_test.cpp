// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "core/units.h"
#include "registration/registrar.h"
#include "tests/registration/support/gauge.h"
#include "tests/registration/support/read_range_ply.h"

namespace dubsar {
namespace {

TEST(RealScans, BunnyWithNoHints) {
  const auto data = testing::data_folder();
  if (!data || !std::filesystem::exists(*data / "stanford_bunny" / "bun.conf")) {
    GTEST_SKIP() << "no real scans here; set DUBSAR_DATA to the folder that holds stanford_bunny";
  }
  const auto truth = testing::read_conf(*data / "stanford_bunny" / "bun.conf", 1000.0);
  std::vector<std::shared_ptr<const RangeGrid>> grids;
  for (RangeGrid& grid : testing::read_folder(*data / "stanford_bunny", 1000.0)) {
    grids.push_back(std::make_shared<const RangeGrid>(std::move(grid)));
  }
  ASSERT_EQ(grids.size(), 10U);
  Registrar registrar;
  JobContext job;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    registrar.add(static_cast<int>(k), grids[k], nullptr, job);
  }
  ASSERT_TRUE(registrar.finalize(job));
  for (const testing::GaugeError& error : testing::gauge_errors(registrar.poses(), truth, grids)) {
    EXPECT_EQ(error.pose.status, PoseStatus::kRegistered) << error.pose.file << ": " << error.pose.reason;
    EXPECT_LT(deg_from_rad(error.turn_rad), 0.5) << error.pose.file;
    EXPECT_LT(error.shift_mm, 0.5) << error.pose.file;
  }
}

}  // namespace
}  // namespace dubsar
