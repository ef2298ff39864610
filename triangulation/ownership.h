// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <vector>

#include "core/job.h"
#include "triangulation/owned_scan.h"

namespace dubsar {

/// Gives each place of the surface one primary scan, the view closest to the normal there (seed 001, 4), and
/// keeps that scan's samples and triangles: patches of single scans that nowhere overlap, with a seam about
/// one spacing wide between them. No place that any scan covers with triangles is left without a patch, but
/// for the seams and where loose samples lie. Scans must be sorted by id. Returns false when cancelled.
[[nodiscard]] bool assign_owners(std::vector<OwnedScan>& scans, const GridTriangulationOptions& grid,
                                 const OwnershipOptions& options, const JobContext& job);

}  // namespace dubsar
