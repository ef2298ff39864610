// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "ui/shell/time_left.h"

namespace dubsar::ui {

std::optional<double> TimeLeft::of(const std::string& stage, double fraction, double now_s) {
  constexpr double kEarlyPart = 0.05;
  constexpr double kEarlyS = 2;
  if (stage != stage_ || fraction < fraction_) {
    stage_ = stage;
    began_s_ = now_s;
  }
  fraction_ = fraction;
  const double spent_s = now_s - began_s_;
  if (fraction < kEarlyPart || spent_s < kEarlyS) {
    return std::nullopt;
  }
  return spent_s * (1 - fraction) / fraction;
}

}  // namespace dubsar::ui
