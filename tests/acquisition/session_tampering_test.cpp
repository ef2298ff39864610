// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A session that somebody else had in hand: pipes in place of files, tables that say what no table of ours
// does.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "acquisition/session_files.h"
#include "acquisition/session_tables.h"
#include "acquisition/sqlite_db.h"
#include "formats/atomic_file.h"
#include "tests/acquisition/session_damage_support.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::SessionDamageTest;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

TEST_F(SessionDamageTest, WhatIsNoFileIsNamedAndNotWaitedFor) {
  ASSERT_EQ(::mkfifo((folder_ / "grids/007.grid").c_str(), 0600), 0);
  fs::remove(folder_ / "grids/003.grid");
  ASSERT_EQ(::mkfifo((folder_ / "grids/003.grid").c_str(), 0600), 0);
  ASSERT_EQ(::mkfifo((folder_ / "mesh/notes.json").c_str(), 0600), 0);
  for (const auto access : {kReadOnly, SessionStore::Access::kReadWrite}) {
    const SessionStore store = SessionStore::open(folder_, access).value();
    expect_content(store, {3});
    const VerifyReport report = store.verify(job_).value();
    ASSERT_EQ(report.damaged.size(), 2U);
    EXPECT_EQ(report.damaged[0].where, "grids/007.grid");
    EXPECT_EQ(report.damaged[1].where, "grids/003.grid");
    EXPECT_EQ(report.damaged[1].what, "not a file");
    EXPECT_THAT(report.extra, testing::Contains("mesh/notes.json"));
  }
}

TEST_F(SessionDamageTest, RowsWithoutTheirKeyAreNotTakenIntoTheRebuiltDatabase) {
  std::string bytes = read_whole_file(folder_ / session::kDatabase).value();
  const std::string key = "scans(id INTEGER PRIMARY KEY";
  const std::size_t at = bytes.find(key);
  ASSERT_NE(at, std::string::npos);
  bytes.replace(at, key.size(),
                "scans(id INTEGEM PRIMARY KEY");  // no longer the row's number: reads as nothing
  std::ofstream(folder_ / session::kDatabase, std::ios::binary) << bytes;
  {
    SqlDatabase db = SqlDatabase::open(folder_ / session::kDatabase, SqlDatabase::Mode::kCreate).value();
    ASSERT_TRUE(
        db.execute("UPDATE scans SET sum = dubsar_sum(id,file,bytes,hash,rows,cols,samples,spacing_mm,"
                   "timestamp_ns,device,source,dropped,note)"));
  }
  EXPECT_FALSE(SessionStore::open(folder_).value().opening().damage.empty());
  const SessionStore again = SessionStore::open(folder_).value();
  EXPECT_THAT(again.opening().damage, IsEmpty());
  EXPECT_EQ(again.scans().value().size(), 4U);
}

/// A grid of another session, and a folder of somebody else's: neither read nor written through.
TEST_F(SessionDamageTest, LinksAreNotFollowed) {
  const fs::path elsewhere = temporary_.path() / "elsewhere";
  fs::create_directories(elsewhere);
  fs::rename(folder_ / "grids/002.grid", elsewhere / "002.grid");
  fs::create_symlink(elsewhere / "002.grid", folder_ / "grids/002.grid");
  {
    const SessionStore store = SessionStore::open(folder_, kReadOnly).value();
    EXPECT_TRUE(store.scans().value()[2].damaged);
    const VerifyReport report = store.verify(job_).value();
    ASSERT_EQ(report.damaged.size(), 1U);
    EXPECT_EQ(report.damaged[0].where, "grids/002.grid");
    EXPECT_THAT(report.damaged[0].what, testing::HasSubstr("a link"));
  }
  ASSERT_TRUE(SessionStore::open(folder_));
  for (const char* name : {"export", "session.sqlite"}) {
    fs::rename(folder_ / name, elsewhere / name);
    fs::create_symlink(elsewhere / name, folder_ / name);
    const auto refused = SessionStore::open(folder_);
    ASSERT_FALSE(refused) << name;
    EXPECT_THAT(refused.error().line(), testing::HasSubstr(std::string(name) + ": a link"));
    fs::remove(folder_ / name);
    fs::rename(elsewhere / name, folder_ / name);
  }
}

TEST(SalvageRows, ARowThatCannotBePutCostsNoOtherRow) {
  SqlDatabase from = SqlDatabase::open("from", SqlDatabase::Mode::kMemory).value();
  ASSERT_TRUE(
      from.execute("CREATE TABLE events(number, time_ns, kind, json, sum);"
                   "INSERT INTO events(number) VALUES('first'),(7),('last');"
                   "UPDATE events SET sum = dubsar_sum(number,time_ns,kind,json)"));
  SqlDatabase to = SqlDatabase::open("to", SqlDatabase::Mode::kMemory).value();
  ASSERT_TRUE(session::prepare_schema(to, "to"));
  EXPECT_EQ(session::salvage_rows(from, to, true), 1);
  EXPECT_EQ(to.integer_of("SELECT number FROM events").value(), 7);
}

