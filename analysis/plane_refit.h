// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "analysis/wedge_faces.h"
#include "analysis/wedge_patch.h"

namespace dubsar {

/// The faces with planes that what is wrong at their borders does not tilt. Stitching fills the creases: a
/// sample is averaged with triangles of other scans, which cut them short over about a spacing. And what is
/// taken by where noise has put it is biased: cut by their own heights, vertices near the rim that noise
/// raised are left out and those that it lowered stay. Either makes faces too flat. So vertices are taken by
/// where their feet on the plane lie, which noise across the plane does not move, and weigh less the nearer
/// their feet lie to a crease. Normals, offsets, middles, scatter and sigmas of the planes are new; labels,
/// depth point and edges are not touched. A plane that cannot be fitted so stays as it was. `tolerance_mm`:
/// scatter of the vertices about their faces, three times. `rim_mm`: feet higher than this are of the rim,
/// over the free surface (below zero).
[[nodiscard]] WedgeFaces refit_planes(const WedgePatch& patch, WedgeFaces faces, double tolerance_mm,
                                      double rim_mm, double normal_gate_deg);

}  // namespace dubsar
