// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is set of a scanner takes, is kept, or is said not to.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <future>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "build_paths.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/endless_scanner.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Pair;

class LiveSettings : public ::testing::Test {
 protected:
  void SetUp() override {
    ::setenv("DUBSAR_DRIVER_PATH", DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/good", 1);
  }
  void keep(const std::string& device, const SettingWords& words) {
    SessionStore store = SessionStore::open_or_create(session_).value();
    ASSERT_TRUE(keep_settings(store, device, words));
  }
  [[nodiscard]] SettingWords kept(const std::string& device) const {
    const SessionStore store = SessionStore::open(session_, SessionStore::Access::kReadOnly).value();
    return kept_settings(store, device).value();
  }
  /// As the panel of the open device shows it.
  static std::string shown(const DevicePanel& panel, const std::string& key) {
    const auto at = std::ranges::find(panel.settings, key, [](const auto& one) { return one.info.key; });
    return at == panel.settings.end() ? std::string() : at->word;
  }
  test::TemporaryFolder folder_;
  std::filesystem::path session_ = folder_.path() / "s";
};

TEST_F(LiveSettings, AScannerThatIsChosenAgainHasWhatIsKeptOfIt) {
  keep("odd:2", {{"average", "2"}});
  keep("odd:1", {{"average", "4"}, {"gain", "2"}});
  Followed followed("odd:1", session_);
  followed.session.read();
  ASSERT_TRUE(followed.wait_for_rest());
  followed.session.set_device("odd:2");
  followed.session.set_device("odd:1");
  followed.session.watch_camera(true);
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.panel != nullptr; }));
  EXPECT_EQ(shown(*followed.session.state().panel, "average"), "4");
  followed.session.change_setting("gain", "3");
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return shown(*s.panel, "gain") == "3"; }));
  followed.session.watch_camera(false);
  EXPECT_THAT(kept("odd:1"), ElementsAre(Pair("average", "4"), Pair("gain", "3")));
  EXPECT_THAT(kept("odd:2"), ElementsAre(Pair("average", "2")));
}

TEST_F(LiveSettings, WhatIsSetOfAScannerIsKeptOfItAlsoWhereAnotherIsChosenMeanwhile) {
  keep("odd:2", {});
  keep("odd:1", {});
  Followed followed("odd:1", session_);
  followed.session.watch_camera(true);
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.panel != nullptr; }));
  followed.session.change_setting("gain", "3");
  followed.session.set_device("odd:2");  // before the first has taken it
  ASSERT_TRUE(followed.wait_until(
      [&](const LiveState&) { return !kept("odd:1").empty() || !kept("odd:2").empty(); }));
  followed.session.watch_camera(false);
  EXPECT_THAT(kept("odd:1"), ElementsAre(Pair("gain", "3")));
  EXPECT_THAT(kept("odd:2"), ElementsAre());
}

TEST_F(LiveSettings, WhatNobodyTakesIsSaid) {
  Followed followed("odd:1", session_);
  followed.session.change_setting("gain", "3");
  EXPECT_EQ(followed.session.state().notice, kNotSet);
  // A camera that cannot be opened takes nothing either.
  followed.session.set_device("odd:gone");
  followed.session.watch_camera(true);
  ASSERT_TRUE(followed.wait_until(
      [](const LiveState& s) { return s.notice.find("no such device") != std::string::npos; }));
  followed.session.change_setting("gain", "3");
  ASSERT_TRUE(followed.wait_until([](const LiveState& s) { return s.notice == kNotSet; }));
}

TEST_F(LiveSettings, WhatIsSetDuringTheLastScanIsKept) {
  const auto scans = test::write_bumpy_scans(folder_.path() / "scans", 2);
  EngineOptions options;
  options.device = test::endless_scanner(scans);
  options.session = session_;
  options.automatic = options.paced = true;
  std::promise<void> in_the_middle;
  std::promise<void> said;
  Engine engine(options, [&](const Event& event) {
    if (const auto* profile = std::get_if<ProfileArrived>(&event); profile && profile->row == 30) {
      in_the_middle.set_value();
      said.get_future().wait();
    }
  });
  JobContext job;
  std::optional<Result<EngineResult>> result;
  std::jthread runs([&] { result.emplace(engine.run(job)); });
  in_the_middle.get_future().wait();
  EXPECT_TRUE(engine.post(ChangeSetting{"rate", "5000"}));
  EXPECT_TRUE(engine.post(Finish{}));
  said.set_value();
  runs.join();
  ASSERT_TRUE(*result) << result->error().line();
  EXPECT_THAT(kept(options.device), ElementsAre(Pair("rate", "5000")));
}

