// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A run that is stopped while its session is opened.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string>
#include <thread>

#include "acquisition/session_store.h"
#include "station/engine.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;

constexpr int kScans = 4;
constexpr const char* kChecking = "checking the session";

class EngineStopped : public ::testing::Test {
 protected:
  EngineStopped() {
    SessionStore store = SessionStore::open_or_create(session_).value();
    for (int k = 0; k < kScans; ++k) {
      EXPECT_TRUE(store.add_grid(test::bumpy_scan(k)));
    }
  }
  /// How a run ends that is stopped as soon as `stage` has come half of the way.
  Result<EngineResult> stopped_at(std::string_view stage) {
    Engine engine({"replay:" + scans_.string(), session_, false, 0, std::nullopt}, [](const Event&) {});
    JobContext* stopped = nullptr;
    JobContext job([&](std::string_view now, double fraction) {
      if (now == stage && fraction >= 0.5) {
        stopped->cancel();
      }
    });
    stopped = &job;
    return engine.run(job);
  }
  void expect_as_it_was() const {
    const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
    EXPECT_TRUE(store.opening().damage.empty());
    EXPECT_EQ(store.scans()->size(), static_cast<std::size_t>(kScans));
    EXPECT_EQ(store.events()->size(), static_cast<std::size_t>(kScans)) << "one for each scan that is stored";
    JobContext job;
    EXPECT_TRUE(store.verify(job)->ok());
  }

  test::TemporaryFolder folder_;
  fs::path scans_ = test::write_bumpy_scans(folder_.path() / "scans", 2);
  fs::path session_ = folder_.path() / "s";
};

TEST_F(EngineStopped, WhileTheSessionIsOpenedSaysWhatIsTrueAndChangesNothing) {
  for (const char* stage : {kChecking, "reading the session"}) {
    const Result<EngineResult> result = stopped_at(stage);
    ASSERT_FALSE(result) << stage;
    EXPECT_EQ(result.error().kind, ErrorKind::kCancelled) << result.error().line();
    EXPECT_EQ(result.error().line(),
              session_.string() +
                  ": stopped while the session was opened; nothing was scanned; the same "
                  "command goes on with what is there");
    expect_as_it_was();
  }
}

TEST_F(EngineStopped, BeforeThereWasASessionLeavesNone) {
  const fs::path none = folder_.path() / "none";
  Engine engine({"replay:" + scans_.string(), none, false, 0, std::nullopt}, [](const Event&) {});
  JobContext job;
  job.cancel();
  const Result<EngineResult> result = engine.run(job);
  ASSERT_FALSE(result);
  EXPECT_EQ(result.error().kind, ErrorKind::kCancelled);
  EXPECT_FALSE(fs::exists(none));
}

/// Closing it waits for the grid that is being read and for no other.
TEST_F(EngineStopped, AWindowThatIsClosedMeanwhileReadsNoFurther) {
  std::atomic<bool> begun = false;
  std::atomic<bool> closes = false;
  std::atomic<int> grids = 0;
  std::atomic<LiveSession*> session = nullptr;
  double last = -1;
  auto watched = std::make_unique<LiveSession>(
      LiveSession::Options{"replay:" + scans_.string(), session_, std::nullopt}, [&] {
        const LiveState state = session.load()->state();
        if (state.stage != kChecking || state.fraction == last) {
          return;
        }
        last = state.fraction;
        ++grids;
        begun = true;
        while (!closes) {
          std::this_thread::sleep_for(std::chrono::milliseconds(1));
        }
        std::this_thread::sleep_for(std::chrono::milliseconds(300));  // until the closing has begun
      });
  session = watched.get();
  watched->read();
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  while (!begun && watched->busy() && std::chrono::steady_clock::now() < until) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  closes = true;
  watched.reset();
  EXPECT_EQ(grids, 1);
}

}  // namespace
}  // namespace dubsar
