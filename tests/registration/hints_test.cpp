// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the operator says of where scans lie: points, rough poses, locks, poses to start from.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random.h"
#include "registration/point_pairs.h"
#include "registration/registrar.h"
#include "tests/registration/support/height_field.h"

namespace dubsar {
namespace {

using testing::bumpy;
using testing::FieldScan;
using ::testing::HasSubstr;
using testing::Height;
using testing::pose_of;
using testing::scan_field;

std::shared_ptr<const RangeGrid> scanned(const Height& surface, const RigidTransform& pose,
                                         std::uint64_t seed) {
  FieldScan scan;
  scan.seed = seed;
  return std::make_shared<const RangeGrid>(scan_field(surface, pose, scan));
}

/// The places x, y of the surface as they are clicked in two scans, each click off by `sigma_mm` per axis.
PoseHint clicked(int on, const Height& surface, const RigidTransform& model_from_scanner,
                 const RigidTransform& model_from_on, const std::vector<Eigen::Vector2d>& places,
                 double sigma_mm = 0.4) {
  PoseHint hint;
  hint.on = on;
  Random random(5);
  const auto off = [&] {
    return Eigen::Vector3d{sigma_mm * random.normal(), sigma_mm * random.normal(),
                           sigma_mm * random.normal()};
  };
  for (const Eigen::Vector2d& place : places) {
    const Eigen::Vector3d p(place.x(), place.y(), surface(place.x(), place.y()));
    hint.points.push_back({model_from_scanner.inverse() * p + off(), model_from_on.inverse() * p + off()});
  }
  return hint;
}

double error_mm(const ScanPose& pose, const RigidTransform& truth) {
  double worst = 0;
  for (const Eigen::Vector3d& p :
       {Eigen::Vector3d(20, 0, 0), Eigen::Vector3d(0, 20, 0), Eigen::Vector3d(-20, -20, 0)}) {
    worst = std::max(worst, (pose.model_from_scanner * p - truth * p).norm());
  }
  return worst;
}

ScanPose pose_in(const Registrar& registrar, int id) {
  for (const ScanPose& pose : registrar.poses()) {
    if (pose.id == id) {
      return pose;
    }
  }
  return {};
}

/// The same under a half turn: only a click can tell.
Height two_fold() {
  const auto half = bumpy(15, 40);
  return [half](double x, double y) { return half(x, y) + half(-x, -y); };
}

TEST(Hints, OnePointTellsTwoPosesApart) {
  const auto surface = two_fold();
  const RigidTransform truth = pose_of(5, 3, 20, {1, 1, 0});
  const RigidTransform turned = pose_of(0, 0, 180, {0, 0, 0}) * truth;
  for (const RigidTransform& said : {truth, turned}) {
    Registrar registrar;
    JobContext job;
    registrar.add(0, scanned(surface, {}, 1), nullptr, job);
    ASSERT_EQ(registrar.add(1, scanned(surface, truth, 9), nullptr, job).status, PoseStatus::kUnsure);
    ASSERT_TRUE(registrar.set_hint(1, clicked(0, surface, said, {}, {{14, -9}}), job));
    ASSERT_TRUE(registrar.finalize(job));
    const ScanPose pose = pose_in(registrar, 1);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    EXPECT_LT(error_mm(pose, said), 0.02);
  }
}

TEST(Hints, OnePointInTheMiddleTellsNothing) {
  const auto surface = two_fold();
  const RigidTransform truth = pose_of(5, 3, 20, {1, 1, 0});
  Registrar registrar;
  JobContext job;
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  ASSERT_TRUE(registrar.set_hint(1, clicked(0, surface, truth, {}, {{0.2, 0.1}}), job));
  const ScanPose pose = registrar.add(1, scanned(surface, truth, 9), nullptr, job);
  EXPECT_EQ(pose.status, PoseStatus::kUnsure);
  EXPECT_THAT(pose.reason, HasSubstr("two poses fit"));
}

TEST(Hints, AnyNumberOfPointsPlacesAScan) {
  const auto surface = bumpy(21);
  const RigidTransform truth = pose_of(12, -8, 130, {4, -3, 2});
  const std::vector<Eigen::Vector2d> places{{-15, -12}, {16, -8}, {2, 17}, {-10, 9}};
  for (std::size_t count = 1; count <= places.size(); ++count) {
    Registrar registrar;
    JobContext job;
    registrar.add(0, scanned(surface, {}, 1), nullptr, job);
    const PoseHint hint =
        clicked(0, surface, truth, {}, {places.begin(), places.begin() + static_cast<std::ptrdiff_t>(count)});
    ASSERT_TRUE(registrar.set_hint(1, hint, job));
    const ScanPose pose = registrar.add(1, scanned(surface, truth, 9), nullptr, job);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << count << pose.reason;
    EXPECT_LT(error_mm(pose, truth), 0.02) << count;
  }
}

TEST(Hints, ARoughPosePlacesAScan) {
  const auto surface = bumpy(22);
  const RigidTransform truth = pose_of(-10, 6, -70, {3, 2, 1});
  Registrar registrar;
  JobContext job;
  PoseHint hint;
  hint.on = 0;
  hint.on_from_scanner = pose_of(3, -4, 6, {2, -3, 1}) * truth;
  ASSERT_TRUE(registrar.set_hint(1, hint, job));
  registrar.add(1, scanned(surface, truth, 9), nullptr, job);
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  const ScanPose pose = pose_in(registrar, 1);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  EXPECT_EQ(pose_in(registrar, 0).status, PoseStatus::kRegistered);
  EXPECT_LT(error_mm(pose, truth), 0.02);
}

TEST(Hints, AWrongWordIsNeverBelieved) {
  const auto surface = bumpy(23);
  const RigidTransform truth = pose_of(8, 4, 40, {1, -2, 0});
  const RigidTransform wrong = pose_of(0, 0, 95, {3, 0, 0}) * truth;
  Registrar registrar;
  JobContext job;
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  ASSERT_EQ(registrar.add(1, scanned(surface, truth, 9), nullptr, job).status, PoseStatus::kRegistered);
  // The operator contradicts a registered pose: it goes, and nothing that does not verify takes its place.
  ASSERT_TRUE(registrar.set_hint(1, clicked(0, surface, wrong, {}, {{-15, -12}, {16, -8}, {2, 17}}), job));
  for (int round = 0; round < 2; ++round) {
    const ScanPose pose = pose_in(registrar, 1);
    EXPECT_NE(pose.status, PoseStatus::kRegistered);
    EXPECT_THAT(pose.reason, HasSubstr("the hint leads to no certain pose"));
    ASSERT_TRUE(registrar.finalize(job));
  }
  registrar.clear_hint(1, job);
  EXPECT_EQ(pose_in(registrar, 1).status, PoseStatus::kRegistered) << pose_in(registrar, 1).reason;
  EXPECT_EQ(registrar.add(1, scanned(surface, truth, 9), nullptr, job).status, PoseStatus::kRegistered);
}

/// The operator clicked on the wrong places for scan 1: that one is in doubt, nothing else.
TEST(Hints, AWrongWordLeavesOutNeitherTheScanThatItIsGivenOnNorTheOthers) {
  const auto surface = bumpy(27);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}),
                                          pose_of(-7, 6, -50, {-2, 2, 0}), pose_of(4, 7, 30, {1, 1, 0})};
  const PoseHint wrong =
      clicked(0, surface, pose_of(0, 0, 95, {3, 0, 0}) * truth[1], truth[0], {{-15, -12}, {16, -8}, {2, 17}});
  for (const std::vector<int>& order :
       {std::vector{1, 2, 3, 0}, std::vector{1, 2, 0, 3}, std::vector{0, 1, 2, 3}, std::vector{1, 0, 2, 3}}) {
    Registrar registrar;
    JobContext job;
    ASSERT_TRUE(registrar.set_hint(1, wrong, job));
    for (const int id : order) {
      registrar.add(id,
                    scanned(surface, truth[static_cast<std::size_t>(id)], 30U + static_cast<unsigned>(id)),
                    nullptr, job);
    }
    ASSERT_TRUE(registrar.finalize(job));
    const RigidTransform model_from_truth = pose_in(registrar, 0).model_from_scanner * truth[0].inverse();
    for (const int id : {0, 2, 3}) {
      const ScanPose pose = pose_in(registrar, id);
      EXPECT_EQ(pose.status, PoseStatus::kRegistered) << id << pose.reason;
      EXPECT_LT(error_mm(pose, model_from_truth * truth[static_cast<std::size_t>(id)]), 0.02) << id;
    }
    EXPECT_NE(pose_in(registrar, 1).status, PoseStatus::kRegistered);
    EXPECT_THAT(pose_in(registrar, 1).reason, HasSubstr("the hint leads to no certain pose"));
  }
}

