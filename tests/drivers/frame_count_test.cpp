// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "drivers/aravis/frame_count.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "core/random.h"

namespace dubsar::aravis {
namespace {

constexpr std::int64_t kMs = 1'000'000;

TEST(FrameCount, TheCamerasNumbersTellWhatIsMissing) {
  FrameCount count;
  count.begin();
  EXPECT_EQ(count.take(65533, 10 * kMs, 10 * kMs).id, 1U);  // it counts from where it likes
  EXPECT_EQ(count.take(65534, 20 * kMs, 20 * kMs).lost, 0U);
  const FrameCount::Step behind = count.take(3, 60 * kMs, 60 * kMs);  // 65535, 1 and 2 did not come
  EXPECT_EQ(behind.lost, 3U);
  EXPECT_EQ(behind.id, 6U);
  EXPECT_FALSE(behind.camera_restarted);
  count.begin();
  EXPECT_EQ(count.take(9, 70 * kMs, 70 * kMs).id, 1U);
}

TEST(FrameCount, NumbersThatCannotBeSayNothing) {
  FrameCount count;
  count.begin();
  EXPECT_EQ(count.take(70000, 10 * kMs, 10 * kMs).id, 1U);
  for (const std::uint64_t raw :
       {std::uint64_t{1} << 63U, std::uint64_t{7}, std::uint64_t{7}, ~std::uint64_t{0}}) {
    EXPECT_EQ(count.take(raw, 20 * kMs, 20 * kMs).lost, 0U) << raw;
  }
}

TEST(FrameCount, OverANewConnectionTimeTellsWhatIsMissing) {
  FrameCount count;
  count.begin();
  for (std::int64_t k = 1; k <= 50; ++k) {
    static_cast<void>(count.take(static_cast<std::uint64_t>(k), 10 * k * kMs, (7000 + 10 * k) * kMs));
  }
  // It once stood still for a second, which says nothing of its rate.
  static_cast<void>(count.take(51, 1500 * kMs, 8500 * kMs));
  for (std::int64_t k = 52; k <= 60; ++k) {
    static_cast<void>(count.take(static_cast<std::uint64_t>(k), (990 + 10 * k) * kMs, (7990 + 10 * k) * kMs));
  }
  count.go_on();
  const FrameCount::Step kept = count.take(1, 2390 * kMs, 9391 * kMs);
  EXPECT_EQ(kept.lost, 79U);
  EXPECT_EQ(kept.id, 140U);
  EXPECT_FALSE(kept.camera_restarted);
  EXPECT_EQ(count.take(2, 2400 * kMs, 9401 * kMs).id, 141U);
  // The clock of a camera that was switched off begins anew; where a frame has none nobody can tell.
  count.go_on();
  const FrameCount::Step anew = count.take(1, 3400 * kMs, 400 * kMs);
  EXPECT_TRUE(anew.camera_restarted);
  EXPECT_EQ(anew.lost, 99U);
  count.go_on();
  EXPECT_TRUE(count.take(1, 3410 * kMs, 0).camera_restarted);
}

/// Frames of a camera without a clock have the times at which they came, on a busy machine unevenly.
TEST(FrameCount, TimesThatJitterTellTheRateAllTheSame) {
  constexpr std::int64_t kPeriod = 10 * kMs;
  constexpr std::int64_t kMissed = 199;
  std::int64_t worst = 0;
  for (std::uint64_t seed = 1; seed <= 50; ++seed) {
    Random random(seed);
    const auto at = [&](std::int64_t k) {
      return 1000 * kMs + k * kPeriod + static_cast<std::int64_t>(random.uniform(-0.2, 0.2) * kPeriod);
    };
    FrameCount count;
    count.begin();
    for (std::int64_t k = 0; k < 40; ++k) {
      static_cast<void>(count.take(static_cast<std::uint64_t>(k + 1), at(k), 0));
    }
    count.go_on();
    const auto lost = static_cast<std::int64_t>(count.take(1, at(40 + kMissed), 0).lost);
    worst = std::max(worst, std::abs(lost - kMissed));
  }
  EXPECT_LE(worst, 3);
}

TEST(FrameCount, WithoutARateNothingIsClaimed) {
  FrameCount count;
  count.begin();
  static_cast<void>(count.take(1, 10 * kMs, 10 * kMs));
  count.go_on();
  const FrameCount::Step next = count.take(1, 2000 * kMs, 2000 * kMs);
  EXPECT_EQ(next.lost, 0U);
  EXPECT_EQ(next.id, 2U);
}

}  // namespace
}  // namespace dubsar::aravis
