// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <thread>

#include "acquisition/session_files.h"
#include "acquisition/session_log.h"
#include "acquisition/session_store.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/support/in_child.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::be_bound_by_rights;
using test::flip_byte;
using test::in_child;
using test::SessionDamageTest;
using test::small_grid;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

TEST_F(SessionDamageTest, ADamagedGridIsNamedAndTheRestStands) {
  flip_byte(folder_ / "grids/002.grid", 1234);
  for (const auto access : {kReadOnly, SessionStore::Access::kReadWrite}) {
    const SessionStore store = SessionStore::open(folder_, access).value();
    ASSERT_EQ(store.opening().damage.size(), 1U);
    EXPECT_EQ(store.opening().damage[0].where, "grids/002.grid");
    expect_content(store, {2});
    const VerifyReport report = store.verify(job_).value();
    ASSERT_EQ(report.damaged.size(), 1U);
    EXPECT_EQ(report.damaged[0].where, "grids/002.grid");
  }
}

TEST_F(SessionDamageTest, AMissingOrCutGridIsNamed) {
  fs::remove(folder_ / "grids/000.grid");
  fs::resize_file(folder_ / "grids/003.grid", 100);
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_EQ(store.opening().damage.size(), 2U);
  expect_content(store, {0, 3});
}

TEST_F(SessionDamageTest, VerifyNoticesAFlippedByteAnywhere) {
  Random random(11);
  for (const char* name : {"session.sqlite", "session.backup.sqlite", "session.sums", "grids/000.grid"}) {
    const auto size = fs::file_size(folder_ / name);
    for (int round = 0; round < 12; ++round) {
      const auto at = random.below(size);
      flip_byte(folder_ / name, at);
      const Result<SessionStore> store = SessionStore::open(folder_, kReadOnly);
      EXPECT_FALSE(store && store->verify(job_).value().ok()) << name << " at " << at;
      flip_byte(folder_ / name, at);
    }
  }
  const VerifyReport report = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
  EXPECT_TRUE(report.ok());
  EXPECT_EQ(report.whole.size(), 7U);
}

TEST_F(SessionDamageTest, AListOfChecksumsThatIsGoneIsTold) {
  fs::remove(folder_ / "session.sums");
  {
    const VerifyReport report = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
    ASSERT_EQ(report.damaged.size(), 1U);
    EXPECT_EQ(report.damaged[0].where, "session.sums");
    EXPECT_EQ(report.damaged[0].what, "missing");
    EXPECT_THAT(report.unrecorded, ElementsAre("session.sqlite", "session.backup.sqlite"));
  }
  EXPECT_TRUE(SessionStore::open(folder_).value().verify(job_).value().ok()) << "it is about to be written";
  const VerifyReport mended = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
  EXPECT_TRUE(mended.ok());
  EXPECT_EQ(mended.whole.size(), 7U);
  // Nothing tells that there ever was one: a session of an early version has none either.
  fs::remove(folder_ / "session.sums");
  fs::remove(folder_ / "session.backup.sqlite");
  const VerifyReport bare = SessionStore::open(folder_, kReadOnly).value().verify(job_).value();
  EXPECT_TRUE(bare.ok());
  EXPECT_THAT(bare.unrecorded, ElementsAre("session.sqlite"));
}

TEST_F(SessionDamageTest, ASessionThatWasNeverClosedHasLostNoListOfChecksums) {
  const fs::path killed = temporary_.path() / "killed";
  {
    SessionStore store = SessionStore::open_or_create(temporary_.path() / "first").value();
    ASSERT_TRUE(store.add_grid(small_grid(1)));
    fs::copy(temporary_.path() / "first", killed, fs::copy_options::recursive);
  }
  const VerifyReport report = SessionStore::open(killed, kReadOnly).value().verify(job_).value();
  EXPECT_TRUE(report.ok());
  EXPECT_THAT(report.whole, ElementsAre("session.sqlite", "grids/000.grid"));
}

TEST_F(SessionDamageTest, ADatabaseWithFlippedBytesKeepsTheScans) {
  Random random(5);
  const auto size = fs::file_size(folder_ / "session.sqlite");
  for (int round = 0; round < 12; ++round) {
    const fs::path copy = temporary_.path() / ("copy" + std::to_string(round));
    fs::copy(folder_, copy, fs::copy_options::recursive);
    const auto at = random.below(size);
    flip_byte(copy / "session.sqlite", at);
    for (const auto access : {kReadOnly, SessionStore::Access::kReadWrite}) {
      const Result<SessionStore> store = SessionStore::open(copy, access);
      ASSERT_TRUE(store) << "byte " << at << ": " << store.error().line();
      expect_content(*store);
    }
  }
}

