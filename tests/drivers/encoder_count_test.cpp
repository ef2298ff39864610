// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/encoder_count.h"

#include <gtest/gtest.h>

#include <limits>

namespace dubsar::aravis {
namespace {

TEST(EncoderCount, GoesOnWhereARegisterWithoutASignGoesRound) {
  EncoderCount count;
  EXPECT_EQ(count.take(20), 20);
  EXPECT_EQ(count.take(5), 5);
  EXPECT_EQ(count.take(4294967286), -10);  // back over the place where it was switched on
  EXPECT_EQ(count.take(4294967200), -96);
  EXPECT_EQ(count.take(4), 4);
}

TEST(EncoderCount, GoesOnWhereARegisterWithASignGoesRound) {
  EncoderCount count;
  EXPECT_EQ(count.take(2147483640), 2147483640);
  EXPECT_EQ(count.take(-2147483640), 2147483656);
  EXPECT_EQ(count.take(2147483647), 2147483647);
}

TEST(EncoderCount, TakesWhatDoesNotGoRoundAsItStands) {
  EncoderCount count;
  for (const std::int64_t raw :
       {std::int64_t{0}, std::int64_t{2000000000}, std::int64_t{3000000000}, std::int64_t{1} << 40U,
        std::int64_t{-5}, std::numeric_limits<std::int64_t>::max(),
        std::numeric_limits<std::int64_t>::min()}) {
    EXPECT_EQ(count.take(raw), raw);
  }
}

TEST(EncoderCount, BeginsAnewWithTheCamera) {
  EncoderCount count;
  EXPECT_EQ(count.take(4294967290), 4294967290);
  EXPECT_EQ(count.take(10), 4294967306);
  count.begin();
  EXPECT_EQ(count.take(10), 10);
}

}  // namespace
}  // namespace dubsar::aravis
