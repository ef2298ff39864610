// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// A scan whose lengths are not those of the others: a stage with another step, another calibration, one that
// drifts sideways.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "bench/support/true_scans.h"
#include "registration/registrar.h"
#include "registration/scan_stretch.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

constexpr double kSpacing_mm = 0.15;
constexpr std::uint64_t kSeed = 71;
constexpr std::size_t kStretched = 1;

const std::vector<bench::TrueScan>& true_scans() {
  static const std::vector<bench::TrueScan> scans =
      bench::true_scans(bench::random_tablet(kSeed, "text", kSpacing_mm),
                        {kSpacing_mm, 0.02, 12, {0, 2, 4}, kSeed, bench::Pins::kNone, 0});
  return scans;
}

/// About its middle, as a scan comes out that was taken with wrong lengths, or lines that drift sideways.
std::shared_ptr<const RangeGrid> stretched(const RangeGrid& grid, const Eigen::Vector3f& by, float shear) {
  auto out = std::make_shared<RangeGrid>(grid);
  Eigen::Vector3f middle = Eigen::Vector3f::Zero();
  for (std::size_t i = 0; i < grid.size(); ++i) {
    middle += grid.valid[i] != 0 ? grid.point(i) : Eigen::Vector3f(0, 0, 0);
  }
  middle /= static_cast<float>(grid.valid_count());
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const Eigen::Vector3f from = grid.point(i) - middle;
    const Eigen::Vector3f p = by.cwiseProduct(from) + middle;
    out->x[i] = p.x() + shear * from.y();
    out->y[i] = p.y();
    out->z[i] = p.z();
  }
  return out;
}

/// What is said of each of them once they are registered.
std::string said_of(const std::vector<std::shared_ptr<const RangeGrid>>& grids) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < grids.size(); ++k) {
    registrar.add(static_cast<int>(k), grids[k], nullptr, job);
  }
  EXPECT_TRUE(registrar.finalize(job));
  std::string all;
  for (const ScanPose& pose : registrar.poses()) {
    all += pose.reason + pose.warning + "\n";
    EXPECT_TRUE(pose.warning.empty() || pose.status == PoseStatus::kRegistered);
  }
  return all;
}

struct Lengths {
  const char* name;
  Eigen::Vector3f by;
  const char* reason;  ///< empty: nothing is off
  float shear = 0;
};

class StretchedScan : public testing::TestWithParam<Lengths> {
 protected:
  static std::string said() {
    std::vector<std::shared_ptr<const RangeGrid>> grids;
    for (std::size_t k = 0; k < true_scans().size(); ++k) {
      const auto& grid = true_scans()[k].grid;
      grids.push_back(k == kStretched ? stretched(*grid, GetParam().by, GetParam().shear) : grid);
    }
    return said_of(grids);
  }
};

TEST_P(StretchedScan, IsMeasuredFromWhereItLies) {
  std::vector<std::shared_ptr<const ScanSurface>> surfaces;
  std::vector<ModelScan> others;
  double scale_mm = 0;
  for (std::size_t k = 0; k < true_scans().size(); ++k) {
    const auto& grid = true_scans()[k].grid;
    scale_mm = k == 0 ? surface_scale_mm(*grid) : scale_mm;
    ScanSurfaceOptions options;
    options.scale_mm = scale_mm;
    surfaces.push_back(make_scan_surface(
        k == kStretched ? *stretched(*grid, GetParam().by, GetParam().shear) : *grid, {}, options));
    if (k != kStretched) {
      others.push_back({surfaces.back().get(), true_scans()[k].tablet_from_scanner});
    }
  }
  const ModelFit fit =
      judge_in_model(*surfaces[kStretched], others, true_scans()[kStretched].tablet_from_scanner, {});
  const std::optional<ScanStretch> found = find_stretch(*surfaces[kStretched], others, fit);
  ASSERT_TRUE(found);
  EXPECT_NEAR(found->along_line, static_cast<double>(GetParam().by.x()) - 1.0, 0.006);
  EXPECT_NEAR(found->along_motion, static_cast<double>(GetParam().by.y()) - 1.0, 0.006);
  EXPECT_NEAR(found->shear, static_cast<double>(GetParam().shear), 0.003);
  EXPECT_EQ(found->is_off(), *GetParam().reason != '\0');
  // What costs less says so beforehand.
  EXPECT_EQ(may_be_stretched(*surfaces[kStretched], others, fit), found->is_off());
}

TEST_P(StretchedScan, IsTold) {
  if (*GetParam().reason == '\0') {
    EXPECT_THAT(said(), Not(HasSubstr("against the other scans")));
  } else {
    EXPECT_THAT(said(), HasSubstr(GetParam().reason));
  }
}

