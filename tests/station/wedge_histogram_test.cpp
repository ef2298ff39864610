// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_histogram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "analysis/wedge_features.h"
#include "core/units.h"

namespace dubsar {
namespace {

using ::testing::ElementsAre;

TEST(WedgeHistogram, CountsEveryWedgeOnceBetweenTheLeastAndTheMost) {
  std::vector<Wedge> wedges(5);
  const double depths[] = {0.2, 0.2, 0.3, 0.9, 1.0};
  for (std::size_t k = 0; k < wedges.size(); ++k) {
    wedges[k].depth_mm = depths[k];
    wedges[k].exit_points_mm[0] = {3, 0, 0};
  }
  const WedgeHistogram depth = histogram_of(wedges, 0, 4);
  EXPECT_EQ(depth.least, 0.2);
  EXPECT_EQ(depth.most, 1.0);
  EXPECT_THAT(depth.bins, ElementsAre(3, 0, 0, 2));
  const WedgeHistogram length = histogram_of(wedges, 1, 3);
  EXPECT_EQ(length.least, 3);
  EXPECT_EQ(length.most, 3);
  EXPECT_THAT(length.bins, ElementsAre(5, 0, 0)) << "all are alike";
  EXPECT_THAT(histogram_of({}, 0, 2).bins, ElementsAre(0, 0));
  EXPECT_EQ(depth.note + length.note, "");
}

TEST(WedgeHistogram, AnglesAreThoseOfWedgesThatTheyCanBeReadOf) {
  std::vector<Wedge> wedges(4);
  for (Wedge& wedge : wedges) {
    wedge.intact = kLeastIntact;
    wedge.roundness = kMostRoundness;
    wedge.opening_angles_rad.fill(rad_from_deg(90));
    wedge.depth_mm = 0.5;
  }
  wedges[1].intact = 0.79;
  wedges[2].roundness = 0.021;
  wedges[1].opening_angles_rad.fill(rad_from_deg(150));
  wedges[2].opening_angles_rad.fill(rad_from_deg(150));
  const WedgeHistogram opening = histogram_of(wedges, kWedgeLengths + 1, 2);
  EXPECT_NEAR(opening.most, 90, 1e-9);
  EXPECT_THAT(opening.bins, ElementsAre(2, 0));
  EXPECT_EQ(opening.note, "2 / 4: angles are read where a wedge is known to be whole and sharp");
  EXPECT_THAT(histogram_of(wedges, 0, 2).bins, ElementsAre(4, 0)) << "a depth is there all the same";
  wedges[0].beyond_mesh[0] = true;
  EXPECT_EQ(histogram_of(wedges, 1, 2).note, "3 / 4: of the others the mesh ends before the edge does");
}

}  // namespace
}  // namespace dubsar
