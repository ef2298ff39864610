// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A window's session with a device that hangs: that it does not answer is said for as long as it is so.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <functional>
#include <optional>
#include <thread>

#include "build_paths.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;

/// Nothing wakes who waits for a device that is silent: the session is looked at. False where it never is so.
template <class Is>
bool comes_to_be(const Followed& followed, const Is& is) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::minutes(3);
  while (std::chrono::steady_clock::now() < until) {
    if (is(followed.session.state())) {
      return true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
  }
  return false;
}

bool is_silent(const LiveState& state) {
  return state.silence.has_value();
}

class LiveSilence : public ::testing::Test {
 protected:
  LiveSilence() {
    ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/hang", 1);
    followed_.emplace("hang:" + release_.string(), folder_.path() / "s");
  }
  /// Of whatever hangs, before the session goes.
  ~LiveSilence() override {
    answer();
    followed_.reset();
    ::unsetenv("DUBSAR_DRIVER_PATH");
  }
  void answer() const { std::ofstream(release_) << "released"; }
  /// In the middle of its second scan.
  [[nodiscard]] bool hangs() {
    followed_->session.scan_now();
    // Stored as well: that is said beside the scan that comes.
    if (!comes_to_be(*followed_, [](const LiveState& s) {
          return s.phase == LivePhase::kWaiting && s.scans.size() == 1 && s.scans[0].pose;
        })) {
      return false;
    }
    followed_->session.scan_now();
    return comes_to_be(*followed_, [](const LiveState& s) {
      return s.phase == LivePhase::kScanning && s.scans.size() == 1 && s.profiles == 20;
    });
  }

  test::TemporaryFolder folder_;
  std::filesystem::path release_ = folder_.path() / "release";
  std::optional<Followed> followed_;
};

TEST_F(LiveSilence, ADeviceThatWasStoppedAndHangsIsSilentUntilItAnswers) {
  ASSERT_TRUE(hangs());
  EXPECT_FALSE(followed_->session.state().silence) << "nobody has told it anything";
  followed_->session.stop();
  EXPECT_TRUE(comes_to_be(*followed_, is_silent));
  answer();
  EXPECT_TRUE(comes_to_be(*followed_, std::not_fn(is_silent)));
  EXPECT_TRUE(followed_->wait_for_rest());
  EXPECT_EQ(followed_->session.state().scans.size(), 1U);
}

TEST_F(LiveSilence, SoIsOneOfTheEmergencyStop) {
  ASSERT_TRUE(hangs());
  followed_->session.halt();
  EXPECT_TRUE(comes_to_be(*followed_, is_silent));
  answer();
  EXPECT_TRUE(followed_->wait_for_rest());
  EXPECT_FALSE(followed_->session.state().silence);
}

}  // namespace
}  // namespace dubsar
