// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <span>

#include "core/mesh.h"
#include "core/placed_scan.h"

namespace dubsar::bench {

/// Chosen on one tablet at two noises: of what was tried, what left the least boundary and held the most
/// surface.
struct LinkStitchOptions {
  /// × µ of the coarsest scan so far: how far apart two samples may pair, as Dubsar's own (PairingOptions).
  double reach_factor = 2.5;
  /// The same across the ray. A grid has a sample within 0.71 µ of any place that it covers; with more, what
  /// lies beyond the rim of the other scan is drawn to that rim.
  double across_factor = 1.0;
  int smoothing = 30;       ///< of R, rings of neighbours
  bool one_to_one = false;  ///< see LinkMergeOptions
};

/// The stitching of seed 001, 4 as a peer of Dubsar's own mesher; merge_links() says how it is read. Each
/// scan's triangles by themselves, then the links of the mesh so far and of the next scan merged, in the
/// order given. Holes are not filled and nothing is repaired.
[[nodiscard]] Mesh stitch_links(std::span<const PlacedScan> scans, const LinkStitchOptions& options = {});

}  // namespace dubsar::bench
