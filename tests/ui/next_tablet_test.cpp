// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the box of the next tablet asks about before a session that is there is gone on with.
#include <gtest/gtest.h>

#include <filesystem>

#include "acquisition/session_store.h"
#include "station/next_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::ui {
namespace {

TEST(NextTablet, ASessionThatLiesThereIsKnownByItsTablet) {
  const test::TemporaryFolder folder;
  EXPECT_FALSE(session_found(folder.path() / "none"));
  std::filesystem::create_directories(folder.path() / "pictures");
  EXPECT_FALSE(session_found(folder.path() / "pictures"));
  {
    auto store = SessionStore::open_or_create(folder.path() / "box-2");
    ASSERT_TRUE(store);
    TabletRecord record;
    record.museum_number = "BM 999";
    ASSERT_TRUE(keep_tablet_record(*store, record));
  }
  const auto found = session_found(folder.path() / "box-2");
  ASSERT_TRUE(found);
  EXPECT_TRUE(found->is_read);
  EXPECT_EQ(found->record.museum_number, "BM 999");
  EXPECT_EQ(found->scans, 0);
}

}  // namespace
}  // namespace dubsar::ui
