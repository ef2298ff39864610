// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Faults of SQLite's structure: those that cost no row are mended without a copy, those that may have are
// told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <string>

#include "acquisition/session_store.h"
#include "acquisition/sqlite_db.h"
#include "tests/acquisition/session_damage_support.h"
#include "tests/acquisition/spoil.h"
#include "tests/support/files.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using testing::IsEmpty;
using testing::Not;

constexpr auto kReadOnly = SessionStore::Access::kReadOnly;

class SessionStructure : public test::SessionDamageTest {
 protected:
  void SetUp() override {
    SessionDamageTest::SetUp();
    SessionStore store = SessionStore::open(folder_).value();
    for (int i = 0; i < 5; ++i) {
      ASSERT_TRUE(store.save_document("document " + std::to_string(i), "{}"));
    }
  }
  /// Where the page of a table or index begins that lies on one page.
  [[nodiscard]] std::uintmax_t page_of(const std::string& name) const {
    SqlDatabase db = SqlDatabase::open(database_, SqlDatabase::Mode::kImmutable).value();
    return static_cast<std::uintmax_t>(
        (db.integer_of(("SELECT rootpage FROM sqlite_schema WHERE name = '" + name + "'").c_str()).value() -
         1) *
        4096);
  }
  /// Turns bits of a byte in the tables, without a backup that would have everything.
  void damage(std::uintmax_t at, int mask) const {
    fs::remove(folder_ / "session.backup.sqlite");
    test::flip_byte(database_, at, mask);
  }
  const fs::path database_ = folder_ / "session.sqlite";
};

TEST_F(SessionStructure, OneThatCostsNoRowIsMendedWithoutACopy) {
  const std::uintmax_t index = page_of("sqlite_autoindex_documents_1");
  const std::string bytes = test::text_of_file(database_);
  const struct {
    const char* what;
    std::uintmax_t at;
    int mask;
  } kFaults[] = {{"a key in the index", bytes.find("document 4", index), 1},
                 {"the kind of its page", index, 1},
                 {"the number of its keys", index + 4, 2},
                 {"where its first key lies", index + 9, 4},
                 {"the count of free pages", 39, 1}};
  for (const auto& fault : kFaults) {
    const fs::path whole = temporary_.path() / "whole";
    fs::remove_all(whole);
    fs::copy(folder_, whole, fs::copy_options::recursive);
    damage(fault.at, fault.mask);
    EXPECT_FALSE(SessionStore::open(folder_, kReadOnly)->verify(job_)->ok()) << fault.what;
    {
      const SessionStore store = SessionStore::open(folder_).value();
      EXPECT_FALSE(store.opening().damage.empty()) << fault.what;
      expect_content(store);
      EXPECT_EQ(store.document_names()->size(), 6U) << fault.what;
      EXPECT_TRUE(store.load_document("document 4").value()) << fault.what;
    }
    EXPECT_TRUE(fs::exists(folder_ / "session.sqlite.damaged-1")) << fault.what;
    const VerifyReport report = SessionStore::open(folder_, kReadOnly)->verify(job_).value();
    EXPECT_TRUE(report.ok()) << fault.what;
    EXPECT_THAT(report.lost, IsEmpty()) << fault.what;
    fs::remove_all(folder_);
    fs::rename(whole, folder_);
  }
}

TEST_F(SessionStructure, OneThatMayHaveCostARowIsTold) {
  const struct {
    const char* what;
    std::uintmax_t at;
    int mask;
  } kFaults[] = {{"one event less", page_of("events") + 4, 1},
                 {"one document less, which the index still has", page_of("documents") + 4, 2},
                 {"a key more than the table has", page_of("sqlite_autoindex_documents_1") + 4, 8}};
  for (const auto& fault : kFaults) {
    const fs::path whole = temporary_.path() / "whole";
    fs::remove_all(whole);
    fs::copy(folder_, whole, fs::copy_options::recursive);
    damage(fault.at, fault.mask);
    { EXPECT_TRUE(SessionStore::open(folder_)) << fault.what; }
    const VerifyReport report = SessionStore::open(folder_, kReadOnly)->verify(job_).value();
    EXPECT_THAT(report.lost, Not(IsEmpty())) << fault.what;
    fs::remove_all(folder_);
    fs::rename(whole, folder_);
  }
}

TEST_F(SessionStructure, AWriteOfThePageOfRowsThatNeverReachedTheDiskIsTold) {
  // The index has the key of a row; the page of rows is that of before, and nothing is wrong with it.
  const std::string before = test::text_of_file(database_);
  { ASSERT_TRUE(SessionStore::open(folder_)->save_document("document 5", "{}")); }
  std::string after = test::text_of_file(database_);
  const std::uintmax_t page = page_of("documents");
  after.replace(page, 4096, before, page, 4096);
  std::ofstream(database_, std::ios::binary) << after;
  fs::remove(folder_ / "session.backup.sqlite");
  { EXPECT_TRUE(SessionStore::open(folder_)); }
  EXPECT_THAT(SessionStore::open(folder_, kReadOnly)->verify(job_)->lost, Not(IsEmpty()));
}

}  // namespace
}  // namespace dubsar