/// It says nothing while the scan is out that it is given on, and stands again when that one is put back.
TEST(Hints, AWrongWordKeepsNothingOutWhenTheScanThatItIsGivenOnIsTakenOut) {
  const auto surface = bumpy(27);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}),
                                          pose_of(-7, 6, -50, {-2, 2, 0})};
  const auto grid = [&](int id) {
    return scanned(surface, truth[static_cast<std::size_t>(id)], 30U + static_cast<unsigned>(id));
  };
  Registrar registrar;
  JobContext job;
  ASSERT_TRUE(registrar.set_hint(
      2,
      clicked(0, surface, pose_of(0, 0, 95, {3, 0, 0}) * truth[2], truth[0], {{-15, -12}, {16, -8}, {2, 17}}),
      job));
  for (const int id : {0, 1, 2}) {
    registrar.add(id, grid(id), nullptr, job);
  }
  ASSERT_NE(pose_in(registrar, 2).status, PoseStatus::kRegistered);
  ASSERT_TRUE(registrar.remove(0, job));
  const RigidTransform model_from_truth = pose_in(registrar, 1).model_from_scanner * truth[1].inverse();
  const ScanPose without = pose_in(registrar, 2);
  EXPECT_EQ(without.status, PoseStatus::kRegistered) << without.reason;
  EXPECT_LT(error_mm(without, model_from_truth * truth[2]), 0.02);
  EXPECT_EQ(registrar.add(0, grid(0), nullptr, job).status, PoseStatus::kRegistered);
  EXPECT_THAT(pose_in(registrar, 2).reason, HasSubstr("the hint leads to no certain pose"));
}

