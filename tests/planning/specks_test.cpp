// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "planning/excuse.h"
#include "planning/red_regions.h"
#include "planning/surface_cover.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using test::kSpacingMm;
using test::Session;
using test::turned;

constexpr double kCellMm = 3 * kSpacingMm;
constexpr double kLargestMm2 = 10 * kSpacingMm * kSpacingMm;

/// A red place that two scans, each from elsewhere, looked straight at in vain.
RedTarget tried_twice(const Eigen::Vector3d& position_mm, double area_mm2) {
  RedTarget target;
  target.position_mm = target.sample_mm = position_mm;
  target.area_mm2 = area_mm2;
  for (const double deg : {0.0, 30.0}) {
    const Eigen::Vector3d towards = turned(deg, 0).rotation.col(2);
    target.tried.push_back({towards, towards, 1.0});
  }
  return target;
}

class Specks : public testing::Test {
 protected:
  Specks() { session_.scan(turned(0, 0)); }
  /// How many of the targets are excused after excuse_specks().
  std::size_t excused(std::vector<RedTarget> targets, double surface_mm2) {
    RedTargets red;
    red.cell_mm = kCellMm;
    red.targets = std::move(targets);
    excuse_specks(session_.map.scans(), SurfaceCover(session_.map.scans()), surface_mm2, {}, red);
    return static_cast<std::size_t>(
        std::ranges::count(red.targets, RegionState::kExcused, &RedTarget::state));
  }
  Session session_;
};

TEST_F(Specks, AStripOfCellsIsNoSpeckThoughEachCellIs) {
  std::vector<RedTarget> strip;
  for (int i = 0; i < 4; ++i) {
    strip.push_back(tried_twice({-2 + 1.2 * kCellMm * i, 0, 5}, 0.8 * kLargestMm2));
  }
  EXPECT_EQ(excused(strip, 1e5), 0U);
  strip.resize(1);
  EXPECT_EQ(excused(strip, 1e5), 1U);
}

TEST_F(Specks, ThoseThatLooksSettleHaveABudgetToo) {
  std::vector<RedTarget> targets;
  for (int i = 0; i < 5; ++i) {
    targets.push_back(tried_twice({-6.0 + 3 * i, 0, 4.5}, i == 0 ? 0.2 : 0.3));
  }
  EXPECT_EQ(excused(targets, 1500), 5U);
  EXPECT_EQ(excused(targets, 900), 3U) << "the smallest first: 0.2 + 0.3 + 0.3 of 0.9 mm2";
}

TEST_F(Specks, SlitsHaveOneBudgetWhicheverRuleGivesThemUp) {
  const SurfaceCover cover(session_.map.scans());
  const auto given_up = [&](double surface_mm2) {
    RedTargets red;
    red.cell_mm = kCellMm;
    red.targets = {tried_twice({-5, 0, 4.6}, 0.15), tried_twice({5, 0, 4.6}, 0.15)};
    for (const double deg : {60.0, 90.0}) {
      const Eigen::Vector3d towards = turned(deg, 0).rotation.col(2);
      red.targets[0].tried.push_back({towards, towards, 1.0});
    }
    excuse_tried(session_.map.scans(), cover, surface_mm2, {}, red);
    EXPECT_EQ(red.targets[0].excuse, Excuse::kUnneeded);
    const std::vector<float> best_chance = {1.0F, 0.0F};
    excuse_out_of_reach(session_.map.scans(), cover, best_chance, surface_mm2, {}, red);
    return std::ranges::count(red.targets, RegionState::kExcused, &RedTarget::state);
  };
  EXPECT_EQ(given_up(1600), 2) << "0.3 of 0.32 mm2";
  EXPECT_EQ(given_up(1000), 1) << "0.15 of 0.2 mm2, and not 0.3";
}

TEST_F(Specks, SlitsThatAreTooManySayWhyTheyStayRed) {
  const SurfaceCover cover(session_.map.scans());
  const auto reason_of_region = [&](double surface_mm2, float best_chance) {
    RedTargets red;
    red.cell_mm = kCellMm;
    red.targets = {tried_twice({5, 0, 4.6}, 0.15)};
    const std::vector<float> chances = {best_chance};
    excuse_out_of_reach(session_.map.scans(), cover, chances, surface_mm2, {}, red);
    const std::vector<RedRegion> regions =
        red_regions(red, session_.map.scans(), model_surface(session_.map.scans()));
    EXPECT_EQ(regions.size(), 1U);
    EXPECT_EQ(regions[0].state, RegionState::kRed);
    return regions[0].reason;
  };
  EXPECT_TRUE(
      reason_of_region(500, 0.0F).starts_with("slit or pit of less than a wedge's size, one of more"));
  EXPECT_EQ(reason_of_region(500, 1.0F), "") << "a view of it is to be had";
}

TEST_F(Specks, BesideClayThatNobodyHasSeenThereIsNone) {
  const RedTarget speck = tried_twice({0, 0, 5}, 0.3);
  RedTarget patch;
  patch.position_mm = patch.sample_mm = {0, 1.7, 5};
  patch.area_mm2 = 2.0;
  patch.unseen = true;
  EXPECT_EQ(excused({speck, patch}, 1e5), 0U);
  patch.position_mm.y() = patch.sample_mm.y() = 6;
  EXPECT_EQ(excused({speck, patch}, 1e5), 1U);
}

TEST_F(Specks, OnTheRimOfAHoleThereIsNone) {
  EXPECT_EQ(excused({tried_twice({2, 0, 4.9}, 0.3)}, 1e5), 1U);
  Session with_pit;
  with_pit.pit_mm = 2;
  with_pit.scan(turned(0, 0));
  with_pit.scan(turned(20, 0));
  std::swap(session_, with_pit);
  EXPECT_EQ(excused({tried_twice({2, 0, 4.9}, 0.3)}, 1e5), 0U);
  EXPECT_EQ(excused({tried_twice({6, 0, 4.3}, 0.3)}, 1e5), 1U);
}

}  // namespace
}  // namespace dubsar
