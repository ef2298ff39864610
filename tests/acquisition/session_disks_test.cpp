// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Sessions on disks that are full, write-protected or refuse.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <string>

#include "acquisition/session_store.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/acquisition/spoil.h"
#include "tests/support/in_child.h"
#include "tests/support/temporary_folder.h"

namespace {

/// The disk takes what is written to the log of the tables, and reports an error for it.
bool refuses_to_sync_the_log = false;

int sync_unless_refused(int file, long call) {
  char name[4096];
  const std::string link = "/proc/self/fd/" + std::to_string(file);
  const ssize_t length = refuses_to_sync_the_log ? ::readlink(link.c_str(), name, sizeof name) : 0;
  if (length > 0 && std::string(name, static_cast<std::size_t>(length)).ends_with("-wal")) {
    errno = EIO;
    return -1;
  }
  return static_cast<int>(::syscall(call, file));
}

}  // namespace

// In the place of the C library's, which SQLite calls.
extern "C" int fsync(int file) {
  return sync_unless_refused(file, SYS_fsync);
}
extern "C" int fdatasync(int file) {
  return sync_unless_refused(file, SYS_fdatasync);
}

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::be_bound_by_rights;
using test::in_child;
using test::SessionDamageTest;
using test::small_grid;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

TEST_F(SessionDamageTest, AFullDiskLosesNothingThatWasStored) {
  const int status = in_child([&] {
    ::signal(SIGXFSZ, SIG_IGN);
    SessionStore store = SessionStore::open(folder_).value();
    // No file may grow past this: small for a grid file first, then for the database's log.
    for (const rlim_t limit : {rlim_t{512}, rlim_t{12000}}) {
      const rlimit small{limit, RLIM_INFINITY};
      ::setrlimit(RLIMIT_FSIZE, &small);
      RangeGrid grid = small_grid(8);
      if (limit > 10000) {
        grid = RangeGrid();
        grid.allocate(2, 2);
        grid.source = std::string(20000, 's');
      }
      const Result<int> id = store.add_grid(grid);
      if (id || id.error().kind != ErrorKind::kStorage || id.error().mend.empty()) {
        return 1;
      }
      const Status document = store.save_document("big", std::string(20000, ' '));
      if (document || document.error().kind != ErrorKind::kStorage) {
        return 2;
      }
    }
    const rlimit free{RLIM_INFINITY, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &free);
    // With room again the same store goes on.
    return store.add_grid(small_grid(4)).value_or(-1) == 4 ? 0 : 3;
  });
  EXPECT_EQ(status, 0);
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  EXPECT_EQ(store.scans().value().size(), 5U);
  EXPECT_EQ(store.load_grid(4).value().z, small_grid(4).z);
  EXPECT_FALSE(store.load_document("big").value());
}

/// Three scans in a row that the disk refuses when their rows are committed.
bool refuses_three(SessionStore& store) {
  refuses_to_sync_the_log = true;
  bool all = true;
  for (int i = 4; i < 7; ++i) {
    const Result<int> id = store.add_grid(small_grid(i));
    all = all && !id && id.error().kind == ErrorKind::kStorage;
  }
  refuses_to_sync_the_log = false;
  return all;
}

TEST_F(SessionDamageTest, CommitsThatTheDiskRefusesInARowAreNoMissingLog) {
  const int status = in_child([&] {
    SessionStore store = SessionStore::open(folder_).value();
    ::_exit(refuses_three(store) ? 0 : 1);
    return 2;
  });
  ASSERT_EQ(status, 0);
  EXPECT_THAT(SessionStore::open(folder_, kReadOnly)->verify(job_)->lost, IsEmpty());
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  ASSERT_EQ(store.scans().value().size(), 5U) << "of those that were refused one may stand, and none more";
  EXPECT_EQ(store.load_grid(4).value().z, small_grid(4).z);
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty());
}

TEST_F(SessionDamageTest, AScanThatTheDiskRefusedIsListedBeforeTheNextOne) {
  const int status = in_child([&] {
    SessionStore store = SessionStore::open(folder_).value();
    if (!refuses_three(store)) {
      return 1;
    }
    const int next = store.next_id().value();
    if (store.add_grid(small_grid(5), "a remark").value_or(-1) != next || next != 5) {
      return 2;
    }
    return store.scans().value().size() == 6 && store.load_grid(4)->z == small_grid(4).z ? 0 : 3;
  });
  ASSERT_EQ(status, 0);
  const SessionStore store = SessionStore::open(folder_, kReadOnly).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  ASSERT_EQ(store.scans().value().size(), 6U);
  EXPECT_EQ(store.scans().value()[5].remark, "a remark");
  EXPECT_EQ(store.load_grid(5).value().z, small_grid(5).z);
  EXPECT_TRUE(store.verify(job_)->ok());
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty());
}

