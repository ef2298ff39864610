// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a window shows of what the device does: hands off before anything moves, and no longer than it does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <mutex>
#include <optional>
#include <thread>

#include "build_paths.h"
#include "tests/acquisition/session_support.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/endless_scanner.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Followed;
using test::kSmallTablet;
using ::testing::HasSubstr;

constexpr const char* kTinyTablet = "sim:?seed=1&size=12x10x8&spacing=0.4&noise=0.02";

/// A scanner with motors that is held fast before it does anything (plugins/held.c).
class HeldScanner : public ::testing::Test {
 protected:
  HeldScanner() {
    ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/held", 1);
    followed_.emplace("held:" + release_.string() + "?seed=1&size=20x16x8&spacing=0.25&noise=0.02",
                      folder_.path() / "s");
  }
  ~HeldScanner() override {
    let_go();
    followed_.reset();
    ::unsetenv("DUBSAR_DRIVER_PATH");
  }
  void let_go() const { std::ofstream(release_) << "released"; }
  void hold() const { fs::remove(release_); }
  /// Waits until the device was asked for something and does not do it.
  [[nodiscard]] bool is_held() const {
    const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(3);
    while (std::chrono::steady_clock::now() < until) {
      if (fs::exists(release_.string() + ".at")) {
        return true;
      }
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    return false;
  }

  test::TemporaryFolder folder_;
  fs::path release_ = folder_.path() / "release";
  std::optional<Followed> followed_;
};

TEST_F(HeldScanner, MovesOnlyAfterTheWindowHasSaidHandsOff) {
  followed_->session.scan_now();
  ASSERT_TRUE(is_held());
  EXPECT_EQ(followed_->session.state().phase, LivePhase::kMoving);
  let_go();
  ASSERT_TRUE(followed_->wait_for_phase(LivePhase::kWaiting));
  followed_->session.stop();
  ASSERT_TRUE(followed_->wait_for_rest());
  // A session that goes on reads its scans first.
  const std::size_t scans = followed_->session.state().scans.size();
  hold();
  followed_->session.scan_now();
  ASSERT_TRUE(is_held());
  EXPECT_EQ(followed_->session.state().phase, LivePhase::kMoving);
  EXPECT_EQ(followed_->session.state().scans.size(), scans);
  let_go();
  ASSERT_TRUE(followed_->wait_until([&](const LiveState& s) { return s.scans.size() > scans; }));
  followed_->session.stop();
  ASSERT_TRUE(followed_->wait_for_rest());
}

/// Also of the same view once more, which nothing is driven to.
TEST(EnginePhase, EveryScanIsToldOfBeforeItBegins) {
  const test::TemporaryFolder folder;
  std::mutex mutex;
  std::string said;
  Engine engine(
      {"sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02&intrude=gone@1", folder.path() / "s", true, 3,
       std::nullopt},
      [&](const Event& event) {
        const std::scoped_lock lock(mutex);
        if (std::holds_alternative<ProfileArrived>(event)) {
          said += said.ends_with("row ") ? "" : "row ";
        } else if (std::holds_alternative<DeviceStarts>(event)) {
          said += said.ends_with("starts ") ? "" : "starts ";
        } else if (std::holds_alternative<NextPlacement>(event)) {
          said += "next ";
        } else if (std::holds_alternative<ScanStored>(event)) {
          said += "stored ";
        } else if (std::holds_alternative<DeviceRests>(event)) {
          said += "rests ";
        } else if (const auto* notice = std::get_if<Notice>(&event);
                   notice != nullptr && notice->text.ends_with("the same view is scanned once more")) {
          said += "again ";
        }
      });
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  ASSERT_TRUE(result.has_value()) << result.error().line();
  EXPECT_TRUE(said.starts_with("starts row stored ")) << said;
  EXPECT_THAT(said, HasSubstr("again starts row stored "));
  EXPECT_THAT(said, ::testing::Not(::testing::ContainsRegex("(stored|again|rests) row")));
  EXPECT_THAT(said, HasSubstr("rests ")) << said;
}

/// Nothing is left to take, though the tablet is not conclusive.
TEST(EnginePhase, ARunWhoseScansAreAllThereIsNearlyDone) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 2);
  Followed followed("replay:" + scans.string(), folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kFinishing));
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.phase != LivePhase::kFinishing; }));
  EXPECT_EQ(followed.session.state().phase, LivePhase::kStill);
  ASSERT_TRUE(followed.wait_for_rest());
  ASSERT_TRUE(followed.session.state().red_map);
  EXPECT_FALSE(followed.session.state().red_map->conclusive);
}

/// A device that failed in the middle: nothing is scanned any more, and why is said at once.
TEST(EnginePhase, ARunWhoseDeviceFailedIsNearlyDoneAndSaysWhy) {
  const test::TemporaryFolder folder;
  Followed followed(std::string(kSmallTablet) + "&stop_at=0&stop_rows=60", folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kFinishing));
  ASSERT_TRUE(followed.session.state().error);
  // Of the half scan that is kept, too.
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return !s.scans.empty() && s.scans[0].pose; }));
  const LiveState judged = followed.session.state();
  EXPECT_EQ(judged.phase, LivePhase::kFinishing);
  EXPECT_EQ(judged.notice, judged.error->line());
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.phase != LivePhase::kFinishing; }));
  EXPECT_EQ(followed.session.state().phase, LivePhase::kStill);
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_TRUE(followed.session.state().error);
}

/// The map is conclusive, and the run waits all the same: for the scan that is to be taken again.
TEST(EnginePhase, ARunThatWaitsIsNotNearlyDone) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(test::scan_all_round(folder.path() / "s"));
  Followed followed(kTinyTablet, folder.path() / "s");
  followed.session.ask(ScanAgain{0});
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  // Of what is left without it.
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.model_number >= 2; }));
  EXPECT_EQ(followed.session.state().phase, LivePhase::kWaiting);
  const std::size_t scans = followed.session.state().scans.size();
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) { return s.scans.size() > scans; }));
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_FALSE(followed.session.state().error);
}

/// Who stands beside it says when there are enough.
TEST(EnginePhase, APacedRunGoesOnBeyondTheScansOfAnAutomaticOne) {
  const test::TemporaryFolder folder;
  const auto session = folder.path() / "s";
  {
    JobContext job;
    ASSERT_TRUE(Engine({kTinyTablet, session, true, 1, std::nullopt}, nullptr).run(job).has_value());
    SessionStore store = SessionStore::open(session).value();
    for (int k = 1; k < 40; ++k) {
      RangeGrid nothing;  // that could be taken up
      nothing.allocate(2, 2);
      nothing.valid[0] = 1;
      nothing.x[0] = static_cast<float>(k);
      nothing.spacing_mm = 0.4;
      ASSERT_TRUE(store.add_grid(nothing));
    }
  }
  Followed followed(kTinyTablet, session);
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_until([&](const LiveState& s) {
    return !followed.session.busy() || (!s.scans.empty() && s.scans.back().id == 40);
  }));
  EXPECT_TRUE(followed.session.busy()) << followed.session.state().notice;
  followed.session.stop();
  ASSERT_TRUE(followed.wait_for_rest());
}

}  // namespace
}  // namespace dubsar
