// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/key_taps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <string>

namespace dubsar::ui {
namespace {

constexpr int kKey = 301;

/// How a key stands in each of some frames: "-" up, "D" down. Before a frame comes what is given for it.
std::string frames(std::initializer_list<const char*> before) {
  KeyTaps taps;
  std::array<bool, KeyTaps::kKeys> down{};
  std::string seen;
  for (const char* events : before) {
    for (const char event : std::string(events)) {
      taps.happened(kKey, event == 'd');
    }
    taps.put_into(down);
    seen += down[kKey] ? 'D' : '-';
  }
  return seen;
}

TEST(KeyTaps, APressThatIsOverBeforeTheFrameIsSeenInIt) {
  EXPECT_EQ(frames({"du", "", ""}), "D--");
}

TEST(KeyTaps, AKeyThatIsHeldIsDownUntilItIsLetGo) {
  EXPECT_EQ(frames({"", "d", "", "", "u", ""}), "-DDD--");
}

TEST(KeyTaps, EachOfTwoPressesIsOne) {
  EXPECT_EQ(frames({"du", "du", "", ""}), "D-D-");
  EXPECT_EQ(frames({"d", "", "ud", "", "u"}), "DD-D-") << "let go and pressed again between two frames";
  EXPECT_EQ(frames({"du", "d", "", "", "u"}), "D-DD-") << "a tap, then held";
}

TEST(KeyTaps, KeysWithoutANumberAreNone) {
  KeyTaps taps;
  taps.happened(-1, true);
  taps.happened(static_cast<int>(KeyTaps::kKeys), true);
  std::array<bool, KeyTaps::kKeys> down{};
  taps.put_into(down);
  EXPECT_EQ(std::count(down.begin(), down.end(), true), 0);
}

}  // namespace
}  // namespace dubsar::ui
