// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/pin_detection.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/random.h"
#include "core/units.h"
#include "registration/pin_labels.h"
#include "sim/pins.h"
#include "sim/scan_plan.h"
#include "sim/scanner.h"
#include "tests/registration/support/height_field.h"
#include "tests/registration/support/slab_with_pins.h"

namespace dubsar {
namespace {

using testing::Slab;
using testing::slab_with_pins;
using testing::SlabPin;

const std::vector<SlabPin> kThreePins{{{-8, -5, 3}}, {{2, 4, 4}}, {{-3, 9, 2.5}}};

std::size_t masked(const PinDetection& found) {
  return static_cast<std::size_t>(std::count(found.mask.begin(), found.mask.end(), std::uint8_t{1}));
}

double nearest_mm(const PinDetection& found, const Eigen::Vector3d& tip) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const SeenPin& t : found.tips) {
    nearest = std::min(nearest, (t.position_mm - tip).norm());
  }
  return nearest;
}

TEST(PinDetection, FindsTipsAndMasksPinsOnly) {
  const RangeGrid grid = slab_with_pins(kThreePins, {});
  const PinDetection found = detect_pins(grid, 1.2, {});
  ASSERT_EQ(found.tips.size(), kThreePins.size());
  for (const SlabPin& pin : kThreePins) {
    EXPECT_LT(nearest_mm(found, pin.tip_mm), 0.03);
  }
  std::size_t wrong = 0;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool pin = grid.valid[i] != 0 && grid.z[i] > 0.5F;
    wrong += pin != (found.mask[i] != 0) ? 1U : 0U;
  }
  EXPECT_LE(wrong, 3U);
}

TEST(PinDetection, CovarianceIsWhatTheCentresAreOffBy) {
  double sum = 0;
  int count = 0;
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Slab slab;
    slab.seed = seed;
    slab.noise_mm = 0.02;
    const PinDetection found = detect_pins(slab_with_pins(kThreePins, slab), 1.2, {});
    ASSERT_EQ(found.tips.size(), kThreePins.size());
    for (const SlabPin& pin : kThreePins) {
      for (const SeenPin& tip : found.tips) {
        const Eigen::Vector3d off = tip.position_mm - pin.tip_mm;
        if (off.norm() < 0.5) {
          sum += off.dot(tip.covariance_mm2.ldlt().solve(off)) / 3.0;
          ++count;
        }
      }
    }
  }
  // Mean of 120 squared errors of three parts each: its own standard deviation is 0.075.
  EXPECT_EQ(count, 120);
  EXPECT_NEAR(sum / count, 1.0, 0.3);
}

TEST(PinDetection, FindsWhatASimulatedTabletShows) {
  JobContext job;
  sim::TabletOptions options;
  options.size_mm = {26, 22, 11};
  options.spacing_mm = 0.2;
  const auto tablet = sim::make_tablet(options, job);
  ASSERT_TRUE(tablet);
  const MeshQuery query(tablet->mesh);
  const sim::TriangulationScanner scanner(sim::scanner_for(options.size_mm, 0.12, 0.02));
  const sim::PinStand stand(*tablet, query, {});
  const auto plan = sim::plan_views(12, 1);
  std::size_t due = 0, missed = 0, told = 0, wrong = 0;
  for (const std::size_t v : {std::size_t{0}, std::size_t{2}, std::size_t{5}}) {
    const RigidTransform& pose = plan[v].tablet_from_scanner;
    sim::Scene scene{&*tablet, &query, {}, std::nullopt};
    scene.pins = sim::standing_pins(stand.placed(static_cast<int>(v)), scene, scanner, pose);
    const auto grid = scanner.scan_grid(scene, pose, v, job);
    ASSERT_TRUE(grid);
    const PinDetection found = detect_pins(*grid, 1.0, {});
    told += found.tips.size();
    const RigidTransform scanner_from_tablet = pose.inverse();
    for (const sim::Pin& pin : scene.pins) {
      const Eigen::Vector3d tip = scanner_from_tablet * pin.tip_mm;
      const Eigen::Vector3d arm = scanner_from_tablet.rotation * pin.arm;
      int seen = 0;
      for (std::size_t i = 0; i < grid->size(); ++i) {
        const Eigen::Vector3d d = grid->point(i).cast<double>() - tip;
        seen += grid->valid[i] != 0 && d.norm() < 0.6 && d.dot(arm) <= 0 ? 1 : 0;
      }
      const bool near = nearest_mm(found, tip) < 0.2;
      told -= near ? 1U : 0U;
      if (seen >= 0.4 * kPi * 0.25 / (0.12 * 0.12)) {
        ++due;
        missed += near ? 0U : 1U;
      }
    }
    // What is masked stands outside the tablet.
    for (std::size_t i = 0; i < grid->size(); ++i) {
      if (grid->valid[i] != 0 && found.mask[i] != 0) {
        const auto closest = query.closest((pose * grid->point(i).cast<double>()).cast<float>(), 0.1F);
        wrong += closest ? 1U : 0U;
      }
    }
  }
  EXPECT_GE(due, 8U);
  EXPECT_EQ(missed, 0U);
  EXPECT_EQ(told, 0U);
  EXPECT_LE(wrong, 3U);
}

