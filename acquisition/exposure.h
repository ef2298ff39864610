// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/gray_image.h"

namespace dubsar {

enum class ExposureAdvice : std::uint8_t { kGood, kTooLong, kTooShort };

/// What a pixel says of the exposure.
enum class PixelMark : std::uint8_t { kPlain, kSaturated, kDark };

/// How a frame is exposed. Shares are of the columns (or rows, whichever way the stripe runs) that show the
/// laser stripe, or of all pixels where the frame shows none.
struct Exposure {
  bool has_stripe = false;
  double saturated_share = 0;
  double dark_share = 0;  ///< of a stripe: too weak to be measured well; of a photograph: black
  ExposureAdvice advice = ExposureAdvice::kGood;
};

/// Judges a frame with the laser on, or a photograph of a board. A stripe is too long exposed when more than
/// one column in a hundred is saturated, and too short when one in five is less than 40 grey values over its
/// background (noise then moves its middle by more than a tenth of a pixel). A photograph is too long when a
/// hundredth of it is saturated, and too short when less than a hundredth reaches a quarter of the range.
/// `marks`, when given, becomes [width*height]: the saturated pixels, and those of the weak stripe, or the
/// black ones of a photograph. All zero for an empty frame.
[[nodiscard]] Exposure judge_exposure(const GrayView& frame, std::vector<PixelMark>* marks = nullptr);

}  // namespace dubsar
