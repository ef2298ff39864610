// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session as a window follows it: paced by somebody, never waiting for anybody.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <future>
#include <thread>

#include "acquisition/session_store.h"
#include "station/engine.h"
#include "station/unfinished_scan.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wrong_spacing.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(LiveSession, WaitsForEveryTurnByHandAndGoesOnWhenAsked) {
  const test::TemporaryFolder folder;
  Followed followed(kSmallTablet, folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  const LiveState waiting = followed.session.state();
  ASSERT_TRUE(waiting.next && waiting.next->placement);
  EXPECT_TRUE(waiting.next->placement->hand_turn.has_value());
  EXPECT_TRUE(waiting.is_driven);
  EXPECT_GE(waiting.scans.size(), 1U);
  EXPECT_TRUE(waiting.scans.front().grid && waiting.scans.front().picture);
  EXPECT_TRUE(waiting.mesh && waiting.red);
  EXPECT_GT(waiting.seen_mm2[static_cast<std::size_t>(Face::kObverse)], 100);
  const std::size_t before = waiting.scans.size();
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) { return s.scans.size() > before; }));
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  const LiveState ended = followed.session.state();
  EXPECT_FALSE(ended.error) << ended.error->line();
  ASSERT_TRUE(ended.red_map && ended.checklist);
  EXPECT_FALSE(ended.red_map->conclusive) << "finished in the middle";
}

TEST(LiveSession, TakingAScanOutMovesNothingByItself) {
  const test::TemporaryFolder folder;
  Followed followed(kSmallTablet, folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  const LiveState before = followed.session.state();
  followed.session.ask(DropScan{-1, "a test"});
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.scans.back().dropped; }));
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  EXPECT_EQ(followed.session.state().scans.size(), before.scans.size());
  const int id = before.scans.back().id;
  followed.session.ask(RestoreScan{id});
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return !s.scans.back().dropped; }));
  followed.session.stop();
  ASSERT_TRUE(followed.wait_for_rest());
}

/// A hand in the first scan is seen only when others have looked where it was.
TEST(LiveSession, AScanThatIsSetAsideLaterSaysWhy) {
  const test::TemporaryFolder folder;
  Followed followed("sim:?seed=2&size=24x20x10&spacing=0.3&intrude=hand@0", folder.path() / "s");
  followed.session.scan_now();
  const auto set_aside = [](const LiveState& s) { return !s.scans.empty() && s.scans[0].set_aside; };
  for (int turn = 0; turn < 4; ++turn) {
    ASSERT_TRUE(followed.wait_until(
        [&](const LiveState& s) { return set_aside(s) || s.phase == LivePhase::kWaiting; }));
    if (set_aside(followed.session.state())) {
      break;
    }
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_until(
        [&](const LiveState& s) { return set_aside(s) || s.phase != LivePhase::kWaiting; }));
  }
  const LiveState state = followed.session.state();
  ASSERT_TRUE(set_aside(state));
  EXPECT_TRUE(state.scans[0].dropped);
  EXPECT_THAT(state.scans[0].note, HasSubstr("something was in the way of scan 0"));
  EXPECT_THAT(state.notice, HasSubstr("something was in the way of scan 0"));
  followed.session.ask(RestoreScan{0});
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return !s.scans[0].dropped; }));
  EXPECT_EQ(followed.session.state().scans[0].note, "");
  followed.session.stop();
  ASSERT_TRUE(followed.wait_for_rest());
}

double apart_rad(const RigidTransform& a, const RigidTransform& b) {
  return Eigen::AngleAxisd(a.rotation.transpose() * b.rotation).angle();
}

