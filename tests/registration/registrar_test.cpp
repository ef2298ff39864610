// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/registrar.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <limits>

#include "bench/support/odd_body.h"
#include "core/random.h"
#include "core/units.h"
#include "tests/registration/support/height_field.h"
#include "tests/registration/support/pose_error.h"

namespace dubsar {
namespace {

using testing::bumpy;
using ::testing::ElementsAre;
using testing::error_mm;
using testing::FieldScan;
using ::testing::HasSubstr;
using ::testing::Not;
using testing::pose_of;
using testing::scan_field;
using testing::share;

TEST(Registrar, RegistersScansTurnedAnyWayWithNoHints) {
  const auto surface = bumpy(11);
  const std::vector<RigidTransform> truth{pose_of(0, 0, 0, {0, 0, 0}), pose_of(12, -8, 130, {4, -3, 2}),
                                          pose_of(-15, 10, -75, {-5, 6, 1})};
  Registrar registrar;
  JobContext job;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    FieldScan scan;
    scan.seed = 100 + k;
    const ScanPose pose =
        registrar.add(static_cast<int>(k), share(scan_field(surface, truth[k], scan)), nullptr, job);
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  }
  ASSERT_TRUE(registrar.finalize(job));
  const std::vector<ScanPose> poses = registrar.poses();
  ASSERT_EQ(poses.size(), 3U);
  EXPECT_TRUE(poses[0].model_from_scanner.rotation.isIdentity(1e-12));
  for (std::size_t k = 1; k < poses.size(); ++k) {
    EXPECT_LT(error_mm(poses[k], poses[0], truth[k], truth[0]), 0.02);
    EXPECT_GT(poses[k].sigma_mm, 0.0);
    EXPECT_LT(poses[k].sigma_mm, 0.05);
    EXPECT_GT(poses[k].overlap, 0.5);
    EXPECT_TRUE(poses[k].covariance.has_value());
  }
}

TEST(Registrar, ABallThatOnlySeemsToHoldIsUnsure) {
  // A smooth ball with stray samples: the relief that two of its scans seem to share is no relief, and the
  // pose is known to more than a millimetre only.
  Random random(seed_for(77, 56));
  const bench::OddBody ball(random);
  const bench::OddScanning scanning(random);
  (void)random.below(6);
  Registrar registrar;
  JobContext job;
  for (int k = 0; k < 2; ++k) {
    registrar.add(k, share(scanning.scan(ball, random).first), nullptr, job);
  }
  ASSERT_TRUE(registrar.finalize(job));
  const ScanPose pose = registrar.poses().back();
  EXPECT_GT(pose.sigma_mm, 1.0);
  EXPECT_EQ(pose.status, PoseStatus::kUnsure);
  EXPECT_THAT(pose.reason,
              HasSubstr("the overlap is too even: the scan can "));  // on a ball slides are turns
}

TEST(Registrar, GivesTheSameBytesOnOneThreadAndOnMany) {
  const auto surface = bumpy(12);
  const auto run = [&](std::size_t threads) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
    Registrar registrar;
    JobContext job;
    for (int k = 0; k < 3; ++k) {
      FieldScan scan;
      scan.seed = 7 + static_cast<std::uint64_t>(k);
      registrar.add(k,
                    share(scan_field(surface, pose_of(5.0 * k, -3.0 * k, 80.0 * k, {1.0 * k, 0, 0}), scan)),
                    nullptr, job);
    }
    EXPECT_TRUE(registrar.finalize(job));
    std::vector<double> numbers;
    for (const ScanPose& pose : registrar.poses()) {
      const auto m = pose.model_from_scanner.row_major();
      numbers.insert(numbers.end(), m.begin(), m.end());
      numbers.insert(numbers.end(), {pose.rms_mm, pose.sigma_mm, pose.overlap});
    }
    return numbers;
  };
  EXPECT_EQ(run(1), run(4));
}

