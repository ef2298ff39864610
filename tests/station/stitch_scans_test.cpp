// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What the command and the Python module both do and say of the scans that they stitch.

#include "station/stitch_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "station/stitch_warnings.h"
#include "tests/station/support/bumpy_scans.h"

namespace dubsar {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

class StitchScans : public ::testing::Test {
 protected:
  /// Scan `number`, something held `held_mm` over the middle of it, where that is not 0.
  void take(int number, float held_mm = 0) {
    RangeGrid grid = test::bumpy_scan(number);
    for (std::size_t i = 0; i < grid.size(); ++i) {
      const bool is_under = std::max(std::abs(grid.x[i]), std::abs(grid.y[i])) < 4.0F;
      grid.z[i] += is_under ? held_mm : 0.0F;
    }
    grid.source = test::scan_name(number);
    scans.push_back(prepare_scan(number, std::move(grid), std::nullopt));
    ScanPose& pose = poses.emplace_back();
    pose.id = number;
    pose.status = PoseStatus::kRegistered;
    pose.model_from_scanner = test::bumpy_pose(number);
    names[number] = scans.back().file;
  }
  [[nodiscard]] Result<std::vector<ForeignFound>> add() {
    return add_without_foreign(stitcher, scans, poses, job);
  }

  JobContext job;
  std::vector<StationScan> scans;
  std::vector<ScanPose> poses;
  std::map<int, std::string> names;
  Stitcher stitcher;
};

TEST_F(StitchScans, LeavesOutWhatWasInTheWay) {
  constexpr float kHeldMm = 6;
  take(0, kHeldMm);
  for (const int other : {1, 2, 3}) {
    take(other);
  }
  const auto foreign = add();
  ASSERT_TRUE(foreign) << foreign.error().line();
  ASSERT_THAT(*foreign, SizeIs(1));
  EXPECT_EQ(foreign->front().id, 0);
  EXPECT_GT(foreign->front().foreign_mm2, 30);
  double highest_mm = 0;
  for (const Eigen::Vector3f& p : stitcher.mesh().positions) {
    highest_mm = std::max<double>(highest_mm, p.z());
  }
  EXPECT_LT(highest_mm, *std::ranges::max_element(scans[1].grid->z) + 1.5);
}

TEST_F(StitchScans, NoCopyComesInThePlaceOfAScanOfWhichNothingIsLeft) {
  for (const int number : {0, 1, 2, 3}) {
    take(number);
  }
  poses[0].model_from_scanner.translation_mm.z() += 10;
  scans.push_back(prepare_scan(7, RangeGrid(*scans[0].grid), std::nullopt));
  poses.push_back(poses[0]);
  poses.back().id = 7;
  const auto foreign = add();
  ASSERT_TRUE(foreign) << foreign.error().line();
  ASSERT_THAT(*foreign, SizeIs(1));
  ASSERT_TRUE(foreign->front().is_all());
  const std::vector<ScanCopy> copies = take_out_with_copies(stitcher, foreign->front());
  ASSERT_THAT(copies, SizeIs(1));
  EXPECT_EQ(copies.front().of_id, foreign->front().id);
  double highest_mm = 0;
  for (const Eigen::Vector3f& p : stitcher.mesh().positions) {
    highest_mm = std::max<double>(highest_mm, p.z());
  }
  EXPECT_LT(highest_mm, *std::ranges::max_element(scans[1].grid->z) + 1.5);
}

TEST_F(StitchScans, TakesNoScanThatIsNotRegistered) {
  take(0);
  take(1);
  take(2);
  poses[1].status = PoseStatus::kUnsure;
  poses.pop_back();
  ASSERT_TRUE(add());
  EXPECT_TRUE(stitcher.remove(0));
  EXPECT_FALSE(stitcher.remove(1));
  EXPECT_FALSE(stitcher.remove(2));
}

TEST_F(StitchScans, NamesAScanThatLiesTooFarAway) {
  take(0);
  take(1);
  poses[1].model_from_scanner.translation_mm.x() = 1e9;
  const auto foreign = add();
  ASSERT_FALSE(foreign);
  EXPECT_EQ(foreign.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(foreign.error().where, test::scan_name(1));
}

TEST_F(StitchScans, SaysWhichPosesLookWrong) {
  for (const int number : {0, 1, 2}) {
    take(number);
  }
  ASSERT_TRUE(add());
  EXPECT_THAT(warnings_of_places(stitcher, names), IsEmpty());
  stitcher.remove(1);
  poses[1].model_from_scanner.translation_mm.z() += 1.0;
  poses[2].model_from_scanner.translation_mm.x() += 100.0;
  stitcher.remove(0);
  stitcher.remove(2);
  ASSERT_TRUE(add());
  EXPECT_THAT(warnings_of_places(stitcher, names),
              ElementsAre(HasSubstr(test::scan_name(2) + " overlaps no other scan where its pose puts it"),
                          AllOf(HasSubstr("scans 0 and 1 lie "), HasSubstr("register them again"))));
}

TEST_F(StitchScans, SaysWhatIsNoPartOfTheMesh) {
  EXPECT_EQ(left_out_sentence("a.ply", "unsure", "two places fit"),
            "a.ply is left out: unsure, two places fit");
  EXPECT_EQ(left_out_sentence("a.ply", "failed", ""), "a.ply is left out: failed");
  EXPECT_EQ(left_out_sentence("a.ply", "", copy_reason({.id = 1, .of_id = 0}, {{0, "b.ply"}, {1, "a.ply"}})),
            "a.ply is left out: it has the very samples of b.ply, and counts as the same scan");
  const Status none = check_has_surface({}, "scans");
  ASSERT_FALSE(none);
  EXPECT_THAT(none.error().line(), HasSubstr("scans: its scans have no surface"));
}

TEST_F(StitchScans, TellsSizesThatCannotBe) {
  take(0);
  RangeGrid grid = *scans[0].grid;
  EXPECT_THAT(size_fault(grid), IsEmpty());
  for (std::vector<float>* axis : {&grid.x, &grid.y, &grid.z}) {
    std::ranges::for_each(*axis, [](float& mm) { mm *= 1e-4F; });
  }
  grid.spacing_mm *= 1e-4;
  EXPECT_THAT(size_fault(grid), HasSubstr("mm across"));
}

}  // namespace
}  // namespace dubsar
