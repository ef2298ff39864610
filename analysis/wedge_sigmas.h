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
};

/// Sets wedge->sigma, from what the fits say of themselves, from where the lines and the planes of the same
/// clay do not agree, and from what is missing. `spacing_mm`: of the mesh. The measures of the wedge are
/// there already, its edges not yet counted from the directional one.
void note_sigmas(const WedgeFaces& faces, const InnerEdges& edges, const FacesSeen& seen, double spacing_mm,
                 ExitDefinition exits, Wedge* wedge);

}  // namespace dubsar
