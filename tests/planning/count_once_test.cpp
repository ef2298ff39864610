// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/count_once.h"

#include <gtest/gtest.h>

#include "planning/red_map.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using test::Session;
using test::turned;

RedTarget at(double x, double area_mm2, bool patch) {
  RedTarget target;
  target.position_mm = target.sample_mm = {x, 0, 0};
  target.area_mm2 = area_mm2;
  target.unseen = patch;
  return target;
}

TEST(CountOnce, PatchesAndTheirBorderCountForTheLargerOfBoth) {
  RedTargets red;
  red.cell_mm = 1;
  red.targets = {at(0, 1, true), at(1, 1, true), at(-1, 0.75, false), at(2, 0.25, false)};
  count_once({}, 1.0, red);
  double all_mm2 = 0;
  for (const RedTarget& t : red.targets) {
    all_mm2 += t.area_mm2;
  }
  EXPECT_NEAR(all_mm2, 2.0, 1e-12);
  EXPECT_NEAR(red.targets[2].area_mm2, 0.5, 1e-12) << "the same share of its own";
  red.targets = {at(0, 1, true), at(1, 3, false)};
  count_once({}, 1.0, red);
  EXPECT_NEAR(red.targets[0].area_mm2 + red.targets[1].area_mm2, 3.0, 1e-12);
}

TEST(CountOnce, WhatBordersNoPatchKeepsItsArea) {
  RedTargets red;
  red.cell_mm = 1;
  // A crack runs away from the patch, and another place lies far off.
  red.targets = {at(0, 1, true), at(1, 0.5, false), at(3, 0.5, false), at(5, 0.5, false), at(20, 0.5, false)};
  count_once({}, 0.5, red);
  EXPECT_NEAR(red.targets[0].area_mm2 + red.targets[1].area_mm2, 1.0, 1e-12);
  for (const std::size_t i : {2U, 3U, 4U}) {
    EXPECT_EQ(red.targets[i].area_mm2, 0.5);
  }
  RedTargets only_border;
  only_border.cell_mm = 1;
  only_border.targets = {at(0, 1, false), at(1, 1, false)};
  count_once({}, 0.5, only_border);
  EXPECT_EQ(only_border.targets[0].area_mm2, 1.0);
}

TEST(CountOnce, APitThatNoScanSeesIsAboutAsLargeAsItIs) {
  Session session;
  session.pit_mm = 2;
  for (const auto& [x, y] : {std::pair{0, 0},
                             {40, 0},
                             {-40, 0},
                             {0, 40},
                             {0, -40},
                             {180, 0},
                             {140, 0},
                             {-140, 0},
                             {180, 40},
                             {180, -40}}) {
    session.scan(turned(x, y));
  }
  JobContext job;
  const auto result = make_red_map(session.map.scans(), nullptr, nullptr, {}, job);
  ASSERT_TRUE(result);
  double red_mm2 = 0;
  for (const RedRegion& region : result->map.regions) {
    if (region.state == RegionState::kRed && region.center_mm.z() > 3 &&
        region.center_mm.head<2>().norm() < 3) {
      red_mm2 += region.area_mm2;
    }
  }
  const double pit_mm2 = 3.14159 * session.pit_mm * session.pit_mm;
  EXPECT_GT(red_mm2, 0.7 * pit_mm2);
  EXPECT_LT(red_mm2, 1.6 * pit_mm2);
}

}  // namespace
}  // namespace dubsar