TEST_F(SessionDamageTest, AnUnreadableDatabaseIsRebuiltFromBackupAndGrids) {
  std::ofstream(folder_ / "session.sqlite")
      << "Not a database at all, but long enough to look like one. " << std::string(5000, '#');
  {
    const SessionStore reader = SessionStore::open(folder_, kReadOnly).value();
    EXPECT_THAT(reader.opening().damage.at(0).line(), HasSubstr("damaged"));
    expect_content(reader);
    EXPECT_FALSE(reader.verify(job_).value().ok());
  }
  {
    const SessionStore store = SessionStore::open(folder_).value();
    EXPECT_THAT(store.opening().damage.at(0).line(), HasSubstr("damaged"));
    expect_content(store);
    EXPECT_TRUE(fs::exists(folder_ / "session.sqlite.damaged-1")) << "the bad file is kept";
  }
  const SessionStore again = SessionStore::open(folder_).value();
  EXPECT_THAT(again.opening().damage, IsEmpty());
  expect_content(again);
}

TEST_F(SessionDamageTest, WhatIsSaidToBeKeptAsideIsThere) {
  fs::remove(folder_ / "session.sqlite");
  {
    const SessionStore store = SessionStore::open(folder_).value();
    EXPECT_THAT(store.opening().damage, testing::SizeIs(1));
    expect_content(store);
    EXPECT_THAT(store.opening().notes, testing::Not(testing::Contains(HasSubstr("kept the damaged"))))
        << "there was none to keep";
  }
  std::ofstream(folder_ / "session.sqlite") << "no database";
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_THAT(store.opening().notes,
              testing::Contains("kept the damaged database as session.sqlite.damaged-1"));
  EXPECT_TRUE(fs::exists(folder_ / "session.sqlite.damaged-1"));
}

TEST_F(SessionDamageTest, AFolderThatMayNotBeReadIsNotCalledMissing) {
  { SessionStore store = SessionStore::open(folder_).value(); }
  fs::permissions(temporary_.path(), fs::perms(0755));
  const auto kind_of_error = [&](fs::perms perms, const fs::path& closed) {
    fs::permissions(closed, perms);
    const int status = in_child([&] {
      const auto store = be_bound_by_rights() ? SessionStore::open(folder_, kReadOnly)
                                              : fail(ErrorKind::kInternal, "root stays root");
      if (!store) {
        return store.error().kind == ErrorKind::kStorage &&
                       store.error().what.find("Permission denied") != std::string::npos
                   ? 0
                   : 2;
      }
      const auto report = store->verify(job_);
      const bool told = report && std::ranges::any_of(report->damaged, [](const Error& damage) {
                          return damage.where == "grids/000.grid" && damage.what != "missing";
                        });
      return told ? 1 : 3;
    });
    fs::permissions(closed, fs::perms(0755));
    return status;
  };
  EXPECT_EQ(kind_of_error(fs::perms(0600), folder_), 0) << "it may not be entered";
  EXPECT_EQ(kind_of_error(fs::perms(0700), folder_), 0) << "nor listed";
  EXPECT_EQ(kind_of_error(fs::perms(0700), folder_ / "grids"), 1);
}

TEST_F(SessionDamageTest, AnEmptiedDatabaseIsToldAndReadFromItsBackup) {
  std::ofstream(folder_ / "session.sqlite", std::ios::trunc);
  for (const auto access : {kReadOnly, SessionStore::Access::kReadWrite}) {
    const SessionStore store = SessionStore::open(folder_, access).value();
    ASSERT_EQ(store.opening().damage.size(), 1U);
    EXPECT_THAT(store.opening().damage[0].line(), HasSubstr("missing or empty"));
    expect_content(store);
  }
}

TEST_F(SessionDamageTest, WithoutDatabaseAndBackupTheGridsAreTakenIn) {
  fs::remove(folder_ / "session.sqlite");
  fs::remove(folder_ / "session.backup.sqlite");
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_FALSE(store.opening().damage.empty());
  ASSERT_EQ(store.scans().value().size(), 4U);
  EXPECT_EQ(store.load_grid(3).value().z, small_grid(3).z);
}

