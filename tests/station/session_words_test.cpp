// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said of a session's scans and tablet: nothing is lost, nothing passes unheard, and a session goes
// by its folder's name however it is pointed at.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "build_paths.h"
#include "tests/station/support/command.h"
#include "tests/station/support/shell.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/wrong_spacing.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::bytes_of;
using test::Outcome;
using test::run_command;
using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::SizeIs;

class SessionWords : public ::testing::Test {
 protected:
  SessionWords() { copy_to("BM 1"); }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  void copy_to(const std::string& name) const {
    fs::copy(fs::path(DUBSAR_SOURCE_DIR) / "tests/data/sessions/schema1_first", at(name),
             fs::copy_options::recursive);
    for (const auto& file : fs::recursive_directory_iterator(at(name))) {
      fs::permissions(file, fs::perms::owner_write, fs::perm_options::add);
    }
  }
  [[nodiscard]] Outcome say(const char* verb, const Arguments& more) const {
    Arguments words{"session", verb, at("BM 1").string()};
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  }
  [[nodiscard]] std::string note_of(std::size_t scan) const {
    return say("list", {"--json"}).json()["scans"][scan]["note"];
  }
  static void expect_refused(const Outcome& outcome, const char* with) {
    EXPECT_EQ(outcome.status, 2) << outcome.out;
    EXPECT_THAT(outcome.complaints(), SizeIs(1)) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr(with));
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(SessionWords, TheFirstReasonForTakingAScanOutStands) {
  ASSERT_EQ(say("drop", {"1", "--why", "a thumb in view"}).status, 0);
  for (const Arguments& again : {Arguments{"1"}, {"1", "--why", "a thumb in view"}}) {
    const Outcome outcome = say("drop", again);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("was taken out before: a thumb in view; nothing changed"));
  }
  expect_refused(say("drop", {"1", "--why", "too dark"}), "restore it first");
  EXPECT_EQ(note_of(1), "a thumb in view");
  EXPECT_EQ(say("restore", {"1", "--json"}).json()["changed"], true);
  EXPECT_EQ(say("restore", {"1", "--json"}).json()["changed"], false);
  EXPECT_THAT(say("restore", {"0"}).out, HasSubstr("scan 0 was not taken out"));
  expect_refused(say("restore", {"9"}), "there is no scan 9");
  expect_refused(say("drop", {"9"}), "there is no scan 9");
}

TEST_F(SessionWords, AnEmptyTextTakesAFieldOfTheTabletAway) {
  ASSERT_EQ(say("describe", {"--museum-number", "K 1", "--collection", "BM"}).status, 0);
  const nlohmann::json tablet = say("describe", {"--museum-number", "", "--json"}).json()["tablet"];
  EXPECT_EQ(tablet["museum_number"], "");
  EXPECT_EQ(tablet["collection"], "BM");
  const nlohmann::json after = say("describe", {"--collection=", "--json"}).json()["tablet"];
  EXPECT_EQ(after["collection"], "") << "not the word that comes next";
}

TEST_F(SessionWords, NamesAndReasonsHaveNoControlCharacters) {
  for (const char* text : {"two\nlines", "red \x1B[31m",
                           "red \xC2\x9B"
                           "31m"}) {
    expect_refused(say("drop", {"1", "--why", text}), "--why: has control characters");
    expect_refused(say("describe", {"--operator", text}), "--operator: has control characters");
    for (const char* option : {"--name", "--role", "--incomplete"}) {
      Arguments words{option, text};
      if (words.front() != "--name") {
        words.insert(words.end(), {"--name", "A. Reader"});
      }
      expect_refused(say("sign", words), "has control characters");
    }
  }
}

TEST_F(SessionWords, AReasonIsTextAndBlanksAreNone) {
  expect_refused(say("drop", {"1", "--why", "d\xE4mmrig"}), "--why: has bytes that are no UTF-8");
  ASSERT_EQ(say("drop", {"1", "--why", "  "}).status, 0);
  EXPECT_EQ(note_of(1), "");
}

TEST_F(SessionWords, ASessionGoesByItsFoldersNameHoweverItIsPointedAt) {
  const auto sender = [&](const char* session, const char* package) {
    const Outcome made = run_command({"export", session, "--to", at(package).string(), "--without",
                                      "renderings,features,wedges,grid-ply", "--json"});
    EXPECT_EQ(made.status, 0) << made.err;
    EXPECT_THAT(bytes_of(at(package) / "bag-info.txt"), HasSubstr("Internal-Sender-Identifier: BM 1\n"));
    return made.json().value("identifier", "");
  };
  EXPECT_EQ(sender((at("BM 1") / "").c_str(), "slash"), "BM 1");
  const fs::path stood = fs::current_path();
  fs::current_path(at("BM 1"));
  EXPECT_EQ(sender(".", "dot"), "BM 1");
  EXPECT_LE(run_command({"plan", ".", "--page", at("page.html").string()}).status, 1);
  fs::current_path(stood);
  EXPECT_THAT(bytes_of(at("page.html")), HasSubstr("<title>BM 1"));
}

TEST_F(SessionWords, AFolderWhoseNameIsNoUtf8IsExportedAllTheSame) {
  copy_to("B\xFFM");
  const Outcome made =
      run_command({"export", at("B\xFFM").string(), "--to", at("package").string(), "--json"});
  ASSERT_EQ(made.status, 0) << made.err;
  EXPECT_EQ(made.json()["identifier"], "B\xEF\xBF\xBDM");
  EXPECT_EQ(run_command({"verify", at("package").string()}).status, 0);
  EXPECT_THAT(bytes_of(at("package") / "bag-info.txt"), Not(HasSubstr("\xFF")));
}

/// Whoever reads the session later knows what the operator was told.
TEST_F(SessionWords, WhatTheReaderOfAScanRemarkedStaysWithTheSession) {
  fs::create_directory(at("scans"));
  std::ofstream(at("scans") / "a.ply") << test::ply_of_wrong_spacing();
  const std::string session = at("s").string();
  ASSERT_LE(run_command({"scan", "--device", "replay:" + at("scans").string(), "--session", session}).status,
            1);
  const std::string said = "its header says a spacing of 2.5 mm";
  EXPECT_THAT(run_command({"session", "list", session, "--json"}).json()["scans"][0].value("remark", ""),
              HasSubstr(said));
  EXPECT_THAT(run_command({"session", "list", session}).out, HasSubstr("a.ply: " + said));
  const nlohmann::json remarks = run_command({"plan", session, "--json"}).json()["checklist"]["remarks"];
  ASSERT_EQ(remarks.size(), 1U);
  EXPECT_EQ(remarks[0]["scan"], 0);
  EXPECT_THAT(remarks[0].value("text", ""), HasSubstr(said));
  ASSERT_EQ(run_command({"export", session, "--to", at("package").string(), "--without",
                         "renderings,features,wedges,grid-ply"})
                .status,
            0);
  for (const char* file : {"scans/scans.json", "report/report.html", "report/checklist.html"}) {
    EXPECT_THAT(bytes_of(at("package") / "data" / file), HasSubstr(said)) << file;
  }
}

/// The first file that is opened would have the number of the stream.
TEST_F(SessionWords, NothingThatIsSaidGoesIntoAFileWhereAStreamIsClosed) {
  test::shell("{ " DUBSAR_BINARY_DIR "/bin/dubsar plan " + test::quoted(at("BM 1")) + " 2>&-; }");
  EXPECT_THAT(bytes_of(at("BM 1") / "session.lock"), Not(HasSubstr("%")));
}

}  // namespace
}  // namespace dubsar
