// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A database that is rebuilt while a log lies beside the damaged one.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/acquisition/spoil.h"
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
  /// The same with twelve more, each a commit of its own, of which those in the middle cannot be played.
  void leave_a_log_damaged_in_its_middle() const {
    const int status = test::in_child([&] {
      Result<SessionStore> store = SessionStore::open(folder_);
      bool good = store.has_value();
      for (int i = 0; good && i < 12; ++i) {
        good = store->save_document("document " + std::to_string(i), "{}").has_value();
      }
      ::_exit(good ? 0 : 1);
      return 2;
    });
    ASSERT_EQ(status, 0);
    test::flip_byte(log_, fs::file_size(log_) - 6 * kFrame + 200);
  }
  /// What is told as lost, by a program that only reads.
  [[nodiscard]] std::string lost() {
    std::string out;
    const VerifyReport report = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
    for (const Error& error : report.lost) {
      out += error.what + "\n";
    }
    return out;
  }
  static constexpr std::uintmax_t kFrame = 24 + 4096;
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

TEST_F(SessionRebuildTest, LostCommitsAreNotForgottenByARebuildingThatTheDiskRefuses) {
  leave_a_log_damaged_in_its_middle();
  test::spoil(database_, "made 3");
  const std::string damaged = test::text_of_file(database_);
  const std::string log = test::text_of_file(log_);
  refuses_to_go = database_.string() + "-shm";
  const Result<SessionStore> refused = SessionStore::open(folder_);
  refuses_to_go.clear();
  ASSERT_FALSE(refused);
  EXPECT_TRUE(test::text_of_file(database_) == damaged) << "neither is written to before both are replaced";
  EXPECT_TRUE(test::text_of_file(log_) == log);
  { expect_content(SessionStore::open(folder_).value()); }
  EXPECT_THAT(lost(), HasSubstr("records are lost that nothing names"));
}

TEST_F(SessionRebuildTest, LostCommitsAreNotForgottenByAKillThatFoundTheLogTakenAway) {
  leave_a_log_damaged_in_its_middle();
  for (const bool head : {false, true}) {  // nothing at all can be played of a log whose head is damaged
    const fs::path session = temporary_.path() / (head ? "head" : "middle");
    fs::copy(folder_, session, fs::copy_options::recursive);
    test::spoil(session / "session.sqlite", "made 3");
    if (head) {
      test::flip_byte(session / "session.sqlite-wal", 20);
    }
    fs::copy_file(session / "session.sqlite", session / "session.sqlite.damaged-1");
    fs::rename(session / "session.sqlite-wal", session / "session.sqlite.damaged-1-wal");
    fs::remove(session / "session.sqlite-shm");
    { expect_content(SessionStore::open(session).value()); }
    EXPECT_TRUE(SessionStore::open(session, kReadOnly)->verify(job_)->lost.size() > 0) << session;
  }
}

TEST_F(SessionRebuildTest, LostCommitsAreNotForgottenWhereTheyCannotBeNoted) {
  leave_a_log_damaged_in_its_middle();
  fs::copy_file(database_, folder_ / "session.sqlite.damaged-1");  // as the disk has no room for copies
  fs::copy_file(log_, folder_ / "session.sqlite.damaged-1-wal");
  const auto first_lost = fs::file_size(log_) - 6 * kFrame;
  ASSERT_GT(first_lost, fs::file_size(database_)) << "merging the log needs no room beyond it";
  const int status = test::in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{first_lost, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &small);
    const Result<SessionStore> refused = SessionStore::open(folder_);
    return !refused && refused.error().kind == ErrorKind::kStorage ? 0 : 1;
  });
  EXPECT_EQ(status, 0);
  { expect_content(SessionStore::open(folder_).value()); }
  EXPECT_THAT(lost(), HasSubstr("records are lost that nothing names"));
}

TEST_F(SessionRebuildTest, LostCommitsAreNotedOnceWhateverEndsTheProgram) {
  leave_a_log_damaged_in_its_middle();
  EXPECT_EQ(test::in_child([&] {
              const Result<SessionStore> store = SessionStore::open(folder_);
              ::_exit(store ? 0 : 1);
              return 2;
            }),
            0);
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  EXPECT_EQ(store.events()->back().kind, "records lost");
  EXPECT_NE(store.events()->rbegin()[1].kind, "records lost");
}

