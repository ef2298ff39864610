// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "planning/sample_states.h"

#include <gtest/gtest.h>

namespace dubsar {
namespace {

RedTarget excused(Excuse excuse, double area_mm2, const std::string& reason) {
  RedTarget target;
  target.state = RegionState::kExcused;
  target.excuse = excuse;
  target.area_mm2 = area_mm2;
  target.reason = reason;
  return target;
}

TEST(SampleStates, EveryStateHasItsFlags) {
  RangeGrid grid;
  grid.allocate(1, 9);
  grid.valid = {1, 1, 1, 1, 1, 1, 1, 0, 1};
  constexpr std::uint8_t kEx = kSparse | kExcused;
  const SampleFlags flags{0, kPotentiallySparse, kSparse, kSparse | kCleared, kEx, kEx, kEx, 0, kNotTablet};
  RedTargets red;
  red.targets = {RedTarget{}, excused(Excuse::kUnneeded, 0.1, "gap"),
                 excused(Excuse::kUnreachable, 1, "deep"), excused(Excuse::kUnneeded, 0, "stray")};
  red.samples = {{1, 2, 0}, {1, 4, 1}, {0, 5, 1}, {1, 5, 2}, {1, 6, 3}};
  const SampleStates states = sample_states(grid, flags, {-1, -1, -1, 4, -1, -1, -1, -1, -1}, red, 1);
  using S = SampleState;
  EXPECT_EQ(states.state, (std::vector{S::kSampled, S::kSampled, S::kRed, S::kCleared, S::kInterpolated,
                                       S::kUnreachable, S::kStray, S::kNone, S::kNone}));
  EXPECT_EQ(states.cleared_by, (std::vector{-1, -1, -1, 4, -1, -1, -1, -1, -1}));
  EXPECT_EQ(states.reason, (std::vector{-1, -1, -1, -1, 0, 1, 2, -1, -1}));
  EXPECT_EQ(states.reasons, (std::vector<std::string>{"gap", "deep", "stray"}));
}

}  // namespace
}  // namespace dubsar
