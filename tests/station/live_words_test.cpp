// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What is said to a session while something else is under way: it is done, or told, or kept.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>
#include <functional>
#include <memory>
#include <thread>

#include "acquisition/session_store.h"
#include "acquisition/sign_off_log.h"
#include "station/packing.h"
#include "station/results.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/followed_session.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::kSmallTablet;
using ::testing::HasSubstr;

/// A session that says something itself, once, when it comes to a state: on a thread of its own, so surely
/// then.
class Saying {
 public:
  using Is = std::function<bool(const LiveState&, const LiveSession&)>;
  using Say = std::function<void(LiveSession&)>;

  Saying(const LiveSession::Options& options, Is is, Say say)
      : is_(std::move(is)), say_(std::move(say)), session_(std::make_unique<LiveSession>(options, [this] {
          LiveSession* const live = live_;
          opens_after_ = opens_after_ || (said_ && live->state().phase == LivePhase::kOpening);
          if (live != nullptr && is_(live->state(), *live) && !said_.exchange(true)) {
            say_(*live);
          }
        })) {
    live_ = session_.get();
  }
  [[nodiscard]] LiveSession& session() { return *session_; }
  [[nodiscard]] bool has_said() const { return said_; }
  void close() { session_.reset(); }
  void wait_for_phase(LivePhase phase) {
    while (session_->busy() && session_->state().phase != phase) {
      std::this_thread::yield();
    }
  }
  /// Or where a run that has begun since waits for somebody.
  LiveState at_rest() {
    while (session_->busy() && !(opens_after_ && session_->state().phase == LivePhase::kWaiting)) {
      std::this_thread::yield();
    }
    EXPECT_TRUE(said_) << "it shows nothing";
    return session_->state();
  }

 private:
  Is is_;
  Say say_;
  std::atomic<bool> said_ = false;
  std::atomic<bool> opens_after_ = false;
  std::atomic<LiveSession*> live_ = nullptr;
  std::unique_ptr<LiveSession> session_;
};

/// A run that takes no words any more.
bool writes(const LiveState& state, const LiveSession&) {
  return state.stage == "writing results";
}

bool is_out(const fs::path& session, int id) {
  return SessionStore::open(session, SessionStore::Access::kReadOnly)->scans()->at(id).dropped;
}

TEST(LiveWords, AfterAnEmergencyStopBeginNoRunByThemselves) {
  const test::TemporaryFolder folder;
  Saying saying({kSmallTablet, folder.path() / "s", std::nullopt}, writes, [](LiveSession& session) {
    session.ask(DropScan{0, "undone by the operator"});
  });
  saying.session().scan_now();
  saying.wait_for_phase(LivePhase::kWaiting);
  saying.session().halt();
  while (saying.session().busy() && !saying.has_said()) {
    std::this_thread::yield();
  }
  const LiveState after = saying.at_rest();
  EXPECT_EQ(after.phase, LivePhase::kStill) << "it runs, and nobody has said that it may";
  EXPECT_THAT(after.notice, HasSubstr("not heeded; say it again"));
  EXPECT_FALSE(is_out(folder.path() / "s", 0));
  // The next word is one.
  saying.session().ask(DropScan{0, "undone by the operator"});
  const LiveState again = saying.at_rest();
  EXPECT_EQ(again.phase, LivePhase::kWaiting);
  EXPECT_FALSE(again.halted);
  EXPECT_TRUE(is_out(folder.path() / "s", 0));
}

