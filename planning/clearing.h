// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid_lookup.h"
#include "core/placed_scan.h"

namespace dubsar {

/// How near a sample of another scan has to be to show that a place was well sampled (seed 001, 3.3, step 3).
struct ClearingOptions {
  double spacing_factor = 1.5;  ///< of the larger µ of the two scans
  double sigma_factor = 3.0;    ///< of the poses' and the samples' standard deviation together
  /// The radius never grows beyond this many µ: a bad pose must not clear what it cannot place.
  double max_spacing_factor = 6.0;
  /// Normals farther apart do not match: the other side of a thin rim is another place. More than a right
  /// angle, since a red sample often lies where its own scan grazes the surface.
  double max_normal_angle_rad = 1.83;
};

/// µ of the grid, estimated where it is not known.
[[nodiscard]] double spacing_of(const RangeGrid& grid);

/// Unit normal of a sample towards the scanner, by differences to its neighbours nearer than step_mm; zero
/// where that is undefined. Scanner frame.
[[nodiscard]] Eigen::Vector3f sample_normal(const RangeGrid& grid, std::size_t sample, float step_mm);

/// 2µ + 3σ, σ² = both poses' variances + both scans' noise variances.
[[nodiscard]] double matching_radius_mm(const RangeGrid& a, double noise_a_mm, double sigma_a_mm,
                                        const RangeGrid& b, double noise_b_mm, double sigma_b_mm,
                                        const ClearingOptions& options);

/// A sparse sample that may be cleared; scanner frame of its own scan.
struct SparseSample {
  std::uint32_t index = 0;  ///< in its grid
  Eigen::Vector3f position_mm{0, 0, 0};
  /// Towards the camera. Its own normal would not do: at a gap differences say nothing, and where the scan
  /// grazes the surface their sign is a matter of luck; but a surface that was seen faces the camera.
  Eigen::Vector3f facing{0, 0, 0};
};

/// The sparse samples of a scan in index order.
[[nodiscard]] std::vector<SparseSample> sparse_samples(const RangeGrid& grid, const SampleFlags& flags);

/// Which of the sparse samples (positions in the span, ascending) match a sample that `others` holds.
/// other_from_own takes the samples' scanner frame to the lookup's. Uses both cores.
[[nodiscard]] std::vector<std::uint32_t> matched_samples(std::span<const SparseSample> sparse,
                                                         const RigidTransform& other_from_own,
                                                         const GridLookup& others, double radius_mm,
                                                         const ClearingOptions& options);

/// The plain pairwise step: sets kCleared in `flags` (of `own`) where a non-flagged sample of `other` lies.
/// Returns how many samples it cleared that were not cleared before.
std::int64_t clear_against(const PlacedScan& own, const PlacedScan& other, SampleFlags& flags,
                           const ClearingOptions& options = {});

}  // namespace dubsar
