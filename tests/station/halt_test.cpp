// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The emergency stop of a run: what was scanned is kept, nothing is scanned after it, and the session goes
// on.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <mutex>
#include <string>

#include "acquisition/session_store.h"
#include "build_paths.h"
#include "station/engine.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

constexpr const char* kSmallTablet = "sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02";

class Halt : public ::testing::Test {
 protected:
  /// A run on the session that is halted at row `at` of its first scan; -1: when it first waits for somebody.
  Result<EngineResult> run_until(int at, bool paced = false) {
    EngineOptions options;
    options.device = device_;
    options.session = session_;
    options.automatic = options.paced = paced;
    Engine* running = nullptr;
    Engine engine(options, [&](const Event& event) {
      const auto* profile = std::get_if<ProfileArrived>(&event);
      const bool waits = std::holds_alternative<WaitsForOperator>(event);
      if ((profile != nullptr && profile->row == at) || (waits && at < 0)) {
        running->halt();
      }
      if (const auto* notice = std::get_if<Notice>(&event)) {
        const std::scoped_lock lock(mutex_);
        said_ += notice->text + "\n";
      }
    });
    running = &engine;
    return engine.run(job_);
  }
  [[nodiscard]] std::vector<StoredScan> stored() const {
    const auto store = SessionStore::open(session_, SessionStore::Access::kReadOnly);
    return store ? store->scans().value_or(std::vector<StoredScan>{}) : std::vector<StoredScan>{};
  }
  std::string device_ = kSmallTablet;
  test::TemporaryFolder folder_;
  std::filesystem::path session_ = folder_.path() / "s";
  JobContext job_;
  std::mutex mutex_;
  std::string said_;
};

TEST_F(Halt, InMidScanKeepsWhatCameAndSaysHowToGoOn) {
  const Result<EngineResult> halted = run_until(40);
  ASSERT_TRUE(halted.has_value()) << halted.error().line();
  ASSERT_TRUE(halted->device_error.has_value());
  EXPECT_THAT(halted->device_error->line(), HasSubstr("emergency stop was pressed"));
  EXPECT_THAT(halted->device_error->mend, HasSubstr("see that all is clear, then scan"));
  EXPECT_THAT(said_, HasSubstr("the half scan is kept, rows: 41"));
  ASSERT_THAT(stored(), SizeIs(1));
  // The same command goes on.
  const Result<EngineResult> again = run_until(1 << 30);
  ASSERT_TRUE(again.has_value()) << again.error().line();
  EXPECT_FALSE(again->device_error.has_value());
  EXPECT_THAT(stored(), SizeIs(2));
}

TEST_F(Halt, OfADeviceThatDoesNotObeySaysSo) {
  ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/hang", 1);
  device_ = "hang:never?whole=0&deaf=1";
  const Result<EngineResult> halted = run_until(30);
  ::unsetenv("DUBSAR_DRIVER_PATH");
  ASSERT_TRUE(halted.has_value()) << halted.error().line();
  ASSERT_TRUE(halted->device_error.has_value());
  EXPECT_EQ(exit_status(halted->device_error->kind), 3);
  const std::string said = halted->device_error->line();
  EXPECT_THAT(said, HasSubstr("the emergency stop was pressed, but laser and motors may still be on: the "
                              "controller does not answer; pull the plugs of laser and stage"));
  EXPECT_THAT(said_, HasSubstr(said));
  EXPECT_THAT(said_, Not(HasSubstr("nothing moves")));
  EXPECT_THAT(stored(), SizeIs(1));
}

TEST_F(Halt, OfARunThatWaitsEndsIt) {
  const Result<EngineResult> halted = run_until(-1, true);
  ASSERT_TRUE(halted.has_value()) << halted.error().line();
  ASSERT_TRUE(halted->device_error.has_value());
  EXPECT_THAT(said_, HasSubstr("emergency stop was pressed"));
  EXPECT_FALSE(stored().empty());
}

TEST_F(Halt, BeforeTheDeviceIsOpenLetsNothingBegin) {
  EngineOptions options;
  options.device = kSmallTablet;
  options.session = session_;
  Engine engine(options, {});
  engine.halt();
  const Result<EngineResult> halted = engine.run(job_);
  ASSERT_FALSE(halted.has_value());
  EXPECT_THAT(halted.error().line(), HasSubstr("emergency stop was pressed"));
  EXPECT_THAT(stored(), SizeIs(0));
}

}  // namespace
}  // namespace dubsar