TEST(LiveWords, ThatAStopLeavesUndoneAreTold) {
  const test::TemporaryFolder folder;
  Saying saying({kSmallTablet, folder.path() / "s", std::nullopt}, writes, [](LiveSession& session) {
    session.ask(HintScan{1, {}});
    session.ask(DropScan{0, "undone by the operator"});
    EXPECT_TRUE(session.state().scans.at(1).hinted);
    session.stop();
  });
  saying.session().scan_now();
  saying.wait_for_phase(LivePhase::kWaiting);
  saying.session().finish();
  const LiveState after = saying.at_rest();
  EXPECT_EQ(after.phase, LivePhase::kStill);
  EXPECT_THAT(after.notice, HasSubstr("not heeded; say it again"));
  EXPECT_FALSE(after.scans.at(1).hinted) << "there is none to withdraw";
  EXPECT_FALSE(is_out(folder.path() / "s", 0));
}

/// Whoever closes the window copies this once the window waits for its threads: it wants it beside them.
struct TellsOfClosing {
  std::shared_ptr<std::atomic<bool>> armed, closes;
  TellsOfClosing()
      : armed(std::make_shared<std::atomic<bool>>()), closes(std::make_shared<std::atomic<bool>>()) {}
  TellsOfClosing(const TellsOfClosing& other) : armed(other.armed), closes(other.closes) {
    *closes = armed->load();
  }
  TellsOfClosing& operator=(const TellsOfClosing&) = delete;
  void operator()(const Error&) const {}
};

TEST(LiveWords, AreKeptWhereTheWindowIsClosedBeforeTheyAreHeeded) {
  const test::TemporaryFolder folder;
  const TellsOfClosing closing;
  Saying saying({kSmallTablet, folder.path() / "s", std::nullopt, true, closing}, writes,
                [&](LiveSession& session) {
                  session.ask(DropScan{0, "undone by the operator"});
                  *closing.armed = true;
                  while (!*closing.closes) {
                    std::this_thread::yield();
                  }
                });
  saying.session().scan_now();
  saying.wait_for_phase(LivePhase::kWaiting);
  saying.session().finish();
  while (!*closing.armed) {
    std::this_thread::yield();
  }
  saying.close();
  EXPECT_TRUE(is_out(folder.path() / "s", 0));
}

/// As labels of pins are: two scans at once. The second comes while a run is still being begun for the first.
TEST(LiveWords, ThatComeAtOnceAreOfOneRun) {
  const test::TemporaryFolder folder;
  test::Followed followed(kSmallTablet, folder.path() / "s");
  followed.session.scan_now();
  ASSERT_TRUE(followed.wait_for_phase(LivePhase::kWaiting));
  followed.session.finish();
  ASSERT_TRUE(followed.wait_for_rest());
  const std::size_t count = followed.session.state().scans.size();
  ASSERT_GE(count, 2U);
  followed.session.ask(LockScan{0});
  followed.session.ask(DropScan{static_cast<int>(count) - 1, "undone by the operator"});
  EXPECT_TRUE(followed.wait_until([](const LiveState& state) {
    const LiveScan& first = state.scans.front();
    return state.phase == LivePhase::kWaiting && first.pose && first.pose->locked &&
           state.scans.back().dropped;
  })) << "the run waits for a scan, and one of them waits for its end";
  followed.session.stop();
  ASSERT_TRUE(followed.wait_for_rest());
}

/// The run has them, and is stopped with the window before it comes to them.
TEST(LiveWords, AreKeptWhereTheWindowIsClosedBeforeARunThatTookThemHasHeededThem) {
  const test::TemporaryFolder folder;
  {
    Result<SessionStore> store = SessionStore::open_or_create(folder.path() / "s");
    ASSERT_TRUE(store && store->add_grid(test::bumpy_scan(0, 11, 1.0)));
  }
  const TellsOfClosing closing;
  const auto opens = [](const LiveState& state, const LiveSession&) {
    return state.phase == LivePhase::kOpening;
  };
  Saying saying({kSmallTablet, folder.path() / "s", std::nullopt, true, closing}, opens,
                [&](LiveSession& session) {
                  session.ask(DropScan{0, "undone by the operator"});
                  *closing.armed = true;
                  while (!*closing.closes) {
                    std::this_thread::yield();
                  }
                });
  saying.session().scan_now();
  while (!*closing.armed) {
    std::this_thread::yield();
  }
  saying.close();
  EXPECT_TRUE(is_out(folder.path() / "s", 0));
}

