// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// A scan that came twice is one measurement.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"
#include "tests/support/other_forms.h"

namespace dubsar {
namespace {

using testing::bumpy;
using testing::FieldScan;
using ::testing::HasSubstr;
using testing::Height;
using testing::pose_of;
using testing::scan_field;

using Grid = std::shared_ptr<const RangeGrid>;

Grid scanned(const Height& surface, const RigidTransform& pose, std::uint64_t seed) {
  FieldScan scan;
  scan.seed = seed;
  return std::make_shared<const RangeGrid>(scan_field(surface, pose, scan));
}

const std::vector<RigidTransform>& truth() {
  static const std::vector<RigidTransform> poses{
      pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}), pose_of(-7, 6, -50, {-2, 2, 0}),
      pose_of(4, 7, 30, {1, 1, 0}), pose_of(-3, -6, 200, {0, -2, 0})};
  return poses;
}

/// One of each place.
const std::vector<Grid>& grids() {
  static const std::vector<Grid> all = [] {
    const Height surface = bumpy(31);
    std::vector<Grid> out;
    for (std::size_t k = 0; k < truth().size(); ++k) {
      out.push_back(scanned(surface, truth()[k], 40 + k));
    }
    return out;
  }();
  return all;
}

struct Arrival {
  int id;
  std::size_t grid;
};

class CopiedScans : public ::testing::Test {
 protected:
  void add(std::initializer_list<Arrival> arrivals) {
    for (const Arrival& a : arrivals) {
      registrar.add(a.id, grids()[a.grid], nullptr, job);
    }
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

  JobContext job;
  Registrar registrar;
};

/// The poses of these scans, by id.
std::map<int, ScanPose> registered(std::initializer_list<Arrival> arrivals) {
  JobContext job;
  Registrar registrar;
  for (const Arrival& a : arrivals) {
    registrar.add(a.id, grids()[a.grid], nullptr, job);
  }
  EXPECT_TRUE(registrar.finalize(job));
  std::map<int, ScanPose> out;
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
    out[pose.id] = pose;
  }
  EXPECT_EQ(out.size(), arrivals.size());
  return out;
}

/// Of one measurement, to the last digit.
void expect_one(const ScanPose& a, const ScanPose& b) {
  EXPECT_EQ(a.model_from_scanner.row_major(), b.model_from_scanner.row_major()) << a.id << b.id;
  EXPECT_EQ(a.status, b.status) << a.id << b.id;
  EXPECT_EQ(a.reason, b.reason);
  EXPECT_EQ(a.sigma_mm, b.sigma_mm) << a.id << b.id;
  EXPECT_EQ(a.rms_mm, b.rms_mm);
  EXPECT_EQ(a.overlap, b.overlap);
  EXPECT_EQ(a.covariance, b.covariance);
}

/// The same but for where its pairs were measured from.
void expect_near(const ScanPose& a, const ScanPose& b) {
  EXPECT_EQ(a.status, b.status) << a.id << a.reason;
  for (const Eigen::Vector3d& p : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(20, 0, 0)}) {
    EXPECT_LT((a.model_from_scanner * p - b.model_from_scanner * p).norm(), 0.1 * b.sigma_mm + 1e-9) << a.id;
  }
  EXPECT_NEAR(a.sigma_mm, b.sigma_mm, 0.02 * b.sigma_mm) << a.id;
}

TEST_F(CopiedScans, ChangeNothingWhateverOrderTheyComeIn) {
  const std::map<int, ScanPose> once = registered({{0, 0}, {1, 1}, {2, 2}, {3, 3}});
  const std::initializer_list<Arrival> orders[] = {
      {{0, 0}, {1, 1}, {7, 1}, {2, 2}, {3, 3}},                  // at once
      {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {7, 1}},                  // last
      {{0, 0}, {1, 1}, {9, 1}, {2, 2}, {3, 3}, {8, 1}},          // three times
      {{0, 0}, {5, 0}, {1, 1}, {2, 2}, {8, 2}, {3, 3}, {9, 0}},  // of two, one of them the model's frame
  };
  for (const auto& order : orders) {
    const std::map<int, ScanPose> poses = registered(order);
    for (const Arrival& a : order) {
      expect_one(poses.at(a.id), once.at(static_cast<int>(a.grid)));
    }
  }
}

