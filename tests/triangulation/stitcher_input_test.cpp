// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What a stitcher is given, and when it is told to stop.

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "tests/triangulation/support/ball_scans.h"

namespace dubsar {
namespace {

using test::ball;
using test::expect_same;
using test::stitched;

TEST(StitcherInput, PosesInTheNumbersOfAMapAreRefused) {
  test::ScanSet set = ball();
  for (PlacedScan& scan : set.placed) {
    scan.model_from_scanner.translation_mm.x() += 1e6;
  }
  const JobContext job;
  const Result<Mesh> mesh = stitch(set.placed, {}, job);
  ASSERT_FALSE(mesh);
  EXPECT_EQ(mesh.error().kind, ErrorKind::kBadInput);
  EXPECT_EQ(
      mesh.error().line(),
      "scan 0: its pose puts it 1000 m from the origin, too far for its samples to keep their places to "
      "a small part of their spacing; take the offset of a map or a room from all poses, or mend this "
      "one");
}

TEST(StitcherInput, PosesAMetreAwayAreNot) {
  test::ScanSet set = ball();
  for (PlacedScan& scan : set.placed) {
    scan.model_from_scanner.translation_mm += Eigen::Vector3d(1200, -900, 2000);
  }
  EXPECT_FALSE(stitched(set).faces.empty());
}

/// As 0, which says as little.
TEST(StitcherInput, AConfidenceThatIsNoNumberIsNone) {
  const auto with_confidence = [](float confidence) {
    test::ScanSet set = ball();
    for (RangeGrid& grid : set.grids) {
      grid.confidence.assign(grid.size(), confidence);
    }
    return stitched(set);
  };
  const Mesh none = with_confidence(0.0F);
  expect_same(with_confidence(std::numeric_limits<float>::quiet_NaN()), none);
  expect_same(with_confidence(-3.0F), none);
}

/// The last stages take as long as any.
TEST(StitcherInput, AJobThatIsCancelledLateEndsThere) {
  const test::ScanSet set = ball();
  for (const std::string last : {"close seams", "repair intersections"}) {
    std::vector<std::string> stages;
    JobContext* running = nullptr;
    JobContext job([&](std::string_view stage, double) {
      stages.emplace_back(stage);
      if (stage == last) {
        running->cancel();
      }
    });
    running = &job;
    const Result<Mesh> mesh = stitch(set.placed, {}, job);
    ASSERT_FALSE(mesh);
    EXPECT_EQ(mesh.error().kind, ErrorKind::kCancelled);
    EXPECT_EQ(stages.back(), last);
  }
}

}  // namespace
}  // namespace dubsar
