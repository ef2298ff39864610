// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Copies of a session by hard links (cp -al): the same files under two names, and two sessions all the same.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>

#include "acquisition/session_files.h"
#include "formats/atomic_file.h"
#include "formats/files_below.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/support/in_child.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::SizeIs;

class HardLinks : public test::SessionDamageTest {
 protected:
  /// As `cp -al session copy` makes it.
  void link_all() const {
    fs::copy(folder_, copy_, fs::copy_options::recursive | fs::copy_options::create_hard_links);
  }
  /// Name → bytes.
  [[nodiscard]] static std::map<std::string, std::string> bytes_in(const fs::path& session) {
    std::map<std::string, std::string> out;
    const std::vector<fs::path> files = files_below(session).value();
    for (const fs::path& file : files) {
      out[file.lexically_relative(session).generic_string()] = read_whole_file(file).value();
    }
    return out;
  }
  void expect_whole(const fs::path& session, std::size_t scans) {
    const SessionStore store = SessionStore::open(session, SessionStore::Access::kReadOnly).value();
    EXPECT_THAT(store.opening().damage, testing::IsEmpty()) << session;
    EXPECT_THAT(store.scans().value(), SizeIs(scans)) << session;
    EXPECT_TRUE(store.verify(job_).value().ok()) << session;
  }

  fs::path copy_ = temporary_.path() / "copy";
};

TEST_F(HardLinks, WhatIsWrittenIntoACopyLeavesTheOriginalAsItWas) {
  link_all();
  const auto before = bytes_in(folder_);
  {
    SessionStore store = SessionStore::open(copy_).value();
    ASSERT_TRUE(store.add_grid(test::small_grid(7)));
  }
  EXPECT_TRUE(bytes_in(folder_) == before);
  expect_whole(folder_, 4);
  expect_whole(copy_, 5);
}

TEST_F(HardLinks, TheLogOfAKilledProgramIsOfEachCopy) {
  ASSERT_EQ(test::in_child([&]() -> int {
              SessionStore store = SessionStore::open(folder_).value();
              ::_exit(store.add_grid(test::small_grid(4)) ? 0 : 1);  // without closing it
            }),
            0);
  ASSERT_GT(fs::file_size(folder_ / "session.sqlite-wal"), 0U);
  link_all();
  const auto before = bytes_in(folder_);
  {
    SessionStore store = SessionStore::open(copy_).value();
    ASSERT_TRUE(store.add_grid(test::small_grid(7)));
  }
  EXPECT_TRUE(bytes_in(folder_) == before);
  { const SessionStore store = SessionStore::open(folder_).value(); }
  expect_whole(folder_, 5);
  expect_whole(copy_, 6);
}

/// The tables of the one that was open when the copy was made are those of the copy, too.
TEST_F(HardLinks, OfTwoProgramsTheSecondIsToldAsLongAsTheFirstWrites) {
  {
    SessionStore first = SessionStore::open(folder_).value();
    link_all();
    const auto second = SessionStore::open(copy_);
    ASSERT_FALSE(second);
    EXPECT_EQ(second.error().kind, ErrorKind::kStorage);
    EXPECT_THAT(second.error().line(), HasSubstr("shares its files through hard links (process "));
    EXPECT_TRUE(first.add_grid(test::small_grid(4)));
  }
  expect_whole(folder_, 5);
  SessionStore one = SessionStore::open(folder_).value();
  SessionStore other = SessionStore::open(copy_).value();
  EXPECT_FALSE(SessionStore::open(folder_)) << "each has a lock of its own";
  EXPECT_FALSE(SessionStore::open(copy_));
  EXPECT_EQ(one.add_grid(test::small_grid(5)).value(), 5);
  EXPECT_TRUE(one.save_document("rig", "{\"name\":\"one\"}"));
  EXPECT_TRUE(other.save_document("rig", "{\"name\":\"other\"}"));
  EXPECT_EQ(*one.load_document("rig").value(), "{\"name\":\"one\"}");
}

/// It would be emptied for the process number.
TEST_F(HardLinks, ALockThatIsAnotherNameOfSomebodysFileIsNotWrittenTo) {
  const fs::path other = temporary_.path() / "other.txt";
  std::ofstream(other) << "precious";
  fs::remove(folder_ / session::kLock);
  fs::create_hard_link(other, folder_ / session::kLock);
  {
    const SessionStore store = SessionStore::open(folder_).value();
    expect_content(store);
    EXPECT_EQ(fs::hard_link_count(other), 1U);
    EXPECT_FALSE(SessionStore::open(folder_)) << "locked all the same";
  }
  EXPECT_EQ(read_whole_file(other).value(), "precious");
}

}  // namespace
}  // namespace dubsar
