// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "acquisition/session_store.h"
#include "tests/acquisition/session_support.h"
#include "tests/support/in_child.h"
#include "tests/support/temporary_folder.h"

namespace dubsar::test {

/// A session of four scans, one of them dropped, to be damaged.
class SessionDamageTest : public testing::Test {
 protected:
  void SetUp() override {
    SessionStore store = SessionStore::open_or_create(folder_).value();
    for (int i = 0; i < 4; ++i) {
      ASSERT_EQ(store.add_grid(small_grid(i)).value(), i);
    }
    ASSERT_TRUE(store.drop_scan(1, "blurred"));
    ASSERT_TRUE(store.save_document("rig", "{\"name\":\"bench\"}"));
    ScanPose pose;
    pose.status = PoseStatus::kRegistered;
    pose.id = 2;
    ASSERT_TRUE(store.save_poses({pose}));
  }

  /// Everything that SetUp stored is there and whole, apart from the grids named.
  static void expect_content(const SessionStore& store, const std::vector<int>& lost = {}) {
    const auto scans = store.scans().value();
    ASSERT_EQ(scans.size(), 4U);
    for (int id = 0; id < 4; ++id) {
      const bool gone = std::ranges::find(lost, id) != lost.end();
      EXPECT_EQ(scans[static_cast<std::size_t>(id)].damaged, gone) << id;
      const Result<RangeGrid> grid = store.load_grid(id);
      EXPECT_EQ(grid.has_value(), !gone) << id;
      if (grid) {
        EXPECT_EQ(grid->z, small_grid(id).z);
      }
    }
    EXPECT_TRUE(scans[1].dropped);
    EXPECT_EQ(store.load_document("rig").value(), "{\"name\":\"bench\"}");
  }

  /// A session with a scan and twelve documents, left as a kill leaves it: most of it stands in the log
  /// alone.
  static void leave_with_log(const std::filesystem::path& folder) {
    const int status = in_child([&]() -> int {
      Result<SessionStore> store = SessionStore::open_or_create(folder);
      bool good = store && store->add_grid(small_grid(1));
      for (int i = 0; i < 12; ++i) {
        good = good && store->save_document("document " + std::to_string(i), "{}");
      }
      ::_exit(good ? 0 : 1);
    });
    ASSERT_EQ(status, 0);
  }

  TemporaryFolder temporary_;
  std::filesystem::path folder_ = temporary_.path() / "session";
  JobContext job_;
};

}  // namespace dubsar::test