TEST(LiveSession, AScanThatIsTakenAgainIsAimedAsItWas) {
  const test::TemporaryFolder folder;
  Followed followed(kSmallTablet, folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  // While the tablet lies as it did: the very same view, and nothing moves before the key.
  const LiveScan last = followed.session.state().scans.back();
  ASSERT_TRUE(last.pose);
  const RigidTransform then = last.pose->model_from_scanner;
  followed.session.ask(ScanAgain{last.id});
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    return s.phase == LivePhase::kWaiting && s.scans.back().dropped && s.next &&
           !s.next->placement->hand_turn;
  }));
  EXPECT_LT(apart_rad(followed.session.state().next->model_from_scanner, then), 0.01);
  EXPECT_EQ(followed.session.state().scans.back().id, last.id);
  const auto retaken = static_cast<std::size_t>(last.id) + 1;
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    return s.phase == LivePhase::kWaiting && s.scans.size() > retaken && s.scans.back().pose;
  }));
  const RigidTransform now = followed.session.state().scans[retaken].pose->model_from_scanner;
  EXPECT_LT(apart_rad(now, then), 0.05);
  // It is turned by hand since, and so it is turned back first, as near as may be.
  const std::size_t before = followed.session.state().scans.size();
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    return s.phase == LivePhase::kWaiting && s.scans.size() > before && s.scans.back().pose;
  }));
  followed.session.ask(ScanAgain{last.id + 1});
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    return s.phase == LivePhase::kWaiting && s.scans[retaken].dropped && s.next &&
           apart_rad(s.next->model_from_scanner, now) < 0.4;
  }));
  EXPECT_TRUE(followed.session.state().next->placement->hand_turn);
}

TEST(LiveSession, TheScanUnderWayIsKeptWhenItsWindowIsShut) {
  for (const bool is_shut : {false, true}) {
    const test::TemporaryFolder folder;
    std::promise<void> in_the_middle;
    std::promise<void> stopped;
    Engine engine({kSmallTablet, folder.path() / "s", true, 0, std::nullopt}, [&](const Event& event) {
      if (const auto* profile = std::get_if<ProfileArrived>(&event); profile && profile->row == 30) {
        in_the_middle.set_value();
        stopped.get_future().wait();
      }
    });
    JobContext job;
    std::optional<Result<EngineResult>> result;
    std::jthread runs([&] { result.emplace(engine.run(job)); });
    in_the_middle.get_future().wait();
    if (is_shut) {
      EXPECT_TRUE(engine.post(KeepHalfScan{}));
    }
    job.cancel();
    stopped.set_value();
    runs.join();
    ASSERT_FALSE(*result);
    EXPECT_EQ(result->error().kind, ErrorKind::kCancelled);
    const Result<SessionStore> store =
        SessionStore::open(folder.path() / "s", SessionStore::Access::kReadOnly);
    ASSERT_TRUE(store);
    const auto scans = store->scans();
    ASSERT_TRUE(scans);
    ASSERT_THAT(*scans, SizeIs(is_shut ? 1 : 0));
    if (is_shut) {
      const Result<RangeGrid> half = store->load_grid(0);
      ASSERT_TRUE(half);
      EXPECT_GE(half->rows, 30);
      EXPECT_LT(half->rows, 60);
      EXPECT_GT(half->valid_count(), 0U);
    }
  }
}

