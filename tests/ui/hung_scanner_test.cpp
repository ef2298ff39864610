// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scanner that does not come back, in the real window: it is said, and the window that is closed leaves no
// program behind.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "build_paths.h"
#include "tests/station/support/command.h"
#include "tests/ui/support/on_a_display.h"

namespace dubsar {
namespace {

using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class HungScanner : public test::OnADisplay {
 protected:
  /// Up to the middle of a second scan, and from there on as `script` has it.
  [[nodiscard]] Outcome play(const std::string& script) const {
    const auto file = folder_.path() / "a.script";
    std::ofstream(file) << "wait idle\nkey space\nwait scans.1\nwait waiting\nkey space\nwait scanning\n"
                        << script;
    return run_command(
        {"station", "--session", session(), "--device", "hang:" + (folder_.path() / "never").string(),
         "--script", file.string()},
        {.environment = {"DUBSAR_DRIVER_PATH=" DUBSAR_BINARY_DIR "/lib/dubsar/test_drivers/hang"}});
  }
  /// The window was closed, the program is gone, and what was stored is there.
  void expect_ended(const Outcome& ended) const {
    EXPECT_FALSE(ended.timed_out);
    EXPECT_EQ(ended.signal, 0);
    EXPECT_EQ(ended.status, 3) << ended.err;
    const std::size_t told = ended.err.find("hang: told to stop");
    const std::size_t ends = ended.err.find("the device does not answer: the program ends without it");
    EXPECT_LT(told, ends) << ended.err;
    EXPECT_NE(ends, std::string::npos) << ended.err;
    const Outcome verified = run_command({"verify", session()});
    EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
    const Outcome described = run_command({"session", "describe", session(), "--notes", "it hung"});
    EXPECT_EQ(described.status, 0) << described.err;
    EXPECT_THAT(run_command({"session", "list", session(), "--json"}).json()["scans"], SizeIs(1));
  }
  [[nodiscard]] std::string session() const { return (folder_.path() / "session").string(); }
};

TEST_F(HungScanner, AfterStopItIsSaidAndTheWindowCanBeClosed) {
  const Outcome ended = play("click stop\nwait device-silent\nwait statement-whole\nquit\n");
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("waited in vain"))) << ended.err;
  expect_ended(ended);
}

TEST_F(HungScanner, SoItIsAfterTheEmergencyStop) {
  const Outcome ended = play("halt\nwait device-silent\nquit\n");
  EXPECT_THAT(ended.err, ::testing::Not(HasSubstr("waited in vain"))) << ended.err;
  expect_ended(ended);
}

TEST_F(HungScanner, AWindowThatIsClosedAtOnceLeavesNoProgramBehind) {
  expect_ended(play("quit\n"));
}

}  // namespace
}  // namespace dubsar
