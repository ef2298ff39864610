// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator is told before and after a signature, and of what stands in its way.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "tests/ui/support/live_states.h"
#include "ui/operator/statement.h"

namespace dubsar::ui {
namespace {

using ::testing::HasSubstr;
using testing::map_with;
using testing::with_scan;

TEST(StatementOfSigning, AFailedVerificationIsNotCalledAMissingOne) {
  LiveState state;
  state.care = RigCare{};
  const Statement never = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(never.headline, "First measure the artefact: press Calibration");
  EXPECT_THAT(never.detail, HasSubstr("not measured today"));
  state.care->last = VerificationEntry{};
  state.care->last->passed = false;
  state.care->age_days = 0.1;
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_THAT(s.detail, HasSubstr("FAILED"));
  EXPECT_THAT(s.detail, HasSubstr("measure it again"));
  EXPECT_EQ(s.tone, Tone::kBad);
  EXPECT_THAT(statement_of(state, true, Language::kGerman).detail, HasSubstr("DURCHGEFALLEN"));
}

TEST(StatementOfSigning, OnlyWhatIsThereMayBeSigned) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(12.34);
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).headline, HasSubstr("12.3 mm²"));
  state.red_map = map_with(0);
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).tone, Tone::kGood);
  EXPECT_TRUE(statement_of(state, true, Language::kEnglish).may_sign);
  state.signed_off = true;
  state.signed_by = "A. Reader";
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Signed by A. Reader: make the package");
  EXPECT_FALSE(s.may_sign);
  state.package = "/disk/package";
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline,
            "Signed by A. Reader: lay the next tablet");
}

/// Its place is sure, and yet its lengths are wrong: whoever signs has read it.
TEST(StatementOfSigning, WrongLengthsAreSaidBeforeTheSignature) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.scans.back().pose->warning =
      "against the other scans it is 1.2 % too large: its calibration is not theirs; verify the scanner, "
      "then "
      "scan it again";
  for (const double red : {2.5, 0.0}) {
    state.red_map = map_with(red);
    const Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_EQ(s.tone, Tone::kAsk);
    EXPECT_TRUE(s.may_sign);
    EXPECT_THAT(s.detail, HasSubstr("Scan 4: against the other scans it is 1.2 % too large"));
    EXPECT_THAT(statement_of(state, true, Language::kGerman).detail,
                HasSubstr("Scan 4: gegen die anderen Scans ist er 1,2 % zu groß"));
  }
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).headline,
            "Conclusive, but of a scan there is a warning: check, then sign");
  state.scans.push_back(state.scans.back());
  EXPECT_THAT(statement_of(state, true, Language::kEnglish).detail,
              HasSubstr("scan it again. More scans with a warning: 1."));
  state.scans.pop_back();
  state.scans.back().dropped = true;
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).detail, "");
}

/// An interrupted session: its red is worked out to be seen, no verdict is in it.
TEST(StatementOfSigning, WhatIsNotInTheSessionCannotBeSigned) {
  for (const double red : {2.5, 0.0}) {
    LiveState state = with_scan(PoseStatus::kRegistered);
    state.red_map = map_with(red);
    state.verdict_kept = false;
    const Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_FALSE(s.may_sign);
    EXPECT_TRUE(s.may_scan);
    EXPECT_EQ(s.headline, red > 0 ? "2.5 mm² are still red: scan on" : "Scans stored: 1. Go on");
  }
}

/// The same key after every signature: it must not drive the scanner while the next tablet is laid down.
TEST(StatementOfSigning, AfterASignatureTheKeyLeadsToTheNextTabletConclusiveOrNot) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.signed_off = true;
  state.signed_by = "A. Reader";
  for (const double red : {2.5, 0.0}) {
    state.red_map = map_with(red);
    const Statement s = statement_of(state, true, Language::kEnglish);
    EXPECT_FALSE(s.may_scan);
    EXPECT_TRUE(s.may_next);
    EXPECT_TRUE(s.may_pack);
    EXPECT_FALSE(s.may_undo) << "a stray key would void the signature";
    EXPECT_EQ(s.scan_label, Text::kNextTablet);
    EXPECT_EQ(s.headline, "Signed by A. Reader: make the package");
    EXPECT_EQ(s.tone, red > 0 ? Tone::kAsk : Tone::kGood);
    EXPECT_EQ(s.detail.find("incomplete") != std::string::npos, red > 0);
  }
}