TEST(LiveSession, WhatWasStoppedGoesOnWithEverythingThatWasStored) {
  const test::TemporaryFolder folder;
  std::size_t stored = 0;
  {
    Followed followed(kSmallTablet, folder.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
    TabletRecord record;
    record.museum_number = "VAT 1";
    record.cdli = "P123456";
    followed.session.describe(record);
    ASSERT_TRUE(followed.wait_until(
        [](const LiveState& s) { return s.notice.find("said of the tablet") != std::string::npos; }));
    stored = followed.session.state().scans.size();
  }  // closed while it waited
  Followed again(kSmallTablet, folder.path() / "s");
  again.session.read();
  // Nothing was finished, so no mesh was kept: it is made again.
  ASSERT_TRUE(again.wait_until([](const LiveState& s) { return s.mesh && s.red; }));
  ASSERT_TRUE(again.wait_for_rest());
  const LiveState state = again.session.state();
  EXPECT_TRUE(state.exists);
  ASSERT_THAT(state.scans, SizeIs(stored));
  EXPECT_TRUE(state.scans.front().picture);
  EXPECT_EQ(state.record.museum_number, "VAT 1");
  again.session.scan_now();
  bool out = false;
  ASSERT_TRUE(again.wait_until([&](const LiveState& s) {
    out = out || std::ranges::any_of(s.scans, &LiveScan::dropped);
    return s.scans.size() > stored;
  }));
  EXPECT_FALSE(out) << "a scan that is not read again yet is not one that was taken out";
}

TEST(LiveSession, AReopenedSessionShowsWhatIsExcusedAsBefore) {
  const test::TemporaryFolder folder;
  // Of which something is excused after five scans, and something still red.
  const std::string tablet = "sim:?seed=2&size=20x16x8&spacing=0.25&noise=0.02";
  std::shared_ptr<const ColouredPoints> before;
  std::array<int, kFaceCount> red_points{};
  {
    Followed followed(tablet, folder.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
    for (int turns = 0; turns < 4; ++turns) {
      const std::size_t scans = followed.session.state().scans.size();
      followed.session.scan_now();
      ASSERT_TRUE(followed.wait_until(
          [&](const LiveState& s) { return s.scans.size() > scans && s.phase == LivePhase::kWaiting; }));
    }
    followed.session.finish();
    ASSERT_TRUE(followed.wait_for_rest());
    before = followed.session.state().red;
    red_points = followed.session.state().red_points;
    ASSERT_FALSE(followed.session.state().red_map->conclusive);
  }
  ASSERT_TRUE(before);
  EXPECT_GT(std::ranges::count(before->colours, kAmberOfExcused), 0)
      << "nothing is excused: it shows nothing";
  Followed again(tablet, folder.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  const LiveState state = again.session.state();
  ASSERT_TRUE(state.red);
  EXPECT_EQ(state.red->positions_mm, before->positions_mm);
  EXPECT_EQ(state.red->colours, before->colours);
  EXPECT_EQ(state.red_points, red_points);
}

TEST(LiveSession, AScanThatWasBrokenOffIsToldUntilARunHasStoredIt) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(SessionStore::open_or_create(folder.path() / "s"));
  RangeGrid rows;
  rows.allocate(30, 40);
  rows.spacing_mm = 0.25;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows.x[i] = 0.25F * static_cast<float>(i % 40);
    rows.y[i] = 0.25F * static_cast<float>(i / 40);
    rows.valid[i] = 1;
  }
  {
    UnfinishedScan killed(folder.path() / "s", std::nullopt, std::chrono::milliseconds(0));
    killed.remark("the lamp is low");
    killed.follow(rows, 0);
    for (int k = 0; k < 500 && (left_scans(folder.path() / "s").empty() ||
                                left_scans(folder.path() / "s").front().rows() < 30);
         ++k) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    killed.leave();
  }
  Followed followed(kSmallTablet, folder.path() / "s");
  followed.session.read();
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_EQ(followed.session.state().broken_off_rows, 30);
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.scans.size() >= 2; }));
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_EQ(followed.session.state().broken_off_rows, 0);
  EXPECT_EQ(followed.session.state().scans.front().remark, "the lamp is low");
  EXPECT_EQ(SessionStore::open(folder.path() / "s").value().scans()->front().remark, "the lamp is low");
}

TEST(LiveSession, WhatIsAskedForGoesBeforeTheModelOfAnInterruptedSession) {
  const test::TemporaryFolder folder;
  {
    Followed followed(kSmallTablet, folder.path() / "s");
    followed.session.scan_now();
    ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  }
  Followed again(kSmallTablet, folder.path() / "s");
  again.session.read();
  again.session.scan_now();  // while it reads, or makes the model
  ASSERT_TRUE(again.wait_until([](const LiveState& s) { return s.scans.size() > 1 && s.mesh; }));
  again.session.finish();
  ASSERT_TRUE(again.wait_for_rest());
  EXPECT_FALSE(again.session.state().error);
}

