// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include "registration/scan_surface.h"

namespace dubsar {

/// Fills the level's samples from its usable cells: points on crease edges and in their neighbourhoods, and
/// the rest spread evenly (seed 001, 3.2: edges suffice at high resolution; a smooth object has few).
void choose_samples(SurfaceLevel& level, int count, const ScanSurfaceOptions& options);

}  // namespace dubsar
