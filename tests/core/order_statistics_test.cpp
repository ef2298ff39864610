// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/order_statistics.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/random.h"

namespace dubsar {
namespace {

TEST(OrderStatistics, RanksCountFromTheLeast) {
  std::vector<int> values{5, 1, 4, 1, 3};
  EXPECT_EQ(value_at_rank(values, 0), 1);
  EXPECT_EQ(value_at_rank(values, 1), 1);
  EXPECT_EQ(value_at_rank(values, 2), 3);
  EXPECT_EQ(value_at_rank(values, 4), 5);
  std::array<double, 3> three{0.3, 0.1, 0.2};
  EXPECT_EQ(value_at_rank(three, 1), 0.2);
}

TEST(OrderStatistics, OfTwoMiddleValuesTheMedianIsTheUpperAndTheListStays) {
  const std::vector<float> values{4, 1, 3, 2};
  EXPECT_EQ(median_of(values), 3.0F);
  EXPECT_EQ(values, (std::vector<float>{4, 1, 3, 2}));
  EXPECT_EQ(median_of(std::vector<int>{7}), 7);
}

TEST(OrderStatistics, TheMedianOfAbsoluteValuesTellsTheStandardDeviation) {
  Random random(3);
  std::vector<double> off(200'000);
  for (double& value : off) {
    value = std::abs(0.02 * random.normal());
  }
  // Its own standard deviation is 1.17 over the root of the count: 0.26 %.
  EXPECT_NEAR(kSigmaOfMedian * median_of(off), 0.02, 3 * 0.0026 * 0.02);
}

}  // namespace
}  // namespace dubsar
