// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
//
// Whole tablets with nothing told of the poses; dubsar-registration and dubsar-false-accepts do the same at
// length.
#include <gtest/gtest.h>

#include "bench/accuracy/gauge.h"
#include "bench/support/true_scans.h"
#include "registration/registrar.h"

namespace dubsar {
namespace {

struct Outcome {
  int registered = 0;
  double normalised_error = 0;  ///< mean over the scans after the first
  int wrong = 0;
  double worst_mm = 0;  ///< displacement of the tablet's middle
};

Outcome register_all(const std::vector<bench::TrueScan>& scans) {
  JobContext job;
  Registrar registrar;
  for (std::size_t k = 0; k < scans.size(); ++k) {
    registrar.add(static_cast<int>(k), scans[k].grid, nullptr, job);
  }
  EXPECT_TRUE(registrar.finalize(job));
  Outcome outcome;
  const std::vector<ScanPose> poses = registrar.poses();
  const ScanPose* first = nullptr;
  for (const ScanPose& pose : poses) {
    if (pose.status != PoseStatus::kRegistered) {
      EXPECT_FALSE(pose.reason.empty());
      continue;
    }
    ++outcome.registered;
    if (first == nullptr) {
      first = &pose;
      continue;
    }
    const bench::PairError error = bench::pair_error(scans, *first, pose);
    outcome.wrong += error.wrong() ? 1 : 0;
    outcome.worst_mm = std::max(outcome.worst_mm, error.shift_mm);
    const bench::TrueScan& scan = scans[static_cast<std::size_t>(pose.id)];
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < scan.grid->size(); ++i) {
      centroid += scan.grid->valid[i] != 0 ? Eigen::Vector3d(scan.grid->point(i).cast<double>())
                                           : Eigen::Vector3d::Zero();
    }
    centroid /= static_cast<double>(scan.grid->valid_count());
    const RigidTransform truth = first->model_from_scanner *
                                 scans[static_cast<std::size_t>(first->id)].tablet_from_scanner.inverse() *
                                 scan.tablet_from_scanner;
    outcome.normalised_error +=
        accuracy::normalised_error(pose, truth, centroid) / static_cast<double>(scans.size() - 1);
  }
  return outcome;
}

TEST(SimulatedTablets, AWrittenOneIsRegisteredFromAnyHandPose) {
  const auto scans =
      bench::true_scans(bench::random_tablet(2, "text", 0.2), {0.2, 0.02, 12, {}, 2, bench::Pins::kNone, 0});
  const Outcome outcome = register_all(scans);
  EXPECT_EQ(outcome.registered, 12);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_LT(outcome.worst_mm, 0.03);
}

TEST(SimulatedTablets, CovariancesAreWhatTheyClaim) {
  double mean = 0;
  for (const std::uint64_t seed : {21, 22, 23}) {
    const auto scans = bench::true_scans(bench::random_tablet(seed, "text", 0.15),
                                         {0.15, 0.02, 12, {}, seed, bench::Pins::kNone, 0});
    mean += register_all(scans).normalised_error / 3.0;
  }
  // 1 when calibrated; three tablets tell it to a factor of two.
  EXPECT_GT(mean, 0.5);
  EXPECT_LT(mean, 2.0);
}

TEST(SimulatedTablets, OnesThatLookTheSameTurnedAreAskedAbout) {
  for (const char* kind : {"blank", "symmetric"}) {
    const auto scans = bench::true_scans(bench::random_tablet(105, kind, 0.2),
                                         {0.25, 0.02, 8, {0, 1, 2, 3, 4, 5}, 105, bench::Pins::kNone, 0});
    EXPECT_EQ(register_all(scans).wrong, 0) << kind;
  }
}

/// Even rulings fit themselves turned by a half: the scans that see nothing else settle no pose.
TEST(SimulatedTablets, ARuledBlankIsAskedAbout) {
  const auto scans =
      bench::true_scans(bench::random_tablet(5, "ruled", 0.2),
                        {.views = 8, .only = {0, 1, 2, 3, 4, 5}, .seed = 5, .ruled_every_mm = 2.5});
  EXPECT_EQ(register_all(scans).wrong, 0);
}

TEST(SimulatedTablets, ScansOfAnotherOneStayOut) {
  auto scans = bench::true_scans(bench::random_tablet(7, "text", 0.2),
                                 {0.25, 0.02, 8, {0, 2, 4}, 7, bench::Pins::kNone, 0});
  sim::TabletOptions other = bench::random_tablet(7, "text", 0.2);
  other.seed = 8;
  for (bench::TrueScan& scan : bench::true_scans(other, {0.25, 0.02, 8, {0, 2}, 8, bench::Pins::kNone, 1})) {
    scans.push_back(std::move(scan));
  }
  EXPECT_EQ(register_all(scans).wrong, 0);
}

/// Fingers hold it by another edge in each third scan: what stands in the air is left out, and the rest says
/// where the scan lies.
TEST(SimulatedTablets, ScansWithFingersInThemAreRegistered) {
  sim::TabletOptions tablet = bench::random_tablet(1, "text", 0.25);
  tablet.size_mm = {48, 36, 18};
  const auto scans = bench::true_scans(tablet, {.spacing_mm = 0.3, .gripped_every = 3});
  const Outcome outcome = register_all(scans);
  EXPECT_GE(outcome.registered, 11);
  EXPECT_EQ(outcome.wrong, 0);
  EXPECT_LT(outcome.worst_mm, 0.05);
}

TEST(SimulatedTablets, FingersMakeNoScanOfAnotherOneFit) {
  const sim::TabletOptions tablet = bench::random_tablet(7, "text", 0.2);
  auto scans = bench::true_scans(
      tablet, {.spacing_mm = 0.25, .views = 8, .only = {0, 2, 4}, .seed = 7, .gripped_every = 2});
  sim::TabletOptions other = tablet;
  other.seed = 8;
  for (bench::TrueScan& scan : bench::true_scans(other, {.spacing_mm = 0.25,
                                                        .views = 8,
                                                        .only = {0, 2},
                                                        .seed = 8,
                                                        .tablet_number = 1,
                                                        .gripped_every = 1})) {
    scans.push_back(std::move(scan));
  }
  EXPECT_EQ(register_all(scans).wrong, 0);
}

}  // namespace
}  // namespace dubsar
