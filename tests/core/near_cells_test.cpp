// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/near_cells.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/random.h"

namespace dubsar {
namespace {

using ::testing::IsEmpty;

TEST(NearCells, FindsAllThatLieWithinOneEdge) {
  constexpr double kEdgeMm = 0.3;
  Random random(5);
  const auto place = [&] {
    return Eigen::Vector3d(random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-2, 2));
  };
  NearCells cells(kEdgeMm);
  std::vector<Eigen::Vector3d> places;
  for (std::size_t k = 0; k < 300; ++k) {
    places.push_back(place());
    cells.add(places.back(), k);
  }
  std::size_t within = 0;
  for (int trial = 0; trial < 1000; ++trial) {
    const Eigen::Vector3d p = place();
    const auto found = cells.about(p);
    EXPECT_TRUE(std::ranges::is_sorted(found)) << "in the order of their adding";
    for (std::size_t k = 0; k < places.size(); ++k) {
      if ((places[k] - p).norm() <= kEdgeMm) {
        ++within;
        EXPECT_TRUE(std::ranges::binary_search(found, k));
      }
    }
  }
  EXPECT_GT(within, 100U);
}

TEST(NearCells, FindsFarAwayPlacesAndNothingWhereNothingIs) {
  NearCells cells(1e-3);
  const Eigen::Vector3d far(4e5, -4e5, 1e300);
  cells.add(far, 7);
  EXPECT_THAT(cells.about(far), ::testing::ElementsAre(7U));
  EXPECT_THAT(cells.about({0, 0, 0}), IsEmpty());
}

}  // namespace
}  // namespace dubsar
