// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// What is told of poses that are off, and how little they harm.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <utility>

#include "core/random.h"
#include "sim/scanner.h"
#include "tests/triangulation/support/ball_scans.h"
#include "tests/triangulation/support/evenly_spread.h"
#include "tests/triangulation/support/simulated_tablet.h"
#include "triangulation/mesh_check.h"
#include "triangulation/pairing.h"
#include "triangulation/pose_step.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {
namespace {

using test::stitched;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

Stitcher holding(const test::ScanSet& set) {
  Stitcher stitcher;
  EXPECT_TRUE(stitcher.add(set.placed, JobContext{}));
  return stitcher;
}

/// Six sides of a ball, of poses that nobody tells anything of; the third is off.
test::ScanSet ball_with_one_off(const Eigen::Vector3d& off_mm) {
  test::ScanSet set = test::ball();
  for (PlacedScan& scan : set.placed) {
    scan.sigma_mm = 0;
  }
  set.placed[2].model_from_scanner.translation_mm += off_mm;
  return set;
}

const Eigen::Vector3d kOff(0.12, 0.1, 0.12);  // 0.2 mm

struct Found {
  double error_mm = 0, ratio = 0, reliability = 0;
};
/// RMS distance from the ball, RMS of it over sigma, mean reliability.
Found found(const Mesh& mesh, int least_scans, int most_scans) {
  Found sum;
  double count = 0;
  for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
    if (mesh.scans[v] < least_scans || mesh.scans[v] > most_scans) {
      continue;
    }
    const double error_mm = mesh.positions[v].cast<double>().norm() - test::kRadius;
    sum.error_mm += error_mm * error_mm;
    sum.ratio += std::pow(error_mm / static_cast<double>(mesh.sigma_mm[v]), 2);
    sum.reliability += static_cast<double>(mesh.reliability[v]);
    ++count;
  }
  EXPECT_GT(count, 100);
  return {std::sqrt(sum.error_mm / count), std::sqrt(sum.ratio / count), sum.reliability / count};
}

TEST(PosesThatAreOff, TrueOnesOfNoisyScansAreNot) {
  const test::SimulatedTablet tablet({12, 9, 5});
  sim::ScannerOptions options;
  options.spacing_mm = 0.1;
  options.noise_mm = 0.04;
  const sim::TriangulationScanner scanner(options);
  test::ScanSet set;
  JobContext job;
  constexpr int kScans = 12;
  for (int k = 0; k < kScans; ++k) {
    const RigidTransform pose = test::tablet_from_scanner(k, kScans);
    auto grid = scanner.scan_grid(tablet.scene(), pose, static_cast<std::uint64_t>(k) + 1, job);
    ASSERT_TRUE(grid.has_value());
    set.add(std::move(*grid), pose);
  }
  for (const Stitcher::Overlap& overlap : holding(set).overlaps()) {
    EXPECT_FALSE(overlap.is_off()) << overlap.id << " " << overlap.other_id << " " << overlap.step_mm;
  }
}

TEST(PosesThatAreOff, OneIsToldByItsPairsAndNoOthers) {
  std::size_t told = 0;
  for (const Stitcher::Overlap& overlap : holding(ball_with_one_off(kOff)).overlaps()) {
    EXPECT_FALSE(overlap.is_off() && overlap.id != 2 && overlap.other_id != 2)
        << overlap.id << " " << overlap.other_id << " " << overlap.step_mm;
    told += overlap.is_off() ? 1 : 0;
  }
  EXPECT_GE(told, 2U);
  const std::map<int, double> moved_mm = holding(ball_with_one_off(kOff)).moved_mm();
  ASSERT_EQ(moved_mm.size(), 1U);
  EXPECT_NEAR(moved_mm.at(2), kOff.norm(), 0.03);
  const Stitcher true_ones = holding(ball_with_one_off({0, 0, 0}));
  for (const Stitcher::Overlap& overlap : true_ones.overlaps()) {
    EXPECT_EQ(overlap.step_mm, 0.0);
  }
  EXPECT_THAT(true_ones.moved_mm(), IsEmpty());
}

