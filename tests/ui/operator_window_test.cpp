// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What an operator does beside the straight way: other keys, a scan that is fixed, one that is taken again,
// how the window looks.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <fstream>

#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"
#include "tests/ui/support/read_png.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;

class OperatorWindow : public test::OnADisplay {
 protected:
  [[nodiscard]] Outcome play(const std::string& script, const char* width = "1366") const {
    std::ofstream(in("a.script")) << script;
    return run_command({"station", "--session", in("session"), "--device",
                        "sim:?seed=1&size=20x16x8&spacing=0.25&noise=0.02", "--script", in("a.script"),
                        "--width", width, "--height", "768"});
  }
};

TEST_F(OperatorWindow, PedalsScansThatAreFixedAndOnesThatAreTakenAgain) {
  const Outcome outcome = play(R"(wait idle
key pagedown
wait waiting-turn
expect scan.1.fits
click scan.0
click lock
wait scan.0.locked
click scan.0
click unlock
wait waiting-turn
click scan.0
wait lock
key escape
# the tablet lies as it did: nothing moves before the key, and no turn is asked for
click scan.1
click rescan
wait scan.1.taken out
wait waiting
key f9
wait scan.2.fits
wait waiting-turn
key pageup
wait scan.2.taken out
wait waiting
key end
wait idle 60
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto scans = run_command({"session", "list", in("session"), "--json"}).json()["scans"];
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_EQ(scans[0]["status"], "registered");
}

/// Means of red, green and blue.
std::array<double, 3> mean_of(const Image& image) {
  std::array<double, 3> sum{};
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      for (std::size_t c = 0; c < 3; ++c) {
        sum[c] += image.rgb(x, y)[c];
      }
    }
  }
  for (double& one : sum) {
    one /= std::max(1, image.width * image.height);
  }
  return sum;
}

/// Pixels that are as red as what is under-sampled.
int red_pixels(const Image& image) {
  int count = 0;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const auto rgb = image.rgb(x, y);
      count += rgb[0] > 140 && rgb[1] < 80 && rgb[2] < 80 ? 1 : 0;
    }
  }
  return count;
}

TEST_F(OperatorWindow, LooksAsItsUserLikesAndSaysWhatIsNextInWhole) {
  const Outcome outcome =
      play("wait idle\nkey space\nwait waiting-turn\nwait model-shown\nscreenshot " + in("dark.png") +
           "\nclick settings\nclick colour-blind\nkey escape\nscreenshot " + in("blue.png") +
           "\nclick settings\nclick dark\nkey escape\nscreenshot " + in("light.png") + R"(
click face.reverse
wait looks-at.reverse
key 1
wait looks-at.obverse
click settings
click german
click font-larger
click font-larger
click font-larger
click font-larger
click font-larger
click font-larger
click font-larger
key escape
pause 0.2
expect waiting-turn
expect statement-whole
expect german-words
key space
wait waiting
expect statement-whole
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image dark = test::read_png(in("dark.png"));
  const Image blue = test::read_png(in("blue.png"));
  EXPECT_GT(red_pixels(dark), 1000);
  EXPECT_LT(red_pixels(blue), 20);
  EXPECT_LT(mean_of(dark)[1], 90);
  EXPECT_GT(mean_of(test::read_png(in("light.png")))[1], 150);
}

/// In the language with the longer words.
TEST_F(OperatorWindow, NothingIsCutOffInANarrowWindow) {
  const Outcome outcome = play(R"(wait idle
click settings
click german
key escape
pause 0.2
click calibration
click page-calibrate
wait stage-mirror
pause 0.2
expect whole.stage-linear
expect whole.stage-turntable
expect whole.stage-mirror
key escape
pause 0.2
key space
wait waiting-turn
wait model-shown
pause 0.2
expect model-whole
key 3
expect model-whole
quit
)",
                               "1024");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

/// On a small display, in the largest letters, in the language with the longer words.
TEST_F(OperatorWindow, NothingIsCutOffInTheLargestLetters) {
  std::string larger = "wait idle\nclick settings\nclick german\n";
  for (int k = 0; k < 7; ++k) {
    larger += "click font-larger\n";
  }
  const Outcome outcome = play(larger + R"(
expect title-whole
key escape
key space
wait waiting-turn
key space
wait scans.3
wait waiting
pause 0.2
expect whole.face.obverse
expect whole.face.bottom
expect scan.0.words-whole
expect scan.2.words-whole
click scan.0
click label-pins
wait pins-left
pause 0.2
expect whole.label.15
expect whole.label.F
expect whole.pins-left
expect whole.pins-close
key escape
pause 0.2
click tablet
wait cdli
pause 0.2
expect title-whole
expect whole.close-tablet
key escape
pause 0.2
key enter
wait idle 60
key enter
wait sign-name
pause 0.2
type A. Reader
key enter
wait lacks.sign-incomplete
pause 0.2
type the rim is lost
key enter
wait signed
click calibration
wait verify-artefact
click verify-artefact
type plate.toml
pause 0.2
expect whole.verify-now
expect whole.close-calibration
click close-calibration
pause 0.2
click viewer
wait whole
expect whole.view.right
expect whole.view.bottom
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace
}  // namespace dubsar
