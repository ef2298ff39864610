// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/files_below.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/in_child.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;

class FilesBelow : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directories(at("b/c"));
    for (const char* name : {"z", "b/y", "b/c/x", "a"}) {
      std::ofstream(at(name)) << name;
    }
  }
  [[nodiscard]] fs::path at(const std::string& name) const { return folder_.path() / name; }
  test::TemporaryFolder folder_;
};

TEST_F(FilesBelow, AreListedInOrderWithoutWhatIsPassedOver) {
  EXPECT_THAT(*files_below(folder_.path()), ElementsAre(at("a"), at("b/c/x"), at("b/y"), at("z")));
  EXPECT_THAT(*files_below(folder_.path(), [](const fs::path& path) { return path.filename() == "c"; }),
              ElementsAre(at("a"), at("b/y"), at("z")));
}

TEST_F(FilesBelow, ALinkIsWhatItLeadsTo) {
  fs::create_symlink("z", at("link"));
  fs::create_directory_symlink("b", at("linked"));
  fs::create_symlink("nothing", at("in vain"));
  EXPECT_THAT(*files_below(folder_.path()),
              ElementsAre(at("a"), at("b/c/x"), at("b/y"), at("link"), at("z")));
}

/// What came after it used to make it forgotten: the list was one file short, and nobody was told.
TEST_F(FilesBelow, WhatCannotBeLookedAtIsAnErrorWhateverComesAfterIt) {
  for (const char* name : {"0", "m", "zz"}) {  // before, among and behind the others
    fs::create_symlink(name, at(name));        // which leads to itself
    const auto files = files_below(folder_.path());
    ASSERT_FALSE(files);
    EXPECT_EQ(files.error().kind, ErrorKind::kStorage);
    EXPECT_EQ(files.error().where, at(name).string());
    fs::remove(at(name));
  }
  EXPECT_FALSE(files_below(at("none")));
}

TEST_F(FilesBelow, WhatIsInOtherFoldersThanTheUnreadableOneIsFound) {
  fs::permissions(folder_.path(), fs::perms(0755));
  for (const fs::perms closed : {fs::perms(0), fs::perms(0644)}) {  // not to be listed; not to be entered
    fs::permissions(at("b/c"), closed);
    EXPECT_EQ(test::in_child([&] {
                if (!test::be_bound_by_rights()) {
                  return 9;
                }
                const FoundBelow found = readable_files_below(folder_.path());
                return found.files == std::vector{at("a"), at("b/y"), at("z")} &&
                               found.unreadable.size() == 1 &&
                               found.unreadable[0].where == at("b/c").string() && !files_below(folder_.path())
                           ? 0
                           : 1;
              }),
              0);
    fs::permissions(at("b/c"), fs::perms(0755));
  }
}

}  // namespace
}  // namespace dubsar
