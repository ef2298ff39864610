// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/statement.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <string>

#include "station/device_patience.h"
#include "tests/ui/support/live_states.h"

namespace dubsar::ui {
namespace {

using ::testing::HasSubstr;
using testing::map_with;
using testing::with_scan;

TEST(Statement, AsksForAScannerFirst) {
  const Statement s = statement_of({}, false, Language::kEnglish);
  EXPECT_EQ(s.headline, "Choose a scanner");
  EXPECT_FALSE(s.may_scan);
  EXPECT_FALSE(s.may_undo);
  EXPECT_FALSE(s.may_sign);
}

/// What was scanned elsewhere is judged, signed and packed here.
TEST(Statement, WithoutAScannerOnlyScanningHasToWait) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.scans.front().pose.reset();
  Statement s = statement_of(state, false, Language::kEnglish);
  EXPECT_EQ(s.headline, "A scan is not judged yet: Finish judges it");
  EXPECT_TRUE(s.may_finish);
  EXPECT_FALSE(s.may_scan);
  EXPECT_FALSE(s.may_sign);
  state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(12.5);
  s = statement_of(state, false, Language::kEnglish);
  EXPECT_EQ(s.headline, "Choose a scanner");
  EXPECT_THAT(s.detail, HasSubstr("12.5 mm² are still red: scan on."));
  EXPECT_TRUE(s.may_sign) << "as incomplete, with the reason";
  EXPECT_FALSE(s.may_scan);
  state.verdict_kept = false;
  EXPECT_TRUE(statement_of(state, false, Language::kEnglish).may_finish);
  state.verdict_kept = true;
  state.red_map = map_with(0);
  s = statement_of(state, false, Language::kEnglish);
  EXPECT_EQ(s.headline, "Conclusive: nothing is missing. Sign it");
  EXPECT_TRUE(s.may_sign);
  state.signed_off = true;
  EXPECT_TRUE(statement_of(state, false, Language::kEnglish).may_pack);
  // The chooser keeps the headline over what is lost, as it does where there are no scans.
  state.signed_off = false;
  state.red_map = map_with(12.5);
  state.scans.front().damaged = true;
  s = statement_of(state, false, Language::kEnglish);
  EXPECT_EQ(s.headline, "Choose a scanner");
  EXPECT_THAT(s.detail, HasSubstr("Scan 4 is damaged"));
  EXPECT_EQ(s.tone, Tone::kBad);
}

TEST(Statement, HandsOffWhileTheScannerWorks) {
  for (const LivePhase phase :
       {LivePhase::kOpening, LivePhase::kMoving, LivePhase::kScanning, LivePhase::kJudging}) {
    LiveState state = with_scan(PoseStatus::kRegistered);
    state.phase = phase;
    const Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_EQ(s.tone, Tone::kHandsOff);
    EXPECT_FALSE(s.may_scan);
    EXPECT_TRUE(s.may_stop);
    EXPECT_THAT(s.headline + s.detail, HasSubstr("Hands off"));
    EXPECT_EQ(s.may_halt, phase != LivePhase::kJudging) << "nothing moves while it computes";
  }
}

/// A signature that was read by half would be none.
TEST(Statement, AFolderIsReadToItsEndAndARunThatReadsCanBeStopped) {
  LiveState state;
  state.phase = LivePhase::kReading;
  EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_stop);
  state.reads_folder = true;
  EXPECT_FALSE(statement_of(state, true, Language::kEnglish).may_stop);
}

/// Whatever it was doing, and whatever was pressed.
TEST(Statement, AScannerThatDoesNotAnswerIsStoppedByHand) {
  for (const LivePhase phase : {LivePhase::kOpening, LivePhase::kScanning, LivePhase::kMeasuring}) {
    for (const bool halted : {false, true}) {
      LiveState state = with_scan(PoseStatus::kRegistered);
      state.phase = phase;
      state.halted = halted;
      state.silence = silence_of("rig:museum.toml");
      const Statement english = statement_of(state, true, Language::kEnglish);
      EXPECT_EQ(english.tone, Tone::kBad);
      EXPECT_THAT(english.headline,
                  HasSubstr("The device does not answer: stop the laser and the stage by hand"));
      EXPECT_THAT(english.detail, HasSubstr("What was stored is safe; close the window"));
      EXPECT_FALSE(english.may_scan);
      EXPECT_FALSE(english.may_undo);
      EXPECT_EQ(english.may_halt, !halted) << "it may still be pressed";
      const Statement german = statement_of(state, true, Language::kGerman);
      EXPECT_THAT(german.headline,
                  HasSubstr("Das Gerät antwortet nicht: Laser und Antrieb von Hand abschalten"));
      EXPECT_THAT(german.detail, HasSubstr("das Fenster schließen: das Programm endet dann binnen 10 s"));
    }
  }
}