TEST_F(CopiedScans, TheOneWithTheHighestNumberMayComeFirst) {
  const std::map<int, ScanPose> poses = registered({{0, 0}, {7, 1}, {2, 2}, {3, 3}, {1, 1}});
  expect_one(poses.at(1), poses.at(7));
  for (const auto& [id, once] : registered({{0, 0}, {7, 1}, {2, 2}, {3, 3}})) {
    expect_one(poses.at(id), once);
  }
  for (const auto& [id, once] : registered({{0, 0}, {1, 1}, {2, 2}, {3, 3}})) {
    expect_near(poses.at(id), once);
  }
}

/// In the frame of the other: its pose holds of it.
TEST_F(CopiedScans, MayBeWrittenOtherwise) {
  add({{0, 0}, {1, 1}});
  const ScanPose before = pose(1);
  registrar.add(7, std::make_shared<const RangeGrid>(test::rounded(test::transposed(*grids()[1]), 0.001)),
                nullptr, job);
  expect_one(pose(1), before);
  expect_one(pose(7), pose(1));
}

TEST_F(CopiedScans, OtherNoiseMakesAnotherScan) {
  add({{0, 0}, {1, 1}});
  registrar.add(7, scanned(bumpy(31), truth()[1], 77), nullptr, job);
  EXPECT_NE(pose(7).model_from_scanner.row_major(), pose(1).model_from_scanner.row_major());
}

