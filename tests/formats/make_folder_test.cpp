// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/make_folder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/files.h"
#include "tests/support/seen_syncs.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

TEST(MakeFolder, MakesWhatIsNotThereAndLeavesWhatIs) {
  const test::TemporaryFolder folder;
  const std::filesystem::path deep = folder.path() / "a" / "b" / "c";
  ASSERT_TRUE(make_folder(deep));
  test::put(deep / "file", "kept");
  ASSERT_TRUE(make_folder(deep));
  EXPECT_EQ(test::text_of_file(deep / "file"), "kept");
}

TEST(MakeFolder, WhatItMakesIsThereAfterAPowerCut) {
  const test::TemporaryFolder folder;
  const std::filesystem::path deep = folder.path() / "a" / "b" / "c";
  test::forget_syncs();
  ASSERT_TRUE(make_folder(deep / ""));
  for (const auto& parent : {folder.path(), folder.path() / "a", folder.path() / "a" / "b"}) {
    EXPECT_TRUE(test::was_synced(parent)) << parent;
  }
  test::forget_syncs();
  ASSERT_TRUE(make_folder(deep));
  EXPECT_FALSE(test::was_synced(deep.parent_path())) << "there is nothing new in it";
  const Status roundabout = make_folder(folder.path() / "d" / ".." / "e" / "." / "f");
  ASSERT_TRUE(roundabout) << roundabout.error().line();
  EXPECT_TRUE(test::was_synced(folder.path() / "e"));
}

TEST(MakeFolder, SaysWhatWhereAndTheMend) {
  const test::TemporaryFolder folder;
  test::put(folder.path() / "file", "in the way");
  const Status made = make_folder(folder.path() / "file" / "below");
  ASSERT_FALSE(made);
  EXPECT_EQ(made.error().kind, ErrorKind::kStorage);
  EXPECT_EQ(made.error().where, (folder.path() / "file" / "below").string());
  EXPECT_THAT(made.error().line(), HasSubstr("cannot make the folder: Not a directory"));
  EXPECT_THAT(made.error().line(), HasSubstr("choose a folder that can be written to"));
}

TEST(MakeFolder, SaysThatANameIsTooLong) {
  const test::TemporaryFolder folder;
  const Status made = make_folder(folder.path() / std::string(300, 'x'));
  ASSERT_FALSE(made);
  EXPECT_THAT(made.error().line(), HasSubstr("File name too long; choose a shorter name"));
}

}  // namespace
}  // namespace dubsar
