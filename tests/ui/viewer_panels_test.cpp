// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
// What stands beside the surface in the viewer: views, overlays with their legends, the tape, the table.

#include <gtest/gtest.h>

#include <fstream>
#include <iterator>
#include <regex>
#include <string>

#include "tests/ui/support/on_a_tablet.h"
#include "tests/ui/support/read_png.h"

namespace dubsar {
namespace {

using ViewerPanels = test::OnATablet;

/// Share of the pixels in which two pictures of one size differ clearly.
double unlike(const Image& a, const Image& b) {
  if (a.width != b.width || a.height != b.height || a.width == 0) {
    return 1;
  }
  int other = 0;
  for (int y = 0; y < a.height; ++y) {
    for (int x = 0; x < a.width; ++x) {
      for (int c = 0; c < 3; ++c) {
        if (std::abs(int{a.rgb(x, y)[c]} - int{b.rgb(x, y)[c]}) > 24) {
          ++other;
          break;
        }
      }
    }
  }
  return static_cast<double>(other) / (a.width * a.height);
}

TEST_F(ViewerPanels, EveryViewHasItsKeyAndItsButton) {
  const auto outcome = play(R"(wait wedges 60
wait whole
expect looks-at.obverse
key 2
wait looks-at.reverse
key 3
wait looks-at.left
key 4
wait looks-at.right
key 5
wait looks-at.top
key 6
wait looks-at.bottom
wait whole
screenshot bottom.png
click view.reverse
wait looks-at.reverse
key 1
wait looks-at.obverse
wait whole
screenshot obverse.png
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(unlike(test::read_png(in("obverse.png")), test::read_png(in("bottom.png"))), 0.05);
}

TEST_F(ViewerPanels, OverlaysHaveLegendsAndFeaturesHistograms) {
  const auto outcome = play(R"(wait wedges 60
wait whole
wait idle
expect graphics-memory
screenshot clay.png
click overlay
click overlay.Reliability
wait legend
click overlay
click overlay.Scans that agree
wait legend
click overlay
click overlay.Sparse and filled
wait legend
click overlay
click overlay.Openness
wait legend
click overlay
click overlay.Height over free surface, mm
wait legend
expect overlay-whole
click overlay
click overlay.Mean curvature, 1/mm
wait legend
wait idle
wait whole
screenshot curvature.png
expect histogram.depth_mm
click feature
click feature.directional_opening_deg
wait histogram.directional_opening_deg
wait idle
screenshot opening.png
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image curvature = test::read_png(in("curvature.png"));
  EXPECT_GT(unlike(test::read_png(in("clay.png")), curvature), 0.1);
  EXPECT_GT(unlike(curvature, test::read_png(in("opening.png"))), 0.0005) << "other bars";
}

TEST_F(ViewerPanels, AFieldThatIsNotKnownHasNotTheColoursOfTheOneBefore) {
  const auto outcome = play(R"(wait wedges 60
wait whole
wait idle
click overlay
click overlay.Clay
wait whole
screenshot clay.png
click overlay
click overlay.Mean curvature, 1/mm
wait legend
wait idle
wait whole
screenshot curvature.png
click overlay
click overlay.Integral invariant
wait stop
click stop
wait idle 60
wait whole
screenshot stopped.png
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  const Image stopped = test::read_png(in("stopped.png"));
  EXPECT_GT(unlike(test::read_png(in("curvature.png")), stopped), 0.1);
  EXPECT_LT(unlike(test::read_png(in("clay.png")), stopped), 0.02);
}

TEST_F(ViewerPanels, WhatIsDoubtedInTheWedgesStandsAboveTheirTable) {
  std::ifstream file(in("tablet.wedges.json"));
  std::string text{std::istreambuf_iterator<char>(file), {}};
  text = std::regex_replace(text, std::regex(R"("text_certainty":[^,]*,)"), R"("text_certainty":0.05,)");
  text = std::regex_replace(text, std::regex(R"("intact":[^,}]*)"), R"("intact":0.5)");
  std::ofstream(in("tablet.wedges.json")) << text;
  const auto outcome = play(R"(wait wedges 60
wait doubt
wait whole
wait idle
screenshot depth.png
click feature
click feature.directional_opening_deg
wait histogram-of-some
wait idle
screenshot opening.png
click wedge.4
wait chosen.4
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_GT(unlike(test::read_png(in("depth.png")), test::read_png(in("opening.png"))), 0.0005);
}

TEST_F(ViewerPanels, TheTapeMeasuresAndTableAndViewChooseInEachOther) {
  const auto outcome = play(R"(wait wedges 60
wait whole
wait idle
click wedge.4
wait chosen.4
wait whole
click surface 0.01 0.02
wait chosen.none
# it is in the middle now
click surface 0.5 0.5
wait chosen.4
click tool-measure
click surface 0.5 0.5
click surface 0.55 0.52
wait measured
quit
)");
  ASSERT_EQ(outcome.status, 0) << outcome.err;
}

}  // namespace
}  // namespace dubsar
