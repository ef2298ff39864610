// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Copies and parts of a scan in frames of their own, as other programs write them: they measure nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <vector>

#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"
#include "tests/support/other_forms.h"

namespace dubsar {
namespace {

using testing::bumpy;
using testing::FieldScan;
using ::testing::HasSubstr;
using testing::Height;
using ::testing::Not;
using testing::pose_of;
using testing::scan_field;

using Grid = std::shared_ptr<const RangeGrid>;

RangeGrid scanned(const Height& surface, const RigidTransform& pose, std::uint64_t seed) {
  FieldScan scan;
  scan.seed = seed;
  return scan_field(surface, pose, scan);
}

Grid shared(RangeGrid grid) {
  return std::make_shared<const RangeGrid>(std::move(grid));
}

/// Of one surface, from three places.
const std::vector<RangeGrid>& grids() {
  static const std::vector<RangeGrid> all = [] {
    const Height surface = bumpy(31);
    return std::vector{scanned(surface, pose_of(0, 0, 0, {0, 0, 0}), 40),
                       scanned(surface, pose_of(9, -5, 100, {2, -1, 0}), 41),
                       scanned(surface, pose_of(-7, 6, -50, {-2, 2, 0}), 42)};
  }();
  return all;
}

/// The frame of the k-th copy.
RigidTransform frame(int k) {
  return RigidTransform::from_twist({0.1 * k, -0.05 * k, 0.2 + 0.3 * k}, {3.0 + k, 2.0 - k, 5.0});
}

class MovedCopies : public ::testing::Test {
 protected:
  void add(int id, const RangeGrid& grid) { registrar.add(id, shared(grid), nullptr, job); }
  void add_moved(int id, const RangeGrid& grid, int k) { add(id, test::moved(grid, frame(k))); }
  void finalize() { ASSERT_TRUE(registrar.finalize(job)); }
  /// Three scans, and the second four times more, as 7 to 10 in other frames.
  void add_all() {
    add(0, grids()[0]);
    add(1, grids()[1]);
    for (int k = 0; k < 4; ++k) {
      add_moved(7 + k, grids()[1], k);
    }
    add(2, grids()[2]);
    finalize();
  }
  [[nodiscard]] ScanPose pose(int id) const {
    for (const ScanPose& pose : registrar.poses()) {
      if (pose.id == id) {
        return pose;
      }
    }
    ADD_FAILURE() << "there is no scan " << id;
    return {};
  }
  /// The id stands for a copy of scan `of` in the k-th frame, and all that is said is said of both.
  void expect_copy(int id, int of, int k) const {
    const ScanPose copy = pose(id);
    const ScanPose original = pose(of);
    EXPECT_EQ(copy.status, original.status) << id;
    EXPECT_EQ(copy.reason, original.reason) << id;
    EXPECT_EQ(copy.sigma_mm, original.sigma_mm) << id;
    EXPECT_EQ(copy.covariance, original.covariance) << id;
    for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, -20, 1)}) {
      EXPECT_LT((copy.model_from_scanner * (frame(k) * p) - original.model_from_scanner * p).norm(), 2e-4)
          << id;
    }
  }

  JobContext job;
  Registrar registrar;
};

/// The poses of the three scans alone.
const std::map<int, ScanPose>& alone() {
  static const std::map<int, ScanPose> poses = [] {
    JobContext job;
    Registrar registrar;
    for (int id = 0; id < 3; ++id) {
      registrar.add(id, shared(grids()[static_cast<std::size_t>(id)]), nullptr, job);
    }
    EXPECT_TRUE(registrar.finalize(job));
    std::map<int, ScanPose> out;
    for (const ScanPose& pose : registrar.poses()) {
      EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
      out[pose.id] = pose;
    }
    return out;
  }();
  return poses;
}

TEST_F(MovedCopies, ChangeNothing) {
  add_all();
  for (const auto& [id, without] : alone()) {
    EXPECT_EQ(pose(id).model_from_scanner.row_major(), without.model_from_scanner.row_major()) << id;
    EXPECT_EQ(pose(id).sigma_mm, without.sigma_mm) << id;
    EXPECT_EQ(pose(id).covariance, without.covariance) << id;
  }
  for (int k = 0; k < 4; ++k) {
    expect_copy(7 + k, 1, k);
  }
}