TEST(Registrar, SaysWhenScansDoNotOverlap) {
  const auto surface = bumpy(13, 120);
  FieldScan left;
  left.high_x_mm = -3;
  FieldScan right;
  right.low_x_mm = 3;
  right.seed = 2;
  Registrar registrar;
  JobContext job;
  EXPECT_EQ(registrar.add(0, share(scan_field(surface, {}, left)), nullptr, job).status,
            PoseStatus::kRegistered);
  const ScanPose pose =
      registrar.add(1, share(scan_field(surface, pose_of(0, 0, 40, {0, 0, 0}), right)), nullptr, job);
  EXPECT_NE(pose.status, PoseStatus::kRegistered);
  EXPECT_THAT(pose.reason, HasSubstr("scan"));
}

TEST(Registrar, ScansThatFitOneAnotherAndNotTheModelAreOfOneGroup) {
  const auto surface = bumpy(13, 120);
  Registrar registrar;
  JobContext job;
  for (const int id : {0, 1, 2, 3, 5}) {
    FieldScan scan;
    scan.seed = 20 + static_cast<std::uint64_t>(id);
    (id < 3 ? scan.high_x_mm : scan.low_x_mm) = id < 3 ? -3 : 3;
    registrar.add(id, share(scan_field(surface, pose_of(3.0 * id, -2.0 * id, 50.0 * id, {1, 0, 0}), scan)),
                  nullptr, job);
  }
  const auto group = [&](std::size_t at) { return registrar.poses().at(at).group_apart; };
  for (const std::size_t at : {0, 1, 2}) {
    EXPECT_EQ(registrar.poses()[at].status, PoseStatus::kRegistered) << registrar.poses()[at].reason;
    EXPECT_EQ(group(at), -1);
  }
  for (const std::size_t at : {3, 4}) {
    EXPECT_EQ(registrar.poses()[at].status, PoseStatus::kUnsure);
    EXPECT_EQ(group(at), 3);
  }
  registrar.remove(5, job);
  EXPECT_EQ(group(3), -1) << "alone it is no group";
}

TEST(Registrar, PinsAreNotAdvisedToWhoHasSome) {
  const auto plane = [](double, double) { return 0.0; };
  const auto reason_with = [&](const std::optional<PinSet>& pins) {
    Registrar registrar;
    JobContext job;
    ScanPose pose;
    for (int k = 0; k < 2; ++k) {
      FieldScan scan;
      scan.seed = 30 + static_cast<std::uint64_t>(k);
      scan.half_mm = 20;  // a field that cuts the plane on all sides
      pose = registrar.add(k, share(scan_field(plane, pose_of(0, 0, 0, {2.0 * k, 0, 0}), scan)),
                           pins ? &*pins : nullptr, job);
    }
    EXPECT_EQ(pose.status, PoseStatus::kUnsure);
    return pose.reason;
  };
  EXPECT_THAT(reason_with({}), HasSubstr("use pins"));
  PinSet pins;
  for (int k = 0; k < 2; ++k) {
    int label = 0;
    for (const Eigen::Vector2d& at : {Eigen::Vector2d(-17, -17), Eigen::Vector2d(17, -15),
                                      Eigen::Vector2d(-14, 17), Eigen::Vector2d(15, 16)}) {
      pins.tips[k].push_back({label++, {at.x() - 2.0 * k, at.y(), 4.0 + label}});
    }
  }
  const std::string reason = reason_with(pins);
  EXPECT_THAT(reason, ::testing::Not(HasSubstr("use pins")));
  EXPECT_THAT(reason, HasSubstr("; its pins, put back by hand, hold it no better"));
}

TEST(Registrar, DoesNotJoinDifferentObjects) {
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(bumpy(14), {}, {})), nullptr, job);
  for (int k = 1; k < 5; ++k) {
    const ScanPose pose = registrar.add(
        k,
        share(scan_field(bumpy(200 + static_cast<std::uint64_t>(k)), pose_of(5, 5, 30.0 * k, {0, 0, 0}), {})),
        nullptr, job);
    EXPECT_NE(pose.status, PoseStatus::kRegistered) << k;
    EXPECT_FALSE(pose.reason.empty());
  }
}

