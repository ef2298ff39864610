// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A database that is rebuilt while a log lies beside the damaged one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/support/files.h"
#include "tests/support/in_child.h"
#include "tests/support/remove_call.h"

namespace {

/// A name that the disk does not let go.
std::string refuses_to_go;

}  // namespace

// In the place of the C library's, which std::filesystem calls; SQLite calls unlink().
extern "C" int remove(const char* name) noexcept {
  if (!refuses_to_go.empty() && name == refuses_to_go) {
    errno = EIO;
    return -1;
  }
  return dubsar::test::remove_call(name);
}

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::SessionDamageTest;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

class SessionRebuildTest : public SessionDamageTest {
 protected:
  /// Stores one more document, and leaves it in the log as a kill does.
  void leave_one_in_the_log() const {
    const int status = test::in_child([&] {
      Result<SessionStore> store = SessionStore::open(folder_);
      ::_exit(store && store->save_document("last", "{}") ? 0 : 1);
      return 2;
    });
    ASSERT_EQ(status, 0);
    ASSERT_GT(fs::file_size(log_), 0U);
  }
  const fs::path database_ = folder_ / "session.sqlite";
  const fs::path log_ = folder_ / "session.sqlite-wal";
};

TEST_F(SessionRebuildTest, ALogThatCannotBeTakenAwayIsNotLeftBesideANewDatabase) {
  leave_one_in_the_log();
  {
    // Pages of another size than the log's: SQLite can neither play that nor merge it when it closes.
    std::fstream file(database_, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(16);
    file.write("\x02\x00", 2);
  }
  const std::string damaged = test::text_of_file(database_);
  for (const char* suffix : {"-shm", "-wal"}) {
    refuses_to_go = database_.string() + suffix;
    const Result<SessionStore> refused = SessionStore::open(folder_);
    refuses_to_go.clear();
    ASSERT_FALSE(refused) << suffix;
    EXPECT_EQ(refused.error().kind, ErrorKind::kStorage);
    EXPECT_THAT(refused.error().line(), HasSubstr("cannot take the old log away"));
    EXPECT_EQ(test::text_of_file(database_), damaged) << "nothing was put in its place";
    EXPECT_TRUE(fs::exists(log_)) << suffix;
  }
  {
    const Result<SessionStore> store = SessionStore::open(folder_);
    ASSERT_TRUE(store) << store.error().line();
    expect_content(*store);
  }
  const SessionStore again = SessionStore::open(folder_, kReadOnly).value();
  EXPECT_THAT(again.opening().damage, IsEmpty());
  expect_content(again);
  EXPECT_TRUE(again.verify(job_).value().ok());
}

TEST_F(SessionRebuildTest, WhatTheLogHeldIsBroughtBackAfterAKillThatFoundItTakenAway) {
  leave_one_in_the_log();
  const std::string bytes = test::text_of_file(database_);
  const std::size_t at = bytes.find("made 3");
  ASSERT_NE(at, std::string::npos);
  test::flip_byte(database_, at);
  fs::copy_file(database_, folder_ / "session.sqlite.damaged-1");
  fs::rename(log_, folder_ / "session.sqlite.damaged-1-wal");
  fs::remove(folder_ / "session.sqlite-shm");
  fs::copy_file(database_, folder_ / "session.sqlite.damaged-2");  // by a repair that was begun since
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_FALSE(store.opening().damage.empty());
  expect_content(store);
  EXPECT_EQ(store.load_document("last").value(), "{}") << "it stood in the log alone";
}

TEST_F(SessionRebuildTest, TheLogOfAnotherTimeIsLeftWhereItLies) {
  const std::string bytes = test::text_of_file(database_);
  fs::copy_file(database_, folder_ / "session.sqlite.damaged-1");
  leave_one_in_the_log();
  fs::rename(log_, folder_ / "session.sqlite.damaged-1-wal");
  fs::remove(folder_ / "session.sqlite-shm");
  test::flip_byte(database_, bytes.find("made 3"));  // unlike the one aside, which is whole there
  const SessionStore store = SessionStore::open(folder_).value();
  expect_content(store);
  EXPECT_FALSE(store.load_document("last").value());
}

}  // namespace
}  // namespace dubsar
