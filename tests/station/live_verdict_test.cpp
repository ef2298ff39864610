// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a window may call the verdict of its session: what the session holds, of the scans that stand.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/session_store.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;

class LiveVerdict : public ::testing::Test {
 protected:
  /// Some scans, and the verdict of them.
  void scan_and_finish() {
    Followed followed(kSmallTablet, folder_.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
    followed.session.finish();
    ASSERT_TRUE(followed.wait_for_rest());
    ASSERT_TRUE(followed.session.state().verdict_kept);
    ASSERT_GE(followed.session.state().scans.size(), 2U);
  }
  test::TemporaryFolder folder_;
};

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
