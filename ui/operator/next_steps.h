// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string>

#include "core/red_map.h"
#include "station/live_state.h"
#include "ui/shell/text_table.h"

namespace dubsar::ui {

[[nodiscard]] bool is_turned_by_hand(const NextView& next);

/// What the red map would do next, in the words that it has for it; empty where it has none.
[[nodiscard]] std::string by_hand(const LiveState& state, Language language);

/// What the hand does, and what the motors do behind it: "turn …; then turntable to …". Either may be empty.
struct NextSteps {
  std::string hand, motors;
};
[[nodiscard]] NextSteps steps_of(const NextView& next);

/// What motors do by themselves; empty where they do nothing.
[[nodiscard]] std::string goes_itself(const std::string& motors, Language language);

/// All of it: what motors do is not told as if the operator were to do it.
[[nodiscard]] std::string what_is_next(const NextView& next, Language language);

}  // namespace dubsar::ui
