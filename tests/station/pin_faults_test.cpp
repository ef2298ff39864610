// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "station/pin_faults.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>

namespace dubsar {
namespace {

using ::testing::HasSubstr;

/// 21 x 21 samples, 1 mm apart, in the plane z = 0.
RangeGrid plate() {
  RangeGrid grid;
  grid.allocate(21, 21);
  for (int row = 0; row < 21; ++row) {
    for (int col = 0; col < 21; ++col) {
      const std::size_t i = grid.index(row, col);
      grid.x[i] = static_cast<float>(col - 10);
      grid.y[i] = static_cast<float>(row - 10);
      grid.valid[i] = 1;
    }
  }
  return grid;
}

std::string fault(const std::vector<PinTip>& tips) {
  const auto error = misplaced_tips({1.0, {{5, tips}}}, 5, plate(), "a.ply");
  return error ? error->line() : "";
}

TEST(PinFaults, TipsBesideTheSamplesAreRight) {
  EXPECT_EQ(fault({{-1, {3, 4, 1}}, {-1, {-9, 2, 3.5}}, {-1, {12, 0, 0}}}), "");
  EXPECT_EQ(fault({{-1, {3, 4, 1}}, {-1, {-9, 2, 20}}}), "") << "one may be hidden in this scan";
  EXPECT_EQ(fault({{-1, {0, 0, 0.01}}}), "") << "one alone cannot be in another";
  EXPECT_EQ(fault({}), "");
  EXPECT_FALSE(misplaced_tips({1.0, {{5, {{-1, {900, 0, 0}}}}}}, 4, plate(), "a.ply")) << "of another scan";
}

TEST(PinFaults, TipsAwayFromAllSamplesAreTold) {
  EXPECT_THAT(fault({{-1, {3, 4, 1}}, {-1, {-9, 2, 45}}}),
              HasSubstr("a.ply: its pins cannot be right: 1 of them lie farther outside"));
  EXPECT_THAT(fault({{-1, {3, 4, 9}}, {-1, {-9, 2, 4.5}}}), HasSubstr("none of them lies within 4 mm"));
  EXPECT_THAT(fault({{-1, {3000, 4000, 1000}}, {-1, {-9000, 2000, 3500}}}), HasSubstr("2 of them"));
}

TEST(PinFaults, TipsInOneAnotherAreTold) {
  EXPECT_THAT(fault({{-1, {0.003, 0.004, 0.001}}, {-1, {-0.009, 0.002, 0.003}}}),
              HasSubstr("all of them lie in one another"));
}

TEST(PinFaults, ScansThatAreNotThereAreTold) {
  const PinSet pins{1.0, {{0, {}}, {3, {}}, {77, {}}}};
  const std::array<int, 3> ids{0, 1, 3};
  const auto error = tips_of_no_scan(pins, ids, "pins.json");
  ASSERT_TRUE(error.has_value());
  EXPECT_THAT(error->line(), HasSubstr("pins.json: it has pins of scan 77, which is not there"));
  const std::array<int, 2> all{3, 77};
  EXPECT_THAT(tips_of_no_scan(pins, all, "pins.json")->line(), HasSubstr("scan 0,"));
  const std::array<int, 4> more{0, 3, 5, 77};
  EXPECT_FALSE(tips_of_no_scan(pins, more, "pins.json"));
}

}  // namespace
}  // namespace dubsar
