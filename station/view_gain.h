// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <optional>

namespace dubsar {

/// What a scan that was asked for was to clear, and what of that red it did clear (cleared_area_mm2()).
struct ViewGain {
  int scan = 0;
  std::optional<double> predicted_mm2;  ///< nothing for a scan that was not taken where it was proposed
  double actual_mm2 = 0;
};

}  // namespace dubsar