TEST(PosesThatAreOff, OneThatIsFixedStaysAndTheOthersAreLaidAgainstIt) {
  test::ScanSet set = ball_with_one_off(kOff);
  set.placed[2].is_fixed = true;
  const Stitcher stitcher = holding(set);
  const std::map<int, double> moved_mm = stitcher.moved_mm();
  EXPECT_FALSE(moved_mm.contains(2));
  ASSERT_EQ(moved_mm.size(), set.placed.size() - 1);
  for (const auto& [id, mm] : moved_mm) {
    EXPECT_NEAR(mm, kOff.norm(), 0.05) << id;
  }
  // Two that contradict each other stay both, and are told.
  set.placed[0].is_fixed = true;
  const Stitcher both = holding(set);
  EXPECT_FALSE(both.moved_mm().contains(0) || both.moved_mm().contains(2));
  EXPECT_TRUE(std::ranges::any_of(both.overlaps(), [](const Stitcher::Overlap& o) { return o.is_off(); }));
}

TEST(PosesThatAreOff, OneSaysSoInSigmaAndReliabilityThoughNobodyToldIt) {
  const test::ScanSet set = ball_with_one_off(kOff);
  const Mesh mesh = stitched(set);
  EXPECT_TRUE(check_mesh(mesh).is_manifold());
  const Found alone = found(mesh, 1, 1);
  EXPECT_LT(alone.ratio, 1.5);
  EXPECT_GT(alone.ratio, 0.5);
  EXPECT_LT(alone.reliability, found(stitched(ball_with_one_off({0, 0, 0})), 1, 1).reliability - 0.03);
}

TEST(PosesThatAreOff, OneIsLaidWhereTheOthersHaveIt) {
  const double true_mm = found(stitched(ball_with_one_off({0, 0, 0})), 1, 255).error_mm;
  EXPECT_LT(found(stitched(ball_with_one_off(kOff)), 1, 255).error_mm, 1.5 * true_mm);
}

TEST(PosesThatAreOff, AllOfThemStillGiveOneClosedSurface) {
  constexpr int kScans = 12;
  constexpr double kShiftMm = 0.4;  // of four spacings
  const test::SimulatedTablet tablet({12, 9, 5});
  sim::ScannerOptions options;
  options.spacing_mm = 0.1;
  options.noise_mm = 0.02;
  const sim::TriangulationScanner scanner(options);
  test::ScanSet set;
  JobContext job;
  Random random(5);
  for (int k = 0; k < kScans; ++k) {
    RigidTransform pose = test::tablet_from_scanner(k, kScans);
    auto grid = scanner.scan_grid(tablet.scene(), pose, static_cast<std::uint64_t>(k) + 1, job);
    ASSERT_TRUE(grid.has_value());
    pose.translation_mm += kShiftMm * random.normal3().normalized();
    set.add(std::move(*grid), pose);
  }
  const Mesh mesh = stitched(set);
  const MeshReport report = check_mesh(mesh);
  EXPECT_TRUE(report.is_manifold());
  EXPECT_EQ(report.self_intersections, 0U);
  EXPECT_EQ(report.components, 1U);
  EXPECT_LT(report.boundary_length_mm, 2.0) << "19 mm where scans stay where their poses put them";
  EXPECT_GT(std::ranges::count_if(holding(set).overlaps(), [](const auto& o) { return o.is_off(); }), 6);
}

TEST(PosesThatAreOff, OneHardlyMovesTheOthers) {
  const double true_mm = found(stitched(ball_with_one_off({0, 0, 0})), 2, 255).error_mm;
  test::ScanSet set = ball_with_one_off(kOff);
  // As if it weighed like the others it would be 8.4 times.
  EXPECT_LT(found(stitched(set), 2, 255).error_mm, 6.5 * true_mm);
  set.placed[2].sigma_mm = 0.2;  // told
  EXPECT_LT(found(stitched(set), 2, 255).error_mm, 6.5 * true_mm);
}

