// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "formats/folder_lock.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>

#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(FolderLock, OneHasItAndAFolderThatCannotBeLockedStopsNobody) {
  const test::TemporaryFolder folder;
  const int one = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
  const int other = ::open(folder.path().c_str(), O_RDONLY | O_DIRECTORY);
  EXPECT_EQ(lock_folder(one, LOCK_EX | LOCK_NB), 0);
  EXPECT_EQ(lock_folder(other, LOCK_EX | LOCK_NB), EWOULDBLOCK);
  ::close(one);
  EXPECT_EQ(lock_folder(other, LOCK_EX | LOCK_NB), 0);
  ::close(other);
  // The kernel answers as NFS does for a folder: EBADF.
  const int path_alone = ::open(folder.path().c_str(), O_PATH | O_DIRECTORY);
  ASSERT_NE(::flock(path_alone, LOCK_EX | LOCK_NB), 0);
  ASSERT_EQ(errno, EBADF);
  EXPECT_EQ(lock_folder(path_alone, LOCK_EX | LOCK_NB), 0);
  ::close(path_alone);
}

}  // namespace
}  // namespace dubsar
