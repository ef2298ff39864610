// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// When a place is given up because scans looked at it in vain.
#include "planning/vain_look.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/units.h"
#include "planning/excuse.h"
#include "planning/next_view.h"
#include "planning/red_map.h"
#include "planning/view_prediction.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

using test::Session;
using test::turned;
using test::turntable_rig;
using ::testing::Each;
using ::testing::Ge;

VainLook look_from(double about_x_deg, double roll_deg, double chance = 0.9) {
  const Eigen::Matrix3d turn =
      turned(about_x_deg, 0).rotation * Eigen::AngleAxisd(rad_from_deg(roll_deg), Eigen::Vector3d::UnitZ());
  return {turn.col(2), turn * Eigen::Vector3d(0, std::sin(rad_from_deg(24)), std::cos(rad_from_deg(24))),
          chance};
}

TEST(VainLook, WhoDoesNotMoveHasLookedOnce) {
  std::vector<VainLook> looks(4, look_from(0, 0));
  EXPECT_EQ(full_looks_apart(looks), 1U);
  looks.push_back(look_from(10, 0));
  EXPECT_EQ(full_looks_apart(looks), 1U) << "nearly the same shadows";
  looks.push_back(look_from(20, 0));
  EXPECT_EQ(full_looks_apart(looks), 2U);
  looks.push_back(look_from(0, 90));
  EXPECT_EQ(full_looks_apart(looks), 3U) << "the camera stands elsewhere";
  looks.push_back(look_from(60, 0, 0.4));
  EXPECT_EQ(full_looks_apart(looks), 3U) << "that one need not have seen it";
}

TEST(VainLook, LooksOfLittleChanceTakeLessOfAPlacesWorth) {
  const Eigen::Vector3d up(0, 0, 1);
  const auto left = [&](std::vector<VainLook> looks) { return novelty(looks, up); };
  EXPECT_EQ(left({}), 1.0);
  EXPECT_LT(left({look_from(0, 0)}), left({look_from(0, 0, 0.2)}));
  EXPECT_LT(left({look_from(0, 0, 0.2)}), 0.8);
  EXPECT_GT(left({look_from(80, 0)}), 0.75) << "from elsewhere";
  EXPECT_GT(left(std::vector<VainLook>(20, look_from(80, 0))), 0.75) << "twenty times from there";
  EXPECT_LT(left(std::vector<VainLook>(3, look_from(5, 0))), 0.01) << "and from here";
}

double pit_of(const RedMapResult& result, RegionState state, Excuse excuse) {
  double area_mm2 = 0;
  for (const RedRegion& region : result.map.regions) {
    const bool is_there = region.center_mm.head<2>().norm() < 3 && region.center_mm.z() > 0;
    area_mm2 += is_there && region.state == state && region.excuse == excuse ? region.area_mm2 : 0.0;
  }
  return area_mm2;
}