/// What is told of all poses holds of where they lie together, however well two scans of them agree once one
/// was moved: no overlap shows an error that they share.
TEST(PosesThatAreOff, WhatIsToldOfAllOfThemOutlivesTheMotionOfOne) {
  const auto sigma_mm = [](const Eigen::Vector3d& off_mm) {
    test::ScanSet set = ball_with_one_off(off_mm);
    for (PlacedScan& scan : set.placed) {
      scan.sigma_mm = 0.15;
    }
    const Mesh mesh = stitched(set);
    std::vector<float> of_several;
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) {
      if (mesh.scans[v] > 1) {
        of_several.push_back(mesh.sigma_mm[v]);
      }
    }
    std::ranges::sort(of_several);
    return static_cast<double>(of_several[of_several.size() / 20]);  // those of the scan that was moved
  };
  const double mean_mm = 0.15 / std::sqrt(3.0 * 6);
  EXPECT_GT(sigma_mm({0, 0, 0}), mean_mm);
  EXPECT_GT(sigma_mm(kOff), mean_mm) << "the motion of one took it off all";
}

struct Measured {
  std::size_t nodes = 0;  ///< with a pair
  PoseStep step;
};
/// Two flat scans of so many samples along either side, the second 0.03 mm above the first.
Measured measured_above(int side) {
  test::ScanSet set;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    Random random(seed);
    const auto noise = [&](double, double) { return 0.005 * random.normal(); };
    set.add(test::height_grid(side, side, 0.05, noise), {});
  }
  set.placed[1].model_from_scanner.translation_mm.z() += 0.03;
  const StitchSurface below = make_scan_surface(set.placed[0], {});
  const StitchSurface above = make_scan_surface(set.placed[1], {});
  const double reach_mm = pair_reach_mm(below, above, {});
  const Pairs there = find_pairs(below, above, reach_mm, {});
  return {there.nodes, pose_step(below, there, above, find_pairs(above, below, reach_mm, {}))};
}

TEST(PosesThatAreOff, OfALargeOverlapAPartTellsTheStep) {
  const Measured few = measured_above(200);
  EXPECT_GT(few.step.count, few.nodes + few.nodes / 2) << "either way at nearly all of them";
  const Measured many = measured_above(520);
  ASSERT_GT(many.nodes, 16000U);
  EXPECT_LT(many.step.count, many.nodes + many.nodes / 2);
  EXPECT_NEAR(many.step.step_mm(), few.step.step_mm(), 0.001);
  EXPECT_NEAR(many.step.step_mm(), 0.03, 0.006);
}

TEST(PosesThatAreOff, OneThatGoesLeavesNoTrace) {
  const test::ScanSet set = ball_with_one_off(kOff);
  Stitcher stitcher = holding(set);
  const Mesh all = stitched(set);
  test::expect_same(stitcher.mesh(), all);
  EXPECT_TRUE(stitcher.remove(2));
  test::ScanSet without = ball_with_one_off(kOff);
  without.placed.erase(without.placed.begin() + 2);
  test::expect_same(stitcher.mesh(), stitched(without));
  ASSERT_TRUE(stitcher.add(set.placed[2], JobContext{}));
  test::expect_same(stitcher.mesh(), all);
}

TEST(WithoutSurface, ScansOfOneRowOrOnePlaceAreTold) {
  const auto flat = [](double, double) { return 0.0; };
  test::ScanSet set;
  set.add(test::height_grid(30, 30, 0.1, flat), {});
  set.add(test::height_grid(1, 30, 0.1, flat), {});
  RangeGrid one_place = test::height_grid(30, 30, 0.1, flat);
  std::fill(one_place.x.begin(), one_place.x.end(), 0.5F);
  std::fill(one_place.y.begin(), one_place.y.end(), 0.5F);
  one_place.spacing_mm = 0.1;
  set.add(std::move(one_place), {});
  EXPECT_THAT(holding(set).without_surface(), ElementsAre(1, 2));
  set.placed.resize(1);
  EXPECT_THAT(holding(set).without_surface(), IsEmpty());
}

}  // namespace
}  // namespace dubsar
