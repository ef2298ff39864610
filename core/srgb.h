// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cmath>

namespace dubsar {

// The transfer function of sRGB (IEC 61966-2-1) in both directions, numbers from 0 to 1.

[[nodiscard]] inline double linear_of_srgb(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}

[[nodiscard]] inline double srgb_of_linear(double light) {
  return light <= 0.0031308 ? 12.92 * light : 1.055 * std::pow(light, 1.0 / 2.4) - 0.055;
}

}  // namespace dubsar
