// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/operator/next_steps.h"

#include <string_view>

#include "ui/operator/sentences.h"
#include "ui/shell/widgets.h"

namespace dubsar::ui {

bool is_turned_by_hand(const NextView& next) {
  return next.placement && next.placement->hand_turn;
}

std::string by_hand(const LiveState& state, Language language) {
  const bool any = state.red_map && !state.red_map->next.empty();
  return any ? capitalised(translated(state.red_map->next.front().say, language)) : std::string();
}

NextSteps steps_of(const NextView& next) {
  constexpr std::string_view kThen = "; then ";
  if (next.placement && !is_turned_by_hand(next)) {
    return {{}, next.say};
  }
  const auto then = next.say.find(kThen);
  return !next.placement || then == std::string::npos
             ? NextSteps{next.say, {}}
             : NextSteps{next.say.substr(0, then), next.say.substr(then + kThen.size())};
}

std::string goes_itself(const std::string& motors, Language language) {
  return motors.empty() ? std::string()
                        : filled(text_of(Text::kGoesItself, language), translated(motors, language));
}

std::string what_is_next(const NextView& next, Language language) {
  const NextSteps steps = steps_of(next);
  std::string said = steps.hand.empty() ? std::string() : sentence(steps.hand, language);
  if (const std::string drive = goes_itself(steps.motors, language); !drive.empty()) {
    add_sentence(said, drive);
  }
  return said;
}

}  // namespace dubsar::ui
