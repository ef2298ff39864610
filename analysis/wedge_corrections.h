// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "analysis/wedge_ids.h"
#include "analysis/wedges.h"

namespace dubsar {

/// Makes options.corrections, in their order, in a set that follows from the findings, in the order of these.
/// A wedge that a correction gives is measured by the code that measures all others and keeps whatever it
/// measures; its confidence is what the judgement says of it beside the others. Wedges that no correction
/// names stay as they are, with their ids; new ones get theirs of `ids`. What cannot be made is noted in
/// `lost`, and changes nothing.
void correct_wedges(const Mesh& mesh, const VertexGraph& graph, const SurfaceFields& fields,
                    const WedgeOptions& options, const WedgeFindings& findings, WedgeIds* ids, WedgeSet* set);

}  // namespace dubsar
