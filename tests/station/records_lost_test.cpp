// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a session records of its tablet (signature, description, what was taken out), damaged in both its
// tables and their backup: told, refused to be built upon, brought back from a copy, and named where nothing
// does.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/acquisition/spoil.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::Arguments;
using test::Outcome;
using test::run_command;
using test::spoil;
using test::spoil_both;
using testing::HasSubstr;
using testing::IsEmpty;

class RecordsLost : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new test::TemporaryFolder;
    const std::string made = (folder_->path() / "made").string();
    run_command({"scan", "--auto", "--max-scans", "3", "--device", "sim:?seed=4&size=18x14x9&spacing=0.4",
                 "--session", made});
    run_command({"session", "describe", made, "--museum-number", "BM 15285"});
    run_command({"session", "drop", made, "2", "--why", "a hand in view"});
    run_command({"register", made});
    run_command({"plan", made});
    signed_ = run_command({"session", "sign", made, "--name", "A. Reader", "--incomplete", "three scans"});
  }
  static void TearDownTestSuite() { delete folder_; }
  void SetUp() override {
    ASSERT_EQ(signed_.status, 0) << signed_.err;
    fs::copy(folder_->path() / "made", session_, fs::copy_options::recursive);
    fs::copy(folder_->path() / "made", copy_, fs::copy_options::recursive);
  }
  void TearDown() override {
    fs::remove_all(session_);
    fs::remove_all(copy_);
  }
  [[nodiscard]] Outcome repair(const Arguments& more = {}) const {
    Arguments arguments{"verify", session_.string(), "--repair", "--json"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run_command(arguments);
  }
  void remove_both() const {
    fs::remove(session_ / "session.sqlite");
    fs::remove(session_ / "session.backup.sqlite");
  }

  const fs::path session_ = folder_->path() / "session";
  const fs::path copy_ = folder_->path() / "copy";
  static test::TemporaryFolder* folder_;
  static Outcome signed_;
};
test::TemporaryFolder* RecordsLost::folder_ = nullptr;
Outcome RecordsLost::signed_;

TEST_F(RecordsLost, AWordIsRefusedWhereRecordsAreDamagedAndNothingIsWritten) {
  spoil_both(session_, "A. Reader");
  const std::string at = session_.string();
  const std::string tables = test::text_of_file(session_ / "session.sqlite");
  for (const Arguments& word :
       {Arguments{"lock", at, "1"}, Arguments{"unlock", at, "1"}, Arguments{"drop", at, "1"},
        Arguments{"restore", at, "2"}, Arguments{"undo", at}, Arguments{"describe", at, "--notes", "x"},
        Arguments{"hint", at, "1", "--withdraw"}}) {
    Arguments arguments{"session"};
    arguments.insert(arguments.end(), word.begin(), word.end());
    const Outcome refused = run_command(arguments);
    EXPECT_EQ(refused.status, 2) << word.front();
    EXPECT_THAT(refused.err, HasSubstr("its records are damaged, and nothing was changed")) << word.front();
    EXPECT_THAT(refused.err, HasSubstr("dubsar verify --repair --from COPY")) << word.front();
  }
  EXPECT_EQ(test::text_of_file(session_ / "session.sqlite"), tables);
  EXPECT_EQ(repair({"--from", copy_.string()}).json()["sign_offs"].size(), 1U);
  const Outcome said = run_command({"session", "describe", at, "--notes", "x"});
  EXPECT_EQ(said.status, 0) << said.err;
}

TEST_F(RecordsLost, ADamagedBackupWithTheLastSignatureIsNotOverwritten) {
  fs::remove(session_ / "session.sqlite");
  spoil(session_ / "session.backup.sqlite", "A. Reader");
  const std::string backup = test::text_of_file(session_ / "session.backup.sqlite");
  const Outcome planned =
      run_command({"plan", session_.string()});  // goes on with what there is, and says so
  EXPECT_THAT(planned.err, HasSubstr("kept the damaged backup as session.backup.sqlite.damaged-1"));
  EXPECT_THAT(planned.err, HasSubstr("is lost; bring it back from a copy"));
  EXPECT_EQ(test::text_of_file(session_ / "session.backup.sqlite.damaged-1"), backup);
}

TEST_F(RecordsLost, ACopyBringsThemBackAndTheExportGoesOn) {
  const std::string bag = (folder_->path() / "bag").string();
  const Arguments pack{"export",  session_.string(), "--to",
                       bag,       "--without",       "renderings,features,wedges,grid-ply",
                       "--update"};
  ASSERT_EQ(run_command(pack).status, 0);
  remove_both();
  const Outcome alone = repair();
  EXPECT_EQ(alone.status, 1);
  EXPECT_FALSE(alone.json()["lost"].empty());
  const Outcome later = run_command({"verify", session_.string()});
  EXPECT_EQ(later.status, 1) << "it goes on saying so";
  EXPECT_THAT(later.out, HasSubstr("lost: session.sqlite: records are lost that nothing names"));
  EXPECT_THAT(later.out, HasSubstr("0 damaged, and records are lost\n"));
  EXPECT_THAT(run_command({"session", "list", session_.string()}).out,
              HasSubstr("it may have been taken out"));
  const Outcome refused = run_command(pack);
  EXPECT_EQ(refused.status, 2);
  EXPECT_THAT(refused.err, HasSubstr("where there is none, choose another folder"));

  const Outcome mended = repair({"--from", copy_.string()});
  EXPECT_EQ(mended.status, 0) << mended.out;
  EXPECT_THAT(mended.json()["lost"], IsEmpty());
  EXPECT_THAT(mended.json()["unrecorded"], IsEmpty());
  ASSERT_EQ(mended.json()["sign_offs"].size(), 1U);
  EXPECT_THAT(run_command({"session", "list", session_.string()}).out, HasSubstr("a hand in view"));
  const Outcome packed = run_command(pack);
  EXPECT_EQ(packed.status, 0) << packed.err;
  fs::remove_all(bag);
}

TEST_F(RecordsLost, ARowThatNothingBringsBackIsNamedWithStatus1) {
  spoil_both(session_, "BM 15285");
  const Outcome mended = repair();
  EXPECT_EQ(mended.status, 1);
  EXPECT_THAT(mended.json()["lost"].dump(), HasSubstr("documents row tablet is lost"));
  EXPECT_THAT(mended.json()["lost"].dump(), HasSubstr("events row "));
  EXPECT_THAT(mended.json()["damaged"], IsEmpty());
  EXPECT_EQ(repair().status, 1);
  const Outcome back = repair({"--from", copy_.string()});
  EXPECT_EQ(back.status, 0) << back.out;
  EXPECT_THAT(back.json()["repair"]["records"].dump(), HasSubstr("documents row tablet"));
}

}  // namespace
}  // namespace dubsar
