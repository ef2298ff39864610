// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "analysis/wedges.h"

namespace dubsar {

/// A depth point that moved further than this when the mesh was made anew is not taken for the same one.
inline constexpr double kSamePlaceMm = 0.25;

/// Makes options.corrections, in their order, in a set that follows from the findings. A wedge that a
/// correction gives is measured by the code that measures all others and keeps whatever it measures; its
/// confidence is what the judgement says of it beside the others. Wedges that no correction names stay as
/// they are, with their ids; new ones get new ids. What cannot be made is noted in `lost`, and changes
/// nothing.
void correct_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                    const WedgeOptions& options, const WedgeFindings& findings, WedgeSet* set);

}  // namespace dubsar