TEST(VainLook, WhatLiesInTheOpenAndGivesNoSignalStaysRedAndIsNamed) {
  JobContext job;
  const Rig rig = turntable_rig();
  const auto mapped = [&](std::initializer_list<double> about_x_deg) {
    Session session;
    session.pit_mm = 2.5;
    for (const double deg : about_x_deg) {
      session.scan(turned(deg, 0));
    }
    return make_red_map(session.map.scans(), nullptr, &rig, {}, job).value();
  };
  const RedMapResult unmoved = mapped({0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_GT(pit_of(unmoved, RegionState::kRed, Excuse::kNone), 10.0);
  EXPECT_EQ(pit_of(unmoved, RegionState::kExcused, Excuse::kUnreachable), 0.0);
  const RedMapResult moved = mapped({0, 20, -20, 40, -40});
  EXPECT_GT(pit_of(moved, RegionState::kRed, Excuse::kNone), 10.0);
  EXPECT_EQ(pit_of(moved, RegionState::kExcused, Excuse::kUnreachable), 0.0);
  EXPECT_FALSE(moved.map.conclusive);
  const auto is_named = [](const RedRegion& region) {
    return region.state == RegionState::kRed && region.center_mm.head<2>().norm() < 3 &&
           region.reason.starts_with("gives no signal");
  };
  EXPECT_EQ(std::ranges::count_if(moved.map.regions, is_named), 1);
  EXPECT_EQ(std::ranges::count_if(unmoved.map.regions, is_named), 0);
}

TEST(VainLook, NoViewIsPlannedForWhatGaveNoSignalEightTimes) {
  Session session;
  session.scan(turned(0, 0));
  const SurfaceCover cover(session.map.scans());
  RedTargets red;
  red.cell_mm = 0.75;
  RedTarget& target = red.targets.emplace_back();
  target.position_mm = target.sample_mm = {0, 0, 5};
  target.area_mm2 = 4;
  std::vector<ViewCandidate> candidates(1);
  JobContext job;
  const auto ranked = [&](int looks) {
    target.tried.clear();
    for (int k = 0; k < looks; ++k) {
      target.tried.push_back(look_from(20.0 * (k % 4), k < 4 ? 0 : 90));
    }
    excuse_tried(session.map.scans(), cover, 500.0, {}, red);
    return next_views(candidates, ScannerModel::of(*session.grids.front(), 0.02),
                      model_surface(session.map.scans()), red.targets, {}, job)
        .value()
        .ranked.size();
  };
  EXPECT_EQ(ranked(4), 1U);
  EXPECT_TRUE(target.no_signal);
  EXPECT_EQ(ranked(8), 0U);
  EXPECT_EQ(target.state, RegionState::kRed);
}

TEST(VainLook, ASpeckIsSettledByLooksFromTwoPlaces) {
  Session session;
  session.scan(turned(0, 0));
  const SurfaceCover cover(session.map.scans());
  const auto state_after = [&](std::vector<VainLook> looks) {
    RedTargets red;
    red.cell_mm = 0.75;
    RedTarget& target = red.targets.emplace_back();
    target.position_mm = target.sample_mm = {0, 0, 5};
    target.area_mm2 = 0.3;
    target.tried = std::move(looks);
    excuse_specks(session.map.scans(), cover, 500.0, {}, red);
    return red.targets.front().state;
  };
  EXPECT_EQ(state_after(std::vector<VainLook>(3, look_from(0, 0))), RegionState::kRed);
  EXPECT_EQ(state_after({look_from(0, 0), look_from(30, 0)}), RegionState::kExcused);
}

/// One place that faces up, and the only pose from which it can be looked at, at a slope of 69°.
struct Grazed {
  Session session;
  RedTargets red;
  std::vector<ViewCandidate> candidates{1};
  ScannerModel scanner;
  JobContext job;

  Grazed() {
    session.scan(turned(0, 0));
    candidates.front().model_from_scanner = turned(68, 0);
    red.cell_mm = 0.75;
    RedTarget& target = red.targets.emplace_back();
    target.position_mm = {0, 0, 5.5};
    target.area_mm2 = 4;
    scanner = ScannerModel::of(*session.grids.front(), 0.02);
    scanner.view.camera_mm.reset();
    scanner.view.laser_mm.reset();
  }
  [[nodiscard]] NextViews views(const NextViewOptions& options = {}) {
    return next_views(candidates, scanner, model_surface(session.map.scans()), red.targets, options, job)
        .value();
  }
};

TEST(VainLook, AfterLooksOfSomeChanceNoPosePromisesAnyMore) {
  Grazed one;
  const double plain = one.views().best_chance.front();
  ASSERT_GT(plain, 0.05);
  ASSERT_LT(plain, kTriedChance);
  const SurfaceCover cover(one.session.map.scans());
  const auto excuse = [&] {
    excuse_tried_out(one.session.map.scans(), cover, one.views(), 500.0, {}, one.red);
    return one.red.targets.front().excuse;
  };
  RedTarget& target = one.red.targets.front();
  target.tried.assign(3, look_from(68, 0, plain));
  EXPECT_EQ(excuse(), Excuse::kNone) << "three looks are not enough";
  target.tried.assign(6, look_from(68, 0, plain));
  EXPECT_EQ(one.views().best_chance.front(), static_cast<float>(plain));
  EXPECT_EQ(excuse(), Excuse::kUnreachable);
}

TEST(VainLook, WhatIsThinnedOutIsJudgedToo) {
  Grazed some;
  some.red.targets.resize(7, some.red.targets.front());
  some.red.targets[5].normal = {0, 0, -1};  // away from the only pose
  NextViewOptions options;
  options.max_targets = 2;
  const NextViews views = some.views(options);
  EXPECT_THAT(views.best_chance, Each(Ge(0.0F)));
  EXPECT_EQ(views.best_chance[5], 0.0F);
  EXPECT_GE(views.best_chance[4], 0.05F);
}

/// Where the first may not be driven to, the next one is.
TEST(VainLook, OthersAreProposedThoughTheMostWorthyOverlapTooLittle) {
  Session session;
  session.scan(turned(0, 0));
  std::vector<RedTarget> targets(2);
  targets[0].position_mm = targets[0].sample_mm = {0, 0, 5};
  targets[0].area_mm2 = 1;
  targets[1].position_mm = targets[1].sample_mm = {0, 0, -5};
  targets[1].normal = {0, 0, -1};
  targets[1].area_mm2 = 5;
  std::vector<ViewCandidate> candidates(30);
  for (std::size_t i = 0; i < 23; ++i) {
    candidates[i].model_from_scanner = turned(180, 0);
  }
  JobContext job;
  const NextViews views = next_views(candidates, ScannerModel::of(*session.grids.front(), 0.02),
                                     model_surface(session.map.scans()), targets, {}, job)
                              .value();
  EXPECT_EQ(views.ranked.size(), 5U);
  for (const NextView& view : views.ranked) {
    EXPECT_LT(view.predicted_cleared_mm2, 2) << "of the side that was seen";
  }
}

/// A rig tells where laser and camera stand at a grid's middle row, and where they stand now.
TEST(VainLook, AScanLookedFromWhereItsOwnLaserStood) {
  Session session;
  session.scan(turned(0, 0));
  const auto scans = session.map.scans();
  Rig rig = turntable_rig();
  rig.view.laser_mm = Eigen::Vector3d(250, 0, 0);
  const double noise_mm[] = {0.02};
  std::vector<RedTarget> targets(1);
  targets[0].position_mm = targets[0].sample_mm = {0, 0, 5.5};
  note_tries(scans, &rig, noise_mm, model_surface(scans), targets);
  EXPECT_EQ(targets[0].tried.size(), 1U);
}

TEST(VainLook, AScanThatWasCutOffLookedNoFartherThanItsRows) {
  Session session;
  session.scan(turned(0, 0));
  RangeGrid half = *session.grids.front();
  half.rows = 50;  // its last one lies at y = -1.5 mm
  const std::size_t kept = half.index(half.rows, 0);
  for (std::vector<float>* values : {&half.x, &half.y, &half.z}) {
    values->resize(kept);
  }
  half.valid.resize(kept);
  const SampleFlags flags = flag_sparse(half);
  const PlacedScan cut{0, &half, &flags, turned(0, 0), 0.0};
  const Rig rig = turntable_rig();
  const double noise_mm[] = {0.02};
  std::vector<RedTarget> targets(2);
  targets[0].position_mm = targets[0].sample_mm = {0, -4, 5};
  targets[1].position_mm = targets[1].sample_mm = {0, 4, 5};
  note_tries({&cut, 1}, &rig, noise_mm, model_surface(session.map.scans()), targets);
  EXPECT_EQ(targets[0].tried.size(), 1U);
  EXPECT_TRUE(targets[1].tried.empty());
}

/// Whether or not it looked so far: where no rig is known a new view is supposed to.
TEST(VainLook, AViewThatWasTakenForNothingIsNotAdvisedAgain) {
  Session session;
  session.scan(turned(0, 0));
  const auto scans = session.map.scans();
  const ModelSurface surface = model_surface(scans, nullptr, {});
  const double noise_mm[] = {0.02};
  std::vector<RedTarget> targets(1);
  targets[0].position_mm = targets[0].sample_mm = {11.0, 0, 2.1};  // as deep as the scan's last returns
  targets[0].area_mm2 = 1;
  const ViewCandidate same{scans[0].model_from_scanner, {}, {}, false, {}};
  const ScannerModel scanner = ScannerModel::of(*scans[0].grid, noise_mm[0]);
  const double before = clearing_chances(same, scanner, surface, targets)[0];
  note_tries(scans, nullptr, noise_mm, surface, targets);
  EXPECT_TRUE(targets[0].tried.empty()) << "which no excuse may rest on";
  EXPECT_EQ(targets[0].perhaps.size(), 1U);
  EXPECT_GT(before, 0.5);
  EXPECT_LT(clearing_chances(same, scanner, surface, targets)[0], 0.5 * before);
  // What the last specks are excused by is as if it had not been taken.
  JobContext job;
  const auto best_gain_mm2 = [&](std::vector<VainLook> perhaps) {
    targets[0].perhaps = std::move(perhaps);
    return next_views({&same, 1}, scanner, surface, targets, {}, job).value().best_gain_mm2;
  };
  const std::vector<VainLook> noted = targets[0].perhaps;
  EXPECT_GT(best_gain_mm2({}), 0.5);
  EXPECT_EQ(best_gain_mm2(noted), best_gain_mm2({}));
}

}  // namespace
}  // namespace dubsar
