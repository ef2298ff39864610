// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "core/random.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

TEST(Random, DrawsWhatSplitMix64DoesFromItsSeed) {
  Random random(1234567);
  EXPECT_EQ(random.next(), 6457827717110365317ULL);
  EXPECT_EQ(random.next(), 3203168211198807973ULL);
  EXPECT_EQ(random.next(), 9817491932198370423ULL);
}

// Seeds stand in the documents beside figures: whatever compiled the program, they have to mean the same
// tablet.
TEST(Random, TheLastOfThreeNormalsIsDrawnFirst) {
  Random three(7);
  Random single(7);
  for (int i = 0; i < 5; ++i) {
    const Eigen::Vector3d drawn = three.normal3();
    EXPECT_EQ(drawn.z(), single.normal());
    EXPECT_EQ(drawn.y(), single.normal());
    EXPECT_EQ(drawn.x(), single.normal());
  }
}

}  // namespace
}  // namespace dubsar
