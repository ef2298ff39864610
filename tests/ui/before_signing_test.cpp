// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What stands in the way of a signature, or is to be read before it: what is excused, damaged, or not judged.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>

#include "tests/ui/support/live_states.h"
#include "ui/operator/before_signing.h"
#include "ui/operator/map_areas.h"
#include "ui/operator/window_title.h"

namespace dubsar::ui {
namespace {

using ::testing::HasSubstr;
using testing::map_with;
using ::testing::Not;
using testing::with_scan;

constexpr auto kReverse = static_cast<std::size_t>(Face::kReverse);

/// Conclusive, with so many mm² of the reverse, and 0.4 of the top edge, that no view gives; 100 were seen.
LiveState with_excused(double mm2) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.seen_mm2.fill(100);
  auto map = std::make_shared<RedMap>();
  map->conclusive = true;
  const auto add = [&](Face face, double area_mm2, const char* reason) {
    RedRegion region;
    region.face = face;
    region.area_mm2 = area_mm2;
    region.state = RegionState::kExcused;
    region.excuse = Excuse::kUnreachable;
    region.reason = reason;
    map->regions.push_back(region);
  };
  add(Face::kReverse, 0.25 * mm2, "no pose reaches it");
  add(Face::kTop, 0.4, "speck: no view is expected to clear as much as one such speck");
  add(Face::kReverse, 0.75 * mm2, "no pose reaches it");
  add(Face::kLeft, 0, "stray return");
  state.red_map = map;
  return state;
}

TEST(BeforeSigning, ASideOfWhichMuchIsExcusedGetsNoTick) {
  LiveState state = with_excused(110.4);
  for (const double seen_mm2 : {100.0, 0.0}) {
    state.seen_mm2[kReverse] = seen_mm2;
    const FaceState reverse = face_state(state, Face::kReverse, Language::kEnglish);
    EXPECT_FALSE(reverse.whole);
    EXPECT_TRUE(reverse.excused);
    EXPECT_FALSE(reverse.lacks);
    EXPECT_THAT(reverse.note, HasSubstr("110.4 mm² excused"));
  }
  const FaceState top = face_state(state, Face::kTop, Language::kEnglish);
  EXPECT_TRUE(top.whole) << "0.4 % is no more than specks";
  EXPECT_FALSE(top.excused);
}

/// Of what is seen of it, what is excused included.
TEST(BeforeSigning, MuchIsMoreThanOneInAHundred) {
  for (const double mm2 : {0.9, 1.1}) {
    LiveState state = with_excused(mm2);
    state.seen_mm2[kReverse] = 100 - mm2;
    const FaceState reverse = face_state(state, Face::kReverse, Language::kEnglish);
    EXPECT_EQ(reverse.whole, mm2 < 1) << mm2;
    EXPECT_EQ(reverse.excused, mm2 > 1) << mm2;
    EXPECT_EQ(statement_of(state, true, Language::kEnglish).tone, mm2 > 1 ? Tone::kAsk : Tone::kGood) << mm2;
  }
}

TEST(BeforeSigning, AConclusiveTabletWithExcusedPlacesIsNotSaidToLackNothing) {
  const Statement much = statement_of(with_excused(110.4), true, Language::kEnglish);
  EXPECT_EQ(much.headline, "Conclusive, but 110.8 mm² are excused: read why, then sign");
  EXPECT_EQ(much.detail, "Excused: Reverse 110.4 mm², Top edge 0.4 mm². Sign shows why.");
  EXPECT_EQ(much.tone, Tone::kAsk);
  EXPECT_TRUE(much.may_sign);
  const Statement german = statement_of(with_excused(110.4), true, Language::kGerman);
  EXPECT_EQ(german.headline,
            "Vollständig, aber 110,8 mm² sind entschuldigt: lesen, warum, dann unterschreiben");
  const Statement specks = statement_of(with_excused(0), true, Language::kEnglish);
  EXPECT_EQ(specks.headline, "Conclusive, but 0.4 mm² are excused: read why, then sign");
  EXPECT_EQ(specks.tone, Tone::kGood);
}

TEST(BeforeSigning, PlacesOfOneSideAndReasonAreToldTogetherLargestFirst) {
  const std::vector<ExcusedPlaces> places = excused_places(*with_excused(8).red_map);
  ASSERT_EQ(places.size(), 2U) << "a stray return lacks no surface";
  EXPECT_EQ(places[0].face, Face::kReverse);
  EXPECT_DOUBLE_EQ(places[0].area_mm2, 8);
  EXPECT_EQ(places[0].reason, "no pose reaches it");
  EXPECT_EQ(places[1].face, Face::kTop);
}

/// It takes no part in the verdict, and yet signing is refused without a reason.
TEST(BeforeSigning, ADamagedScanThatWasTakenOutAsksForTheReason) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(0);
  state.checklist = Checklist{};
  state.checklist->store_whole = true;
  EXPECT_FALSE(signing_reason(state).asked);
  EXPECT_TRUE(is_session_whole(state));
  LiveScan out;
  out.id = 3;
  out.dropped = out.damaged = true;
  state.scans.push_back(out);
  EXPECT_TRUE(signing_reason(state).wanted);
  EXPECT_FALSE(is_session_whole(state));
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Conclusive, but the session is damaged: check, then sign with the reason");
  EXPECT_THAT(s.detail, HasSubstr("Scans that were taken out are damaged: 3."));
  EXPECT_EQ(s.tone, Tone::kWarn);
  EXPECT_TRUE(s.may_sign);
}

