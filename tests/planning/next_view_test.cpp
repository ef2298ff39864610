// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// Which view comes next, and how much it is said to clear.
#include "planning/next_view.h"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "planning/view_prediction.h"
#include "tests/planning/support/pebble.h"

namespace dubsar {
namespace {

/// Red places of a square millimetre each over the top of the pebble, in a row.
std::vector<RedTarget> on_top(int count) {
  std::vector<RedTarget> targets(static_cast<std::size_t>(count));
  for (int k = 0; k < count; ++k) {
    RedTarget& target = targets[static_cast<std::size_t>(k)];
    target.position_mm = target.sample_mm = {0.5 * k - 0.25 * (count - 1), 0, 5.5};
    target.area_mm2 = 1;
  }
  return targets;
}

class NextViewsOfAPebble : public ::testing::Test {
 protected:
  NextViewsOfAPebble() { session_.scan(test::turned(0, 0)); }

  std::vector<NextView> ranked(const std::vector<ViewCandidate>& candidates,
                               const std::vector<RedTarget>& targets, const NextViewOptions& options = {}) {
    JobContext job;
    return next_views(candidates, ScannerModel::of(*session_.grids.front(), 0.02),
                      model_surface(session_.map.scans()), targets, options, job)
        .value()
        .ranked;
  }

 private:
  test::Session session_;
};

ViewCandidate candidate(const RigidTransform& pose, bool by_hand, const std::string& say) {
  ViewCandidate out;
  out.model_from_scanner = pose;
  out.by_hand = by_hand;
  out.say = say;
  return out;
}

TEST_F(NextViewsOfAPebble, OfTwoThatClearAsMuchTheOneThatNeedsNoHandComesFirst) {
  const RigidTransform above = test::turned(0, 0);
  const std::vector<NextView> views =
      ranked({candidate(test::turned(180, 0), false, "from below"), candidate(above, true, "by hand"),
              candidate(above, false, "by motor")},
             on_top(8));
  ASSERT_EQ(views.size(), 2U) << "from below there is nothing to clear";
  EXPECT_EQ(views[0].say, "by motor");
  EXPECT_EQ(views[1].say, "by hand");
  EXPECT_EQ(views[1].predicted_cleared_mm2, views[0].predicted_cleared_mm2) << "a hand clears no less";
}

/// Nobody has looked at them, they face the scanner, and nothing stands before them: nearly sure, and in no
/// case more than there is. Thinned ones stand for the others.
TEST_F(NextViewsOfAPebble, WhatItClearsIsTheAreaThatIsThere) {
  const std::vector<ViewCandidate> above{candidate(test::turned(0, 0), false, "from above")};
  for (const std::size_t most : {std::size_t{1500}, std::size_t{2}}) {
    NextViewOptions options;
    options.max_targets = most;
    const std::vector<NextView> views = ranked(above, on_top(8), options);
    ASSERT_EQ(views.size(), 1U) << most;
    EXPECT_LE(views[0].predicted_cleared_mm2, 8.0 + 1e-9) << most;
    EXPECT_GT(views[0].predicted_cleared_mm2, 5.0) << most;
  }
}

}  // namespace
}  // namespace dubsar
