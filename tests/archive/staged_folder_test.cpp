// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "archive/staged_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <set>
#include <string>

#include "tests/support/files.h"
#include "tests/support/temporary_folder.h"

namespace {

/// A file system that cannot exchange two names, as not all of them can, and then one name that it refuses.
bool cannot_exchange = false;
std::string refuses_from;
/// Folders cannot be synced.
bool refuses_sync = false;
int exchanges = 0;  ///< of names, so far
std::set<ino_t> synced_folders;
/// A name that cannot be taken away.
std::string refuses_to_go;

}  // namespace

// In the place of the C library's.
extern "C" int renameat2(int from_folder, const char* from, int to_folder, const char* to,
                         unsigned flags) noexcept {
  if (cannot_exchange && flags != 0) {
    errno = EINVAL;
    return -1;
  }
  if (!refuses_from.empty() && from == refuses_from) {
    errno = EIO;
    return -1;
  }
  exchanges += flags != 0 ? 1 : 0;
  return static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}
extern "C" int rename(const char* from, const char* to) noexcept {
  return renameat2(AT_FDCWD, from, AT_FDCWD, to, 0);
}
extern "C" int fsync(int file) {
  struct stat what {};
  if (::fstat(file, &what) == 0 && S_ISDIR(what.st_mode)) {
    synced_folders.insert(what.st_ino);
  }
  if (refuses_sync && ::fstat(file, &what) == 0 && S_ISDIR(what.st_mode) && exchanges > 0) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_fsync, file));
}
extern "C" int unlinkat(int folder, const char* name, int flags) noexcept {
  if (!refuses_to_go.empty() && name == refuses_to_go) {
    errno = EPERM;
    return -1;
  }
  return static_cast<int>(::syscall(SYS_unlinkat, folder, name, flags));
}

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::put;
using test::text_of_file;
using ::testing::HasSubstr;

TEST(StagedFolder, WhatWasLeftAndCannotBeTakenAwayIsSaid) {
  const test::TemporaryFolder folder;
  const fs::path left = folder.path() / (std::string(kTemporaryPrefix) + "bag");
  const std::string names[] = {"a", "b", "c"};
  for (const std::string& name : names) {  // in whatever order they are listed, others come after one of them
    for (const std::string& each : names) {
      put(left / each / ("in_" + each), "of a program that was killed");
    }
    refuses_to_go = "in_" + name;
    const auto staged = StagedFolder::begin(folder.path() / "bag", false);
    refuses_to_go.clear();
    ASSERT_FALSE(staged) << name << " would have become a part of the new folder";
    EXPECT_EQ(staged.error().kind, ErrorKind::kStorage);
    EXPECT_THAT(staged.error().line(), HasSubstr("cannot clear what was left there"));
  }
}

TEST(StagedFolder, IsThereWholeOrNotAtAll) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "new" / "bag";
  {
    auto staged = StagedFolder::begin(target, false);
    ASSERT_TRUE(staged) << staged.error().line();
    put(staged->path() / "file", "x");
    EXPECT_FALSE(fs::exists(target));
    EXPECT_EQ(StagedFolder::begin(target, false).error().kind, ErrorKind::kStorage)
        << "two at once: to be tried again, not given up";
  }
  EXPECT_TRUE(fs::is_empty(target.parent_path())) << "given up: nothing is left";
  auto staged = StagedFolder::begin(target, false);
  ASSERT_TRUE(staged);
  put(staged->path() / "file", "y");
  ASSERT_TRUE(staged->publish());
  EXPECT_EQ(text_of_file(target / "file"), "y");
  EXPECT_EQ(std::distance(fs::directory_iterator(target.parent_path()), fs::directory_iterator()), 1);
}

TEST(StagedFolder, TheFoldersThatItLiesInAreThereAfterAPowerCut) {
  const test::TemporaryFolder folder;
  const fs::path year = folder.path() / "archive" / "2026";
  synced_folders.clear();
  auto staged = StagedFolder::begin(year / "bag", false);
  ASSERT_TRUE(staged) << staged.error().line();
  put(staged->path() / "file", "x");
  ASSERT_TRUE(staged->publish());
  for (const fs::path& parent : {folder.path(), folder.path() / "archive", year}) {
    struct stat info {};
    ASSERT_EQ(::stat(parent.c_str(), &info), 0);
    EXPECT_TRUE(synced_folders.contains(info.st_ino)) << parent;
  }
}

