// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// dubsar analyze on a mesh that was analysed before.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::bytes_of;
using test::Outcome;
using test::run_command;

class AnalyzeAgainTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ASSERT_EQ(
        run_command({"simulate", "tablet", "--size", "12x10x7", "--spacing", "0.15", "-o", path("T")}).status,
        0);
  }
  [[nodiscard]] std::string path(const std::string& name) const { return (folder_.path() / name).string(); }
  /// Whether it was found done.
  [[nodiscard]] bool found_done(const Arguments& more = {}) const {
    Arguments words{"analyze", path("T/tablet.ply"), "-o",    path("T/wedges.json"),
                    "--svg",   path("T/svg"),        "--json"};
    words.insert(words.end(), more.begin(), more.end());
    const Outcome outcome = run_command(words);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    const nlohmann::json json = outcome.json();
    EXPECT_GT(json["count"], 5);
    return json.value("done_before", false);
  }

  test::TemporaryFolder folder_;
};

TEST_F(AnalyzeAgainTest, TheSameIsDoneOnce) {
  EXPECT_FALSE(found_done());
  const std::string first = bytes_of(path("T/wedges.json"));
  EXPECT_TRUE(found_done());
  EXPECT_EQ(bytes_of(path("T/wedges.json")), first);
  EXPECT_FALSE(found_done({"--again"}));
  EXPECT_TRUE(found_done());
}

TEST_F(AnalyzeAgainTest, DamagedOutputsAndOtherOptionsAreDoneAgain) {
  EXPECT_FALSE(found_done());
  for (const fs::directory_entry& drawing : fs::directory_iterator(path("T/svg"))) {
    fs::remove(drawing.path());
    EXPECT_FALSE(found_done()) << drawing.path();
    EXPECT_TRUE(fs::exists(drawing.path()));
    break;
  }
  std::fstream(path("T/wedges.json")).put('x');
  EXPECT_FALSE(found_done());
  EXPECT_EQ(bytes_of(path("T/wedges.json")).front(), '{');
  EXPECT_FALSE(found_done({"--exit", "extent"}));
  EXPECT_TRUE(found_done({"--exit", "extent"}));
}

TEST_F(AnalyzeAgainTest, AMovedTabletIsStillDone) {
  EXPECT_FALSE(found_done());
  fs::rename(path("T"), path("U"));
  const Outcome outcome = run_command(
      {"analyze", path("U/tablet.ply"), "-o", path("U/wedges.json"), "--svg", path("U/svg"), "--json"});
  EXPECT_TRUE(outcome.json().value("done_before", false)) << outcome.out << outcome.err;
}

TEST_F(AnalyzeAgainTest, NothingIsRememberedOfAPipe) {
  const Outcome outcome = run_command({"analyze", path("T/tablet.ply"), "-o", "/dev/stdout"});
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_FALSE(fs::exists("/dev/stdout.done"));
}

}  // namespace
}  // namespace dubsar
