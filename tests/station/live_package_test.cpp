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
#include "station/live_session.h"
#include "tests/station/support/bumpy_scans.h"
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

}  // namespace
}  // namespace dubsar