TEST_F(CopiedScans, AreNoGroupOfTheirOwn) {
  const Grid of_another = scanned(bumpy(214), pose_of(5, 5, 30, {0, 0, 0}), 3);
  add({{0, 0}});
  registrar.add(1, of_another, nullptr, job);
  registrar.add(2, of_another, nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  EXPECT_EQ(pose(0).status, PoseStatus::kRegistered);
  EXPECT_NE(pose(1).status, PoseStatus::kRegistered);
  expect_one(pose(1), pose(2));
  EXPECT_FALSE(pose(2).reason.empty());
}

TEST_F(CopiedScans, TakeThePlaceOfTheOneThatIsTakenOut) {
  RangeGrid named = *grids()[1];
  named.source = "again.ply";
  add({{0, 0}, {1, 1}, {2, 2}, {3, 3}});
  registrar.add(7, std::make_shared<const RangeGrid>(named), nullptr, job);
  registrar.add(8, grids()[1], nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  const std::vector<ScanPose> before = registrar.poses();
  ASSERT_TRUE(registrar.remove(1, job));
  EXPECT_FALSE(registrar.remove(1, job));
  ASSERT_EQ(registrar.poses().size(), 5U);
  for (const ScanPose& was : before) {
    if (was.id != 1) {
      expect_one(pose(was.id), was);
    }
  }
  EXPECT_EQ(pose(7).file, "again.ply");
  // It is measured against the others as that one was, whichever of two has the lower number.
  ASSERT_TRUE(registrar.finalize(job));
  for (const ScanPose& was : before) {
    if (was.id != 1) {
      expect_near(pose(was.id), was);
    }
  }
  // What it said of the others holds with the next one, too.
  add({{9, 4}});
  ASSERT_TRUE(registrar.finalize(job));
  for (const auto& [id, alone] : registered({{0, 0}, {7, 1}, {2, 2}, {3, 3}, {9, 4}})) {
    expect_near(pose(id), alone);
  }
  ASSERT_TRUE(registrar.remove(9, job));
  // Put back, it is the copy; and without any of them the others are as without it.
  add({{1, 1}});
  expect_one(pose(1), pose(7));
  ASSERT_TRUE(registrar.remove(7, job));
  ASSERT_TRUE(registrar.remove(8, job));
  expect_near(pose(1), before[1]);
  ASSERT_TRUE(registrar.remove(1, job));
  ASSERT_TRUE(registrar.finalize(job));
  EXPECT_EQ(registrar.poses().size(), 3U);
  for (const auto& [id, without] : registered({{0, 0}, {2, 2}, {3, 3}})) {
    expect_near(pose(id), without);
  }
}

TEST_F(CopiedScans, AnotherScanUnderTheNumberOfOneLeavesTheOther) {
  add({{0, 0}, {1, 1}, {7, 1}});
  const ScanPose was = pose(7);
  add({{1, 2}});
  EXPECT_EQ(pose(1).status, PoseStatus::kRegistered) << pose(1).reason;
  EXPECT_NE(pose(1).model_from_scanner.row_major(), was.model_from_scanner.row_major());
  expect_near(pose(7), was);
}

TEST_F(CopiedScans, ALockHoldsAllOfThemAndEachHasItsOwn) {
  add({{0, 0}, {1, 1}, {7, 1}, {2, 2}});
  const RigidTransform fixed = pose_of(0, 0, 0, {0.02, 0, 0}) * pose(1).model_from_scanner;
  ASSERT_TRUE(registrar.set_pose(7, fixed, true, job));
  ASSERT_TRUE(registrar.finalize(job));
  for (const int id : {1, 7}) {
    EXPECT_EQ(pose(id).model_from_scanner.row_major(), fixed.row_major()) << id;
    EXPECT_EQ(pose(id).locked, id == 7);
  }
  const RigidTransform elsewhere = pose_of(0, 0, 20, {5, 0, 0}) * fixed;
  EXPECT_EQ(registrar.lock_near(1, elsewhere), LockOutcome::kElsewhere);
  EXPECT_FALSE(registrar.set_pose(1, elsewhere, true, job));
  EXPECT_FALSE(registrar.add_at(1, grids()[1], nullptr, elsewhere, true, job).locked);
  EXPECT_TRUE(pose(7).locked);
  EXPECT_TRUE(registrar.add_at(1, grids()[1], nullptr, fixed, true, job).locked);
  ASSERT_TRUE(registrar.set_locked(7, false));
  EXPECT_FALSE(pose(7).locked);
  EXPECT_FALSE(registrar.set_pose(7, elsewhere, true, job)) << "it is still locked as scan 1";
  ASSERT_TRUE(registrar.remove(1, job));
  EXPECT_EQ(pose(7).model_from_scanner.row_major(), fixed.row_major());
  EXPECT_TRUE(registrar.set_pose(7, elsewhere, true, job)) << "now nothing holds it";
  EXPECT_EQ(pose(7).model_from_scanner.row_major(), elsewhere.row_major());
}

/// The same under a half turn: only a word can tell.
Height two_fold() {
  const auto half = bumpy(15, 40);
  return [half](double x, double y) { return half(x, y) + half(-x, -y); };
}

TEST_F(CopiedScans, AWordOfOneIsSaidOfAll) {
  const Height surface = two_fold();
  const RigidTransform said = pose_of(5, 3, 20, {1, 1, 0});
  const Grid first = scanned(surface, {}, 1);
  const Grid second = scanned(surface, said, 9);
  registrar.add(0, first, nullptr, job);
  registrar.add(4, first, nullptr, job);
  registrar.add(1, second, nullptr, job);
  registrar.add(5, second, nullptr, job);
  EXPECT_EQ(pose(1).status, PoseStatus::kUnsure);
  PoseHint hint;
  hint.on = 1;
  hint.on_from_scanner = RigidTransform{};
  const Status of_itself = registrar.set_hint(5, hint, job);
  ASSERT_FALSE(of_itself);
  EXPECT_THAT(of_itself.error().line(), HasSubstr("needs another scan"));
  const Eigen::Vector3d place(14, -9, surface(14, -9));
  const PoseHint click{4, {{said.inverse() * place, place}}, std::nullopt};
  ASSERT_TRUE(registrar.set_hint(5, click, job));
  ASSERT_TRUE(registrar.finalize(job));
  EXPECT_EQ(pose(1).status, PoseStatus::kRegistered) << pose(1).reason;
  expect_one(pose(1), pose(5));
  EXPECT_LT((pose(1).model_from_scanner * place - said * place).norm(), 0.02);
  ASSERT_TRUE(registrar.set_locked(1, true));
  const Status refused = registrar.set_hint(5, click, job);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr("scan 1 is locked"));
}

TEST_F(CopiedScans, APoseToStartFromPlacesTheOneThatStandsNowhere) {
  const Height surface = two_fold();
  const RigidTransform said = pose_of(5, 3, 20, {1, 1, 0});
  const Grid second = scanned(surface, said, 9);
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  EXPECT_EQ(registrar.add(1, second, nullptr, job).status, PoseStatus::kUnsure);
  EXPECT_EQ(registrar.add(5, second, nullptr, job).status, PoseStatus::kUnsure);
  EXPECT_EQ(registrar.add_at(6, second, nullptr, said, false, job).status, PoseStatus::kRegistered)
      << pose(6).reason;
  expect_one(pose(1), pose(6));
  expect_one(pose(5), pose(6));
  // Once it stands, another start says nothing.
  registrar.add_at(7, second, nullptr, pose_of(0, 0, 180, {0, 0, 0}) * said, false, job);
  expect_one(pose(7), pose(6));
  EXPECT_LT((pose(7).model_from_scanner.translation_mm - said.translation_mm).norm(), 0.02);
}

}  // namespace
}  // namespace dubsar