LiveState waits_for_a_turn(const std::string& say) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.phase = LivePhase::kWaiting;
  state.next = NextView{};
  state.next->say = say;
  state.next->placement = Placement{};
  state.next->placement->hand_turn = RigidTransform{};
  return state;
}

TEST(Statement, SaysHowToTurnTheTablet) {
  LiveState state = waits_for_a_turn("turn the reverse towards the camera, 90°");
  const Statement english = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(english.headline, "Turn the reverse towards the camera, 90°");
  EXPECT_THAT(english.detail, HasSubstr("as shown"));
  EXPECT_TRUE(english.may_scan);
  EXPECT_TRUE(english.may_finish);
  EXPECT_THAT(statement_of(state, true, Language::kGerman).headline, HasSubstr("Rückseite"));
}

/// The same words for hand and motors would have the turntable turned by hand.
TEST(Statement, WhatTheHandDoesAndWhatMotorsDoBehindItAreToldApart) {
  LiveState state =
      waits_for_a_turn("turn the reverse towards the camera, 90°; then turntable to 60°, tilt to 70°");
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Turn the reverse towards the camera, 90°");
  EXPECT_EQ(
      s.detail,
      "Turn the tablet as shown, then scan. The scanner goes by itself: turntable to 60°, tilt to 70°.");
  state.phase = LivePhase::kMoving;
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Hands off: the scanner moves");
  EXPECT_EQ(s.detail, "Turntable to 60°, tilt to 70°.");
  state.next->say = "turn the reverse towards the camera, 90°";
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).detail, "");
}

TEST(Statement, AnEmergencyStopIsToldAtOnce) {
  for (const LivePhase phase : {LivePhase::kOpening, LivePhase::kMoving, LivePhase::kScanning,
                                LivePhase::kJudging, LivePhase::kWaiting, LivePhase::kFinishing}) {
    LiveState state = with_scan(PoseStatus::kRegistered);
    state.phase = phase;
    state.halted = true;
    const Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_EQ(s.tone, Tone::kBad);
    EXPECT_EQ(s.headline, "EMERGENCY STOP pressed");
    EXPECT_FALSE(s.may_scan);
  }
}

TEST(Statement, AnUnsureScanIsToldWithItsReason) {
  LiveState state = with_scan(PoseStatus::kUnsure);
  state.phase = LivePhase::kWaiting;
  state.last_not_taken_up = true;
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Scan 4 is unsure: scan on, or show same places");
  EXPECT_THAT(s.detail, HasSubstr("The overlap is too small."));
  EXPECT_TRUE(s.may_point);
}

/// One by one they would be told as scans that went wrong.
TEST(Statement, AScanOfAGroupApartIsToldWithTheGroup) {
  LiveState state = with_scan(PoseStatus::kUnsure);
  state.phase = LivePhase::kWaiting;
  state.last_not_taken_up = true;
  auto map = std::make_shared<RedMap>(*map_with(12));
  map->apart = {{{2, 3}, "scans 2 and 3 fit one another"}};
  state.red_map = map;
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).detail, HasSubstr("The overlap is too small."));
  state.next = NextView{};
  state.next->say = "turn the top edge towards the camera, 40°";
  map->apart.push_back({{1, 4}, "scans 1 and 4 fit one another, and not scan 0"});
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Scan 4 is unsure: scan on, or show same places");
  EXPECT_THAT(s.detail, HasSubstr("Scans 1 and 4 fit one another, and not scan 0."));
  EXPECT_THAT(s.detail, ::testing::Not(HasSubstr("The overlap is too small.")));
  EXPECT_THAT(s.detail, ::testing::Not(HasSubstr("top edge"))) << "two ways to turn it";
  state.next->placement = Placement{};
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).detail, HasSubstr("top edge")) << "motors go";
  state.phase = LivePhase::kStill;
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).detail,
              HasSubstr("Scans 2 and 3 fit one another."));
}

