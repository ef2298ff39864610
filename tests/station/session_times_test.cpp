// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sessions through time: those of earlier versions, a clock that is set back, two programs at once.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/session_store.h"
#include "build_paths.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::CommandOptions;
using test::Outcome;
using test::run_command;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kDevice = "sim:?seed=2&size=14x11x8&spacing=0.5";

class OldSessions : public testing::TestWithParam<const char*> {};

TEST_P(OldSessions, OpenVerifyAndGoOn) {
  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "session";
  fs::copy(fs::path(DUBSAR_SOURCE_DIR) / "tests/data/sessions" / GetParam(), session,
           fs::copy_options::recursive);
  for (const char* name : {"grids", "mesh", "analysis"}) {
    fs::create_directories(session / name);  // git keeps no empty folder
  }
  const bool was_signed = std::string(GetParam()).ends_with("signed");
  const Outcome verified = run_command({"verify", session.string(), "--json"});
  EXPECT_EQ(verified.status, 0) << verified.out << verified.err;
  EXPECT_EQ(verified.json()["sign_offs"].size(), was_signed ? 1U : 0U);
  const Outcome listed = run_command({"session", "list", session.string(), "--json"});
  EXPECT_EQ(listed.status, 0) << listed.err;
  ASSERT_EQ(listed.json()["scans"].size(), 3U);
  for (const Arguments& verb : {Arguments{"plan", session.string()}, Arguments{"register", session.string()},
                                Arguments{"session", "drop", session.string(), "0"},
                                Arguments{"scan", "--auto", "--max-scans", "4", "--device", kDevice,
                                          "--session", session.string()}}) {
    const Outcome done = run_command(verb);
    EXPECT_TRUE(done.status == 0 || done.status == 1) << verb.front() << ": " << done.err;
  }
  const auto store = SessionStore::open(session, SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store);
  EXPECT_EQ(store->scans().value().size(), 5U) << "four that stand and the dropped one";
  JobContext job;
  EXPECT_TRUE(store->verify(job).value().ok());
}

INSTANTIATE_TEST_SUITE_P(Schemas, OldSessions, testing::Values("schema1_first", "schema1_signed"),
                         [](const auto& schema) { return std::string(schema.param); });

/// The command ten years ago, as its clock has it.
Outcome long_ago(const Arguments& arguments) {
  CommandOptions options;
  options.environment = {"LD_PRELOAD=" DUBSAR_BINARY_DIR "/lib/dubsar/test_support/libdubsar_other_clock.so",
                         "DUBSAR_CLOCK_OFF_S=-315360000"};
  return run_command(arguments, options);
}

TEST(SessionTimes, AClockSetBackChangesNoOrder) {
#ifdef DUBSAR_SANITIZED
  GTEST_SKIP() << "a sanitizer's own library has to be loaded first";
#endif
  const test::TemporaryFolder folder;
  const std::string session = (folder.path() / "session").string();
  const auto scan = [&](const char* most) {
    return Arguments{"scan", "--auto", "--max-scans", most, "--device", kDevice, "--session", session};
  };
  const auto sign = [&](const char* name) {
    return Arguments{"session", "sign", session, "--name", name, "--incomplete", "a trial"};
  };
  ASSERT_LE(run_command(scan("2")).status, 1);
  ASSERT_LE(run_command(sign("The First")).status, 1);
  ASSERT_LE(long_ago(scan("3")).status, 1);
  ASSERT_LE(long_ago(sign("The Second")).status, 1);
  {
    const auto store = SessionStore::open(session, SessionStore::Access::kReadOnly);
    const std::vector<SessionEvent> events = store->events().value();
    ASSERT_GT(events.size(), 2U);
    EXPECT_LT(events.back().time_ns, events.front().time_ns) << "the clock was not set back";
    for (std::size_t i = 0; i < events.size(); ++i) {
      EXPECT_EQ(events[i].number, static_cast<std::int64_t>(i) + 1);
    }
  }
  // The latest word counts, whatever the clock said when it was given.
  const auto sign_offs = run_command({"verify", session, "--json"}).json()["sign_offs"];
  ASSERT_EQ(sign_offs.size(), 2U);
  EXPECT_EQ(sign_offs[1]["name"], "The Second");
  EXPECT_EQ(sign_offs[1]["holds"], true);
  EXPECT_EQ(sign_offs[0]["holds"], false);
  EXPECT_EQ(long_ago({"session", "undo", session}).status, 0);
  const auto scans = SessionStore::open(session, SessionStore::Access::kReadOnly)->scans().value();
  ASSERT_EQ(scans.size(), 3U);
  EXPECT_TRUE(scans[2].dropped) << "undo takes the newest scan out";
  EXPECT_FALSE(scans[0].dropped || scans[1].dropped);
}

TEST(SessionTimes, TheSecondProgramIsToldWhoHasTheSession) {
  const test::TemporaryFolder folder;
  const std::string session = (folder.path() / "session").string();
  test::RunningCommand first(
      {"scan", "--auto", "--max-scans", "30", "--device", kDevice, "--session", session});
  ASSERT_TRUE(first.says("scan 0 stored"));
  for (const Arguments& verb : {Arguments{"scan", "--auto", "--device", kDevice, "--session", session},
                                Arguments{"register", session}, Arguments{"session", "undo", session},
                                Arguments{"verify", session, "--repair"}}) {
    const Outcome second = run_command(verb);
    if (verb.front() == "verify") {
      EXPECT_EQ(second.status, 0) << "it only reads where there is nothing to mend: " << second.err;
      continue;
    }
    EXPECT_EQ(second.status, 4) << "to be tried again: " << second.err;
    ASSERT_EQ(second.complaints().size(), 1U) << second.err;
    EXPECT_THAT(second.complaints()[0], HasSubstr("another program is writing to this session (process "));
  }
  first.send(SIGINT);
  first.wait();
  EXPECT_EQ(run_command({"session", "undo", session}).status, 0) << "free again";
}

}  // namespace
}  // namespace dubsar
