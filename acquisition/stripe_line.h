// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <limits>
#include <span>
#include <vector>

namespace dubsar {

/// The stripe's middle in successive columns, each found alone.
struct StripeLine {
  static constexpr float kNone = std::numeric_limits<float>::quiet_NaN();
  std::vector<float> at_px;  ///< kNone where the column has no stripe
  std::vector<float> mass;   ///< light that the middle was taken from: what it counts for
};

/// Standard deviation of one column's middle that its neighbours do not share, px: the median of the second
/// differences over one and over two columns, the larger of the two, for speckles may be wider than a column.
/// A surface that bends adds little to it, and an edge nothing. 0 when there are too few columns to tell.
[[nodiscard]] double line_noise_px(const StripeLine& line);

/// Standard deviation, in columns, of the average along the stripe that loses the least: noise falls with the
/// root of the width, and what a bend of the surface is rounded by grows with its square.
[[nodiscard]] double averaging_width_px(double noise_px);

/// The middle in each column after an average along the stripe: a straight line through the neighbours,
/// weighted by light and by a Gaussian of `width_px`, as far as they hang together; a step of more than
/// `largest_step_px` between two columns is an edge, over which nothing is averaged. `out` has a value
/// wherever the line has one.
void average_along(const StripeLine& line, double width_px, double largest_step_px, std::span<float> out);

}  // namespace dubsar
