// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session whose scans came from another machine, in a window that has no scanner.

#include <gtest/gtest.h>

#include <fstream>

#include "acquisition/session_store.h"
#include "tests/station/support/command.h"
#include "tests/station/support/two_fold_scans.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;

using ScannedElsewhere = test::OnADisplay;

TEST_F(ScannedElsewhere, ScansThatNobodyJudgedAreJudgedAndSignedWithoutAScanner) {
  {
    Result<SessionStore> store = SessionStore::open_or_create(in("session"));
    ASSERT_TRUE(store) << store.error().line();
    for (int k = 0; k < 2; ++k) {
      testing::FieldScan scan;
      scan.seed = 1 + 8 * static_cast<std::uint64_t>(k);
      ASSERT_TRUE(
          store->add_grid(testing::scan_field(test::two_fold_surface(), test::two_fold_pose(k), scan)));
    }
  }
  std::ofstream(in("a.script")) << "wait idle\nwait scans.2\nexpect statement-whole\nkey enter\n"
                                   "wait scan.0.fits 120\nwait idle 120\n"
                                   // it fits under a half turn as well: that is told also when nothing runs
                                   "expect scan.1.unsure\nexpect unplaced\n"
                                   "key enter\nwait sign-name\npause 0.2\ntype A. Reader\nkey enter\n"
                                   "wait lacks.sign-incomplete\npause 0.2\ntype one side alone was scanned\n"
                                   "key enter\nwait signed 60\nexpect package\nquit\n";
  const Outcome outcome = run_command({"station", "--session", in("session"), "--script", in("a.script")});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const auto scans = run_command({"session", "list", in("session"), "--json"}).json()["scans"];
  ASSERT_EQ(scans.size(), 2U);
  EXPECT_EQ(scans[0]["status"], "registered");
  EXPECT_EQ(scans[1]["status"], "unsure");
}

}  // namespace
}  // namespace dubsar
