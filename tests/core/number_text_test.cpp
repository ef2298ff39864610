// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/number_text.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <limits>

#include "core/motion_limits.h"
#include "tests/support/comma_locale.h"

namespace dubsar {
namespace {

std::string fixed_by_printf(double value, int decimals) {
  char text[400];
  std::snprintf(text, sizeof text, "%.*f", decimals, value);
  return text;
}

std::string short_by_printf(double value, int digits) {
  char text[64];
  std::snprintf(text, sizeof text, "%.*g", digits, value);
  return text;
}

TEST(NumberText, OneIsCountedAsOne) {
  EXPECT_EQ(counted(0, "wedge"), "0 wedges");
  EXPECT_EQ(counted(1, "wedge"), "1 wedge");
  EXPECT_EQ(counted(12, "wedge"), "12 wedges");
}

TEST(NumberText, IsWhatPrintfWrites) {
  for (const double value : {0.0, -0.0, 0.5, 1.5, 2.5, -0.04, 0.125, 1e-9, 99.995, 123456789.0, -1e22,
                             std::numeric_limits<double>::max(), std::numeric_limits<double>::infinity()}) {
    for (const int decimals : {0, 2, 6}) {
      EXPECT_EQ(fixed_text(value, decimals), fixed_by_printf(value, decimals));
    }
    for (const int digits : {2, 6, 17}) {
      EXPECT_EQ(short_text(value, digits), short_by_printf(value, digits));
    }
  }
}

TEST(NumberText, KeepsThePointWhereTheHostWritesCommas) {
  const test::CommaLocale comma;
  if (!test::CommaLocale::is_set()) {
    GTEST_SKIP() << "no locale with a decimal comma can be made here";
  }
  EXPECT_EQ(fixed_by_printf(0.5, 1), "0,5");
  EXPECT_EQ(fixed_text(0.5, 2), "0.50");
  EXPECT_EQ(short_text(0.5), "0.5");
  EXPECT_EQ(number_text(0.5), "0.5");
}

}  // namespace
}  // namespace dubsar
