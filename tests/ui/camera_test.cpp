// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Through the camera, by clicks in the real window: the exposure, the settings of the open device, before the
// first scan and between two.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "build_paths.h"
#include "station/device_panel.h"
#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::Contains;
using ::testing::Pair;

class Camera : public test::OnADisplay {
 protected:
  Outcome play(const std::string& script) {
    const auto file = folder_.path() / "camera.script";
    std::ofstream(file) << script;
    return run_command(
        {"station", "--session", session().string(), "--device", "eye:", "--script", file.string()},
        {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/window"}});
  }
  [[nodiscard]] std::filesystem::path session() const { return folder_.path() / "session"; }
  [[nodiscard]] SettingWords kept() const {
    const Result<SessionStore> store = SessionStore::open(session(), SessionStore::Access::kReadOnly);
    return store ? kept_settings(*store, "eye:").value_or(SettingWords{}) : SettingWords{};
  }
};

TEST_F(Camera, TheExposureIsJudgedAndSetBeforeAndBetweenScans) {
  const Outcome played = play(R"(
wait idle
click camera
wait exposure-good
expect setting.exposure_us=5000
# too long, and the driver's own limits
click setting.exposure_us
key end
type 0
click put.exposure_us
wait setting.exposure_us=5000
pause 0.3
expect exposure-good
click setting.exposure_us
key end
key backspace
key backspace
key backspace
key backspace
key backspace
type 9000
click put.exposure_us
wait setting.exposure_us=9000
wait exposure-too-long
click setting.flip
wait setting.flip=true
click close-camera
# the run puts it again, and the camera can be looked through while it waits
key space
wait waiting-turn
click camera
wait exposure-too-long
expect setting.flip=true
# what cannot change while frames run: the picture goes, and comes again
click setting.flip
wait setting.flip=false
wait exposure-too-long
click setting.flip
wait setting.flip=true
wait exposure-too-long
click setting.exposure_us
key end
key backspace
key backspace
key backspace
key backspace
type 400,5
click put.exposure_us
wait setting.exposure_us=400.5
wait exposure-too-short
click close-camera
key space
wait scans.2
wait waiting
key escape
wait idle
click camera
wait setting.exposure_us=400.5
wait exposure-too-short
click close-camera
quit
)");
  ASSERT_EQ(played.status, 0) << played.err;
  EXPECT_THAT(kept(), Contains(Pair("exposure_us", "400.5")));
  EXPECT_THAT(kept(), Contains(Pair("flip", "1")));
  // And again, when the session goes on.
  const Outcome again = play(
      "wait idle\nclick camera\nwait setting.exposure_us=400.5\nwait exposure-too-short\n"
      "expect setting.flip=true\nclick close-camera\nquit\n");
  EXPECT_EQ(again.status, 0) << again.err;
}

TEST_F(Camera, WhatIsTypedStaysWhileAnotherSettingIsPut) {
  const Outcome played = play(R"(
wait idle
click camera
wait exposure-good
click setting.exposure_us
key selectall
type 9000
click setting.flip
wait setting.flip=true
click put.exposure_us
wait setting.exposure_us=9000
click close-camera
quit
)");
  EXPECT_EQ(played.status, 0) << played.err;
}

TEST_F(Camera, TheCommandLineSetsTheSame) {
  const std::vector<std::string> environment{"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR
                                             "/lib/dubsar/test_drivers/window"};
  const Outcome wrong = run_command({"scan", "--session", session().string(), "--device",
                                     "eye:", "--max-scans", "1", "--set", "exposure_us=90000"},
                                    {.environment = environment});
  EXPECT_EQ(wrong.status, 2) << wrong.err;
  const Outcome good =
      run_command({"scan", "--session", session().string(), "--device", "eye:", "--max-scans", "1", "--set",
                   "exposure_us=700", "--set", "trigger=encoder"},
                  {.environment = environment});
  EXPECT_LE(good.status, 1) << good.err;
  EXPECT_THAT(kept(), ::testing::ElementsAre(Pair("exposure_us", "700"), Pair("trigger", "encoder")));
}

}  // namespace
}  // namespace dubsar
