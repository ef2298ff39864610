// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "archive/image.h"

namespace dubsar {

/// Linear light, 1 = white. Light adds up in linear numbers only; files hold sRGB.
using LinearRgb = std::array<float, 3>;

/// IEC 61966-2-1 in both directions; to_srgb clamps to [0, 1].
[[nodiscard]] LinearRgb to_linear(Rgb8 colour);
[[nodiscard]] Rgb8 to_srgb(const LinearRgb& colour);

/// A ramp that reads the same in print and to colour-blind eyes: dark blue over grey to pale yellow with even
/// steps of lightness (after the idea of cividis, Nuñez et al. 2018). t is clamped to [0, 1].
[[nodiscard]] Rgb8 lightness_ramp(double t);

}  // namespace dubsar
