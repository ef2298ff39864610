// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said of the tablet where the session cannot be written to.
#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "acquisition/session_store.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

using test::Followed;
using test::kSmallTablet;

class LiveRecord : public ::testing::Test {
 protected:
  [[nodiscard]] std::filesystem::path session() const { return folder_.path() / "s"; }
  [[nodiscard]] std::string kept_number() const {
    return tablet_record_of(SessionStore::open(session(), SessionStore::Access::kReadOnly).value())
        .museum_number;
  }
  static TabletRecord bm_15285() {
    TabletRecord record;
    record.museum_number = "BM 15285";
    return record;
  }
  test::TemporaryFolder folder_;
};

TEST_F(LiveRecord, ThatWasRefusedIsSaidToBeAndIsKeptWhenItIsSaidAgain) {
  std::optional<SessionStore> another = SessionStore::open_or_create(session()).value();
  Followed followed(kSmallTablet, session());
  followed.session.read();
  ASSERT_TRUE(followed.wait_for_rest());
  followed.session.describe(bm_15285());
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_TRUE(followed.session.state().error);
  EXPECT_FALSE(followed.session.state().record_kept);
  EXPECT_EQ(followed.session.state().record.museum_number, "BM 15285") << "nobody types it twice";
  EXPECT_EQ(kept_number(), "");
  another.reset();
  followed.session.describe(bm_15285());
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_TRUE(followed.session.state().record_kept);
  EXPECT_EQ(kept_number(), "BM 15285");
}

TEST_F(LiveRecord, ThatWasRefusedIsKeptAtTheLatestWhenItsWindowIsShut) {
  {
    std::optional<SessionStore> another = SessionStore::open_or_create(session()).value();
    Followed followed(kSmallTablet, session());
    followed.session.describe(bm_15285());
    ASSERT_TRUE(followed.wait_for_rest());
    ASSERT_FALSE(followed.session.state().record_kept);
    another.reset();
  }
  EXPECT_EQ(kept_number(), "BM 15285");
}

/// A rig's laser is lit for whoever looks, and to be written to a large session is opened for minutes.
TEST_F(LiveRecord, ThatIsKeptWhenItsWindowIsShutIsKeptAfterTheCameraIsClosed) {
  std::optional<SessionStore> another = SessionStore::open_or_create(session()).value();
  std::atomic<bool> shuts = false;
  std::vector<std::string> kept;  // as the camera is closed
  auto window =
      std::make_unique<LiveSession>(LiveSession::Options{kSmallTablet, session(), std::nullopt}, [&] {
        if (shuts) {
          kept.push_back(kept_number());
        }
      });
  window->describe(bm_15285());
  while (window->busy()) {
    std::this_thread::yield();
  }
  ASSERT_FALSE(window->state().record_kept);
  window->watch_camera(true);
  while (!window->state().panel) {
    std::this_thread::yield();
  }
  another.reset();
  shuts = true;
  window.reset();
  ASSERT_FALSE(kept.empty());
  EXPECT_EQ(kept.back(), "");
  EXPECT_EQ(kept_number(), "BM 15285");
}

TEST_F(LiveRecord, ThatWasRefusedIsKeptByTheNextRun) {
  std::optional<SessionStore> another = SessionStore::open_or_create(session()).value();
  Followed followed(kSmallTablet, session());
  followed.session.describe(bm_15285());
  ASSERT_TRUE(followed.wait_for_rest());
  another.reset();
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_TRUE(followed.session.state().record_kept);
  EXPECT_EQ(kept_number(), "BM 15285");
}

/// The engine tells a refusal of it, and no more.
TEST_F(LiveRecord, ThatARunHasRefusedIsNotSaidToBeKept) {
  Followed followed(kSmallTablet, session());
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  TabletRecord record;
  record.museum_number = std::string(1001, '1');
  followed.session.describe(record);
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  EXPECT_EQ(kept_number(), "");
  EXPECT_FALSE(followed.session.state().record_kept);
}

}  // namespace
}  // namespace dubsar