/// What motors do is not asked of the operator.
TEST(Statement, WhereMotorsGoIsToldAndThatTheTabletStays) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.phase = LivePhase::kWaiting;
  state.next = NextView{};
  state.next->say = "turntable to 320°, tilt to 70°";
  state.next->placement = Placement{};
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Leave the tablet as it lies, and scan");
  EXPECT_EQ(s.detail, "The scanner goes by itself: turntable to 320°, tilt to 70°.");
  state.last_not_taken_up = true;
  state.scans.back().pose->status = PoseStatus::kUnsure;
  EXPECT_THAT(statement_of(state, true, Language::kGerman).detail,
              HasSubstr("Der Scanner fährt selbst: Drehteller auf 320°, Neigung auf 70°."));
}

TEST(Statement, WhatIsShownInBlueIsCalledBlue) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(2.5);
  EXPECT_EQ(statement_of(state, true, {Language::kEnglish, true}).headline,
            "2.5 mm² are still blue: scan on");
  EXPECT_EQ(statement_of(state, true, {Language::kGerman, true}).headline,
            "2,5 mm² sind noch blau: weiter scannen");
  for (int k = 0; k < static_cast<int>(Text::kCount); ++k) {
    const auto text = static_cast<Text>(k);
    if (text != Text::kColourBlind) {
      const std::string english = std::string(" ") + text_of(text, {Language::kEnglish, true}) + " ";
      const std::string german = std::string(" ") + text_of(text, {Language::kGerman, true}) + " ";
      EXPECT_FALSE(std::regex_search(english, std::regex("[^a-z]red[^a-z]"))) << english;
      EXPECT_FALSE(std::regex_search(german, std::regex("[^a-z]rot[^a-z]"))) << german;
    }
  }
}

/// A scanner that nothing drives: what the red map proposes is all that is known of the next view.
TEST(Statement, WithoutMotorsTheRedMapSaysHowToTurn) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.phase = LivePhase::kWaiting;
  auto map = std::make_shared<RedMap>(*map_with(12));
  map->scans.push_back({});
  map->scans.back().id = 4;
  NextView next;
  next.say = "turn the reverse towards the camera, 90°";
  map->next.push_back(next);
  state.red_map = map;
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Turn the reverse towards the camera, 90°");
  EXPECT_THAT(s.detail, HasSubstr("Then scan"));
  EXPECT_TRUE(s.may_scan);
  EXPECT_EQ(statement_of(state, true, Language::kGerman).headline, "Die Rückseite zur Kamera drehen, 90°");
  // A scan later, while that one is judged and until the map tells of it.
  LiveScan another;
  another.id = 5;
  state.scans.push_back(another);
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline, HasSubstr("Working out"));
  EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_scan);
  state.scans.back().pose = state.scans.front().pose;
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline, HasSubstr("Working out"));
  map->scans.push_back({});
  map->scans.back().id = 5;
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline, HasSubstr("Turn the reverse"));
}

/// The red map does not count it, and waits for no other word on it.
TEST(Statement, ACopyIsJudgedOnceTheMapNamesIt) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.phase = LivePhase::kWaiting;
  const LiveScan& scan = state.scans.front();
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline, HasSubstr("Working out"));
  EXPECT_FALSE(copy_of(state, scan));
  auto map = std::make_shared<RedMap>(*map_with(12));
  map->copies = {{4, 1}};
  state.red_map = map;
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline,
              ::testing::Not(HasSubstr("Working out")));
  EXPECT_EQ(copy_of(state, scan), 1);
  state.scans.front().dropped = true;
  EXPECT_FALSE(copy_of(state, scan));
}

TEST(Statement, AFailedScanIsNotCalledUnsure) {
  LiveState state = with_scan(PoseStatus::kFailed);
  state.phase = LivePhase::kWaiting;
  state.last_not_taken_up = true;
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "No place for scan 4: scan on, or show same places");
  EXPECT_TRUE(s.may_point);
}

