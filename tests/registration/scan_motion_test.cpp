// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// A tablet that slips while it is scanned: its scan must not become part of the model.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "bench/support/true_scans.h"
#include "registration/registrar.h"
#include "registration/scan_motion.h"

namespace dubsar {
namespace {

constexpr double kSpacing_mm = 0.15;
constexpr std::uint64_t kSeed = 71;

const std::vector<bench::TrueScan>& still_scans() {
  static const std::vector<bench::TrueScan> scans =
      bench::true_scans(bench::random_tablet(kSeed, "text", kSpacing_mm),
                        {kSpacing_mm, 0.02, 12, {0, 2, 4, 1, 3}, kSeed, bench::Pins::kNone, 0});
  return scans;
}

/// The scan with the rows after the middle one shifted.
std::shared_ptr<const RangeGrid> slipped(const RangeGrid& still, const Eigen::Vector3f& shift_mm) {
  auto out = std::make_shared<RangeGrid>(still);
  std::vector<std::size_t> valid;
  for (std::size_t i = 0; i < out->size(); ++i) {
    if (out->valid[i] != 0) {
      valid.push_back(i);
    }
  }
  const auto middle_row = valid[valid.size() / 2] / static_cast<std::size_t>(out->cols);
  for (const std::size_t i : valid) {
    if (i / static_cast<std::size_t>(out->cols) >= middle_row) {
      out->x[i] += shift_mm.x();
      out->y[i] += shift_mm.y();
      out->z[i] += shift_mm.z();
    }
  }
  return out;
}

/// With the scan slipped, or without it.
std::vector<ScanPose> registered_with(std::size_t which, const std::optional<Eigen::Vector3f>& shift_mm) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    const auto& grid = still_scans()[k].grid;
    if (k != which || shift_mm) {
      registrar.add(static_cast<int>(k), k == which ? slipped(*grid, *shift_mm) : grid, nullptr, job);
    }
  }
  EXPECT_TRUE(registrar.finalize(job));
  return registrar.poses();
}

TEST(ScanMotion, NoneIsFoundWhereNothingMoved) {
  for (const ScanPose& pose : registered_with(0, Eigen::Vector3f(0, 0, 0))) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
  }
}

TEST(ScanMotion, IsLookedForAgainWhenAnotherScanIsTakenOutAndForgottenWithTheScan) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    const auto& grid = still_scans()[k].grid;
    registrar.add(static_cast<int>(k), k == 1 ? slipped(*grid, {0, 0, 1.0F}) : grid, nullptr, job);
  }
  ASSERT_TRUE(registrar.remove(2, job));
  const ScanPose slipped_one = registrar.poses().at(1);
  EXPECT_NE(slipped_one.status, PoseStatus::kRegistered);
  EXPECT_NE(slipped_one.reason.find("moved during the scan, after"), std::string::npos) << slipped_one.reason;
  const ScanPose again = registrar.add(1, still_scans()[1].grid, nullptr, job);
  EXPECT_EQ(again.status, PoseStatus::kRegistered) << again.reason;
  EXPECT_TRUE(again.reason.empty());
}

/// The check comes last; what it has not come to is looked at the next time.
TEST(ScanMotion, AStopDuringTheLastCheckIsSaidAndTheCheckIsMadeTheNextTime) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    registrar.add(static_cast<int>(k), still_scans()[k].grid, nullptr, job);
  }
  JobContext* under_way = nullptr;
  bool is_checked = false;
  JobContext stopped([&](std::string_view stage, double fraction) {
    if (stage == "checking scans") {
      under_way->cancel();
      is_checked = is_checked || fraction == 1.0;
    }
  });
  under_way = &stopped;
  const Status status = registrar.finalize(stopped);
  ASSERT_FALSE(status);
  EXPECT_EQ(status.error().kind, ErrorKind::kCancelled);
  EXPECT_FALSE(is_checked);
  EXPECT_TRUE(registrar.finalize(job));
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
  }
}

struct Slip {
  const char* name;
  std::size_t scan;
  Eigen::Vector3f shift_mm;
};

class SlippedScan : public testing::TestWithParam<Slip> {};

TEST_P(SlippedScan, IsNotPartOfTheModelAndSaysWhy) {
  const auto which = static_cast<int>(GetParam().scan);
  std::vector<ScanPose> poses = registered_with(GetParam().scan, GetParam().shift_mm);
  const ScanPose slipped_one = poses.at(GetParam().scan);
  EXPECT_NE(slipped_one.status, PoseStatus::kRegistered);
  ASSERT_NE(slipped_one.reason.find("moved during the scan"), std::string::npos) << slipped_one.reason;
  const std::size_t by = slipped_one.reason.find("by ");
  ASSERT_NE(by, std::string::npos) << slipped_one.reason;
  EXPECT_NEAR(std::stod(slipped_one.reason.substr(by + 3)), static_cast<double>(GetParam().shift_mm.norm()),
              0.25)
      << slipped_one.reason;
  // The others are as if it had never been there.
  std::erase_if(poses, [&](const ScanPose& pose) { return pose.id == which; });
  const std::vector<ScanPose> without = registered_with(GetParam().scan, std::nullopt);
  ASSERT_EQ(poses.size(), without.size());
  for (std::size_t k = 0; k < without.size(); ++k) {
    EXPECT_EQ(poses[k].status, without[k].status) << poses[k].id << poses[k].reason;
  }
}
INSTANTIATE_TEST_SUITE_P(Each, SlippedScan,
                         testing::Values(Slip{"FirstAlongTheProfile", 0, {0.9F, 0, 0}},
                                         Slip{"SecondTowardsTheCamera", 1, {0, 0, 1.0F}},
                                         Slip{"ThirdSlantwise", 2, {0.7F, 0.4F, 0}},
                                         Slip{"LastAcross", 4, {0, 1.2F, 0}}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace dubsar
