// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "archive/six_views.h"

namespace dubsar {

/// The ending that the Cuneiform Digital Library Initiative gives a picture of a face: "o", "r", "le", "re",
/// "te", "be".
[[nodiscard]] const char* cdli_suffix(Face face);

/// How a collection lays out the six views of a tablet on one picture. Both have the left and the right edge
/// beside the obverse and a ruler.
enum class FatcrossKind {
  /// Cuneiform Digital Library Initiative: the column top edge, obverse, bottom edge, reverse, joined edge to
  /// edge, on black.
  kCdli,
  /// electronic Babylonian Library: the column obverse, bottom edge, reverse, top edge, ruler, with gaps and
  /// a margin of 100 pixels at 600 dots per inch.
  kEbl,
};

/// Where the upper left corner of each view, by Face, comes to lie on that picture: pixels right and down.
[[nodiscard]] std::array<Eigen::Vector2i, kFaceCount> fatcross_corners(const SixViews& views,
                                                                       FatcrossKind kind);

/// Photographs get rescaled until they fit; these views are all to one scale, and so is the picture: its
/// mm_per_px is theirs. The views must have been drawn with `ground` as their background, without margins.
[[nodiscard]] Image fatcross(const SixViews& views, FatcrossKind kind, Rgb8 ground);

}  // namespace dubsar
