// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// A tablet that moves by less than a spacing while it is scanned: told once all scans are in place, and never
// of a scan that is right.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "bench/support/moved_scan.h"
#include "bench/support/true_scans.h"
#include "core/units.h"
#include "registration/registrar.h"
#include "registration/scan_step.h"

namespace dubsar {
namespace {

using ::testing::StartsWith;

constexpr double kSpacing_mm = 0.2;
constexpr std::uint64_t kSeed = 71;
constexpr std::size_t kMoved = 3;

std::vector<bench::TrueScan> scans_of(const char* kind, std::uint64_t seed, double spacing_mm) {
  return bench::true_scans(bench::random_tablet(seed, kind, spacing_mm),
                           {spacing_mm, 0.02, 12, {}, seed, bench::Pins::kNone, 0});
}

const std::vector<bench::TrueScan>& still_scans() {
  static const std::vector<bench::TrueScan> scans = scans_of("text", kSeed, kSpacing_mm);
  return scans;
}

struct Named : bench::Move {
  const char* name;
};

/// The scans in their true places, one of them moved while it was scanned.
class InPlace {
 public:
  explicit InPlace(const std::vector<bench::TrueScan>& scans, const bench::Move* move = nullptr) {
    ScanSurfaceOptions options;
    options.scale_mm = surface_scale_mm(*scans.front().grid);
    for (std::size_t k = 0; k < scans.size(); ++k) {
      surfaces_.push_back(make_scan_surface(
          move != nullptr && k == kMoved ? *bench::moved_scan(*scans[k].grid, *move) : *scans[k].grid, {},
          options));
      model_.push_back({surfaces_[k].get(), scans[k].tablet_from_scanner});
    }
    if (move != nullptr) {
      model_[kMoved].model_from_scanner = fitted(kMoved);
    }
  }

  [[nodiscard]] std::optional<ScanStep> step(std::size_t which) const {
    const ModelFit fit = judge_in_model(*surfaces_[which], without(which), fitted(which), {});
    return find_step(*surfaces_[which], without(which), fit);
  }
  [[nodiscard]] bool is_told(std::size_t which) const {
    const std::optional<ScanStep> found = step(which);
    return found && found->is_told(surfaces_[which]->fine->spacing_mm);
  }

 private:
  [[nodiscard]] std::vector<ModelScan> without(std::size_t which) const {
    std::vector<ModelScan> others = model_;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(which));
    return others;
  }
  /// Where it lies best against the others.
  [[nodiscard]] RigidTransform fitted(std::size_t which) const {
    ModelFitOptions close;
    close.starts_are_close = true;
    close.least_significance = 0;
    return fit_to_model(*surfaces_[which], without(which), {&model_[which].model_from_scanner, 1}, close)
        .front()
        .model_from_scanner;
  }

  std::vector<std::shared_ptr<const ScanSurface>> surfaces_;
  std::vector<ModelScan> model_;
};

class MovedScan : public testing::TestWithParam<Named> {};

TEST_P(MovedScan, IsMeasuredAndTheOthersAreNotAccused) {
  const InPlace scans(still_scans(), &GetParam());
  const std::optional<ScanStep> step = scans.step(kMoved);
  ASSERT_TRUE(step);
  EXPECT_TRUE(scans.is_told(kMoved)) << step->chi2;
  // An estimate: so small a move along a side is held by little.
  EXPECT_NEAR(step->shift_mm / GetParam().shift_mm.norm(), 1.0, 0.5);
  EXPECT_NEAR(deg_from_rad(step->turn_rad), GetParam().turn_deg.norm(), 0.1);
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    EXPECT_TRUE(k == kMoved || step->chi2 > (scans.step(k) ? scans.step(k)->chi2 : 0.0)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(Each, MovedScan,
                         testing::Values(Named{{{0, 0, 0.3}, {0.12, 0.09, 0}}, "PushedOnItsPlate"},
                                         Named{{{0, 0, -0.3}, {-0.15, 0, 0}, 0.3}, "PushedEarly"},
                                         Named{{{0.3, 0, 0}, {0, 0, 0.15}}, "RockedOnItsPlate"},
                                         Named{{{0.2, -0.2, 0.1}, {0.1, -0.05, 0.1}}, "AnyHow"}),
                         [](const auto& one) { return std::string(one.param.name); });

struct Right {
  const char* kind;
  std::uint64_t seed;
  double spacing_mm;
};

class RightScan : public testing::TestWithParam<Right> {};

TEST_P(RightScan, IsNotToldToHaveMoved) {
  const std::vector<bench::TrueScan> right =
      scans_of(GetParam().kind, GetParam().seed, GetParam().spacing_mm);
  const InPlace scans(right);
  for (std::size_t k = 0; k < right.size(); ++k) {
    EXPECT_FALSE(scans.is_told(k)) << k;
  }
}

INSTANTIATE_TEST_SUITE_P(OfTablets, RightScan,
                         testing::Values(Right{"text", 72, 0.2}, Right{"worn", 73, 0.3},
                                         Right{"tiny", 74, 0.2}, Right{"blank", 75, 0.2}),
                         [](const auto& one) { return std::string(one.param.kind); });

/// The others are where they were, so that nothing has to be put out; and it is the only one that is told.
TEST(ScanStep, IsToldBesideThePose) {
  const bench::Move push{{0, 0, -0.3}, {-0.15, 0, 0}, 0.3};
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < still_scans().size(); ++k) {
    const auto& grid = still_scans()[k].grid;
    registrar.add(static_cast<int>(k), k == kMoved ? bench::moved_scan(*grid, push) : grid, nullptr, job);
  }
  ASSERT_TRUE(registrar.finalize(job));
  for (const ScanPose& pose : registrar.poses()) {
    EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
    if (pose.id == static_cast<int>(kMoved)) {
      EXPECT_THAT(pose.warning, StartsWith("the tablet or the scanner moved during the scan, after about"));
    } else {
      EXPECT_EQ(pose.warning, "") << pose.id;
    }
  }
}

/// Lines that drift sideways are another fault, and rows that sag a third.
TEST(ScanStep, ADriftIsNoStep) {
  for (const Named& drift : {Named{{{0, 0, 0}, {0.5, 0, 0}, 0, true}, "sideways"},
                             Named{{{0, 0, 0.6}, {0, 0, 0}, 0, true}, "turning"},
                             Named{{{0.4, 0, 0}, {0, 0, 0.2}, 0, true}, "sinking"}}) {
    EXPECT_FALSE(InPlace(still_scans(), &drift).is_told(kMoved)) << drift.name;
  }
}

}  // namespace
}  // namespace dubsar
