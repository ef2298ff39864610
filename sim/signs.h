// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <vector>

#include "core/random.h"
#include "sim/impression.h"

namespace dubsar::sim {

/// How one scribe writes.
struct Hand {
  double line_height_mm = 4.5;
  double head_width = 0.28;     ///< of the line height
  double depth = 0.42;          ///< of the head's width
  double head_slope_rad = 1.1;  ///< of the head face
  double slant_rad = 0;         ///< of all strokes
  double unsteadiness = 0.05;   ///< relative, of sizes
};

enum class StrokeKind { kHorizontal, kVertical, kDown, kUp, kWinkelhaken };

/// A stroke of a sign in units of the sign's height, the head's place counted from its lower left corner.
struct SignStroke {
  StrokeKind kind = StrokeKind::kVertical;
  double x = 0;
  double y = 0;
  double length = 0.8;
};
struct Sign {
  std::vector<SignStroke> strokes;  ///< in writing order: a later one overwrites an earlier
  double width = 0.5;               ///< in units of its height
};

/// A sign put together from one to three of the groups that cuneiform signs are built of.
[[nodiscard]] Sign make_sign(Random& random);

/// One writing of a stroke, with the hand's unsteadiness; (0, 0) is the lower left corner of its sign.
[[nodiscard]] Stroke write_stroke(const SignStroke& stroke, const Hand& hand, Random& random);

}  // namespace dubsar::sim