/// One tablet on two scanners by mistake would be two frames, two calibrations and two kinds of noise.
TEST(LiveSession, AStoredSessionGoesOnWithItsOwnScanner) {
  const test::TemporaryFolder folder;
  Followed first(kSmallTablet, folder.path() / "s");
  first.session.scan_now();
  ASSERT_TRUE(first.wait_for_phase(LivePhase::kWaiting));
  first.session.stop();
  ASSERT_TRUE(first.wait_for_rest());
  const std::string another = "sim:?seed=9";
  const auto device_of = [&](const char* name, bool is_asked) {
    LiveSession session({another, folder.path() / name, std::nullopt, is_asked}, nullptr);
    session.read();
    while (session.busy()) {
      std::this_thread::yield();
    }
    return session.device();
  };
  EXPECT_EQ(device_of("s", false), kSmallTablet);
  EXPECT_EQ(device_of("s", true), another);
  EXPECT_EQ(device_of("new", false), another);
  // Where nobody can tell which it is, that keeps nobody from scanning.
  {
    Result<SessionStore> store = SessionStore::open(folder.path() / "s");
    ASSERT_TRUE(store && store->save_document("device_settings", "{"));
  }
  EXPECT_EQ(device_of("s", false), another);
  Followed again(kSmallTablet, folder.path() / "s");
  again.session.scan_now();
  EXPECT_TRUE(again.wait_until(
      [](const LiveState& s) { return s.phase == LivePhase::kWaiting || s.error.has_value(); }));
  EXPECT_FALSE(again.session.state().error) << again.session.state().error->line();
}

TEST(LiveSession, HandsAreKeptOffWhileTheScannerIsOpenedAndNotWhileScansAreRead) {
  const test::TemporaryFolder folder;
  std::atomic<bool> is_opened = false;
  std::atomic<bool> reads_then = false;
  LiveSession* watched = nullptr;
  LiveSession session({kSmallTablet, folder.path() / "s", std::nullopt}, [&] {
    const LivePhase phase = watched->state().phase;
    is_opened = is_opened || phase == LivePhase::kOpening;
    reads_then = reads_then || (is_opened && phase == LivePhase::kReading);
  });
  watched = &session;
  session.scan_now();
  while (session.busy() && session.state().phase != LivePhase::kWaiting) {
    std::this_thread::yield();
  }
  EXPECT_TRUE(is_opened);
  EXPECT_TRUE(reads_then);
}

TEST(LiveSession, WhatADeviceRemarksOnItsScanStays) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directory(folder.path() / "scans");
  std::ofstream(folder.path() / "scans" / "a.ply") << test::ply_of_wrong_spacing();
  Followed followed("replay:" + (folder.path() / "scans").string(), folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_rest());
  const LiveState state = followed.session.state();
  ASSERT_THAT(state.scans, SizeIs(1));
  EXPECT_EQ(state.scans.front().pose->status, PoseStatus::kRegistered)
      << "its placing clears no remark on it";
  EXPECT_THAT(state.scans.front().remark, HasSubstr("its header says a spacing of 2.5 mm"));
  EXPECT_THAT(state.notice, HasSubstr("scan 0 (a.ply): its header says"));

  Followed again({}, folder.path() / "s");
  again.session.read();
  ASSERT_TRUE(again.wait_for_rest());
  ASSERT_THAT(again.session.state().scans, SizeIs(1));
  EXPECT_EQ(again.session.state().scans.front().remark, state.scans.front().remark);
}

TEST(LiveSession, ADeviceThatIsNotThereIsSaidAndLeavesNoSession) {
  const test::TemporaryFolder folder;
  Followed followed("sim:?size=nonsense", folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.error.has_value(); }));
  EXPECT_THAT(followed.session.state().error->line(), HasSubstr("size"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
}

}  // namespace
}  // namespace dubsar