/// One measurement of something else, however often it comes, is not the model.
TEST_F(MovedCopies, HaveOneVoteTogether) {
  const RangeGrid other = scanned(bumpy(214), pose_of(5, 5, 30, {0, 0, 0}), 3);
  for (int k = 0; k < 5; ++k) {
    add_moved(k, other, k);
  }
  add(5, grids()[0]);
  add(6, grids()[1]);
  finalize();
  for (int id = 0; id < 5; ++id) {
    EXPECT_NE(pose(id).status, PoseStatus::kRegistered) << id;
  }
  EXPECT_EQ(pose(5).status, PoseStatus::kRegistered) << pose(5).reason;
  EXPECT_EQ(pose(6).status, PoseStatus::kRegistered) << pose(6).reason;
}

TEST_F(MovedCopies, TakeThePlaceOfTheOneThatIsTakenOut) {
  add(0, grids()[0]);
  add(1, grids()[1]);
  add_moved(7, grids()[1], 0);
  add_moved(8, grids()[1], 1);
  const ScanPose before = pose(7);
  ASSERT_TRUE(registrar.remove(1, job));
  EXPECT_EQ(pose(7).model_from_scanner.row_major(), before.model_from_scanner.row_major());
  // It is measured from where it stands, and so are those that came since.
  add(2, grids()[2]);
  add_moved(9, grids()[1], 2);
  finalize();
  add(1, grids()[1]);
  EXPECT_EQ(pose(2).status, PoseStatus::kRegistered) << pose(2).reason;
  expect_copy(7, 1, 0);
  expect_copy(8, 1, 1);
  expect_copy(9, 1, 2);
  const Eigen::Vector3d p(10, -10, 0);
  EXPECT_LT((pose(1).model_from_scanner * p - alone().at(1).model_from_scanner * p).norm(), 0.005);
}

/// The same under a half turn: only a word can tell.
TEST_F(MovedCopies, AWordIsSaidInTheFrameOfItsId) {
  const auto half = bumpy(15, 40);
  const Height surface = [half](double x, double y) { return half(x, y) + half(-x, -y); };
  const RigidTransform said = pose_of(5, 3, 20, {1, 1, 0});
  const RangeGrid first = scanned(surface, {}, 1);
  const RangeGrid second = scanned(surface, said, 9);
  add(0, first);
  add_moved(4, first, 1);
  add(1, second);
  add_moved(5, second, 2);
  EXPECT_EQ(pose(5).status, PoseStatus::kUnsure);
  const Eigen::Vector3d place(14, -9, surface(14, -9));
  const Eigen::Vector3d in_copy = frame(2) * (said.inverse() * place);
  ASSERT_TRUE(registrar.set_hint(5, {4, {{in_copy, frame(1) * place}}, std::nullopt}, job));
  finalize();
  EXPECT_EQ(pose(1).status, PoseStatus::kRegistered) << pose(1).reason;
  expect_copy(5, 1, 2);
  EXPECT_LT((pose(5).model_from_scanner * in_copy - said * (said.inverse() * place)).norm(), 0.02);
  // Where the id is locked, that is where the scan lies.
  const RigidTransform fixed = pose_of(0, 0, 0, {0.02, 0, 0}) * pose(5).model_from_scanner;
  ASSERT_TRUE(registrar.set_pose(5, fixed, true, job));
  EXPECT_TRUE(pose(5).locked);
  EXPECT_LT((pose(5).model_from_scanner * in_copy - fixed * in_copy).norm(), 1e-9);
  expect_copy(5, 1, 2);
  EXPECT_EQ(registrar.lock_near(5, fixed), LockOutcome::kLocked);
  EXPECT_EQ(registrar.lock_near(1, fixed), LockOutcome::kElsewhere);
}