TEST(Hints, AWrongWordKeepsNothingOutWhenItIsGivenOnAnotherScan) {
  const auto surface = bumpy(23);
  const RigidTransform truth = pose_of(8, 4, 40, {1, -2, 0});
  const RigidTransform wrong = pose_of(0, 0, 95, {3, 0, 0}) * truth;
  const std::vector<Eigen::Vector2d> places{{-15, -12}, {16, -8}, {2, 17}};
  Registrar registrar;
  JobContext job;
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  ASSERT_TRUE(registrar.set_hint(1, clicked(0, surface, wrong, {}, places), job));
  ASSERT_NE(registrar.add(1, scanned(surface, truth, 9), nullptr, job).status, PoseStatus::kRegistered);
  ASSERT_TRUE(registrar.set_hint(1, clicked(2, surface, truth, {}, places), job));  // which is yet to come
  EXPECT_EQ(pose_in(registrar, 1).status, PoseStatus::kRegistered) << pose_in(registrar, 1).reason;
  EXPECT_LT(error_mm(pose_in(registrar, 1), truth), 0.02);
}

/// Nothing but the hinted scan overlaps the one that the hint is given on: what is registered stays.
TEST(Hints, AWrongWordTakesNothingApartForNothing) {
  const auto surface = bumpy(28, 160);
  const auto part = [&](double low_mm, double high_mm, std::uint64_t seed) {
    FieldScan scan;
    scan.seed = seed;
    scan.low_x_mm = low_mm;
    scan.high_x_mm = high_mm;
    return std::make_shared<const RangeGrid>(scan_field(surface, {}, scan));
  };
  Registrar registrar;
  JobContext job;
  const PoseHint wrong = clicked(0, surface, pose_of(0, 0, 95, {3, 0, 0}), {}, {{-6, -12}, {3, -8}, {0, 17}});
  registrar.add(1, part(-10, 30, 2), nullptr, job);
  registrar.add(2, part(8, 30, 3), nullptr, job);
  ASSERT_TRUE(registrar.set_hint(1, wrong, job));
  registrar.add(0, part(-30, 4, 1), nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  for (const int id : {1, 2}) {
    EXPECT_EQ(pose_in(registrar, id).status, PoseStatus::kRegistered) << pose_in(registrar, id).reason;
  }
  EXPECT_THAT(pose_in(registrar, 0).reason, HasSubstr("the hint leads to no certain pose"));
}

TEST(Hints, StandWhenTheScanIsTakenOutAndPutBack) {
  const auto surface = two_fold();
  const RigidTransform truth = pose_of(5, 3, 20, {1, 1, 0});
  Registrar registrar;
  JobContext job;
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  ASSERT_TRUE(registrar.set_hint(1, clicked(0, surface, truth, {}, {{14, -9}}), job));
  const auto grid = scanned(surface, truth, 9);
  const ScanPose before = registrar.add(1, grid, nullptr, job);
  ASSERT_EQ(before.status, PoseStatus::kRegistered) << before.reason;
  ASSERT_TRUE(registrar.remove(1, job));
  const ScanPose after = registrar.add(1, grid, nullptr, job);
  EXPECT_EQ(after.status, PoseStatus::kRegistered);
  EXPECT_EQ(after.model_from_scanner.row_major(), before.model_from_scanner.row_major());
}

TEST(Hints, OneBringsAWholeGroup) {
  const auto surface = bumpy(26);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}),
                                          pose_of(-7, 6, -50, {-2, 2, 0}), pose_of(4, 7, 30, {1, 1, 0})};
  const std::vector<Eigen::Vector2d> places{{-15, -12}, {16, -8}, {2, 17}};
  Registrar registrar;
  JobContext job;
  for (const int id : {2, 3}) {
    registrar.add(id,
                  scanned(surface, truth[static_cast<std::size_t>(id)], 20U + static_cast<std::uint64_t>(id)),
                  nullptr, job);
  }
  const PoseHint wrong = clicked(0, surface, pose_of(0, 0, 95, {3, 0, 0}) * truth[2], truth[0], places);
  ASSERT_TRUE(registrar.set_hint(2, wrong, job));
  registrar.add(0, scanned(surface, truth[0], 1), nullptr, job);
  registrar.add(1, scanned(surface, truth[1], 2), nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  EXPECT_NE(pose_in(registrar, 0).status, pose_in(registrar, 2).status);
  ASSERT_TRUE(registrar.set_hint(2, clicked(0, surface, truth[2], truth[0], places), job));
  ASSERT_TRUE(registrar.finalize(job));
  const RigidTransform model_from_truth = pose_in(registrar, 0).model_from_scanner * truth[0].inverse();
  for (int id = 0; id < 4; ++id) {
    const ScanPose pose = pose_in(registrar, id);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << id << pose.reason;
    EXPECT_LT(error_mm(pose, model_from_truth * truth[static_cast<std::size_t>(id)]), 0.02) << id;
  }
}

