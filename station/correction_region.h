// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "core/mesh.h"
#include "core/mesh_part.h"
#include "core/wedge_correction.h"

namespace dubsar {

/// A wedge is to be added where this is selected. The places are some of the selected vertices, to the
/// micrometre, so close together that each selected one lies within reach of one of them, so that the region
/// is found again on a mesh that was made anew. The selection fits the mesh; empty, it gives no places.
[[nodiscard]] WedgeCorrection addition_of(const Mesh& mesh, const MeshSelection& selection);

}  // namespace dubsar