TEST_F(MovedCopies, ALockKeepsPosesToTheLastDigit) {
  add_all();
  const std::vector<ScanPose> before = registrar.poses();
  for (int id = 7; id < 11; ++id) {
    const auto stored = pose(id).model_from_scanner.row_major();
    ASSERT_TRUE(registrar.set_pose(id, pose(id).model_from_scanner, true, job));
    EXPECT_TRUE(pose(id).locked);
    EXPECT_EQ(pose(id).model_from_scanner.row_major(), stored) << id;
  }
  for (const ScanPose& was : before) {
    if (was.id == 1 || was.id > 6) {  // the others are laid anew beside one that is fixed
      EXPECT_EQ(pose(was.id).model_from_scanner.row_major(), was.model_from_scanner.row_major()) << was.id;
    }
  }
  // The same session once more, as far as it is locked: whichever of the ids the others are copies of.
  enum class Original { kFree, kLocked, kTakenOut };
  for (const Original original : {Original::kFree, Original::kLocked, Original::kTakenOut}) {
    SCOPED_TRACE(static_cast<int>(original));
    const bool original_too = original == Original::kLocked;
    Registrar again;
    for (const ScanPose& was : before) {
      const bool is_copy = was.id > 6;
      if (was.id == 1 && original == Original::kTakenOut) {
        continue;
      }
      const RangeGrid grid =
          is_copy ? test::moved(grids()[1], frame(was.id - 7)) : grids()[static_cast<std::size_t>(was.id)];
      if (is_copy || original_too) {
        again.add_at(was.id, shared(grid), nullptr, was.model_from_scanner, true, job);
      } else {
        again.add(was.id, shared(grid), nullptr, job);
      }
    }
    ASSERT_TRUE(again.finalize(job));
    for (const ScanPose& now : again.poses()) {
      const auto was = std::ranges::find(before, now.id, &ScanPose::id);
      if (now.id > 6 || original_too) {
        EXPECT_TRUE(now.locked) << now.id;
        EXPECT_EQ(now.model_from_scanner.row_major(), was->model_from_scanner.row_major()) << now.id;
      }
    }
  }
}

/// A part of a scan may find its place where the whole finds none, but beside it says nothing more.
TEST_F(MovedCopies, PartsLieWhereTheWholeDoesAndDoNotCount) {
  add(0, grids()[0]);
  add_moved(6, test::cropped(grids()[1], 0.05, 0.8), 1);
  ASSERT_EQ(pose(6).status, PoseStatus::kRegistered) << pose(6).reason;
  add(1, grids()[1]);
  add_moved(7, test::cropped(grids()[1], 0.2, 0.95), 2);
  add_moved(8, test::cropped(grids()[1], 0.1, 0.85), 3);
  add(2, grids()[2]);
  finalize();
  for (const auto& [id, without] : alone()) {
    EXPECT_EQ(pose(id).status, PoseStatus::kRegistered) << id << pose(id).reason;
    EXPECT_NEAR(pose(id).sigma_mm, without.sigma_mm, 0.01 * without.sigma_mm) << id;
  }
  for (const auto& [id, k] : {std::pair{6, 1}, {7, 2}, {8, 3}}) {
    EXPECT_EQ(pose(id).status, PoseStatus::kRegistered) << id << pose(id).reason;
    EXPECT_GT(pose(id).sigma_mm, 0.8 * pose(1).sigma_mm) << id;
    const Eigen::Vector3d p(10, -10, 0);
    EXPECT_LT((pose(id).model_from_scanner * (frame(k) * p) - pose(1).model_from_scanner * p).norm(), 1e-3);
  }
}

TEST_F(MovedCopies, PartsHaveNoVote) {
  const RangeGrid other = scanned(bumpy(214), pose_of(5, 5, 30, {0, 0, 0}), 3);
  add(0, other);
  add_moved(1, test::cropped(other, 0.05, 0.8), 1);
  add_moved(2, test::cropped(other, 0.2, 0.95), 2);
  add(5, grids()[0]);
  add(6, grids()[1]);
  finalize();
  EXPECT_NE(pose(0).status, PoseStatus::kRegistered);
  for (const int id : {0, 1, 2}) {  // which fit nothing but themselves
    EXPECT_EQ(pose(id).group_apart, -1) << id;
    EXPECT_THAT(pose(id).reason, Not(HasSubstr("it fits other scans"))) << id;
    EXPECT_THAT(pose(id).reason, Not(HasSubstr("it was not tried"))) << id;
  }
  EXPECT_EQ(pose(5).status, PoseStatus::kRegistered) << pose(5).reason;
  EXPECT_EQ(pose(6).status, PoseStatus::kRegistered) << pose(6).reason;
}

}  // namespace
}  // namespace dubsar
