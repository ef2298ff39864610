// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/dilated.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace dubsar {
namespace {

TEST(Dilated, MarksASquare) {
  std::vector<std::uint8_t> marks(100, 0);
  marks[0] = marks[57] = 1;
  const std::vector<std::uint8_t> wide = dilated(marks, 10, 10, 2);
  EXPECT_EQ(std::ranges::count(wide, std::uint8_t{1}), 9 + 25);
  EXPECT_EQ(wide[22] & wide[35] & wide[79], 1);
}

}  // namespace
}  // namespace dubsar