/// A session of one scan, signed, in its package.
class LiveSigned : public ::testing::Test {
 protected:
  void SetUp() override {
    JobContext job;
    {
      Result<SessionStore> store = SessionStore::open_or_create(session_);
      ASSERT_TRUE(store->add_grid(test::bumpy_scan(0, 11, 1.0)));
      ASSERT_TRUE(keep_verdict(*store, {}, {}));
      SignOff wanted;
      wanted.name = "A. Reader";
      wanted.incomplete = "one side only";
      ASSERT_TRUE(sign_session(*store, wanted, job));
    }
    ASSERT_TRUE(pack_session({.session = session_, .to = package_, .package = {}}, job));
  }
  test::TemporaryFolder folder_;
  fs::path session_ = folder_.path() / "s";
  fs::path package_ = usual_package_of(session_);
};

TEST_F(LiveSigned, IsReadToItsEndWhateverIsPressed) {
  const auto reads = [](const LiveState& state, const LiveSession&) {
    return state.phase == LivePhase::kReading;
  };
  Saying saying({"", session_, std::nullopt}, reads, [](LiveSession& session) {
    session.stop();
    session.halt();
  });
  saying.session().read();
  const LiveState after = saying.at_rest();
  EXPECT_TRUE(after.signed_off);
  EXPECT_EQ(after.signed_by, "A. Reader");
  EXPECT_TRUE(after.scans.at(0).picture);
  EXPECT_FALSE(after.halted) << "there was nothing to halt";
}

TEST_F(LiveSigned, StaysSoWhereARunDoesNotComeOff) {
  const auto opens = [](const LiveState& state, const LiveSession&) {
    return state.phase == LivePhase::kOpening;
  };
  for (const bool is_there : {false, true}) {
    Saying saying({is_there ? kSmallTablet : "sim:?size=nonsense", session_, std::nullopt}, opens,
                  [&](LiveSession& session) {
                    EXPECT_EQ(session.state().package, "") << "of a run it is not known";
                    if (is_there) {
                      session.stop();
                    }
                  });
    saying.session().read();
    saying.wait_for_phase(LivePhase::kScanning);  // which does not come: it is at rest
    const LiveState before = saying.session().state();
    ASSERT_TRUE(before.signed_off);
    ASSERT_EQ(before.package, package_);
    saying.session().scan_now();
    const LiveState after = saying.at_rest();
    EXPECT_EQ(after.phase, LivePhase::kStill);
    EXPECT_EQ(after.error.has_value(), !is_there);
    EXPECT_TRUE(after.signed_off);
    EXPECT_EQ(after.signed_by, "A. Reader");
    if (!is_there) {  // the session has noted the scanner that was opened, and its package has not
      EXPECT_EQ(after.package, package_);
    }
    EXPECT_EQ(after.verdict_kept, before.verdict_kept);
    EXPECT_TRUE(after.checklist);
  }
}

/// Of a package that is looked through byte by byte.
TEST_F(LiveSigned, IsNotOccupiedByWorkThatNobodyWaitsFor) {
  const fs::path another = folder_.path() / "another";
  const auto looks = [](const LiveState& state, const LiveSession& session) {
    return state.phase == LivePhase::kStill && session.busy();
  };
  Saying saying({"", session_, std::nullopt}, looks, [&](LiveSession& session) {
    EXPECT_FALSE(session.is_occupied());
    session.halt();
    session.pack(another);
  });
  saying.session().read();
  const LiveState after = saying.at_rest();
  EXPECT_EQ(after.package, another) << "the emergency stop was of nothing, and before the word";
  EXPECT_FALSE(after.error);
}

}  // namespace
}  // namespace dubsar
