// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "core/job.h"
#include "triangulation/fusion.h"
#include "triangulation/stitch_surface.h"

namespace dubsar {

struct OwnershipOptions {
  /// Patches with fewer samples than this are left to other scans, where others have the place too.
  int least_wanted_patch_samples = 100;
  /// Patches with fewer samples than this are left out.
  int least_patch_samples = 12;
  /// Samples of another scan stay this far, × the coarser µ, from a patch that is kept: the seam between them
  /// is closed by triangles of about the size of the grid's own.
  double clearance_factor = 0.65;
};

/// How far around a pair's sample the kept patch of the other scan is looked at.
inline constexpr int kLookAroundSamples = 2;

inline constexpr std::uint8_t kAllAroundKept = 2;

/// A scan with what others know of it, as ownership needs it; the pairs are sorted by the id of the other
/// scan, which stands at position `other[k]` of the same list.
struct OwnedScan {
  const StitchSurface* surface = nullptr;
  FusedSamples* fused = nullptr;  ///< holds all wanted samples; grows by those that come to be kept besides
  const std::vector<std::uint8_t>* wanted = nullptr;  ///< as wanted_samples() says
  std::vector<const Pairs*> pairs;
  std::vector<const StitchSurface*> other_surface;  ///< by pair
  std::vector<std::size_t> other;
  std::vector<std::uint8_t> kept;   ///< out: 1 where the sample is a vertex of the stitched mesh
  std::vector<std::uint8_t> cells;  ///< out: CellBit codes of the triangles that are kept
  /// out: samples, ascending, that are not kept though nobody keeps anything where they lie: too few beside
  /// each other for a patch, or without a triangle that meets no other. Averaged, too.
  std::vector<std::uint32_t> loose;
  /// 1 where a kept sample lies within kLookAroundSamples: most of what is asked about others ends here.
  /// kAllAroundKept where triangles lie all around it.
  std::vector<std::uint8_t> near_kept;
  std::vector<std::uint8_t> some_kept;  ///< by node: 1 where a sample of its block is kept
  std::vector<std::uint8_t> all_kept;   ///< by node: 1 where each of them is

  /// Of a job that is cancelled none.
  void fuse(std::span<const std::uint32_t> which, const JobContext& job) const {
    dubsar::fuse(*surface, other_surface, pairs, which, *fused, job);
  }
};

}  // namespace dubsar
