// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which files of a collection are searched: one for each tablet, through links, and nothing that was set
// aside.
#include "station/analysed_files.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>
#include <vector>

#include "tests/support/in_child.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

class AnalysedFilesTest : public ::testing::Test {
 protected:
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / "c" / name; }
  void put(const std::string& name) const {
    fs::create_directories(at(name).parent_path());
    std::ofstream(at(name)) << name;
  }
  [[nodiscard]] std::vector<std::string> names_in(const std::string& folder) const {
    std::vector<std::string> names;
    const auto found = analysed_files(at(folder));
    EXPECT_TRUE(found);
    if (found) {
      EXPECT_THAT(found->unread, IsEmpty());
      for (const fs::path& path : found->paths) {
        names.push_back(path.lexically_relative(at(folder)).string());
      }
    }
    return names;
  }
  test::TemporaryFolder folder_;
};

TEST_F(AnalysedFilesTest, ATabletIsThereOnce) {
  for (const char* session : {"bare", "done", "new"}) {
    put(session + std::string("/session.sqlite"));
    put(session + std::string("/analysis/run.json"));
  }
  for (const char* name :
       {"bare/analysis/wedges.json", "done/analysis/wedges.json", "done.results/wedges.json",
        "done.results/mine.json", "done.results/package/bagit.txt",
        "done.results/package/data/wedges/wedges.json", "done.results/package/data/kept/analysis/wedges.json",
        "grids/grids/001.grid", "grids/analysis/wedges.json", "mesh/model.ply", "mesh/wedges.json",
        "mesh/other.json", "open/tablet.ply", "open/a.json", "open/b.json", "flat/a.json", "flat/truth.json",
        "flat/wedges.json", "lone.results/wedges.json"}) {
    put(name);
  }
  EXPECT_THAT(names_in(""),
              ElementsAre("bare/analysis/wedges.json", "done.results/wedges.json", "flat/a.json",
                          "flat/wedges.json", "grids/analysis/wedges.json", "lone.results/wedges.json",
                          "mesh/wedges.json", "open/a.json", "open/b.json"));
}

TEST_F(AnalysedFilesTest, WhatIsHiddenKeptAsideOrABagIsLeftOut) {
  for (const char* name : {".trash/wedges.json", "a/.b.json", "a/wedges.json", "a.kept-1/wedges.json",
                           "a.damaged-12/wedges.json", "a.kept-/wedges.json", "a.kept-x/wedges.json",
                           "bag/bagit.txt", "bag/data/wedges.json"}) {
    put(name);
  }
  EXPECT_THAT(names_in(""), ElementsAre("a/wedges.json", "a.kept-/wedges.json", "a.kept-x/wedges.json"));
  // Who names one of these means it.
  EXPECT_THAT(names_in("bag"), ElementsAre("data/wedges.json"));
  EXPECT_THAT(names_in("a.kept-1"), ElementsAre("wedges.json"));
  put("s/session.sqlite");
  put("s/analysis/wedges.json");
  EXPECT_THAT(names_in("s"), ElementsAre("analysis/wedges.json"));
}

TEST_F(AnalysedFilesTest, ASessionOfGridsAloneIsNotPassedOverInSilence) {
  for (const char* name : {"a/wedges.json", "half/grids/000.grid", "half/grids/001.grid",
                           "deep/er/session.backup.sqlite", "new/session.sqlite", "new/grids/000.grid",
                           "done/grids/000.grid", "done.results/wedges.json", "aside.kept-1/grids/000.grid",
                           "scans/grids/first.grid", "bag/bagit.txt", "bag/data/grids/000.grid"}) {
    put(name);
  }
  const auto found = analysed_files(at(""));
  ASSERT_TRUE(found);
  EXPECT_THAT(found->lost_sessions, ElementsAre("deep/er", "half"));
  EXPECT_THAT(found->unread, IsEmpty());
  EXPECT_THAT(found->paths, ElementsAre(at("a/wedges.json"), at("done.results/wedges.json")));
}

TEST_F(AnalysedFilesTest, LinksAreFollowedAndGiveNothingTwice) {
  for (const char* name : {"a/wedges.json", "b/x/wedges.json", "../far/s/session.sqlite",
                           "../far/s/analysis/wedges.json", "../far/m/wedges.json", "../far/one.json"}) {
    put(name);
  }
  const fs::path far = folder_.path() / "far";
  fs::create_directory_symlink(far, at("a1"));
  fs::create_directory_symlink("..", at("b/x/up"));
  fs::create_directory_symlink(".", at("a/here"));
  fs::create_directory_symlink("b", at("again"));
  fs::create_symlink("../a/wedges.json", at("b/same.json"));
  fs::create_symlink(far / "one.json", at("b/one.json"));
  fs::create_symlink("nowhere", at("b/none.json"));
  EXPECT_THAT(names_in(""), ElementsAre("a/wedges.json", "a1/m/wedges.json", "a1/one.json",
                                        "a1/s/analysis/wedges.json", "b/x/wedges.json"));
}

TEST_F(AnalysedFilesTest, WhatCannotBeReadIsToldOf) {
  for (const char* name : {"a/wedges.json", "closed/wedges.json"}) {
    put(name);
  }
  fs::create_symlink("itself", at("itself"));
  fs::permissions(at("closed"), fs::perms::none);
  fs::permissions(folder_.path(), fs::perms::all);
  const auto look = [this] {
    const auto found = analysed_files(at(""));
    return found && found->paths == std::vector{at("a/wedges.json")} && found->unread.size() == 2 &&
           found->unread[0].name == "closed" && found->unread[0].reason == "Permission denied" &&
           found->unread[1].name == "itself";
  };
  EXPECT_EQ(test::in_child([&] { return test::be_bound_by_rights() && look() ? 0 : 1; }), 0);
  fs::permissions(at("closed"), fs::perms::owner_all);
  const auto nothing = analysed_files(at("nowhere"));
  ASSERT_FALSE(nothing);
  EXPECT_EQ(nothing.error().kind, ErrorKind::kBadInput);
}

}  // namespace
}  // namespace dubsar