TEST(Hints, BadOnesAreRefused) {
  Registrar registrar;
  JobContext job;
  const auto pair = [](double x, double y) { return PointPair{{x, y, 0}, {x + 5, y, 1}}; };
  const auto refused = [&](const PoseHint& hint, const char* why) {
    const Status status = registrar.set_hint(1, hint, job);
    ASSERT_FALSE(status) << why;
    EXPECT_THAT(status.error().line(), HasSubstr(why));
  };
  refused({0, {}, std::nullopt}, "no point pair");
  refused({1, {pair(0, 0)}, std::nullopt}, "needs another scan");
  refused({0, {pair(0, 0), pair(10, 0), pair(25, 0.2)}, std::nullopt}, "one line");
  refused({0, {pair(0, 0), pair(0.5, 0)}, std::nullopt}, "one place");
  refused({0, {pair(0, 0), {{20, 0, 0}, {60, 0, 0}}}, std::nullopt}, "20 mm apart in one scan and 55 mm");
  PoseHint swapped{0, {pair(0, 0), pair(30, 0), pair(0, 18)}, std::nullopt};
  std::swap(swapped.points[0].on_point_mm, swapped.points[1].on_point_mm);
  refused(swapped, "not the same places");
  PoseHint odd{0, {pair(0, 0), pair(30, 0), pair(0, 18), pair(25, 20)}, std::nullopt};
  odd.points[2].on_point_mm.x() += 14;
  refused(odd, "point pair 3 lies 14 mm");
  PoseHint stretched;
  stretched.on = 0;
  stretched.on_from_scanner = RigidTransform{2.0 * Eigen::Matrix3d::Identity(), {0, 0, 0}};
  refused(stretched, "not a rigid transform");
}

/// The second scan of the two-fold surface; `asked` is the turn that was asked of the operator's hands.
ScanPose turned_by_hand(const Height& surface, const RigidTransform& truth,
                        const std::optional<RigidTransform>& asked) {
  RangeGrid before = *scanned(surface, {}, 1);
  RangeGrid after = *scanned(surface, truth, 9);
  if (asked) {
    before.nominal = NominalPose{};
    after.nominal = NominalPose{.tablet_from_scanner = *asked, .placement = 1};
  }
  Registrar registrar;
  JobContext job;
  registrar.add(0, std::make_shared<const RangeGrid>(std::move(before)), nullptr, job);
  return registrar.add(1, std::make_shared<const RangeGrid>(std::move(after)), nullptr, job);
}

TEST(HandTurns, ThatWereAskedForTellTwoPosesApart) {
  const auto surface = two_fold();
  const RigidTransform truth = pose_of(5, 3, 20, {1, 1, 0});
  EXPECT_EQ(turned_by_hand(surface, truth, std::nullopt).status, PoseStatus::kUnsure);
  for (const RigidTransform& turned : {truth, pose_of(0, 0, 180, {0, 0, 0}) * truth}) {
    const ScanPose pose = turned_by_hand(surface, truth, pose_of(2, -2, 4, {1, -1, 0.5}) * turned);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    EXPECT_LT(error_mm(pose, turned), 0.02);
  }
  // Asked for something in between, it tells nothing.
  const RigidTransform neither = pose_of(0, 0, 90, {0, 0, 0}) * truth;
  EXPECT_NE(turned_by_hand(surface, truth, neither).status, PoseStatus::kRegistered);
}

