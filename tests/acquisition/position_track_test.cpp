// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "acquisition/position_track.h"

#include <gtest/gtest.h>

#include <thread>

#include "acquisition/stage_watch.h"
#include "tests/acquisition/rig_bench.h"

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
    EXPECT_NEAR(track.at(k * kMs).value().position, position(1e-3 * k), 1e-6);
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
    EXPECT_NEAR(track.at(k * kMs).value().position, 0.01 * k, 0.001);
  }
}

TEST(PositionTrack, SaysHowWellItKnows) {
  // 5 mm/s; answers that took 1 ms, then some that took 100 ms and more, on a machine with too much work.
  const auto track_of = [](double late_share, PositionTrack& track) {
    for (int k = 0; k < 60; ++k) {
      const std::int64_t half = k > 20 && k < 40 ? static_cast<std::int64_t>(late_share * 60 * kMs) : kMs / 2;
      // The answer was true when it was given, at either end of the wait.
      const std::int64_t true_ns = k * 10 * kMs + (k % 3 == 0 ? -half : half);
      track.add(k * 10 * kMs, 5e-9 * static_cast<double>(true_ns), half);
    }
    track.close();
  };
  PositionTrack quick;
  track_of(1.0 / 120, quick);
  PositionTrack slow;
  track_of(1, slow);
  for (int k = 250; k < 350; k += 7) {
    const auto sure = quick.at(k * kMs).value();
    EXPECT_LT(sure.sigma, 0.002);
    EXPECT_NEAR(sure.position, 5e-3 * k, 4 * sure.sigma);
    const auto doubtful = slow.at(k * kMs).value();
    EXPECT_GT(doubtful.sigma, 0.02);
    EXPECT_NEAR(doubtful.position, 5e-3 * k, 4 * doubtful.sigma);
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
  EXPECT_NEAR(track.at(15 * kMs).value().position, 1.5, 1e-9);
  EXPECT_NEAR(track.at(10 * kMs).value().position, 1, 1e-9);
  EXPECT_FALSE(track.closed_before(20 * kMs));
  EXPECT_TRUE(track.closed_before(21 * kMs));
}

TEST(PositionTrack, WaitsForWhatIsBehind) {
  PositionTrack track;
  for (int k = 0; k < 3; ++k) {
    track.add(k * 10 * kMs, k, 0);
  }
  std::optional<PositionTrack::Place> told;
  std::jthread asks([&] { told = track.at(15 * kMs); });
  for (int k = 3; k < 8; ++k) {
    track.add(k * 10 * kMs, k, 0);
  }
  asks.join();
  EXPECT_NEAR(told.value().position, 1.5, 1e-9);
}

/// A motor that is stuck, of a controller that reports what it asked of it; or a controller that lies.
TEST(StageWatch, AStageThatMovesForEverIsToldAsOneThatFailed) {
  test::RigBench bench;
  bench.says_it_moves = true;
  const Device stage = test::stage_of(bench);
  StageWatch watch(stage, 0, std::chrono::milliseconds(20));
  while (!watch.track().wait_closed(std::chrono::seconds(1))) {
  }
  const Status told = watch.finish();
  ASSERT_FALSE(told.has_value());
  EXPECT_EQ(told.error().kind, ErrorKind::kDevice);
  EXPECT_NE(told.error().what.find("long after it should have arrived"), std::string::npos);
}

}  // namespace
}  // namespace dubsar
