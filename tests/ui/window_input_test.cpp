// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the window says to displays, scripts and meshes that it cannot work with.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"
#include "tests/ui/support/display.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

TEST(WindowInput, NoDisplayIsOneLineAndStatusThree) {
  unsetenv("DISPLAY");
  unsetenv("WAYLAND_DISPLAY");
  const test::TemporaryFolder folder;
  const Outcome outcome = run_command({"station", "--session", (folder.path() / "s").string()});
  EXPECT_EQ(outcome.status, 3);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("command line"));
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "s"));
}

TEST(WindowInput, ADisplayWithoutOpenGlIsOneLineAndStatusThree) {
  const test::Display display("800x600x24", false);
  if (!display.works()) {
    GTEST_SKIP() << "there is no Xvfb here (Debian package xvfb)";
  }
  const Outcome outcome = run_command({"station"});
  EXPECT_EQ(outcome.status, 3);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("OpenGL 4.1"));
}

TEST(WindowInput, ABadScriptIsNamedByItsLine) {
  const test::TemporaryFolder folder;
  const auto file = folder.path() / "bad.script";
  std::ofstream(file) << "wait idle\nshout\n";
  const Outcome outcome = run_command({"station", "--script", file.string()});
  EXPECT_EQ(outcome.status, 2);
  ASSERT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
  EXPECT_THAT(outcome.complaints().front(), HasSubstr("bad.script:2"));
}

}  // namespace
}  // namespace dubsar
