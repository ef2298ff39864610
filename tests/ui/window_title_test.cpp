// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What stands in the title bar of the real window.

#include <gtest/gtest.h>

#include <chrono>
#include <fstream>
#include <future>
#include <thread>

#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"
#include "tests/ui/support/window_names.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;

using WindowTitleBar = test::OnADisplay;

TEST_F(WindowTitleBar, NamesTheSessionAndTheScannerAndThenTheTablet) {
  std::ofstream(in("a.script")) << "wait idle\npause 1\nclick tablet\nclick museum-number\ntype BM 15285\n"
                                   "click close-tablet\npause 1\nquit\n";
  std::future<Outcome> run = std::async(std::launch::async, [&] {
    return run_command({"station", "--session", in("box-2"), "--device", "sim:?seed=1&size=20x16x8",
                        "--script", in("a.script")});
  });
  std::set<std::string> seen;
  while (run.wait_for(std::chrono::milliseconds(20)) != std::future_status::ready) {
    seen.merge(test::window_names());
  }
  const Outcome outcome = run.get();
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(seen.contains("box-2 – sim:?seed=1&size=20x16x8"));
  EXPECT_TRUE(seen.contains("BM 15285 – box-2 – sim:?seed=1&size=20x16x8"));
}

}  // namespace
}  // namespace dubsar
