// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>
#include <cstddef>

namespace dubsar {

/// What speaks for and against a candidate, each a plain number of about 0 to 1.
enum class Evidence : std::size_t {
  kLeastCoverage,  ///< share of the face of which least is there
  kCoverage,       ///< of all three
  kExplained,      ///< share of what lies in its outline that lies on its faces
  kRoughness,      ///< scatter about its faces, in depths
  kVertices,       ///< how many, logarithmic
  kWidestOpening,  ///< widest opening angle
  kLevelRim,       ///< share of the hollow's rim that lies at the free surface
  kWidestFace,     ///< widest face angle: the two ends of a groove lie across from each other
  kSecondSlope,    ///< slope of the second flattest inner edge, of a right angle
  kDepthUnlike,    ///< off the depths of the tablet's wedges
  kWidthUnlike,    ///< off their widths
  kLonely,         ///< few like it in opening angles, slopes and width
  kFar,            ///< distance to the next one
  kCompany,        ///< share of the hollows around, by area, that are good candidates
  kCount
};
using EvidenceValues = std::array<double, static_cast<std::size_t>(Evidence::kCount)>;

}  // namespace dubsar
