// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/position_track.h"

#include <gtest/gtest.h>

#include <thread>

namespace dubsar {
namespace {

constexpr std::int64_t kMs = 1000000;

TEST(PositionTrack, FollowsSpeedAndAcceleration) {
  PositionTrack track;
  const auto position = [](double t_s) { return -3 + 2 * t_s + 5 * t_s * t_s; };
  for (int k = 0; k < 100; ++k) {
    track.add(k * 5 * kMs, position(0.005 * k), kMs / 10);
  }
  track.close();
  for (int k = 30; k < 400; k += 7) {
    EXPECT_NEAR(track.at(k * kMs).value(), position(1e-3 * k), 1e-6);
  }
  EXPECT_NEAR(track.last().value(), position(0.495), 1e-12);
}

TEST(PositionTrack, ReadingsThatTookLongCountLittle) {
  PositionTrack track;
  for (int k = 0; k < 60; ++k) {
    // At 10 mm/s every fifth answer came late, by up to 8 ms, which it says itself.
    const bool late = k % 5 == 0;
    track.add(k * 5 * kMs + (late ? 4 * kMs : 0), 10 * 0.005 * k, late ? 8 * kMs : kMs / 5);
  }
  track.close();
  for (int k = 40; k < 250; k += 3) {
    EXPECT_NEAR(track.at(k * kMs).value(), 0.01 * k, 0.001);
  }
}

TEST(PositionTrack, TellsNothingOutside) {
  PositionTrack empty;
  empty.close();
  EXPECT_FALSE(empty.at(0).has_value());
  EXPECT_TRUE(empty.closed_before(0));
  PositionTrack track;
  track.add(10 * kMs, 1, 0);
  track.add(10 * kMs, 7, 0);  // no later: left out
  track.add(20 * kMs, 2, 0);
  track.close();
  EXPECT_FALSE(track.at(9 * kMs).has_value());
  EXPECT_FALSE(track.at(21 * kMs).has_value());
  EXPECT_NEAR(track.at(15 * kMs).value(), 1.5, 1e-9);
  EXPECT_NEAR(track.at(10 * kMs).value(), 1, 1e-9);
  EXPECT_FALSE(track.closed_before(20 * kMs));
  EXPECT_TRUE(track.closed_before(21 * kMs));
}

TEST(PositionTrack, WaitsForWhatIsBehind) {
  PositionTrack track;
  for (int k = 0; k < 3; ++k) {
    track.add(k * 10 * kMs, k, 0);
  }
  std::optional<double> told;
  std::jthread asks([&] { told = track.at(15 * kMs); });
  for (int k = 3; k < 8; ++k) {
    track.add(k * 10 * kMs, k, 0);
  }
  asks.join();
  EXPECT_NEAR(told.value(), 1.5, 1e-9);
}

}  // namespace
}  // namespace dubsar
