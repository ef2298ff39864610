// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/tablet_record.h"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TEST(TabletRecord, ACdliNumberIsAPAndSixDigits) {
  EXPECT_TRUE(check_cdli(""));
  EXPECT_TRUE(check_cdli("P123456"));
  for (const char* bad : {"P12345", "P1234567", "p123456", "123456", "P12345x", "P 12345"}) {
    EXPECT_FALSE(check_cdli(bad)) << bad;
  }
  TabletRecord record{"VAT \"1\"", "P000001", "Berlin", "A. Reader", "CC BY 4.0", "line\nbreak"};
  const auto again = parse_tablet_record(tablet_record_to_json(record), "test");
  ASSERT_TRUE(again) << again.error().line();
  EXPECT_EQ(*again, record);
}

TEST(TabletRecord, WhatHeadsPagesAndNamesFilesIsNoText) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  TabletRecord record;
  record.museum_number = std::string(1001, '1');
  const Status kept = keep_tablet_record(*store, record);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().line(), "the museum number: more than 1000 bytes; say less");
  EXPECT_EQ(tablet_record_of(*store), TabletRecord());
  record.museum_number.pop_back();
  record.notes = std::string(100'000, 'n');
  EXPECT_TRUE(keep_tablet_record(*store, record));
  record.notes += "n";
  EXPECT_FALSE(keep_tablet_record(*store, record));
}

TEST(TabletRecord, BlanksSayNothing) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  const TabletRecord record{.museum_number = " BM 1\t",
                            .cdli = "",
                            .collection = "",
                            .operator_name = "",
                            .rights = "  ",
                            .notes = ""};
  ASSERT_TRUE(keep_tablet_record(*store, record));
  EXPECT_EQ(tablet_record_of(*store).museum_number, "BM 1");
  EXPECT_EQ(tablet_record_of(*store).rights, "");
  // As an earlier version kept it.
  ASSERT_TRUE(store->save_document("tablet", tablet_record_to_json(record)));
  EXPECT_EQ(tablet_record_of(*store).rights, "");
  EXPECT_EQ(words_of(tablet_record_of(*store)).size(), 1U);
}

TEST(TabletRecord, WhatIsNoUtf8IsRefusedAndNotKeptAsQuestionMarks) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  TabletRecord record;
  record.operator_name = "J\xF6rg";
  const Status kept = keep_tablet_record(*store, record);
  ASSERT_FALSE(kept);
  EXPECT_EQ(kept.error().line(),
            "the operator: it has bytes that are no UTF-8; set the terminal to UTF-8, and say it again");
  record.operator_name = "J\xC3\xB6rg";
  EXPECT_TRUE(keep_tablet_record(*store, record));
}

TEST(TabletRecord, WhatWasSaidBeforeStaysInTheRecord) {
  const test::TemporaryFolder folder;
  Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "session");
  ASSERT_TRUE(store) << store.error().line();
  for (const char* number : {"BM 1", "BM 1", "BM 2"}) {
    TabletRecord record;
    record.museum_number = number;
    ASSERT_TRUE(keep_tablet_record(*store, record));
  }
  std::vector<std::string> said;
  const Result<std::vector<SessionEvent>> events = store->events();
  ASSERT_TRUE(events);
  for (const SessionEvent& event : *events) {
    if (event.kind == "tablet described") {
      said.push_back(parse_tablet_record(event.json, "event")->museum_number);
    }
  }
  EXPECT_EQ(said, (std::vector<std::string>{"BM 1", "BM 2"})) << "once for each time that it changed";
}

}  // namespace
}  // namespace dubsar