TEST_F(SessionDamageTest, APipeInPlaceOfTheDatabaseIsNotWaitedFor) {
  fs::remove(folder_ / session::kDatabase);
  ASSERT_EQ(::mkfifo((folder_ / session::kDatabase).c_str(), 0600), 0);
  for (const auto access : {kReadOnly, SessionStore::Access::kReadWrite}) {
    const SessionStore store = SessionStore::open(folder_, access).value();
    ASSERT_EQ(store.opening().damage.size(), 1U);
    expect_content(store);
  }
  EXPECT_TRUE(fs::is_regular_file(folder_ / session::kDatabase));
}

// What it leads to would be emptied for the process number.
TEST_F(SessionDamageTest, ALockThatIsAnotherFileIsNotWrittenTo) {
  const fs::path other = temporary_.path() / "other.txt";
  const fs::path nowhere = temporary_.path() / "nowhere";
  const fs::path lock = folder_ / session::kLock;
  std::ofstream(other) << "precious";
  const std::function<void()> laid[] = {
      [&] { fs::create_symlink("../other.txt", lock); },
      [&] { fs::create_symlink("../nowhere", lock); },
      [&] { ASSERT_EQ(::mkfifo(lock.c_str(), 0600), 0); },
  };
  for (const auto& lay : laid) {
    fs::remove(lock);
    lay();
    const auto store = SessionStore::open_or_create(folder_);
    ASSERT_FALSE(store);
    EXPECT_EQ(exit_status(store.error().kind), 2);
    EXPECT_EQ(store.error().where, lock.string());
    EXPECT_EQ(read_whole_file(other).value(), "precious");
    EXPECT_FALSE(fs::exists(nowhere));
  }
  expect_content(SessionStore::open(folder_, kReadOnly).value());
  fs::remove(lock);
  expect_content(SessionStore::open(folder_).value());
}

// Whoever would end the program by its number must not end another one here.
TEST_F(SessionDamageTest, WhoHasTheLockIsToldWithItsComputerWhereThatIsAnother) {
  const SessionStore writer = SessionStore::open(folder_).value();
  const fs::path lock = folder_ / session::kLock;
  const auto refusal = [&] {
    const auto second = SessionStore::open(folder_);
    EXPECT_FALSE(second);
    return second ? std::string() : second.error().line();
  };
  EXPECT_THAT(refusal(), HasSubstr(" (process " + std::to_string(::getpid()) + ")"));
  std::ofstream(lock) << "4711 no-such.computer\n";
  EXPECT_THAT(refusal(), HasSubstr(" (process 4711 of the computer no-such.computer)"));
  std::ofstream(lock) << "4711\n";  // as programs before this one wrote it
  EXPECT_THAT(refusal(), HasSubstr(" (process 4711)"));
  std::ofstream(lock) << std::string(400, '7') << "\x1b[2J";
  EXPECT_THAT(refusal(), testing::Not(HasSubstr("\x1b")));
}

TEST_F(SessionDamageTest, TablesThatLeadOutOfTheSessionAreNotFollowed) {
  {
    SqlDatabase db = SqlDatabase::open(folder_ / session::kDatabase, SqlDatabase::Mode::kCreate).value();
    ASSERT_TRUE(db.execute("UPDATE scans SET file = '/dev/zero' WHERE id = 2"));
    ASSERT_TRUE(
        db.execute("UPDATE scans SET sum = dubsar_sum(id,file,bytes,hash,rows,cols,samples,spacing_mm,"
                   "timestamp_ns,device,source,dropped,note)"));
    ASSERT_TRUE(db.execute("INSERT INTO files(path,bytes,hash) VALUES('mesh/../../other.ply',1,1)"));
    ASSERT_TRUE(db.execute("UPDATE files SET sum = dubsar_sum(path,bytes,hash)"));
  }
  std::ofstream(temporary_.path() / "other.ply") << "x";
  const SessionStore store = SessionStore::open(folder_, kReadOnly).value();
  EXPECT_TRUE(store.scans().value()[2].damaged);
  const VerifyReport report = store.verify(job_).value();
  std::vector<std::string> named;
  for (const Error& fault : report.damaged) {
    named.push_back(fault.where + ": " + fault.what);
  }
  EXPECT_THAT(named,
              testing::IsSupersetOf({"/dev/zero: named by the tables, and no file of a session",
                                     "mesh/../../other.ply: named by the tables, and no file of a session"}));
}

// A count that the bytes beside it cannot give is not asked for as memory.
TEST_F(SessionDamageTest, ACountOfFlagsThatTheirBytesDoNotHoldIsRefusedBeforeTheyAreUnpacked) {
  ASSERT_TRUE(SessionStore::open(folder_)->save_flags(0, SampleFlags(100000, kSparse)));
  for (const char* count : {"2147483648", "100001", "99999", "-1"}) {
    {
      SqlDatabase db = SqlDatabase::open(folder_ / session::kDatabase, SqlDatabase::Mode::kCreate).value();
      ASSERT_TRUE(db.execute((std::string("UPDATE flags SET count = ") + count).c_str()));
      ASSERT_TRUE(db.execute("UPDATE flags SET sum = dubsar_sum(id,count,packed)"));
    }
    const auto flags = SessionStore::open(folder_, kReadOnly)->load_flags(0);
    ASSERT_FALSE(flags) << count;
    EXPECT_EQ(flags.error().what, "the stored count is not that of the stored flags") << count;
  }
}

}  // namespace
}  // namespace dubsar
