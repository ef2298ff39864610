// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <cmath>

#include "core/units.h"
#include "formats/grid_reader.h"
#include "tests/formats/format_support.h"

namespace dubsar {
namespace {

using ::testing::HasSubstr;

/// Of a cylinder of 6 mm, a row for every degree of a turntable.
std::string turned_once(int degrees) {
  constexpr int kColumns = 20;
  std::string text = "ply\nformat ascii 1.0\nobj_info num_cols 20\nobj_info num_rows " +
                     std::to_string(degrees) + "\nobj_info dubsar_direction -1 0 0\nelement vertex " +
                     std::to_string(degrees * kColumns) +
                     "\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  for (int row = 0; row < degrees; ++row) {
    // The scanner stands where the middle row is.
    const double angle_rad = (row - 0.5 * degrees) * kPi / 180;
    for (int col = 0; col < kColumns; ++col) {
      text += std::to_string(6 * std::cos(angle_rad)) + " " + std::to_string(6 * std::sin(angle_rad)) + " " +
              std::to_string(0.1 * col + 0.1) + "\n";
    }
  }
  return text;
}

TEST(AllRoundScan, IsTold) {
  std::vector<std::string> told;
  const GridReadOptions options{
      .remark = [&](const std::string& /*scan*/, const std::string& remark) { told.push_back(remark); }};
  for (const int degrees : {300, 350, 360, 380}) {
    told.clear();
    EXPECT_TRUE(read_scan_bytes(turned_once(degrees), "a.ply", options).has_value());
    ASSERT_EQ(told.size(), 1U) << degrees;
    EXPECT_THAT(told[0], HasSubstr("it is seen from all sides, while a range grid shows one")) << degrees;
  }
  told.clear();
  EXPECT_TRUE(read_scan_bytes(turned_once(120), "a.ply", options).has_value());
  EXPECT_TRUE(told.empty());
}

}  // namespace
}  // namespace dubsar
