// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gtest/gtest.h>

#include "acquisition/rig_scan.h"

namespace dubsar {
namespace {

/// A computer whose clock starts in the year 2000 must not take every rig for one that was verified today.
TEST(DaysSince, ReadsOnlyTimesThatAreOver) {
  EXPECT_FALSE(days_since("").has_value());
  EXPECT_FALSE(days_since("yesterday").has_value());
  EXPECT_GT(days_since("2020-01-01T00:00:00Z").value_or(0), 365);
  EXPECT_FALSE(days_since("2999-01-01T00:00:00Z").has_value());
}

}  // namespace
}  // namespace dubsar