TEST(StagedFolder, ReplacesOnlyWhenTold) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "bag";
  put(target / "old", "old");
  EXPECT_EQ(StagedFolder::begin(target, false).error().kind, ErrorKind::kUsage);
  auto staged = StagedFolder::begin(target.string() + "/", true);
  ASSERT_TRUE(staged) << staged.error().line();
  put(staged->path() / "new", "new");
  ASSERT_TRUE(staged->publish());
  EXPECT_EQ(text_of_file(target / "new"), "new");
  EXPECT_FALSE(fs::exists(target / "old"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

/// A package takes minutes: who copies photographs to its place meanwhile must not lose them.
TEST(StagedFolder, WhatCameToItsPlaceMeanwhileStays) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "bag";
  for (const fs::path& came : {target / "photograph", target}) {
    {
      auto staged = StagedFolder::begin(target, false);
      ASSERT_TRUE(staged) << staged.error().line();
      put(staged->path() / "new", "new");
      put(came, "theirs");
      const Status published = staged->publish();
      ASSERT_FALSE(published) << came;
      EXPECT_EQ(published.error().kind, ErrorKind::kUsage) << published.error().line();
    }
    EXPECT_EQ(text_of_file(came), "theirs");
    EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
    fs::remove_all(target);
  }
}

TEST(StagedFolder, IsRefusedAtTheTopOfADiskBeforeAnyWork) {
  for (const bool replace : {false, true}) {
    const auto staged = StagedFolder::begin("/proc/", replace);
    ASSERT_FALSE(staged);
    EXPECT_EQ(staged.error().kind, ErrorKind::kUsage);
    EXPECT_THAT(staged.error().line(),
                ::testing::AllOf(::testing::HasSubstr("this is the top of a disk"),
                                 ::testing::HasSubstr("give a folder in it, such as /proc/package")));
  }
  const test::TemporaryFolder folder;
  fs::create_directory_symlink("/proc", folder.path() / "stick");
  EXPECT_FALSE(check_no_disk_is_mounted_at(folder.path() / "stick")) << "wherever it leads";
  EXPECT_TRUE(check_no_disk_is_mounted_at(folder.path() / "bag"));
  fs::create_directory(folder.path() / "empty");
  EXPECT_TRUE(check_no_disk_is_mounted_at(folder.path() / "empty"));
}

TEST(StagedFolder, ClearsWhatAKilledProgramLeft) {
  const test::TemporaryFolder folder;
  put(folder.path() / (std::string(kTemporaryPrefix) + "bag") / "half", "written");
  auto staged = StagedFolder::begin(folder.path() / "bag", false);
  ASSERT_TRUE(staged) << staged.error().line();
  EXPECT_TRUE(fs::is_empty(staged->path()));
}

// Whoever made it could go on writing into what becomes a package.
TEST(StagedFolder, TakesOverNoFolderThatOthersMayWriteInto) {
  const test::TemporaryFolder folder;
  const fs::path left = folder.path() / (std::string(kTemporaryPrefix) + "bag");
  constexpr ::uid_t kNobody = 65534;
  for (const ::uid_t owner : {::geteuid(), kNobody}) {
    fs::create_directory(left);
    fs::permissions(left, owner == kNobody ? fs::perms(0755) : fs::perms(0777));
    put(left / "planted", "x");
    const int held = ::open(left.c_str(), O_RDONLY | O_DIRECTORY);
    if (owner == kNobody && ::chown(left.c_str(), kNobody, kNobody) != 0) {
      ::close(held);
      GTEST_SKIP() << "only root can make a folder of another user";
    }
    auto staged = StagedFolder::begin(folder.path() / "bag", false);
    ASSERT_TRUE(staged) << staged.error().line();
    struct stat before {};
    struct stat after {};
    ASSERT_EQ(::fstat(held, &before), 0);
    ASSERT_EQ(::stat(staged->path().c_str(), &after), 0);
    ::close(held);
    EXPECT_NE(before.st_ino, after.st_ino) << "it is made anew";
    EXPECT_EQ(after.st_uid, ::geteuid());
    EXPECT_EQ(after.st_mode & 0002U, 0U);
    EXPECT_TRUE(fs::is_empty(staged->path()));
  }
}

TEST(StagedFolder, SaysThatAFolderThatOthersMayWriteIntoCannotBeTakenAway) {
  const test::TemporaryFolder folder;
  const fs::path left = folder.path() / (std::string(kTemporaryPrefix) + "bag");
  put(left / "planted", "x");
  fs::permissions(left, fs::perms(0777));
  refuses_to_go = "planted";
  const auto staged = StagedFolder::begin(folder.path() / "bag", false);
  refuses_to_go.clear();
  ASSERT_FALSE(staged);
  EXPECT_THAT(staged.error().line(), HasSubstr("others may write into it"));
  EXPECT_TRUE(fs::exists(left));
}

TEST(StagedFolder, WhatItReplacesIsThereAgainWhenTheFileSystemRefusesHalfway) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "bag";
  put(target / "old", "old");
  cannot_exchange = true;
  {
    auto refused = StagedFolder::begin(target, true);
    ASSERT_TRUE(refused) << refused.error().line();
    put(refused->path() / "new", "new");
    refuses_from = refused->path();
    const Status published = refused->publish();
    refuses_from.clear();
    ASSERT_FALSE(published);
    EXPECT_EQ(published.error().kind, ErrorKind::kStorage);
  }
  EXPECT_EQ(text_of_file(target / "old"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
  auto staged = StagedFolder::begin(target, true);
  ASSERT_TRUE(staged) << staged.error().line();
  put(staged->path() / "new", "new");
  ASSERT_TRUE(staged->publish());
  cannot_exchange = false;
  EXPECT_EQ(text_of_file(target / "new"), "new");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

TEST(StagedFolder, ReplacesAgainWhereAKilledProgramLeftWhatItReplaced) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "bag";
  put(target / "old", "old");
  const fs::path left = folder.path() / "bag.replaced";
  put(left / "older", "older");
  cannot_exchange = true;
  auto staged = StagedFolder::begin(target, true);
  ASSERT_TRUE(staged) << staged.error().line();
  put(staged->path() / "new", "new");
  const Status published = staged->publish();
  cannot_exchange = false;
  ASSERT_TRUE(published) << published.error().line();
  EXPECT_EQ(text_of_file(target / "new"), "new");
  EXPECT_EQ(text_of_file(left / "older"), "older") << "it may be the only one";
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(StagedFolder, IsNotThereWhereItCouldNotBeSynced) {
  const test::TemporaryFolder folder;
  const fs::path target = folder.path() / "bag";
  put(target / "old", "old");
  {
    auto staged = StagedFolder::begin(target, true);
    ASSERT_TRUE(staged) << staged.error().line();
    put(staged->path() / "new", "new");
    exchanges = 0;
    refuses_sync = true;
    EXPECT_FALSE(staged->publish());
    refuses_sync = false;
  }
  EXPECT_EQ(text_of_file(target / "old"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 1);
}

}  // namespace
}  // namespace dubsar