TEST(Registrar, AsksWhereAPlaneOrASphereCanSlide) {
  const auto plane = [](double, double) { return 0.0; };
  const auto sphere = [](double x, double y) {
    return std::sqrt(std::max(1.0, 1600.0 - x * x - y * y)) - 40.0;
  };
  for (const auto& surface : {testing::Height(plane), testing::Height(sphere)}) {
    Registrar registrar;
    JobContext job;
    for (int k = 0; k < 2; ++k) {
      FieldScan scan;
      scan.seed = 30 + static_cast<std::uint64_t>(k);
      // A field that cuts the object on all sides: no border tells where it is.
      scan.half_mm = 20;
      const ScanPose pose = registrar.add(
          k, share(scan_field(surface, pose_of(4.0 * k, 0, 25.0 * k, {2.0 * k, 0, 0}), scan)), nullptr, job);
      EXPECT_EQ(pose.status == PoseStatus::kRegistered, k == 0) << k;
      EXPECT_EQ(pose.reason.empty(), k == 0);
    }
  }
}

TEST(Registrar, AsksWhereTwoPosesFit) {
  // The same under a half turn: only a mark could tell.
  const auto half = bumpy(15, 40);
  const auto surface = [half](double x, double y) { return half(x, y) + half(-x, -y); };
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(surface, {}, {})), nullptr, job);
  FieldScan again;
  again.seed = 9;
  const ScanPose pose =
      registrar.add(1, share(scan_field(surface, pose_of(5, 3, 20, {1, 1, 0}), again)), nullptr, job);
  EXPECT_EQ(pose.status, PoseStatus::kUnsure);
  EXPECT_THAT(pose.reason, HasSubstr("two poses fit, 180 degrees apart"));
}

TEST(Registrar, SurvivesGridsWithNothingInThem) {
  Registrar registrar;
  JobContext job;
  EXPECT_EQ(registrar.add(0, nullptr, nullptr, job).status, PoseStatus::kFailed);
  EXPECT_EQ(registrar.add(1, share(RangeGrid{}), nullptr, job).status, PoseStatus::kFailed);
  RangeGrid row;
  row.allocate(1, 300);
  for (std::size_t i = 0; i < row.size(); ++i) {
    row.x[i] = 0.1F * static_cast<float>(i);
    row.valid[i] = 1;
  }
  row.spacing_mm = 0.1;
  EXPECT_EQ(registrar.add(2, share(row), nullptr, job).status, PoseStatus::kFailed);
  RangeGrid wild;
  wild.allocate(40, 40);
  wild.valid.assign(wild.size(), 1);
  for (std::size_t i = 0; i < wild.size(); ++i) {
    wild.x[i] = i % 3 == 0 ? std::numeric_limits<float>::quiet_NaN() : 1e30F;
    wild.z[i] = i % 5 == 0 ? std::numeric_limits<float>::infinity() : -1e30F;
  }
  EXPECT_EQ(registrar.add(3, share(wild), nullptr, job).status, PoseStatus::kFailed);
  EXPECT_EQ(registrar.add(4, share(scan_field(bumpy(3), {}, {})), nullptr, job).status,
            PoseStatus::kRegistered);
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.reason.empty(), pose.id == 4);
  }
  EXPECT_TRUE(registrar.finalize(job));
}