TEST_F(SessionDamageTest, ALogDamagedInItsMiddleIsToldAndATornEndIsNot) {
  const fs::path folder = temporary_.path() / "logged";
  leave_with_log(folder);
  const fs::path log = folder / "session.sqlite-wal";
  const auto size = fs::file_size(log);
  const std::size_t documents = SessionStore::open(folder, kReadOnly).value().document_names().value().size();
  ASSERT_EQ(documents, 12U);
  constexpr std::uintmax_t kFrame = 24 + 4096;
  // The middle, and the head: both cost changes that had been stored, and both are told.
  for (const std::uintmax_t at : {size - 6 * kFrame + 200, std::uintmax_t{20}, std::uintmax_t{8}}) {
    flip_byte(log, at);
    const VerifyReport report = SessionStore::open(folder, kReadOnly).value().verify(job_).value();
    EXPECT_FALSE(report.ok()) << at;
    EXPECT_THAT(report.damaged.front().line(), HasSubstr("session.sqlite-wal")) << at;
    flip_byte(log, at);
  }
  // Every bit of the heads of frames: a mark of a commit that is a single bit and a salt are among them.
  for (std::uintmax_t frame = 2; frame < 8; ++frame) {
    for (std::uintmax_t bit = 0; bit < 24 * 8; ++bit) {
      const std::uintmax_t at = 32 + frame * kFrame + bit / 8;
      flip_byte(log, at, 1 << (bit % 8));
      EXPECT_GT(session::read_log(log).value().lost_commits, 0) << "bit " << bit << " of frame " << frame;
      flip_byte(log, at, 1 << (bit % 8));
    }
  }
  // A torn end is what a power cut leaves of a change that was not reported as stored.
  fs::resize_file(log, size - 100);
  EXPECT_TRUE(SessionStore::open(folder, kReadOnly).value().verify(job_).value().ok());
  flip_byte(log, size - 6 * kFrame + 200);
  const SessionStore opened = SessionStore::open(folder).value();
  EXPECT_FALSE(opened.opening().damage.empty());
  EXPECT_TRUE(fs::exists(folder / "session.sqlite.damaged-1-wal"));
  EXPECT_LT(opened.document_names().value().size(), documents);
  EXPECT_EQ(opened.scans().value().size(), 1U);
}

TEST_F(SessionDamageTest, AKillWhileTheBackupIsReplacedLeavesNothingThatLooksDamaged) {
  // The list of checksums holds the old and the new backup's until the new one stands.
  { ASSERT_TRUE(SessionStore::open(folder_).value().append_event("later")); }
  const fs::path copy = temporary_.path() / "between";
  fs::copy(folder_, copy, fs::copy_options::recursive);
  { ASSERT_TRUE(SessionStore::open(folder_).value().append_event("last")); }
  // Both backups in turn beside the sums of both.
  session::Sums both = session::read_sums(copy).value();
  const session::Sums later = session::read_sums(folder_).value();
  for (const auto& [name, sum] : later) {
    both.emplace(name, sum);
  }
  both.erase("session.sqlite");
  ASSERT_TRUE(session::write_sums(copy, both));
  EXPECT_TRUE(SessionStore::open(copy, kReadOnly).value().verify(job_).value().ok());
  fs::copy_file(folder_ / "session.backup.sqlite", copy / "session.backup.sqlite",
                fs::copy_options::overwrite_existing);
  EXPECT_TRUE(SessionStore::open(copy, kReadOnly).value().verify(job_).value().ok());
  flip_byte(copy / "session.backup.sqlite", 5000);
  EXPECT_FALSE(SessionStore::open(copy, kReadOnly).value().verify(job_).value().ok());
}

TEST_F(SessionDamageTest, WhatWasReportedStoredSurvivesAKill) {
  const fs::path folder = temporary_.path() / "killed";
  Random random(2026);
  std::vector<int> reported;
  for (int round = 0; round < 10; ++round) {
    int pipe[2];
    ASSERT_EQ(::pipe(pipe), 0);
    const pid_t child = ::fork();
    if (child == 0) {
      Result<SessionStore> store = SessionStore::open_or_create(folder);
      for (int i = 0; store && i < 100000; ++i) {
        const auto scans = store->scans();
        const int number = scans ? static_cast<int>(scans->size()) : -1;
        const Result<int> id = store->add_grid(small_grid(number));
        if (!id || !store->save_flags(*id, SampleFlags(2000, kSparse)) ||
            ::write(pipe[1], &*id, sizeof *id) != sizeof *id) {
          ::_exit(1);
        }
      }
      ::_exit(2);
    }
    ::close(pipe[1]);
    // Some stores pass; the kill then falls anywhere in the next one or two.
    int id = 0;
    for (auto wanted = 1 + random.below(3); wanted > 0 && ::read(pipe[0], &id, sizeof id) == sizeof id;
         --wanted) {
      reported.push_back(id);
    }
    std::this_thread::sleep_for(std::chrono::microseconds(random.below(60000)));
    ::kill(child, SIGKILL);
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFSIGNALED(status)) << "the child ended by itself: " << WEXITSTATUS(status);
    while (::read(pipe[0], &id, sizeof id) == sizeof id) {
      reported.push_back(id);
    }
    ::close(pipe[0]);
    const Result<SessionStore> store = SessionStore::open_or_create(folder);
    ASSERT_TRUE(store) << store.error().line();
    EXPECT_THAT(store->opening().damage, IsEmpty()) << "round " << round;
    const auto scans = store->scans().value();
    EXPECT_GE(scans.size(), reported.size());
    for (const int stored : reported) {
      const Result<RangeGrid> grid = store->load_grid(stored);
      ASSERT_TRUE(grid) << grid.error().line();
      EXPECT_EQ(grid->z, small_grid(stored).z) << stored;
      EXPECT_TRUE(store->load_flags(stored).value()) << stored;
    }
  }
  EXPECT_GE(reported.size(), 10U) << "children were killed before they stored anything";
}

}  // namespace
}  // namespace dubsar