TEST_F(SessionDamageTest, RowsThatARebuildingDidNotGetToAreNoMissingLog) {
  test::spoil_both(folder_, "grids/00");  // the rows of all four scans
  const int status = in_child([&] {
    refuses_to_sync_the_log = true;  // the new tables stand, and no grid is taken in
    const Result<SessionStore> store = SessionStore::open(folder_);
    return !store && store.error().kind == ErrorKind::kStorage ? 0 : 1;
  });
  ASSERT_EQ(status, 0);
  const VerifyReport report = SessionStore::open(folder_, kReadOnly)->verify(job_).value();
  for (const Error& lost : report.lost) {
    EXPECT_THAT(lost.line(), testing::Not(HasSubstr("nothing names"))) << "each of them has a name";
  }
  const SessionStore store = SessionStore::open(folder_).value();
  EXPECT_THAT(store.opening().damage, IsEmpty());
  EXPECT_THAT(store.opening().notes, Contains(HasSubstr("grids/003.grid, whose row was lost")));
  expect_content(store);
  EXPECT_THAT(store.verify(job_)->lost, IsEmpty()) << "all of it was known";
}

TEST_F(SessionDamageTest, AWriteProtectedFolderIsToldAndCanBeRead) {
  { SessionStore store = SessionStore::open(folder_).value(); }
  const int status = in_child([&] {
    for (const auto& entry : fs::recursive_directory_iterator(temporary_.path())) {
      fs::permissions(entry.path(), entry.is_directory() ? fs::perms(0555) : fs::perms(0444));
    }
    fs::permissions(temporary_.path(), fs::perms(0555));
    if (!be_bound_by_rights()) {
      return 9;
    }
    const auto writer = SessionStore::open(folder_);
    if (writer || writer.error().kind != ErrorKind::kStorage || writer.error().mend.empty()) {
      return 1;
    }
    const auto reader = SessionStore::open(folder_, kReadOnly);
    return reader && reader->load_grid(3) && reader->verify(job_).value().ok() ? 0 : 2;
  });
  for (const fs::path& path : {temporary_.path(), folder_, folder_ / "grids", folder_ / "mesh"}) {
    fs::permissions(path, fs::perms(0755));
  }
  EXPECT_EQ(status, 0);
}

TEST_F(SessionDamageTest, ABackupThatCannotBeReadKeepsNoWriterOut) {
  fs::remove(folder_ / "session.sums");
  fs::create_directory(folder_ / "session.sums");
  const int status = in_child([&] {
    for (const auto& entry : fs::recursive_directory_iterator(temporary_.path())) {
      fs::permissions(entry.path(), entry.is_directory() ? fs::perms(0777) : fs::perms(0666));
    }
    fs::permissions(temporary_.path(), fs::perms(0777));
    fs::permissions(folder_ / "session.backup.sqlite", fs::perms(0000));
    if (!be_bound_by_rights()) {
      return 9;
    }
    const VerifyReport found = SessionStore::open(folder_, kReadOnly)->verify(job_).value();
    if (!SessionStore::keep_damaged_records(folder_, found)) {
      return 1;
    }
    return SessionStore::open(folder_) ? 0 : 2;
  });
  EXPECT_EQ(status, 0);
  EXPECT_TRUE(fs::is_directory(folder_ / "session.sums.damaged-1"));
  EXPECT_TRUE(fs::exists(folder_ / "session.backup.sqlite.damaged-1"));
  const SessionStore store = SessionStore::open(folder_, kReadOnly).value();
  expect_content(store);
  EXPECT_TRUE(store.verify(job_)->ok()) << "backup and list were made anew";
}

TEST_F(SessionDamageTest, ALogOnAWriteProtectedDiskIsPlayedWhereThereIsRoom) {
  const fs::path folder = temporary_.path() / "logged";
  leave_with_log(folder);
  fs::remove(folder / "session.sqlite-shm");
  const int status = in_child([&] {
    fs::permissions(temporary_.path(), fs::perms(0555));
    fs::permissions(folder, fs::perms(0555));
    if (!be_bound_by_rights()) {
      return 9;
    }
    ::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{1000, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &small);
    const auto full = SessionStore::open(folder, kReadOnly);
    const rlimit free{RLIM_INFINITY, RLIM_INFINITY};
    ::setrlimit(RLIMIT_FSIZE, &free);
    if (full || full.error().kind != ErrorKind::kStorage || full.error().mend.empty()) {
      return 1;
    }
    const auto reader = SessionStore::open(folder, kReadOnly);
    if (!reader || reader->document_names().value().size() != 12) {
      return 2;
    }
    ::setenv("TMPDIR", "/nowhere", 1);
    const auto nowhere = SessionStore::open(folder, kReadOnly);
    return !nowhere && nowhere.error().kind == ErrorKind::kStorage ? 0 : 3;
  });
  for (const fs::path& path : {temporary_.path(), folder}) {
    fs::permissions(path, fs::perms(0755));
  }
  EXPECT_EQ(status, 0);
}

}  // namespace
}  // namespace dubsar
