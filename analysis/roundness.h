// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "analysis/wedge_faces.h"
#include "analysis/wedge_patch.h"

namespace dubsar {

/// How round a hollow is in which three faces were found. Around a bowl or a cone the normal turns steadily,
/// within what is called a face as much as from one to the next; a wedge's faces are planes and all the
/// turning is done at its inner edges, as long as these are sharp.
struct Roundness {
  /// Of each face: how far its clay turns from its one side to its other, level with the free surface; above
  /// zero where it turns as a hollow does. 0 where too few vertices lie on it.
  std::array<double, 3> turn_rad{};
  /// The second largest of them, of the mean angle between the normals of two faces: 0 for planes, below it
  /// where they bulge, 0.6 to 0.85 for cones and bowls. A single face may be bent: a neighbour was pressed
  /// beside it.
  double share = 0;
};
[[nodiscard]] Roundness roundness_of(const WedgePatch& patch, const WedgeFaces& faces);

}  // namespace dubsar