TEST(Registrar, NamesAWrongUnit) {
  Registrar registrar;
  JobContext job;
  RangeGrid grid = scan_field(bumpy(16), {}, {});
  registrar.add(0, share(grid), nullptr, job);
  for (auto* values : {&grid.x, &grid.y, &grid.z}) {
    for (float& v : *values) {
      v *= 0.001F;
    }
  }
  grid.spacing_mm *= 0.001;
  const ScanPose pose = registrar.add(1, share(grid), nullptr, job);
  EXPECT_EQ(pose.status, PoseStatus::kFailed);
  EXPECT_THAT(pose.reason, HasSubstr("1000 times smaller"));
}

TEST(Registrar, LeavesLockedScansWhereTheyAre) {
  const auto surface = bumpy(17);
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(surface, {}, {})), nullptr, job);
  FieldScan second;
  second.seed = 5;
  const RigidTransform truth = pose_of(6, 2, 50, {1, 2, 0});
  registrar.add(1, share(scan_field(surface, truth, second)), nullptr, job);
  const RigidTransform fixed = RigidTransform{Eigen::Matrix3d::Identity(), {0.02, 0, 0}} * truth;
  ASSERT_TRUE(registrar.set_pose(1, fixed, true, job));
  ASSERT_TRUE(registrar.finalize(job));
  const ScanPose pose = registrar.poses()[1];
  EXPECT_TRUE(pose.locked);
  EXPECT_EQ(pose.model_from_scanner.translation_mm, fixed.orthonormalised().translation_mm);
  EXPECT_FALSE(registrar.set_pose(99, fixed, true, job));
  EXPECT_FALSE(registrar.set_pose(0, pose_of(180, 0, 0, {50, 50, 50}), false, job));
}

TEST(Registrar, RemovesAndReplacesScans) {
  const auto surface = bumpy(18);
  Registrar registrar;
  JobContext job;
  registrar.add(3, share(scan_field(surface, {}, {})), nullptr, job);
  registrar.add(7, share(scan_field(surface, pose_of(0, 5, 10, {0, 0, 0}), {})), nullptr, job);
  EXPECT_TRUE(registrar.remove(3, job));
  EXPECT_FALSE(registrar.remove(3, job));
  ASSERT_EQ(registrar.poses().size(), 1U);
  EXPECT_EQ(registrar.poses()[0].status, PoseStatus::kRegistered);
  registrar.add(7, share(RangeGrid{}), nullptr, job);
  EXPECT_EQ(registrar.poses()[0].status, PoseStatus::kFailed);
}

TEST(Registrar, TakesTheStagesWordWhereNothingOverlaps) {
  const auto surface = bumpy(19, 120);
  FieldScan left;
  left.high_x_mm = -3;
  FieldScan right;
  right.low_x_mm = 3;
  const RigidTransform truth = pose_of(3, 0, 20, {0, 1, 0});
  RangeGrid a = scan_field(surface, {}, left);
  RangeGrid b = scan_field(surface, truth, right);
  a.nominal = NominalPose{};
  b.nominal = NominalPose{};
  b.nominal->tablet_from_scanner = truth;
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(a), nullptr, job);
  const ScanPose pose = registrar.add(1, share(b), nullptr, job);
  EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.reason;
  EXPECT_LT((pose.model_from_scanner.translation_mm - truth.translation_mm).norm(), 1e-6);
  EXPECT_GE(pose.sigma_mm, b.nominal->sigma_mm);
}

TEST(Registrar, StopsWhenAsked) {
  Registrar registrar;
  JobContext job;
  registrar.add(0, share(scan_field(bumpy(20), {}, {})), nullptr, job);
  JobContext stopped;
  stopped.cancel();
  const auto second = share(scan_field(bumpy(20), pose_of(0, 0, 90, {0, 0, 0}), {}));
  EXPECT_NE(registrar.add(1, second, nullptr, stopped).status, PoseStatus::kRegistered);
  const Status status = registrar.finalize(stopped);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kCancelled);
  EXPECT_TRUE(registrar.finalize(job));
  EXPECT_EQ(registrar.poses()[1].status, PoseStatus::kRegistered) << registrar.poses()[1].reason;
}

}  // namespace
}  // namespace dubsar
