// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Locks that were made in different frames of the model: while a locked scan is taken out, another frame
// comes.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "acquisition/operator_log.h"
#include "acquisition/session_store.h"
#include "formats/poses_json.h"
#include "tests/station/support/bumpy_scans.h"
#include "tests/station/support/command.h"
#include "tests/support/temporary_folder.h"

namespace dubsar {
namespace {

namespace fs = std::filesystem;
using test::run_command;
using ::testing::HasSubstr;

/// Five scans, registered once; each test has a copy of the session.
class LocksOfTwoFrames : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    made_ = new test::TemporaryFolder;
    test::write_bumpy_scans(made_->path() / "scans", 5);
    scan((made_->path() / "session").string());
  }
  static void TearDownTestSuite() { delete made_; }
  void SetUp() override {
    session_ = (folder_.path() / "session").string();
    fs::copy(made_->path() / "session", session_, fs::copy_options::recursive);
    ASSERT_EQ(stored().size(), 5U);
  }
  /// The engine goes on with what is there.
  static void scan(const std::string& session) {
    run_command({"scan", "--device", "replay:" + (made_->path() / "scans").string(), "--session", session});
  }
  void say(const char* word, int id) const {
    ASSERT_EQ(run_command({"session", word, session_, std::to_string(id)}).status, 0) << word << id;
  }
  [[nodiscard]] std::vector<ScanPose> registered() const {
    run_command({"register", session_});
    return stored();
  }
  [[nodiscard]] std::vector<ScanPose> stored() const {
    return SessionStore::open(session_, SessionStore::Access::kReadOnly).value().poses().value();
  }
  /// Locks a scan as earlier versions did.
  void lock_as_before(int id) const {
    const std::vector<ScanPose> poses = stored();
    SessionStore store = SessionStore::open(session_).value();
    const auto pose = std::ranges::find(poses, id, &ScanPose::id);
    ASSERT_NE(pose, poses.end());
    ASSERT_TRUE(store.append_event(
        "scan locked",
        nlohmann::json{{"id", id}, {"model_from_scanner", pose->model_from_scanner.row_major()}}.dump()));
  }
  /// Locks scan 0, then scan 3 in the frame that scan 1 gives the model without it.
  template <class Lock>
  void lock_in_two_frames(const Lock& lock) const {
    lock(0);
    say("drop", 0);
    ASSERT_EQ(registered().size(), 4U);
    ASSERT_GT(stored()[2].model_from_scanner.translation_mm.norm(), 0.5);
    lock(3);
    say("restore", 0);
  }
  /// How far a scan lies from where it was taken, seen from scan 1, at a corner of the field.
  [[nodiscard]] static double off_mm(const std::vector<ScanPose>& poses, int id) {
    const auto seen = [&](int k) { return poses.at(static_cast<std::size_t>(k)).model_from_scanner; };
    const RigidTransform found = seen(1).inverse() * seen(id);
    const RigidTransform truth = test::bumpy_pose(1).inverse() * test::bumpy_pose(id);
    const Eigen::Vector3d corner(14, 14, 0);
    return (found * corner - truth * corner).norm();
  }
  static void all_lie_right(const std::vector<ScanPose>& poses) {
    ASSERT_EQ(poses.size(), 5U);
    for (const ScanPose& pose : poses) {
      EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
      EXPECT_LT(off_mm(poses, pose.id), 0.1) << pose.id;
      EXPECT_EQ(pose.locked, pose.id == 0 || pose.id == 3) << pose.id;
    }
  }

  static test::TemporaryFolder* made_;
  test::TemporaryFolder folder_;
  std::string session_;
};
test::TemporaryFolder* LocksOfTwoFrames::made_ = nullptr;

TEST_F(LocksOfTwoFrames, AreBothHeldBesideTheScansThatTheyWereMadeBeside) {
  lock_in_two_frames([&](int id) { say("lock", id); });
  const RigidTransform of_3 = stored()[2].model_from_scanner;
  all_lie_right(registered());
  // The model keeps the frame of the lock that stood.
  EXPECT_EQ(stored()[3].model_from_scanner.row_major(), of_3.row_major());
  scan(session_);
  all_lie_right(stored());
  EXPECT_EQ(stored()[3].model_from_scanner.row_major(), of_3.row_major());
  // Taken out and put back with nothing else registered meanwhile, too.
  say("drop", 3);
  say("restore", 3);
  all_lie_right(registered());
  // A run for some scans leaves the others where they are.
  const RigidTransform of_0 = stored()[0].model_from_scanner;
  run_command({"register", session_, "--only", "2"});
  all_lie_right(stored());
  EXPECT_EQ(stored()[0].model_from_scanner.row_major(), of_0.row_major());
}

TEST_F(LocksOfTwoFrames, OfAnEarlierVersionAreNamedAndNotRegistered) {
  lock_in_two_frames([&](int id) { lock_as_before(id); });
  const auto contradiction_is_named = [&] {
    for (const ScanPose& pose : stored()) {
      EXPECT_EQ(pose.status, pose.id == 0 ? PoseStatus::kUnsure : PoseStatus::kRegistered) << pose.id;
      EXPECT_LT(off_mm(stored(), pose.id), 0.1) << pose.id;
    }
    EXPECT_THAT(stored()[0].reason, HasSubstr("its lock and that of scan 3 contradict each other"));
  };
  EXPECT_EQ(run_command({"register", session_}).status, 1);
  contradiction_is_named();
  scan(session_);
  contradiction_is_named();
  say("unlock", 0);
  EXPECT_EQ(run_command({"register", session_}).status, 0);
}

TEST_F(LocksOfTwoFrames, OfOneFrameAreHeldToTheLastDigitAsBefore) {
  lock_as_before(1);
  lock_as_before(3);
  say("lock", 4);
  const std::vector<ScanPose> before = stored();
  const auto log = read_operator_log(SessionStore::open(session_, SessionStore::Access::kReadOnly).value());
  ASSERT_TRUE(log.has_value());
  EXPECT_EQ(log->word.locked.at(1).frame, log->word.locked.at(3).frame);
  EXPECT_EQ(log->word.locked.at(1).frame, log->word.locked.at(4).frame);
  const std::vector<ScanPose> after = registered();
  for (const std::size_t id : {1, 3, 4}) {
    EXPECT_TRUE(after.at(id).locked);
    EXPECT_EQ(after[id].model_from_scanner.row_major(), before.at(id).model_from_scanner.row_major());
  }
}

TEST_F(LocksOfTwoFrames, AScanThatWasMovedSinceIsOutvotedByTheOthers) {
  say("lock", 0);
  {
    const std::vector<ScanPose> poses = stored();
    SessionStore store = SessionStore::open(session_).value();
    ScanLock lock = read_operator_log(store)->word.locked.at(0);
    ASSERT_EQ(lock.beside_from_scanner.size(), 4U);
    lock.beside_from_scanner.at(1).translation_mm.x() += 8;
    lock.frame = 0;
    ASSERT_TRUE(record_lock(store, 0, lock));
  }
  say("drop", 0);
  say("lock", 2);
  say("restore", 0);
  const std::vector<ScanPose> after = registered();
  for (const ScanPose& pose : after) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
    EXPECT_LT(off_mm(after, pose.id), 0.1) << pose.id;
  }
  EXPECT_TRUE(after.at(0).locked);
}

}  // namespace
}  // namespace dubsar
