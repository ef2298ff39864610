// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session with a scanner that nothing drives: somebody turns the tablet and says when to scan, until the
// red map is conclusive.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "tests/station/support/endless_scanner.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;

/// One scan by the key; true once it is waited for the next, or the run has come to its end.
bool scan_once(Followed& followed) {
  const std::size_t before = followed.session.state().scans.size();
  followed.session.scan_now();
  return followed.wait_until([&](const LiveState& s) {
    return s.scans.size() > before && (s.scans.back().pose || s.scans.back().dropped) &&
           (s.phase == LivePhase::kWaiting || s.phase == LivePhase::kStill);
  });
}

std::size_t scan_until_conclusive(Followed& followed) {
  for (std::size_t scans = 1; scans <= 40; ++scans) {
    if (!scan_once(followed)) {
      return 0;
    }
    // What is judged may still settle it.
    const bool judged = followed.wait_until([&](const LiveState& s) {
      const LiveScan& last = s.scans.back();
      const bool is_mapped =
          s.red_map && std::ranges::find(s.red_map->scans, last.id, &RedScan::id) != s.red_map->scans.end();
      const bool is_out = last.dropped || (last.pose && last.pose->status != PoseStatus::kRegistered);
      return s.phase == LivePhase::kStill || is_out ||
             (s.phase == LivePhase::kWaiting && is_mapped && !s.red_map->conclusive);
    });
    if (!judged) {
      return 0;
    }
    if (followed.session.state().phase == LivePhase::kStill) {
      return scans;
    }
  }
  return 0;
}

TEST(LiveUndriven, AConclusiveTabletIsReadyToBeSignedAndMayBeScannedOn) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(test::scan_all_round(folder.path() / "made"));
  const std::string device = test::endless_scanner(folder.path() / "made/grids");
  Followed followed(device, folder.path() / "s");
  const std::size_t scans = scan_until_conclusive(followed);
  const LiveState after = followed.session.state();
  ASSERT_GT(scans, 1U) << after.scans.size() << " scans, " << after.notice
                       << (after.error ? after.error->line() : std::string());
  ASSERT_TRUE(followed.wait_for_rest());
  const LiveState ended = followed.session.state();
  EXPECT_FALSE(ended.error) << ended.error->line();
  ASSERT_TRUE(ended.red_map && ended.red_map->conclusive);
  EXPECT_TRUE(ended.verdict_kept) << "it cannot be signed";

  // Who wants one more has it, although nothing is left to do.
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) { return s.scans.size() > scans; }));
  ASSERT_TRUE(followed.wait_for_rest());
  const LiveState on = followed.session.state();
  EXPECT_FALSE(on.error) << on.error->line();
  EXPECT_EQ(on.scans.size(), scans + 1);
  ASSERT_TRUE(on.red_map);
  EXPECT_TRUE(on.verdict_kept);

  // And a word on a scan does not leave it waiting for a scan that nobody needs.
  followed.session.ask(LockScan{0});
  ASSERT_TRUE(
      followed.wait_until([](const LiveState& s) { return s.scans[0].pose && s.scans[0].pose->locked; }));
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_TRUE(followed.session.state().verdict_kept);
}

/// The red map proposes what a hand can do too, in the form that motors would be told.
TEST(LiveUndriven, OfARigIsNotTakenForDriven) {
  const test::TemporaryFolder folder;
  Followed followed(test::unmoved_rig(), folder.path() / "s");
  ASSERT_TRUE(scan_once(followed));
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) {
    return s.phase == LivePhase::kWaiting && s.red_map && !s.red_map->next.empty();
  }));
  const LiveState state = followed.session.state();
  EXPECT_TRUE(state.red_map->next.front().placement) << "it is no rig: it shows nothing";
  EXPECT_FALSE(state.next);
  EXPECT_FALSE(state.is_driven);
}

}  // namespace
}  // namespace dubsar
