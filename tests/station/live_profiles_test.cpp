// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The profiles of a scan under way, as a window shows them.

#include <gtest/gtest.h>

#include <atomic>
#include <fstream>
#include <thread>

#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wrong_spacing.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;

TEST(LiveProfiles, TheRowsThatAreHandedOverMakeUpTheScan) {
  const test::TemporaryFolder folder;
  Followed followed(kSmallTablet, folder.path() / "s");
  GridPicture built;
  std::uint64_t scan = 0;
  int looks = 0;
  const auto look = [&] {
    const GrowingRows news = followed.session.look_at_growing(scan, built.rows);
    if (news.scan != scan) {
      built = {};
      scan = news.scan;
      EXPECT_EQ(news.first, 0);
    }
    EXPECT_EQ(news.since.has_value(), news.rows.rows > 0) << "woken for rows, and for nothing else";
    if (news.rows.rows > 0) {
      const auto cells = static_cast<std::size_t>(news.first) * static_cast<std::size_t>(news.rows.cols);
      ASSERT_LE(cells, built.shade.size());
      built.cols = news.rows.cols;
      built.rows = news.total;
      built.shade.resize(cells);
      built.state.resize(cells);
      built.shade.insert(built.shade.end(), news.rows.shade.begin(), news.rows.shade.end());
      built.state.insert(built.state.end(), news.rows.state.begin(), news.rows.state.end());
      ++looks;
    }
  };
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    look();
    return s.phase == LivePhase::kWaiting;
  }));
  look();
  EXPECT_GT(looks, 0);
  const GrowingRows whole = followed.session.look_at_growing(0, 0);
  EXPECT_FALSE(whole.since) << "all of it has been seen";
  EXPECT_GT(whole.total, 20);
  EXPECT_EQ(built.rows, whole.total);
  EXPECT_EQ(built.shade, whole.rows.shade);
  EXPECT_EQ(built.state, whole.rows.state);
}

TEST(LiveProfiles, ProfilesThatNobodyHasLookedAtWakeOnce) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scans");
  std::ofstream(folder.path() / "scans" / "a.ply") << test::ply_of_wrong_spacing();
  std::atomic<int> wakes = 0;
  LiveSession* watched = nullptr;
  LiveSession session({"replay:" + (folder.path() / "scans").string(), folder.path() / "s", std::nullopt},
                      [&] { wakes += watched->state().phase == LivePhase::kScanning ? 1 : 0; });
  watched = &session;
  session.scan_now();
  while (session.busy()) {
    std::this_thread::yield();
  }
  EXPECT_EQ(session.state().profiles, 60);
  EXPECT_EQ(session.look_at_growing(0, 0).total, 60);
  EXPECT_GE(wakes, 1);
  EXPECT_LT(wakes, 30);  // a remark on the scan, say, comes while it is scanned
}

}  // namespace
}  // namespace dubsar
