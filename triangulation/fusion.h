// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "triangulation/stitch_surface.h"

namespace dubsar {

struct PairingOptions {
  double reach_factor = 2.5;    ///< × µ of the coarser scan: how far apart two samples may pair
  double sigma_factor = 3.0;    ///< × pose sigma of both scans together, added to the reach
  double min_normal_cos = 0.5;  ///< normals of a pair agree within 60°
  /// The reach grows with the measured mismatch of two scans up to this many µ: poses that are off still give
  /// one surface.
  double most_reach_factor = 8.0;
};

/// The pairs of one scan with one other: for each sample of the first, the nearest usable sample of the other
/// within reach whose normal agrees, or -1.
struct Pairs {
  int other_id = 0;
  float reach_mm = 0;
  /// Samples over which the say of either scan fades out towards its rim: none where the poses agree to
  /// within the noise, more the farther the surfaces lie apart, so that no step shows where a scan ends.
  float feather = 0;
  std::size_t count = 0;
  std::vector<std::int32_t> match;
};

/// How far apart the two surfaces lie, measured on a spread of samples along the normal; robust (median).
/// Negative when they do not overlap.
[[nodiscard]] double mismatch_mm(const StitchSurface& from, const StitchSurface& to, double reach_mm);

/// Distance within which samples of the two scans pair. The same whichever way round.
[[nodiscard]] double pair_reach_mm(const StitchSurface& a, const StitchSurface& b,
                                   const PairingOptions& options);

/// What of the mismatch their noise does not explain: how far apart their poses hold them. The same whichever
/// way round.
[[nodiscard]] double step_mm(const StitchSurface& a, const StitchSurface& b, double reach_mm);

/// For Pairs::feather, from step_mm().
[[nodiscard]] double feather_samples(const StitchSurface& a, const StitchSurface& b, double step_mm);

[[nodiscard]] Pairs find_pairs(const StitchSurface& from, const StitchSurface& to, double reach_mm,
                               const PairingOptions& options);

/// Where each sample goes when its pairs have had their say.
struct FusedSamples {
  std::vector<Eigen::Vector3f> points;  ///< model frame
  /// (1 - Π(1 - r) over the supporting scans) / (1 + (sigma / µ)²)
  std::vector<float> reliability;
  /// Standard deviation along the normal, mm: of the noise that averaging leaves, or what the scans' own
  /// disagreement says when that is more, and of the poses.
  std::vector<float> sigma_mm;
  std::vector<std::uint8_t> sparse;  ///< 1 for a sparse sample that projects onto no well-sampled triangle
  std::vector<std::uint8_t> scans;   ///< supporting scans, itself included
};

/// Seed 001, section 4: the reliability-weighted average of a sample and its projections, along its normal,
/// on the triangles of the scans it pairs with. A projection is as good as the samples that it lies between
/// (their variances, interpolated). `others` and `pairs` run in parallel, in the order of scan ids. Where the
/// other scan has no triangle nothing is counted.
[[nodiscard]] FusedSamples fuse(const StitchSurface& from, std::span<const StitchSurface* const> others,
                                std::span<const Pairs* const> pairs);

}  // namespace dubsar
