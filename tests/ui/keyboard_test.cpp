// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// An operator in gloves, or without a mouse: everything by keys, in the real window.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "station/tablet_record.h"
#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"
#include "tests/ui/support/on_a_tablet.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;

class Keyboard : public test::OnADisplay {
 protected:
  [[nodiscard]] Outcome play(const std::string& script, const std::string& more = {}) const {
    EXPECT_THAT(script, Not(HasSubstr("click")));
    std::ofstream(in("a.script")) << script;
    return run_command({"station", "--session", in("session"), "--device",
                        "sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02" + more, "--script", in("a.script"),
                        "--width", "1366", "--height", "768"});
  }
};

TEST_F(Keyboard, ReachesEveryBoxAndWhatStandsInIt) {
  // In the order of the screen: the main actions, the buttons on the left, the scans.
  const Outcome outcome = play(R"(wait idle
key tab
expect framed.scan
key backtab
expect framed.settings
key enter
wait title-whole
wait framed.english
key down
expect framed.german
key space
wait german-words
key up
key enter
pause 0.2
# escape shuts the box, and one is where one was
key escape
pause 0.2
expect framed.settings
key backtab
expect framed.calibration
key enter
wait framed.page-verify
key tab
key enter
wait calibrate-folder
key escape
pause 0.2
key up
expect framed.camera
key up
expect framed.device
key enter
wait framed.uri
wait driver.sim
pause 0.2
key tab
key tab
key tab
expect framed.close-devices
key enter
pause 0.2
key backtab
expect framed.tablet
key enter
wait framed.museum-number
type BM 15285
key tab
expect framed.cdli
type P123456
key tab
key tab
expect framed.operator
type A. Reader
# the first leaves the line, the second the box
key escape
key escape
pause 0.2
expect framed.tablet
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Keyboard, TheStationsKeysStayItsOwnWhateverIsFramed) {
  const Outcome outcome = play(R"(wait idle
key backtab
expect framed.settings
key space
wait waiting-turn
# a scan is taken out and put back by its menu
key tab
expect framed.scan.0
key tab
expect framed.scan.1
key enter
wait lock
expect framed.label-pins
key down
expect framed.drop
key enter
wait scan.1.taken out
wait waiting
pause 0.2
expect framed.scan.1
key enter
wait framed.restore
key enter
wait scan.1.fits
wait waiting
# enter is for what is framed; the pedal's key finishes all the same
key tab
key tab
expect framed.undo
key enter
wait scan.1.taken out
wait waiting
key end
wait idle 60
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto scans = run_command({"session", "list", in("session"), "--json"}).json()["scans"];
  EXPECT_EQ(scans.size(), 2U);
}

TEST_F(Keyboard, TheEmergencyStopGoesBeforeWhatIsFramed) {
  const Outcome outcome = play(R"(wait idle
key backtab
expect framed.settings
key space
wait scan.0.fits
wait moving
key tab
key backtab
expect framed.settings
key enter
wait title-whole
key tab
key f12
wait stopped
key escape
wait idle
quit
)",
                               "&move_time=30");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Keyboard, AScannerIsChosenByKeys) {
  const Outcome outcome = play(R"(wait idle
key backtab
key up
key up
key up
expect framed.device
key enter
wait framed.uri
wait driver.replay
type sim:?seed=2&size=20x16x8&spacing=0.25
key enter
pause 0.2
expect framed.device
key escape
key space
wait waiting-turn
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

TEST_F(Keyboard, WhatIsTypedOnTheWayIsKept) {
  const Outcome outcome = play(R"(wait idle
key space
wait waiting-turn
wait model-shown
key tab
key tab
key tab
key tab
key tab
key tab
expect framed.tablet
key enter
wait framed.museum-number
type BM 15285
key tab
key tab
type Sippar
key tab
key escape
# enter shuts it too, once no line has the cursor
key enter
pause 0.5
expect framed.tablet
key end
wait idle 60
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Result<SessionStore> store = SessionStore::open(in("session"), SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store);
  const TabletRecord record = tablet_record_of(*store);
  EXPECT_EQ(record.museum_number, "BM 15285");
  EXPECT_EQ(record.collection, "Sippar");
}

using ViewerByKeys = test::OnATablet;

TEST_F(ViewerByKeys, ChoosesFromAListMovesASliderAndPressesByTheSpaceKey) {
  std::string script =
      "wait whole\nwait wedges\nkey tab\nexpect framed.view.obverse\nkey tab\nkey space\n"
      "wait looks-at.reverse\n";
  const auto on_to = [&](const char* name, int steps) {
    for (int k = 0; k < steps; ++k) {
      script += "key tab\n";
    }
    script += std::string("expect framed.") + name + "\n";
  };
  on_to("tool-correct", 9);
  script += "key enter\nwait marked.0\n";
  on_to("radiance", 5);
  script += "expect radiance=0.8\nkey right\nkey right\nexpect radiance=1.0\nkey left\nwait radiance=0.9\n";
  on_to("overlay", 2);
  script +=
      "key enter\nwait framed.overlay.Clay\nkey escape\npause 0.2\nexpect framed.overlay\nkey enter\n"
      "wait framed.overlay.Clay\nkey up\nexpect framed.overlay.Integral invariant\n";
  const Outcome outcome = play(script + "quit\n");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace
}  // namespace dubsar