TEST_F(LiveSettings, OneThatIsKeptAndFailsKeepsNoOtherFromBeingPut) {
  keep("odd:1", {{"nothing", "1"}, {"gain", "2"}, {"light", "dim"}, {"average", "4"}});
  EngineOptions options;
  options.device = "odd:1";
  options.session = session_;
  options.settings = kept("odd:1");  // as a window does
  std::mutex mutex;
  std::string said;
  std::shared_ptr<const DevicePanel> panel;
  Engine engine(options, [&](const Event& event) {
    const std::scoped_lock lock(mutex);
    if (const auto* notice = std::get_if<Notice>(&event)) {
      said += notice->text + "\n";
    } else if (const auto* device = std::get_if<DeviceTells>(&event)) {
      panel = device->panel;
    }
  });
  JobContext job;
  [[maybe_unused]] const auto result = engine.run(job);  // its scans are of nothing
  ASSERT_TRUE(panel);
  EXPECT_EQ(shown(*panel, "gain"), "2");
  EXPECT_EQ(shown(*panel, "average"), "4");
  EXPECT_THAT(said, AllOf(HasSubstr("the device has no setting nothing"),
                          HasSubstr("setting light takes one of on, off")));
}

TEST_F(LiveSettings, WhatIsSetWhileADeviceIsOpenedInVainIsSaidNotToBeSet) {
  EngineOptions options;
  options.device = "odd:gone";
  options.session = session_;
  std::string said;
  Engine engine(options, [&](const Event& event) {
    if (const auto* notice = std::get_if<Notice>(&event)) {
      said += notice->text + "\n";
    }
  });
  ASSERT_TRUE(engine.post(ChangeSetting{"gain", "3"}));
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  EXPECT_FALSE(result);
  EXPECT_THAT(said, HasSubstr(kNotSet));
}

/// One of them may be the power of a camera's own laser.
TEST_F(LiveSettings, BehindAnEmergencyStopNoneIsPutAndAllAreKept) {
  keep("odd:1", {{"gain", "2"}});
  EngineOptions options;
  options.device = "odd:1";
  options.session = session_;
  options.settings = {{"gain", "2"}, {"average", "4"}};
  std::shared_ptr<const DevicePanel> panel;
  Engine engine(options, [&](const Event& event) {
    if (const auto* device = std::get_if<DeviceTells>(&event)) {
      panel = device->panel;
    }
  });
  engine.halt();
  JobContext job;
  const Result<EngineResult> result = engine.run(job);
  ASSERT_FALSE(result.has_value());
  EXPECT_THAT(result.error().line(), HasSubstr("emergency stop was pressed"));
  ASSERT_TRUE(panel);
  EXPECT_EQ(shown(*panel, "gain"), "1");
  EXPECT_EQ(shown(*panel, "average"), "1");
  EXPECT_THAT(kept("odd:1"), ElementsAre(Pair("gain", "2"), Pair("average", "4")));
}

TEST_F(LiveSettings, BehindAnEmergencyStopNoneIsPutOfACameraThatIsBeingOpened) {
  std::promise<void> pressed;
  std::mutex mutex;
  std::shared_ptr<const DevicePanel> panel;
  CameraWatch watch(
      "odd:1",
      [&] {
        pressed.get_future().wait();
        return SettingWords{{"gain", "2"}};
      },
      [&](const Event& event) {
        const std::scoped_lock lock(mutex);
        if (const auto* device = std::get_if<DeviceTells>(&event)) {
          panel = device->panel;
        }
      },
      [](const std::string&, const std::string&) {});
  watch.halt();
  pressed.set_value();
  while (!watch.ended()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  const std::scoped_lock lock(mutex);
  EXPECT_TRUE(!panel || shown(*panel, "gain") == "1") << "it is set to " << shown(*panel, "gain");
}

}  // namespace
}  // namespace dubsar