TEST(Statement, AScanThatWasSetAsideIsNamedAndNoOther) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.phase = LivePhase::kWaiting;
  state.last_not_taken_up = true;
  LiveScan aside;
  aside.id = 5;
  aside.dropped = aside.set_aside = true;
  aside.note = "something was in the way of scan 5: 12 % of it, where scan 4 looked too, stands in the air";
  state.scans.push_back(aside);
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Scan 5 is set aside: scan again");
  EXPECT_THAT(s.detail, HasSubstr("Something was in the way"));
  EXPECT_FALSE(s.may_point) << "there is nothing to point at";
  EXPECT_FALSE(s.may_undo) << "the key would take out scan 4, which is good";
  EXPECT_THAT(statement_of(state, true, Language::kGerman).detail, HasSubstr("wo auch Scan 4 hinsah"));
  // One that the operator took out is nothing to ask about, and the one before it may go too.
  state.scans.back().set_aside = false;
  EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_undo);
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline.find("unsure"), std::string::npos);
}

TEST(Statement, AScanThatWasBrokenOffIsSaidToBeThere) {
  LiveState none;
  none.broken_off_rows = 431;
  EXPECT_THAT(statement_of(none, true, Language::kEnglish).detail, HasSubstr("broken off is kept"));
  LiveState some = with_scan(PoseStatus::kRegistered);
  some.broken_off_rows = 431;
  EXPECT_THAT(statement_of(some, true, Language::kGerman).detail, HasSubstr("Zeilen: 431"));
  some.broken_off_rows = 0;
  EXPECT_EQ(statement_of(some, true, Language::kEnglish).detail, "");
}

TEST(Statement, RedThatIsSmallIsNotSaidToBeNone) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(0.02);
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline, "< 0.1 mm² are still red: scan on");
}

/// As after a window that was closed in mid scan.
TEST(Statement, AMapThatKnowsOfNoRedYetIsNotSaidToBeNearlyDone) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.scans.back().pose.reset();
  state.red_map = std::make_shared<RedMap>();
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline,
            "A scan is not judged yet: Finish judges it");
}

TEST(Statement, WhatEndedTheRunIsToldWithItsMend) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.error = Error{ErrorKind::kDevice, "the camera is gone", "v4l2:/dev/video0", "plug it in"};
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.tone, Tone::kBad);
  EXPECT_EQ(s.headline, "Stopped: put this right, then go on");
  EXPECT_THAT(s.detail, HasSubstr("the camera is gone"));
  EXPECT_THAT(s.detail, HasSubstr("plug it in"));
  EXPECT_TRUE(s.may_scan) << "it goes on with what is there";
}

/// The key would take the scan before the one that the operator looks at.
TEST(Statement, NothingIsTakenOutWhileAScanComesIn) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  for (const LivePhase phase : {LivePhase::kWaiting, LivePhase::kMoving, LivePhase::kJudging}) {
    state.phase = phase;
    EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_undo);
  }
  state.phase = LivePhase::kScanning;
  EXPECT_FALSE(statement_of(state, true, Language::kEnglish).may_undo);
}

TEST(Statement, UndoIsOfTheNewestThatStands) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.scans.push_back(state.scans.back());
  state.scans.back().id = 5;
  ASSERT_TRUE(newest_standing(state));
  EXPECT_EQ(newest_standing(state)->id, 5);
  state.scans.back().dropped = true;
  EXPECT_EQ(newest_standing(state)->id, 4);
  state.scans.front().dropped = true;
  EXPECT_FALSE(newest_standing(state));
}

TEST(Statement, TheScanThatGivesTheFrameHasNoPlaceInQuestion) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  LiveScan& scan = state.scans.back();
  scan.pose->sigma_mm = 0.0042;
  EXPECT_THAT(place_words(scan, Language::kEnglish), HasSubstr("4.2"));
  scan.pose->sigma_mm = 0;
  EXPECT_EQ(place_words(scan, Language::kEnglish), "");
  scan.pose->sigma_mm = 1;
  scan.pose->status = PoseStatus::kUnsure;
  EXPECT_EQ(place_words(scan, Language::kEnglish), "");
}

}  // namespace
}  // namespace dubsar::ui
