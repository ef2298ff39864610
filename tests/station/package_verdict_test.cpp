// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "station/package_content.h"

namespace dubsar {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;

/// README and the bag's label are read before the report, which lists the places.
TEST(PackageVerdict, SaysHowMuchIsOutOfReach) {
  const auto excused = [](Excuse why, double area_mm2) {
    RedRegion region;
    region.state = RegionState::kExcused;
    region.excuse = why;
    region.area_mm2 = area_mm2;
    return region;
  };
  RedMap map;
  map.regions = {excused(Excuse::kUnneeded, 0.2)};
  EXPECT_THAT(conclusive_words(map), EndsWith("is sampled densely enough."));
  map.regions.push_back(excused(Excuse::kUnreachable, 1.5));
  EXPECT_THAT(conclusive_words(map), HasSubstr(" 1 place is out of its reach, 1.50 mm² by estimate: "));
  map.regions.push_back(excused(Excuse::kUnreachable, 1900));
  EXPECT_THAT(conclusive_words(map), HasSubstr(" 2 places are out of its reach, 1901.5 mm² by estimate: "));
}

}  // namespace
}  // namespace dubsar