INSTANTIATE_TEST_SUITE_P(
    Each, StretchedScan,
    testing::Values(Lengths{"NotAtAll", {1.0F, 1.0F, 1.0F}, ""},
                    Lengths{"TooLarge", {1.02F, 1.02F, 1.02F}, "too large: its calibration is not theirs"},
                    Lengths{"TooShortAStep", {1.0F, 0.97F, 1.0F}, "too short along the motion"},
                    // One of two scans, and nothing tells which: said of either.
                    Lengths{"TooLongALine", {1.02F, 1.0F, 1.0F}, "against the other scans"},
                    Lengths{"Sheared", {1.0F, 1.0F, 1.0F}, "sheared sideways by 3.", 0.03F},
                    Lengths{"ShearedTheOtherWay", {1.0F, 1.0F, 1.0F}, "sheared sideways by", -0.02F}),
    [](const auto& one) { return std::string(one.param.name); });

/// One of many, whose place is sure all the same: it is told, and none of those that it touches is.
TEST(ShearedScan, IsWarnedOfAlone) {
  const std::vector<bench::TrueScan> scans = bench::true_scans(
      bench::random_tablet(kSeed, "text", 0.2), {0.2, 0.02, 12, {}, kSeed, bench::Pins::kNone, 0});
  constexpr int kSheared = 3;
  JobContext job;
  Registrar registrar;
  for (int k = 0; k < static_cast<int>(scans.size()); ++k) {
    const auto& grid = scans[static_cast<std::size_t>(k)].grid;
    registrar.add(k, k == kSheared ? stretched(*grid, {1, 1, 1}, 0.03F) : grid, nullptr, job);
  }
  ASSERT_TRUE(registrar.finalize(job));
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
    if (pose.id == kSheared) {
      EXPECT_THAT(pose.warning, HasSubstr("against the other scans it is sheared sideways by 3."));
    } else {
      EXPECT_EQ(pose.warning, "") << pose.id;
    }
  }
}

/// What it shows without the others that are told lets a scan off only where that could tell it.
TEST(ShearedScan, IsAcquittedOnlyWhereItsShearIsSure) {
  ScanStretch accused;
  accused.shear = 0.03;
  accused.shear_sigma = 0.0005;
  accused.sigma = 0.0002;
  ASSERT_TRUE(accused.is_sheared());
  ScanStretch alone;
  alone.sigma = 0.0002;
  alone.shear_sigma = 0.004;
  EXPECT_FALSE(alone.acquits_of(accused)) << "its lengths are sure, and they were not accused";
  alone.sigma = 0.004;
  alone.shear_sigma = 0.0005;
  EXPECT_TRUE(alone.acquits_of(accused));
  ScanStretch too_long;
  too_long.along_motion = 0.02;
  too_long.sigma = 0.0002;
  ASSERT_TRUE(too_long.has_lengths_off());
  EXPECT_FALSE(alone.acquits_of(too_long));
  alone.sigma = 0.0002;
  EXPECT_TRUE(alone.acquits_of(too_long));
  EXPECT_FALSE(too_long.acquits_of(too_long));
}

/// Small and coarse: a rim is a larger part of them.
class RightScans : public testing::TestWithParam<std::uint64_t> {};

TEST_P(RightScans, AreNotAccused) {
  sim::TabletOptions tablet = bench::random_tablet(GetParam(), "text", 0.2);
  tablet.size_mm = {20, 20, 8};
  const std::vector<bench::TrueScan> scans =
      bench::true_scans(tablet, {0.2, 0.02, 12, {}, GetParam(), bench::Pins::kNone, 0});
  std::vector<std::shared_ptr<const ScanSurface>> surfaces;
  for (const bench::TrueScan& scan : scans) {
    ScanSurfaceOptions options;
    options.scale_mm = surface_scale_mm(*scans.front().grid);
    surfaces.push_back(make_scan_surface(*scan.grid, {}, options));
  }
  for (std::size_t k = 0; k < scans.size(); ++k) {
    std::vector<ModelScan> others;
    for (std::size_t other = 0; other < scans.size(); ++other) {
      if (other != k) {
        others.push_back({surfaces[other].get(), scans[other].tablet_from_scanner});
      }
    }
    const ModelFit fit = judge_in_model(*surfaces[k], others, scans[k].tablet_from_scanner, {});
    const std::optional<ScanStretch> found = find_stretch(*surfaces[k], others, fit);
    ASSERT_TRUE(found) << k;
    EXPECT_FALSE(found->is_off()) << k << ": " << found->along_line << " " << found->along_motion
                                  << ", sigma " << found->sigma;
  }
}
INSTANTIATE_TEST_SUITE_P(OfSmallTablets, RightScans, testing::Values(4, 5, 6, 7));

}  // namespace
}  // namespace dubsar