/// What *Undo* asks for is what was seen, whatever has come since.
TEST(StatementOfSigning, LostRecordsAreToldBeforeAndAfterTheSignature) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(0);
  EXPECT_EQ(statement_of(state, true, Language::kEnglish).tone, Tone::kGood);
  state.lost_records = {"the description of the tablet"};
  const Statement before = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(before.tone, Tone::kWarn);
  EXPECT_EQ(before.headline, "Conclusive, but records are lost: check, then sign");
  EXPECT_THAT(before.detail, HasSubstr("has lost records: the description of the tablet. Bring them back"));
  EXPECT_TRUE(before.may_sign);
  state.signed_off = true;
  state.signed_by = "A. Reader";
  const Statement after = statement_of(state, true, Language::kGerman);
  EXPECT_EQ(after.tone, Tone::kWarn);
  EXPECT_THAT(after.headline, HasSubstr("A. Reader"));
  EXPECT_THAT(after.detail, HasSubstr("fehlen Aufzeichnungen: die Beschreibung der Tafel."));
}

TEST(StatementOfSigning, ScansThatMayHaveBeenTakenOutAreNamed) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(14);
  state.scans.back().record_lost = true;
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Records of this session are lost");
  EXPECT_THAT(s.detail, HasSubstr("may have been taken out: 4."));
  EXPECT_THAT(s.detail, HasSubstr("14.0 mm² are still red: scan on.")) << "it is still what is next";
  state.scans.back().dropped = true;  // said anew
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.tone, Tone::kAsk);
}

TEST(StatementOfSigning, DamagedScansComeBeforeWhatIsRedByTheLackOfThem) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(3.4);
  state.scans.back().damaged = true;
  Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Scan 4 is damaged: bring it back from a copy");
  EXPECT_EQ(s.tone, Tone::kBad);
  state.scans.push_back(state.scans.front());
  state.scans.back().id = 6;
  state.void_signed_by = "A. Reader";
  state.void_since = "grids/004.grid: missing; bring it back from a copy";
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_EQ(s.headline, "Scans 4, 6 are damaged: bring them back from a copy");
  EXPECT_THAT(s.detail, HasSubstr("The signature of A. Reader no longer holds."));
  EXPECT_THAT(s.detail, HasSubstr("see the guide"));
  EXPECT_THAT(s.detail, ::testing::Not(HasSubstr("dubsar")));
  state.error = Error{ErrorKind::kDevice, "the cable is out", "", "plug it in"};
  s = statement_of(state, true, Language::kEnglish);
  EXPECT_THAT(s.headline, HasSubstr("Stopped"));
  EXPECT_THAT(s.detail, HasSubstr("Scans 4, 6 are damaged"));
  state.scans.front().dropped = state.scans.back().dropped = true;
  state.error.reset();
  EXPECT_NE(statement_of(state, true, Language::kEnglish).tone, Tone::kBad) << "it was said";
}

TEST(StatementOfSigning, AVoidSignatureIsToldWithWhatChanged) {
  LiveState state = with_scan(PoseStatus::kRegistered);
  state.red_map = map_with(0);
  state.void_signed_by = "A. Reader";
  state.void_since = "scan 7 has come since";
  const Statement s = statement_of(state, true, Language::kEnglish);
  EXPECT_THAT(s.detail, HasSubstr("The signature of A. Reader no longer holds: scan 7 has come since."));
}

}  // namespace
}  // namespace dubsar::ui