TEST_F(SessionRebuildTest, ALogWhoseDatabaseIsGoneIsKept) {
  leave_one_in_the_log();
  const std::string log = test::text_of_file(log_);
  for (const bool removed : {false, true}) {  // SQLite takes the log of an empty database away
    const fs::path session = temporary_.path() / (removed ? "removed" : "emptied");
    fs::copy(folder_, session, fs::copy_options::recursive);
    removed ? (void)fs::remove(session / "session.sqlite") : fs::resize_file(session / "session.sqlite", 0);
    { ASSERT_TRUE(SessionStore::open(session, kReadOnly)); }
    EXPECT_TRUE(test::text_of_file(session / "session.sqlite-wal") == log) << "reading changes nothing";
    std::ofstream(session / "session.sqlite.damaged-1-wal") << "of another time";
    { expect_content(SessionStore::open(session).value()); }
    EXPECT_EQ(test::text_of_file(session / "session.sqlite.damaged-1-wal"), "of another time");
    EXPECT_TRUE(test::text_of_file(session / "session.sqlite.damaged-2-wal") == log) << session;
  }
}

TEST_F(SessionRebuildTest, ALogWhoseDatabaseIsGoneIsKeptWhereNothingElseIsLeft) {
  leave_one_in_the_log();
  const std::string log = test::text_of_file(log_);
  fs::resize_file(database_, 0);
  fs::remove(folder_ / "session.backup.sqlite");
  fs::remove_all(folder_ / "grids");
  {
    const SessionStore store = SessionStore::open(folder_).value();
    EXPECT_FALSE(store.opening().created);
    EXPECT_FALSE(store.opening().damage.empty());
  }
  EXPECT_TRUE(test::text_of_file(folder_ / "session.sqlite.damaged-1-wal") == log);
  EXPECT_THAT(lost(), HasSubstr("records are lost that nothing names"));
}

TEST_F(SessionRebuildTest, PosesOfAnOlderTimeAreNotMixedWithThoseOfTheLog) {
  const auto pose_of = [](int id) {
    ScanPose pose;
    pose.id = id;
    return pose;
  };
  { ASSERT_TRUE(SessionStore::open(folder_)->save_poses({pose_of(2), pose_of(3)})); }
  EXPECT_EQ(test::in_child([&] {
              Result<SessionStore> store = SessionStore::open(folder_);
              ::_exit(store && store->save_poses({pose_of(2)}) ? 0 : 1);
              return 2;
            }),
            0);
  test::spoil(database_, "made 3");
  const SessionStore store = SessionStore::open(folder_).value();
  ASSERT_EQ(store.poses()->size(), 1U) << "3 was not among those of the last time";
  EXPECT_EQ(store.poses()->front().id, 2);
}

TEST_F(SessionRebuildTest, ABackupThatHasEverythingStillHasItAfterARefusal) {
  fs::resize_file(database_, fs::file_size(database_) / 2);
  refuses_to_go = database_.string() + "-shm";
  EXPECT_FALSE(SessionStore::open(folder_));
  EXPECT_FALSE(SessionStore::open(folder_));
  refuses_to_go.clear();
  { expect_content(SessionStore::open(folder_).value()); }
  EXPECT_EQ(lost(), "");
}

TEST_F(SessionRebuildTest, ALogThatABrokenOffRebuildingLeftAsideIsPlayedThoughTheDatabaseLooksWhole) {
  leave_one_in_the_log();
  fs::copy_file(database_, folder_ / "session.sqlite.damaged-1");
  fs::rename(log_, folder_ / "session.sqlite.damaged-1-wal");
  fs::remove(folder_ / "session.sqlite-shm");
  {
    const SessionStore reader = SessionStore::open(folder_, kReadOnly).value();
    ASSERT_FALSE(reader.opening().damage.empty());
    EXPECT_THAT(reader.opening().damage[0].line(), HasSubstr("a rebuilding was broken off"));
    EXPECT_FALSE(reader.verify(job_)->ok());
  }
  EXPECT_FALSE(
      SessionStore::open(folder_, SessionStore::Access::kReadWrite, SessionStore::OnDamage::kRefuse));
  { EXPECT_EQ(SessionStore::open(folder_)->load_document("last").value(), "{}"); }
  const SessionStore again = SessionStore::open(folder_, kReadOnly).value();
  EXPECT_EQ(again.load_document("last").value(), "{}");
  EXPECT_TRUE(again.verify(job_)->ok());
}

}  // namespace
}  // namespace dubsar
