// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What happens to a session's files while a program has it open for writing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>

#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/acquisition/spoil.h"
#include "tests/support/files.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::small_grid;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

class SessionWhileOpen : public test::SessionDamageTest {
 protected:
  const fs::path database_ = folder_ / "session.sqlite";
  const fs::path elsewhere_ = temporary_.path() / "elsewhere";
};

TEST_F(SessionWhileOpen, ADatabaseThatIsDamagedMeanwhileDoesNotTakeThePlaceOfItsBackup) {
  const std::string backup = test::text_of_file(folder_ / "session.backup.sqlite");
  {
    SessionStore store = SessionStore::open(folder_).value();
    ASSERT_TRUE(store.append_event("later"));
    test::spoil(database_, "bench");
  }
  EXPECT_TRUE(test::text_of_file(folder_ / "session.backup.sqlite") == backup);
  EXPECT_FALSE(SessionStore::open(folder_, kReadOnly)->verify(job_)->ok());
  const SessionStore store = SessionStore::open(folder_).value();
  expect_content(store);
  EXPECT_EQ(store.events()->back().kind, "later");
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty());
}

TEST_F(SessionWhileOpen, ARowThatIsDamagedMeanwhileGetsNoChecksumThatFits) {
  SessionStore store = SessionStore::open(folder_).value();
  sqlite3* raw = nullptr;
  ASSERT_EQ(sqlite3_open(database_.c_str(), &raw), SQLITE_OK);
  EXPECT_EQ(sqlite3_exec(raw, "UPDATE scans SET bytes = 7 WHERE id = 2", nullptr, nullptr, nullptr),
            SQLITE_OK);
  sqlite3_close(raw);
  const Status dropped = store.drop_scan(2, "blurred");
  ASSERT_FALSE(dropped);
  EXPECT_EQ(dropped.error().kind, ErrorKind::kBadInput);
  EXPECT_THAT(dropped.error().line(), HasSubstr("the stored row is damaged"));
  EXPECT_FALSE(store.verify(job_)->ok());
  EXPECT_TRUE(store.drop_scan(3, "blurred")) << "the others are none of its business";
}

TEST_F(SessionWhileOpen, NothingIsStoredInWhatLiesWhereTheSessionWas) {
  fs::copy(folder_, elsewhere_, fs::copy_options::recursive);
  const fs::path moved = temporary_.path() / "moved";
  {
    SessionStore store = SessionStore::open(folder_).value();
    fs::rename(folder_, moved);
    fs::rename(elsewhere_, folder_);
    const Result<int> id = store.add_grid(small_grid(4));
    ASSERT_FALSE(id);
    EXPECT_EQ(id.error().kind, ErrorKind::kStorage);
    EXPECT_THAT(id.error().line(), HasSubstr("moved"));
    EXPECT_FALSE(store.append_event("where"));
    EXPECT_FALSE(store.replace_file("mesh/model.ply", [](const fs::path&) { return Status(); }));
    fs::remove(folder_ / "session.backup.sqlite");
  }
  EXPECT_FALSE(fs::exists(folder_ / "grids/004.grid"));
  EXPECT_FALSE(fs::exists(folder_ / "session.backup.sqlite")) << "nor was it closed there";
  const SessionStore store = SessionStore::open(moved).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  expect_content(store);
}

TEST_F(SessionWhileOpen, OneWhoseLockWasTakenAwayIsNotWrittenToAnyMore) {
  SessionStore store = SessionStore::open(folder_).value();
  fs::remove(folder_ / "session.lock");
  SessionStore other = SessionStore::open(folder_).value();
  EXPECT_FALSE(store.add_grid(small_grid(4)));
  EXPECT_EQ(other.add_grid(small_grid(5)).value(), 4);
}

TEST_F(SessionWhileOpen, AFolderInPlaceOfTheBackupIsSetAside) {
  fs::remove(folder_ / "session.backup.sqlite");
  fs::create_directories(folder_ / "session.backup.sqlite/holiday");
  {
    const SessionStore store = SessionStore::open(folder_).value();
    EXPECT_THAT(store.opening().notes,
                testing::Contains("kept the damaged backup as session.backup.sqlite.damaged-1"));
  }
  EXPECT_TRUE(fs::is_directory(folder_ / "session.backup.sqlite.damaged-1/holiday"));
  EXPECT_TRUE(fs::is_regular_file(folder_ / "session.backup.sqlite"));
  EXPECT_TRUE(SessionStore::open(folder_, kReadOnly)->verify(job_)->ok());
}

TEST_F(SessionWhileOpen, APipeOrAFolderInPlaceOfTheTablesIsSetAside) {
  for (const bool pipe : {true, false}) {
    fs::remove(database_);
    pipe ? (void)::mkfifo(database_.c_str(), 0600) : (void)fs::create_directories(database_ / "holiday");
    {
      const Result<SessionStore> store = SessionStore::open(folder_);
      ASSERT_TRUE(store) << store.error().line();
      expect_content(*store);
    }
    EXPECT_TRUE(SessionStore::open(folder_, kReadOnly)->verify(job_)->ok());
  }
  EXPECT_TRUE(fs::is_fifo(folder_ / "session.sqlite.damaged-1"));
  EXPECT_TRUE(fs::is_directory(folder_ / "session.sqlite.damaged-2/holiday"));
}

TEST_F(SessionWhileOpen, ALogThatIsALinkOrNoFileIsNotWrittenTo) {
  const fs::path log = folder_ / "session.sqlite-wal";
  const fs::path somebodys = temporary_.path() / "somebodys";
  std::ofstream(somebodys) << "not a log";
  for (const char* what : {"link", "pipe", "folder"}) {
    const std::string is(what);
    is == "link"   ? fs::create_symlink(somebodys, log)
    : is == "pipe" ? (void)::mkfifo(log.c_str(), 0600)
                   : (void)fs::create_directory(log);
    const Result<SessionStore> store = SessionStore::open(folder_);
    ASSERT_FALSE(store) << what;
    EXPECT_EQ(store.error().kind, ErrorKind::kBadInput) << what;
    EXPECT_THAT(store.error().line(), HasSubstr("session.sqlite-wal")) << what;
    fs::remove(log);
  }
  EXPECT_EQ(test::text_of_file(somebodys), "not a log");
  expect_content(SessionStore::open(folder_).value());
}

}  // namespace
}  // namespace dubsar
