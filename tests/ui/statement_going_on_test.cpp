// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator is told of a session that no run goes on with.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "ui/operator/statement.h"

namespace dubsar::ui {
namespace {

using ::testing::HasSubstr;

/// One scan that fits, and 12 mm² that are red yet, for which the tablet would have to be turned.
LiveState left_in_the_middle(std::optional<Placement> placement) {
  LiveState state;
  LiveScan scan;
  scan.pose = ScanPose{};
  scan.pose->status = PoseStatus::kRegistered;
  state.scans.push_back(scan);
  auto map = std::make_shared<RedMap>();
  map->scans.push_back({});
  RedRegion region;
  region.area_mm2 = 12;
  map->regions.push_back(region);
  NextView next;
  next.say = "turn the right edge towards the camera, 128°; then turntable to 80°, tilt to 70°";
  next.placement = std::move(placement);
  map->next.push_back(next);
  state.red_map = map;
  return state;
}

Placement turned_by_hand() {
  Placement placement;
  placement.hand_turn = RigidTransform{};
  return placement;
}

/// A run begins with a scan of how the tablet lies: who obeyed the red map's turn would turn it twice.
TEST(StatementGoingOn, AMotorDrivenSessionGoesOnWithTheTabletAsItLies) {
  LiveState state = left_in_the_middle(turned_by_hand());
  state.is_driven = true;
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "12.0 mm² are still red: scan on");
  EXPECT_EQ(s.detail, "Leave the tablet as it lies and go on: one scan shows how it lies.");
  state.phase = LivePhase::kWaiting;  // and has no step to ask a turn for
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Leave the tablet as it lies, and scan");
  EXPECT_EQ(s.detail, "");
  EXPECT_TRUE(s.may_scan);
}

TEST(StatementGoingOn, WhereNothingDrivesTheScannerTheTabletIsTurnedBefore) {
  const LiveState state = left_in_the_middle(std::nullopt);
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).detail, HasSubstr("Turn the right edge"));
}

/// Its geometry is known, so the red map knows placements; but nobody can tell it where to go.
TEST(StatementGoingOn, ARigThatNothingDrivesHasTheTabletTurnedByHand) {
  LiveState state = left_in_the_middle(turned_by_hand());
  const std::string english =
      "Turn the right edge towards the camera, 128°; then turntable to 80°, tilt to 70°";
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).detail, english + ".");
  state.phase = LivePhase::kWaiting;
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, english);
  EXPECT_THAT(s.detail, HasSubstr("Then scan"));
  EXPECT_THAT(statement_of(state, true, Language::kGerman).headline,
              HasSubstr("Den rechten Rand zur Kamera"));
  // One whose next view is of the tablet as it lies has nothing to say.
  auto map = std::make_shared<RedMap>(*state.red_map);
  map->next.front().say.clear();
  state.red_map = map;
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Leave the tablet as it lies, and scan");
}

/// No scan is taken only to be able to sign.
TEST(StatementGoingOn, AVerdictThatIsNotKeptYetIsWorkedOutByTheKeyThatSignsIt) {
  LiveState state = left_in_the_middle(std::nullopt);
  state.verdict_kept = false;
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_TRUE(s.may_finish);
  EXPECT_FALSE(s.may_sign);
  state.error = Error{ErrorKind::kDevice, "the camera is gone", {}, "plug it in"};
  EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_finish);
  state.error.reset();
  state.verdict_kept = true;
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_FALSE(s.may_finish);
  EXPECT_TRUE(s.may_sign);
}

TEST(StatementGoingOn, NamesAreSeenFromRightToLeftWhereTheirLettersRunSo) {
  LiveState state = left_in_the_middle(std::nullopt);
  state.signed_off = true;
  state.signed_by = "\u05D0\u05D1";
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline,
            "Signed by \u05D1\u05D0: make the package");
}

}  // namespace
}  // namespace dubsar::ui
