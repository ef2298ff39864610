// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/mesh.h"
#include "core/placed_scan.h"
#include "planning/model_surface.h"

namespace dubsar {

/// Of an object that is no tablet the hull spans hollows: unseen patches that lie over air which cameras
/// looked through go, for no surface is missing there.
void leave_out_air(std::span<const PlacedScan> scans, const Mesh& hull, ModelSurface& surface);

}  // namespace dubsar