TEST(GivenPoses, AreRefinedAndNothingElseIsLookedFor) {
  const auto surface = bumpy(24);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}),
                                          pose_of(-7, 6, -50, {-2, 2, 0})};
  Registrar registrar;
  JobContext job;
  const RigidTransform off = pose_of(1, -1, 1.5, {0.6, -0.5, 0.4});
  registrar.add_at(0, scanned(surface, truth[0], 1), nullptr, truth[0], false, job);
  registrar.add_at(1, scanned(surface, truth[1], 2), nullptr, off * truth[1], false, job);
  registrar.add_at(2, scanned(surface, truth[2], 3), nullptr, pose_of(0, 0, 70, {8, 0, 0}) * truth[2], false,
                   job);
  ASSERT_TRUE(registrar.finalize(job));
  EXPECT_EQ(pose_in(registrar, 1).status, PoseStatus::kRegistered) << pose_in(registrar, 1).reason;
  EXPECT_LT(error_mm(pose_in(registrar, 1), truth[1]), 0.02);
  EXPECT_NE(pose_in(registrar, 2).status, PoseStatus::kRegistered);
  EXPECT_FALSE(pose_in(registrar, 2).reason.empty());
}

TEST(Locks, HoldThroughEverythingThatComesAfter) {
  const auto surface = bumpy(25);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(9, -5, 100, {2, -1, 0}),
                                          pose_of(-7, 6, -50, {-2, 2, 0})};
  const RigidTransform shift = pose_of(20, 10, 30, {100, -50, 7});  // the model frame is where the lock says
  Registrar registrar;
  JobContext job;
  registrar.add_at(2, scanned(surface, truth[2], 3), nullptr, shift * truth[2], true, job);
  registrar.add(0, scanned(surface, truth[0], 1), nullptr, job);
  registrar.add(1, scanned(surface, truth[1], 2), nullptr, job);
  ASSERT_TRUE(registrar.finalize(job));
  const ScanPose locked = pose_in(registrar, 2);
  EXPECT_TRUE(locked.locked);
  EXPECT_EQ(locked.model_from_scanner.row_major(), (shift * truth[2]).row_major());
  for (int id = 0; id < 2; ++id) {
    const ScanPose pose = pose_in(registrar, id);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
    EXPECT_LT(error_mm(pose, shift * truth[static_cast<std::size_t>(id)]), 0.02) << id;
    EXPECT_FALSE(pose.locked);
  }
  const Status refused = registrar.set_hint(2, clicked(0, surface, truth[2], truth[0], {{1, 1}}), job);
  ASSERT_FALSE(refused);
  EXPECT_THAT(refused.error().line(), HasSubstr("unlock"));
  EXPECT_TRUE(registrar.set_locked(2, false));
  EXPECT_FALSE(pose_in(registrar, 2).locked);
  EXPECT_FALSE(registrar.set_locked(77, true));
}

TEST(Locks, ThatAreTakenAwayLeaveAScanAsSureAsItsSurfaceMakesIt) {
  const auto surface = bumpy(25);
  const RigidTransform truth = pose_of(9, -5, 100, {2, -1, 0});
  Registrar registrar;
  JobContext job;
  registrar.add(0, scanned(surface, {}, 1), nullptr, job);
  registrar.add_at(1, scanned(surface, truth, 2), nullptr, truth, true, job);
  registrar.add_at(2, scanned(bumpy(99), {}, 3), nullptr, pose_of(0, 0, 0, {200, 0, 0}), true, job);
  ASSERT_TRUE(registrar.finalize(job));
  ASSERT_EQ(pose_in(registrar, 1).sigma_mm, 0.0);
  ASSERT_EQ(pose_in(registrar, 2).status, PoseStatus::kRegistered);
  ASSERT_TRUE(registrar.set_locked(1, false));
  ASSERT_TRUE(registrar.set_locked(2, false));
  ASSERT_TRUE(registrar.finalize(job));
  const ScanPose held = pose_in(registrar, 1);
  EXPECT_EQ(held.status, PoseStatus::kRegistered) << held.reason;
  EXPECT_GT(held.sigma_mm, 0.0);
  EXPECT_NE(pose_in(registrar, 2).status, PoseStatus::kRegistered) << "nothing holds it";
}

}  // namespace
}  // namespace dubsar
