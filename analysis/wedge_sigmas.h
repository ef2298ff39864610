// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <array>

#include "analysis/inner_edges.h"
#include "analysis/wedge_faces.h"
#include "core/wedge.h"

namespace dubsar {

/// What there is of the three faces.
struct FacesSeen {
  std::array<double, 3> coverage = {1, 1, 1};  ///< share of each that is there, of what the model says
  std::array<double, 3> gap_mm{};              ///< from the depth point to the nearest clay of each
  std::array<double, 3> turn_rad{};            ///< how far the clay of each turns across it (roundness.h)
  double rim_rad = 0;                          ///< how far the free surface leans over towards a rim
};

/// Sets wedge->sigma, from what the fits say of themselves, from where the lines and the planes of the same
/// clay do not agree, from what is missing, how worn the faces are and how near a rim of the tablet is.
/// `spacing_mm`: of the mesh. The measures of the wedge are there already, its edges not yet counted from the
/// directional one.
void note_sigmas(const WedgeFaces& faces, const InnerEdges& edges, const FacesSeen& seen, double spacing_mm,
                 ExitDefinition exits, Wedge* wedge);

}  // namespace dubsar
