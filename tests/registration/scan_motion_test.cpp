// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// A tablet that slips while it is scanned: its scan must not become part of the model.
#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "bench/support/true_scans.h"
#include "core/random.h"
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

/// One of the scans, slipped, among the others in their true places.
class AmongOthers {
 public:
  AmongOthers(std::size_t which, const Eigen::Vector3f& shift_mm) {
    ScanSurfaceOptions options;
    options.scale_mm = surface_scale_mm(*still_scans().front().grid);
    for (std::size_t k = 0; k < still_scans().size(); ++k) {
      const auto& [grid, pose, tips, tablet] = still_scans()[k];
      surfaces_.push_back(make_scan_surface(k == which ? *slipped(*grid, shift_mm) : *grid, {}, options));
      if (k != which) {
        others_.push_back({surfaces_[k].get(), pose});
      }
    }
    scan_ = surfaces_[which].get();
    ModelFitOptions close;
    close.starts_are_close = true;
    close.least_significance = 0;
    const RigidTransform truth = still_scans()[which].tablet_from_scanner;
    pose_ = fit_to_model(*scan_, others_, {&truth, 1}, close).front().model_from_scanner;
  }
  [[nodiscard]] bool may_have_moved() const {
    return dubsar::may_have_moved(*scan_, others_, judge_in_model(*scan_, others_, pose_, {}), {});
  }
  /// Where it lies, or about as far off as its place changes with each other scan.
  [[nodiscard]] bool has_moved(bool was_found, Random* off = nullptr) const {
    constexpr double kOffMm = 0.002;
    RigidTransform pose = pose_;
    if (off != nullptr) {
      const Eigen::Vector3d middle = pose * scan_->centroid_mm;
      const RigidTransform turn =
          RigidTransform::from_twist(kOffMm / (0.5 * scan_->extent_mm) * off->normal3(), {0, 0, 0});
      pose.translation_mm = turn * (pose.translation_mm - middle) + middle + kOffMm * off->normal3();
      pose.rotation = turn.rotation * pose.rotation;
      pose = pose.orthonormalised();
    }
    return find_motion(*scan_, others_, judge_in_model(*scan_, others_, pose, {}), {}, was_found).has_value();
  }

 private:
  std::vector<std::shared_ptr<const ScanSurface>> surfaces_;
  std::vector<ModelScan> others_;
  const ScanSurface* scan_ = nullptr;
  RigidTransform pose_;
};

/// A part of the samples says which bands are worth fitting.
TEST(ScanMotion, NothingIsFittedWholeWhereNothingMoved) {
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    EXPECT_FALSE(AmongOthers(k, {0, 0, 0}).may_have_moved()) << k;
  }
  EXPECT_TRUE(AmongOthers(1, {0, 0, 1.0F}).may_have_moved());
  EXPECT_TRUE(AmongOthers(2, {0.7F, 0.4F, 0}).may_have_moved());
}

/// Between what is told of a scan at first and what clears it again.
TEST(ScanMotion, MicrometresDoNotTurnTheVerdictToAndFro) {
  const AmongOthers scan(2, {0.28F, 0, 0});
  Random off(3);
  EXPECT_FALSE(scan.has_moved(false));
  EXPECT_TRUE(scan.has_moved(true));
  for (int k = 0; k < 4; ++k) {
    EXPECT_FALSE(scan.has_moved(false, &off));
    EXPECT_TRUE(scan.has_moved(true, &off));
  }
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    EXPECT_FALSE(AmongOthers(k, {0, 0, 0}).has_moved(true)) << "it is right, and comes in again: " << k;
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
