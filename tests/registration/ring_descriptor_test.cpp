// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/ring_descriptor.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "tests/registration/support/field_views.h"

namespace dubsar {
namespace {

/// What one content is read from must not depend on which others are read beside it: some samples tell
/// nothing of it, and those around a cell are worked out once for all.
TEST(RingDescriptor, OfContentsMadeTogetherAreThoseMadeOneByOne) {
  const PlacedSurface view = testing::field_views(1).front();
  ScanSurface& surface = *std::const_pointer_cast<ScanSurface>(view.surface);
  for (std::size_t i = 0; i < surface.relief.height_mm.size(); ++i) {
    if (surface.medium->grid.x[i] > 5) {
      surface.relief.height_mm[i] = std::numeric_limits<float>::quiet_NaN();
    }
  }
  const RingDescriptorOptions options;
  constexpr std::array kContents{RingContent::kRelief, RingContent::kShape};
  const std::vector<RingDescriptors> together =
      RingDescriptors::make(surface, surface.scale_mm, kContents, options);
  ASSERT_EQ(together.size(), kContents.size());
  EXPECT_LT(together[0].size(), together[1].size());
  for (std::size_t c = 0; c < kContents.size(); ++c) {
    const RingDescriptors alone =
        RingDescriptors::make(surface, surface.scale_mm, {&kContents[c], 1}, options).front();
    ASSERT_EQ(together[c].size(), alone.size());
    ASSERT_GT(alone.size(), 100U);
    // Each is its own nearest, with nothing between.
    std::size_t same = 0;
    for (const RingDescriptors::Match& match : RingDescriptors::match(together[c], alone, options)) {
      same += match.source == match.target && match.distance < 1e-3F ? 1 : 0;
    }
    EXPECT_EQ(same, alone.size());
  }
}

}  // namespace
}  // namespace dubsar
