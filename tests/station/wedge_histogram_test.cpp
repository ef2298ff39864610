// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/wedge_histogram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

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
}

}  // namespace
}  // namespace dubsar
