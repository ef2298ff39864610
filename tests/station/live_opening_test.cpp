// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said to a session while its scanner is being opened.

#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <thread>

#include "acquisition/session_store.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

TabletRecord vat_1() {
  TabletRecord record;
  record.museum_number = "VAT 1";
  return record;
}

/// How a run ends while whose device is opened `say` was called: on the thread of the session itself, so
/// surely then.
LiveState state_after(const std::string& device, const std::filesystem::path& folder,
                      const std::function<void(LiveSession&)>& say) {
  LiveSession* watched = nullptr;
  std::atomic<bool> said = false;
  LiveSession session({device, folder, std::nullopt}, [&] {
    if (!said && watched->state().phase == LivePhase::kOpening) {
      said = true;
      say(*watched);
    }
  });
  watched = &session;
  session.scan_now();
  while (session.busy()) {
    std::this_thread::yield();
  }
  EXPECT_TRUE(said);
  return session.state();
}

TEST(LiveOpening, TheScanBeforeIsTakenOutAndNotTheNext) {
  const test::TemporaryFolder folder;
  const auto scans = test::write_bumpy_scans(folder.path() / "scans", 3);
  {
    SessionStore store = SessionStore::open_or_create(folder.path() / "s").value();
    ASSERT_TRUE(store.add_grid(test::bumpy_scan(0)));
    ASSERT_TRUE(store.add_grid(test::bumpy_scan(1)));
  }
  const LiveState after =
      state_after("replay:" + scans.string(), folder.path() / "s", [](LiveSession& session) {
        session.ask(DropScan{-1, "undone by the operator"});
        session.describe(vat_1());
      });
  const SessionStore store = SessionStore::open(folder.path() / "s", SessionStore::Access::kReadOnly).value();
  const std::vector<StoredScan> stored = store.scans().value();
  ASSERT_EQ(stored.size(), 5U);
  for (const StoredScan& scan : stored) {
    EXPECT_EQ(scan.dropped, scan.id == 1) << scan.id;
  }
  EXPECT_EQ(tablet_record_of(store).museum_number, "VAT 1");
  EXPECT_TRUE(after.checklist) << "one run was enough";
}

TEST(LiveOpening, WhatIsSaidOfTheTabletIsKeptAlsoWhereTheScannerCannotBeOpened) {
  const test::TemporaryFolder folder;
  EXPECT_TRUE(state_after("sim:?size=nonsense", folder.path() / "s", [](LiveSession& session) {
                session.describe(vat_1());
              }).error);
  const Result<SessionStore> store = SessionStore::open(folder.path() / "s", SessionStore::Access::kReadOnly);
  ASSERT_TRUE(store);
  EXPECT_EQ(tablet_record_of(*store).museum_number, "VAT 1");
}

}  // namespace
}  // namespace dubsar