TEST(PinDetection, FindsNothingOnClay) {
  const RangeGrid grid = testing::scan_field(testing::bumpy(3), {}, {});
  const PinDetection found = detect_pins(grid, 1.5, {});
  EXPECT_TRUE(found.tips.empty());
  EXPECT_EQ(masked(found), 0U);
}

TEST(PinDetection, TakesNoSpecksAndBumpsForTips) {
  RangeGrid grid = slab_with_pins({}, {});
  Random random(9);
  for (int k = 0; k < 300; ++k) {  // outliers, and specks of a few samples
    const auto row = static_cast<int>(random.below(290));
    const std::size_t i = grid.index(row, static_cast<int>(random.below(390)));
    const int side = k % 3;
    for (int dr = 0; dr <= side; ++dr) {
      for (int dc = 0; dc <= side; ++dc) {
        const std::size_t j = i + static_cast<std::size_t>(dr * grid.cols + dc);
        grid.x[j] = static_cast<float>(0.1 * (grid.col_of(j) - 200));
        grid.y[j] = static_cast<float>(0.1 * (grid.row_of(j) - 150));
        grid.z[j] = static_cast<float>(3 + 0.05 * k + 0.01 * random.normal());
        grid.valid[j] = 1;
      }
    }
  }
  for (std::size_t i = 0; i < grid.size(); ++i) {  // half balls of a tip's size on the clay
    for (const double at : {-9.0, -3.0, 4.0, 10.0}) {
      const double d2 = std::pow(grid.x[i] - at, 2) + std::pow(grid.y[i] - 5, 2);
      if (grid.valid[i] != 0 && std::abs(grid.z[i]) < 0.1 && d2 < 0.36) {
        grid.z[i] += static_cast<float>(std::sqrt(0.36 - d2));
      }
    }
  }
  const PinDetection found = detect_pins(grid, 1.2, {});
  EXPECT_TRUE(found.tips.empty());
}

TEST(PinDetection, TellsACutArmFromATip) {
  std::vector<SlabPin> pins = kThreePins;
  pins[1].ball = false;
  const PinDetection found = detect_pins(slab_with_pins(pins, {}), 1.2, {});
  EXPECT_EQ(found.tips.size(), 2U);
  EXPECT_GT(nearest_mm(found, pins[1].tip_mm), 2.0);
}

TEST(PinDetection, TakesNoTipOfAnotherDiameter) {
  const RangeGrid grid = slab_with_pins(kThreePins, {});
  EXPECT_TRUE(detect_pins(grid, 2.4, {}).tips.empty());
  EXPECT_TRUE(detect_pins(grid, 0.6, {}).tips.empty());
}

TEST(PinDetection, TakesGridsOfAnyShape) {
  EXPECT_TRUE(detect_pins(RangeGrid{}, 1.0, {}).tips.empty());
  for (const auto& [rows, cols] : {std::pair{1, 50}, std::pair{50, 1}, std::pair{2, 2}, std::pair{1, 1}}) {
    RangeGrid grid;
    grid.allocate(rows, cols);
    grid.spacing_mm = 0.1;
    EXPECT_EQ(masked(detect_pins(grid, 1.0, {})), 0U);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      grid.x[i] = 0.1F * static_cast<float>(grid.col_of(i));
      grid.y[i] = 0.1F * static_cast<float>(grid.row_of(i));
      grid.z[i] = i % 7 == 3 ? std::numeric_limits<float>::quiet_NaN() : 0.0F;
      grid.valid[i] = 1;
    }
    const PinDetection found = detect_pins(grid, 1.0, {});
    EXPECT_TRUE(found.tips.empty());
    EXPECT_EQ(found.mask.size(), grid.size());
  }
  EXPECT_TRUE(detect_pins(slab_with_pins(kThreePins, {}), 0.0, {}).tips.empty());
  EXPECT_TRUE(detect_pins(slab_with_pins(kThreePins, {}), -1.0, {}).tips.empty());
}

TEST(LabelledTips, MoveOntoWhatWasFound) {
  const std::vector<SeenPin> found{{-1, {0, 0, 0}}, {-1, {1.6, 0, 0}}, {-1, {20, 0, 0}}};
  // The first click is nearest to the second tip, and the second click nearer still.
  const std::vector<SeenPin> out =
      labelled_tips(found, {{3, {0.9, 0, 0}}, {4, {1.5, 0.2, 0}}, {7, {9, 9, 9}}}, 1.0);
  ASSERT_EQ(out.size(), 4U);
  EXPECT_EQ(out[0].label, 3);
  EXPECT_EQ(out[0].position_mm, found[0].position_mm);
  EXPECT_EQ(out[1].label, 4);
  EXPECT_EQ(out[1].position_mm, found[1].position_mm);
  EXPECT_EQ(out[2].label, 7);
  EXPECT_GT(out[2].covariance_mm2(0, 0), 0.1);
  EXPECT_EQ(out[3].label, -1);
}

}  // namespace
}  // namespace dubsar
