// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// The package of a session as the window makes it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <filesystem>
#include <fstream>
#include <mutex>

#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "station/live_session.h"
#include "station/packing.h"
#include "station/results.h"
#include "station/tablet_record.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using ::testing::EndsWith;

/// The window's state once the package is made.
LiveState packed(const fs::path& session, const fs::path& to) {
  std::mutex mutex;
  std::condition_variable changed;
  LiveSession live({"", session, std::nullopt}, [&] {
    const std::scoped_lock lock(mutex);
    changed.notify_all();
  });
  live.pack(to);
  std::unique_lock lock(mutex);
  EXPECT_TRUE(changed.wait_for(lock, std::chrono::seconds(60), [&] {
    lock.unlock();
    const bool at_rest = !live.busy();
    lock.lock();
    return at_rest;
  }));
  lock.unlock();
  return live.state();
}

TEST(LivePackage, SaysWhereItKeepsWhatWasPutIntoTheEarlierOne) {
  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "s";
  const fs::path bag = folder.path() / "bag";
  for (const int number : {0, 1}) {
    ASSERT_TRUE(SessionStore::open_or_create(session)->add_grid(test::bumpy_scan(number, 11, 1.0)));
  }
  const LiveState first = packed(session, bag);
  ASSERT_FALSE(first.error) << first.error->line();
  EXPECT_EQ(first.notice, "");
  std::ofstream(bag / "letter.txt") << "of a curator";
  ASSERT_TRUE(SessionStore::open_or_create(session)->drop_scan(1, "hand in view"));
  const LiveState second = packed(session, bag);
  ASSERT_FALSE(second.error) << second.error->line();
  EXPECT_THAT(second.notice, EndsWith("is kept in " + bag.string() + ".kept-1"));
  EXPECT_TRUE(fs::exists(bag.string() + ".kept-1/letter.txt"));
}

/// As the window has it when its folder is opened.
LiveState opened(const fs::path& session) {
  test::Followed live("", session);
  live.session.read();
  EXPECT_TRUE(live.wait_for_rest());
  return live.session.state();
}

TEST(LivePackage, IsFoundWhenTheSignedSessionIsOpenedAgain) {
  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "s";
  JobContext job;
  {
    Result<SessionStore> store = SessionStore::open_or_create(session);
    ASSERT_TRUE(store->add_grid(test::bumpy_scan(0, 11, 1.0)));
    ASSERT_TRUE(keep_verdict(*store, {}, {}));
    SignOff wanted;
    wanted.name = "A. Reader";
    wanted.incomplete = "one side only";
    const Result<SignOff> made = sign_session(*store, wanted, job);
    ASSERT_TRUE(made) << made.error().line();
  }
  EXPECT_EQ(opened(session).package, "") << "there is none yet";
  const fs::path usual = usual_package_of(session);
  ASSERT_TRUE(pack_session({.session = session, .to = usual, .package = {}}, job));
  const LiveState again = opened(session);
  EXPECT_TRUE(again.signed_off);
  EXPECT_EQ(again.package, usual);
  const fs::path page = usual / "data/README.txt";
  fs::rename(page, folder.path() / "page");
  EXPECT_EQ(opened(session).package, "") << "it is not whole";
  fs::rename(folder.path() / "page", page);
  EXPECT_EQ(opened(session).package, usual);
  {
    Result<SessionStore> store = SessionStore::open_or_create(session);
    TabletRecord record;
    record.museum_number = "BM 1";
    ASSERT_TRUE(keep_tablet_record(*store, record));
  }
  EXPECT_TRUE(opened(session).signed_off);
  EXPECT_EQ(opened(session).package, "") << "it is of the session as it was";
}

TEST(LivePackage, IsNoneOfTheSessionAnyMoreOnceTheTabletIsDescribedAnew) {
  const test::TemporaryFolder folder;
  const fs::path session = folder.path() / "s";
  ASSERT_TRUE(SessionStore::open_or_create(session)->add_grid(test::bumpy_scan(0, 11, 1.0)));
  test::Followed live("", session);
  live.session.pack(folder.path() / "bag");
  ASSERT_TRUE(live.wait_for_rest());
  EXPECT_EQ(live.session.state().package, folder.path() / "bag");
  live.session.describe({});
  EXPECT_EQ(live.session.state().package, folder.path() / "bag") << "nothing new";
  ASSERT_TRUE(live.wait_for_rest());
  TabletRecord record;
  record.museum_number = "BM 1";
  live.session.describe(record);
  EXPECT_EQ(live.session.state().package, "");
  ASSERT_TRUE(live.wait_for_rest());
}

}  // namespace
}  // namespace dubsar
