// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Labels of pins that sure poses contradict.
#include "registration/pin_contradiction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "bench/support/true_scans.h"
#include "registration/registrar.h"

namespace dubsar {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::StartsWith;

/// Three pins that stand where they stood, seen from another place by each scan.
ScanPinsInModel pins_of(int id) {
  ScanPinsInModel scan{id, {}, RigidTransform::from_twist({0, 0.1 * id, 0.5 * id}, {1.0 * id, 2, 3})};
  const RigidTransform from_model = scan.model_from_scanner.inverse();
  const Eigen::Vector3d places[] = {{20, 0, 0}, {0, 20, 0}, {-20, 0, 0}};
  for (int k = 0; k < 3; ++k) {
    scan.tips.push_back({k + 1, from_model * places[k]});
  }
  return scan;
}

void swap_first_two(std::vector<SeenPin>& tips) {
  std::swap(tips[0].label, tips[1].label);
}

TEST(PinContradiction, NothingIsSaidOfPinsThatArePutBack) {
  std::vector<ScanPinsInModel> scans{pins_of(0), pins_of(1), pins_of(4)};
  scans[1].tips[0].position_mm.x() += 1.0;
  scans[2].tips[1].label = -1;
  EXPECT_THAT(contradicted_labels(scans), Each(IsEmpty()));
  EXPECT_THAT(contradicted_labels({}), IsEmpty());
}

TEST(PinContradiction, OfScansTheOddOneOutIsNamed) {
  std::vector<ScanPinsInModel> scans{pins_of(0), pins_of(1), pins_of(4)};
  swap_first_two(scans[0].tips);
  EXPECT_THAT(
      contradicted_labels(scans),
      ElementsAre(HasSubstr("has moved: scan 1 shows it 28.3 mm away; put it back, or correct its label"), "",
                  ""));
}

TEST(PinContradiction, AScanAndAPartOfItAreOneWitness) {
  std::vector<ScanPinsInModel> scans{pins_of(0), pins_of(1), pins_of(2), pins_of(4)};
  swap_first_two(scans[0].tips);
  swap_first_two(scans[1].tips);
  scans[1].part_of = 0;
  EXPECT_THAT(contradicted_labels(scans),
              ElementsAre(HasSubstr("scan 2 shows it"), HasSubstr("scan 2 shows it"), "", ""));
  // What the part alone shows it says.
  scans[0].tips.clear();
  scans[3].tips.clear();
  EXPECT_THAT(contradicted_labels(scans), ElementsAre("", "", HasSubstr("scan 1 shows it"), ""));
}

TEST(PinContradiction, OfTwoScansTheLaterOneIsNamed) {
  std::vector<ScanPinsInModel> scans{pins_of(0), pins_of(4)};
  scans[0].tips[2].position_mm.z() += 3.0;
  EXPECT_THAT(contradicted_labels(scans),
              ElementsAre("", StartsWith("pin 3 has moved: scan 0 shows it 3.0 mm away")));
}

TEST(PinContradiction, ThePinThatIsFarthestOffIsNamed) {
  std::vector<ScanPinsInModel> scans{pins_of(0), pins_of(1), pins_of(4)};
  scans[2].tips[0].position_mm.z() += 3.0;
  scans[2].tips[1].position_mm.z() += 5.0;
  EXPECT_THAT(contradicted_labels(scans), ElementsAre("", "", StartsWith("pin 2 has moved")));
}

/// Written clay finds its place whatever the labels say, and they are told of all the same.
TEST(PinContradiction, IsAWarningOfARegisteredScan) {
  const std::vector<bench::TrueScan> scans = bench::true_scans(
      bench::random_tablet(71, "text", 0.2), {0.2, 0.02, 12, {0, 2, 4}, 71, bench::Pins::kLabelled, 0});
  PinSet pins = bench::pin_set(scans, bench::Pins::kLabelled);
  for (const int wrong : {-1, 1}) {
    if (wrong >= 0) {
      std::vector<PinTip>& tips = pins.tips.at(wrong);
      ASSERT_GE(tips.size(), 2U);
      std::swap(tips[0].label, tips[1].label);
    }
    JobContext job;
    Registrar registrar;
    for (std::size_t k = 0; k < scans.size(); ++k) {
      registrar.add(static_cast<int>(k), scans[k].grid, &pins, job);
    }
    ASSERT_TRUE(registrar.finalize(job));
    for (const ScanPose& pose : registrar.poses()) {
      EXPECT_EQ(pose.status, PoseStatus::kRegistered) << pose.id << pose.reason;
      if (pose.id == wrong) {
        EXPECT_THAT(pose.warning, HasSubstr(" has moved: scan ")) << pose.id;
      } else {
        EXPECT_EQ(pose.warning, "") << pose.id;
      }
    }
  }
}

}  // namespace
}  // namespace dubsar
