// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <string_view>

#include "analysis/surface_fields.h"
#include "core/job.h"
#include "core/mesh.h"

namespace dubsar::bench {

/// What an open border does to the heights: prints how far those of a part of the mesh lie off `whole`, those
/// of the mesh itself, by distance from the border. `part`: "half" (x below zero) or "obverse" (faces that
/// look up, as a scan of one side has them).
void print_cut_heights(const Mesh& mesh, const SurfaceFields& whole, std::string_view part,
                       const SurfaceFieldOptions& options, const JobContext& job);

}  // namespace dubsar::bench
