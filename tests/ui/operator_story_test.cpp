// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The whole of an operator's day, by keys and clicks in the real window: a scan that is unsure, one that is
// taken out and put back, the verdict, the signature.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Outcome;
using test::run_command;

constexpr const char* kSmallTablet = "sim:?seed=1&size=20x16x8&spacing=0.2&noise=0.02";

class OperatorStory : public ::testing::Test {
 protected:
  void SetUp() override {
    if (!display_.works()) {
      GTEST_SKIP() << "there is no Xvfb here (Debian package xvfb)";
    }
  }
  Outcome play(const std::string& script, const std::vector<std::string>& more = {}) {
    const fs::path file = folder_.path() / "story.script";
    std::ofstream(file) << script;
    std::vector<std::string> words{"station",    "--session", session(),    "--device",
                                   kSmallTablet, "--script",  file.string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words, {.timeout_s = 150});
  }
  [[nodiscard]] std::string session() const { return (folder_.path() / "session").string(); }

  test::TemporaryFolder folder_;
  test::Display display_;
};

TEST_F(OperatorStory, FromTheFirstKeyToASignedConclusiveTablet) {
  const Outcome played = play(R"(
wait idle
expect scan
key space
wait waiting-turn
key space
wait scans.3
wait waiting-turn
key space
# a scan that fits nowhere for certain is not taken up in silence
wait waiting-unsure
expect scan.3.unsure
key p
wait pair-left
click pairs-close
key space
wait waiting-turn
expect scan.3.fits
# out, and back again
key backspace
wait scan.5.taken out
wait waiting
click scan.5
click restore
wait scan.5.fits
wait waiting-turn
key space
wait waiting-turn
key space
wait waiting-turn
key space
wait idle 120
expect conclusive
key enter
wait sign-name
click sign-name
type A. Reader
key enter
wait signed
quit
)");
  ASSERT_EQ(played.status, 0) << played.err;
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  ASSERT_EQ(list["sign_offs"].size(), 1U);
  EXPECT_EQ(list["sign_offs"][0]["name"], "A. Reader");
  EXPECT_EQ(list["sign_offs"][0]["conclusive"], true);
  EXPECT_EQ(run_command({"verify", session()}).status, 0);
  EXPECT_EQ(run_command({"plan", session(), "--json"}).json()["conclusive"], true);
}

TEST_F(OperatorStory, WhatIsSaidOfTheTabletIsKeptAndAClosedWindowGoesOn) {
  const Outcome first = play(R"(
wait idle
click tablet
click museum-number
type VAT 12345
click cdli
type P1234
pause 0.2
click cdli
type 56
click close-tablet
key space
wait waiting-turn
quit
)");
  ASSERT_EQ(first.status, 0) << first.err;
  // The window was closed in the middle of a run: what was stored is there, and it goes on.
  const auto list = run_command({"session", "list", session(), "--json"}).json();
  ASSERT_GE(list["scans"].size(), 2U);
  const Outcome second = play(R"(
wait scan.1.fits
wait idle
expect scan.0.fits
key space
wait waiting
wait scans.3
quit
)");
  ASSERT_EQ(second.status, 0) << second.err;
}

}  // namespace
}  // namespace dubsar