/// A signature that was refused has read every byte.
TEST(BeforeSigning, DamageThatOnlySigningFindsAsksForTheReasonNextTime) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(0);
  state.checklist = Checklist{};
  EXPECT_TRUE(signing_reason(state).asked);
  EXPECT_FALSE(signing_reason(state).wanted) << "it may have been mended since, and then none is taken";
  EXPECT_FALSE(is_session_whole(state));
  state.checklist.reset();
  EXPECT_FALSE(signing_reason(state).asked);
  state.damage_found = true;
  EXPECT_TRUE(signing_reason(state).asked);
  state.damage_found = false;
  state.red_map = map_with(2);
  EXPECT_TRUE(signing_reason(state).wanted);
}

TEST(BeforeSigning, ScansThatAreNotJudgedComeBeforeWhatIsRedByTheLackOfThem) {
  for (const double red : {165.3, 0.0}) {
    LiveState state = with_scan(PoseStatus::kRegistered);
    state.red_map = map_with(red);
    for (int id = 20; id < 27; ++id) {
      state.scans.emplace_back();
      state.scans.back().id = id;
    }
    state.scans.push_back(state.scans.back());
    state.scans.back().dropped = true;
    Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_EQ(s.headline, "Scans not judged yet: 7. Finish judges them");
    EXPECT_TRUE(s.may_finish);
    EXPECT_FALSE(s.may_sign) << "signing would be refused";
    EXPECT_TRUE(s.may_scan);
    EXPECT_THAT(s.detail, Not(HasSubstr("Turn")));
    state.error = Error{ErrorKind::kDevice, "the cable is out", "", "plug it in"};
    s = statement_of(state, true, Language::kEnglish);
    EXPECT_THAT(s.detail, HasSubstr("Scans not judged yet: 7. Finish judges them."));
    EXPECT_TRUE(s.may_finish);
    EXPECT_FALSE(s.may_sign);
  }
}

TEST(BeforeSigning, OneScanThatIsNotJudgedIsNotSeveral) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.scans.emplace_back();
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline,
            "A scan is not judged yet: Finish judges it");
}

TEST(BeforeSigning, ScansThatTakeNoPartInTheModelAreNamed) {
  LiveState state;
  for (const PoseStatus status : {PoseStatus::kRegistered, PoseStatus::kUnsure, PoseStatus::kFailed,
                                  PoseStatus::kUnsure, PoseStatus::kFailed}) {
    state.scans.push_back(with_scan(status).scans.front());
    state.scans.back().id = static_cast<int>(state.scans.size()) - 1;
  }
  state.scans[3].dropped = true;
  state.scans[4].damaged = true;
  state.scans.emplace_back();  // not judged yet
  EXPECT_EQ(scans_without_place(state), "1, 2");
}

TEST(WindowTitle, SaysWhichTabletWhichSessionAndWhichScanner) {
  EXPECT_EQ(window_title("BM 15285", "/disk/box-2", "rig:bench.toml"), "BM 15285 – box-2 – rig:bench.toml");
  EXPECT_EQ(window_title("", "/disk/box-2/", "sim:"), "box-2 – sim:");
  EXPECT_EQ(window_title("", "/disk/box-2", ""), "box-2");
  EXPECT_TRUE(is_simulated("sim:?seed=1"));
  EXPECT_FALSE(is_simulated("rig:sim.toml"));
}

}  // namespace
}  // namespace dubsar::ui
