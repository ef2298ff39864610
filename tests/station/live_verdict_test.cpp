// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a window may call the verdict of its session: what the session holds, of the scans that stand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/session_store.h"
#include "formats/red_map_json.h"
#include "station/plan_again.h"
#include "station/scan_set.h"
#include "station/session_pages.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;

class LiveVerdict : public ::testing::Test {
 protected:
  static void SetUpTestSuite() { made_ = new test::TemporaryFolder; }
  static void TearDownTestSuite() { delete made_; }
  /// Some scans, and the verdict of them: made for the first test that wants them, a copy for each.
  void scan_and_finish() {
    if (!std::filesystem::exists(made_->path() / "s")) {
      ASSERT_NO_FATAL_FAILURE(make());
    }
    std::filesystem::copy(made_->path() / "s", folder_.path() / "s",
                          std::filesystem::copy_options::recursive);
  }
  test::TemporaryFolder folder_;

 private:
  static void make() {
    Followed followed(kSmallTablet, made_->path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
    followed.session.finish();
    ASSERT_TRUE(followed.wait_for_rest());
    ASSERT_TRUE(followed.session.state().verdict_kept);
    ASSERT_GE(followed.session.state().scans.size(), 2U);
  }
  static test::TemporaryFolder* made_;
};
test::TemporaryFolder* LiveVerdict::made_ = nullptr;

TEST_F(LiveVerdict, IsNotOneOfAScanThatWasTakenOutSince) {
  scan_and_finish();
  Followed as_it_was(kSmallTablet, folder_.path() / "s");
  as_it_was.session.read();
  ASSERT_TRUE(as_it_was.wait_for_rest());
  EXPECT_TRUE(as_it_was.session.state().verdict_kept);
  ASSERT_TRUE(SessionStore::open(folder_.path() / "s")->drop_scan(1, "a hand in view"));
  Followed again(kSmallTablet, folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  const LiveState state = again.session.state();
  EXPECT_TRUE(state.scans[1].dropped) << "its place is still stored";
  EXPECT_EQ(state.scans[1].note, "a hand in view");
  EXPECT_FALSE(state.verdict_kept);
  ASSERT_TRUE(state.red_map);
  EXPECT_EQ(state.red_map->scans.size(), state.scans.size() - 1) << "it is worked out anew to be seen";
}

TEST_F(LiveVerdict, IsNotOneOfARunThatWasStopped) {
  scan_and_finish();
  Followed again(kSmallTablet, folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  again.session.ask(DropScan{-1, "a test"});
  ASSERT_TRUE(again.wait_for_phase(LivePhase::kWaiting));
  again.session.stop();
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_FALSE(again.session.state().verdict_kept) << "no page says it";
}

TEST_F(LiveVerdict, IsWorkedOutOfWhatIsStoredAndCanBeSignedWithoutAScanner) {
  {
    Followed followed(kSmallTablet, folder_.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  }
  Followed again("no-such-driver:", folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  ASSERT_FALSE(again.session.state().verdict_kept);
  const std::size_t scans = again.session.state().scans.size();
  again.session.finish();
  ASSERT_TRUE(again.wait_for_rest());
  ASSERT_FALSE(again.session.state().error) << again.session.state().error->line();
  EXPECT_TRUE(again.session.state().verdict_kept);
  EXPECT_EQ(again.session.state().scans.size(), scans);
  {
    const SessionStore store =
        SessionStore::open(folder_.path() / "s", SessionStore::Access::kReadOnly).value();
    EXPECT_TRUE(std::filesystem::exists(folder_.path() / "s" / kPages.front())) << "with its pages";
    EXPECT_EQ(why_pages_are_behind(store), "");
  }
  SignOff wanted;
  wanted.name = "A. Reader";
  wanted.incomplete = "the rim is lost";
  again.session.sign(wanted);
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_FALSE(again.session.state().error);
  EXPECT_TRUE(again.session.state().signed_off);
}

/// The motors have turned the tablet before the window was closed: how it lies now says the drive of the last
/// scan.
TEST_F(LiveVerdict, OfASessionThatWasLeftProposesWhatPlanProposes) {
  {
    Followed followed(kSmallTablet, folder_.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  }
  Followed again(kSmallTablet, folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  const LiveState state = again.session.state();
  ASSERT_TRUE(state.red_map);
  EXPECT_TRUE(state.is_driven);
  JobContext job;
  ScanSetOptions reading;
  reading.access = SessionStore::Access::kReadOnly;
  const ScanSet set = load_scan_set(folder_.path() / "s", reading, job).value();
  ASSERT_NE(set.scans.back().drive->turntable_rad, set.scans.front().drive->turntable_rad);
  const PlannedAgain planned = plan_again(set, set.poses, job).value();
  ASSERT_FALSE(planned.results.red_map.next.empty());
  EXPECT_EQ(red_map_to_json(*state.red_map), red_map_to_json(planned.results.red_map));
}

/// The pages of a run that was broken off must not say what was so before it.
TEST_F(LiveVerdict, OfPagesIsTakenBackWithAWordOnAScanAndComesWithTheNext) {
  scan_and_finish();
  const auto why = [&] {
    return why_pages_are_behind(
        SessionStore::open(folder_.path() / "s", SessionStore::Access::kReadOnly).value());
  };
  EXPECT_EQ(why(), "");
  Followed again(kSmallTablet, folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  again.session.ask(DropScan{-1, "a test"});
  ASSERT_TRUE(again.wait_for_phase(LivePhase::kWaiting));
  again.session.stop();
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_EQ(why(), "the session was changed after they were made");
  again.session.finish();
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_FALSE(again.session.state().error);
  EXPECT_EQ(why(), "");
}

/// A key that was pressed by mistake costs nothing.
TEST_F(LiveVerdict, StandsWhereARunWasStoppedBeforeItChangedAnything) {
  scan_and_finish();
  Followed again(kSmallTablet, folder_.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  again.session.scan_now();
  again.session.stop();
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_TRUE(again.session.state().verdict_kept);
}

/// While pages are made nothing is to be turned, and a key that scans would be one for the next tablet.
TEST_F(LiveVerdict, WhoFinishesIsNotAskedToTurnTheTabletAnyMore) {
  Followed followed(kSmallTablet, folder_.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  followed.session.finish();
  EXPECT_EQ(followed.session.state().phase, LivePhase::kFinishing);
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_FALSE(followed.session.state().error);
}

}  // namespace
}  // namespace dubsar
