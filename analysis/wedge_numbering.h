// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "analysis/wedge_measure.h"

namespace dubsar {

/// Counts edges, faces and all that goes by them anew, counter-clockwise as before, so that the directional
/// edge is edge 0. Faces are found in an order that hangs on how the mesh lies in its file; the directional
/// edge does not, and every measured wedge has one.
void number_from_directional_edge(WedgeCandidate* candidate);

}  // namespace dubsar
