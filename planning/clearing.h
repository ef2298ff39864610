// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "core/grid_lookup.h"
#include "core/placed_scan.h"
#include "planning/sample_normals.h"

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
/// The largest µ of all scans; 0 for none.
[[nodiscard]] double coarsest_spacing_mm(std::span<const PlacedScan> scans);

/// Noise of the scan's samples, estimated where it is not known.
[[nodiscard]] double noise_of(const PlacedScan& scan);

/// Unit normal of a sample towards the scanner, by differences to its neighbours nearer than step_mm; zero
/// where that is undefined. Scanner frame.
[[nodiscard]] Eigen::Vector3f sample_normal(const RangeGrid& grid, std::size_t sample, float step_mm);

/// The normals of the whole grid, sample_normal() with a step of 5µ.
[[nodiscard]] SampleNormals normals_of(const RangeGrid& grid);

/// 1.5µ + 3σ and at most 6µ (ClearingOptions), µ of the coarser scan, σ² = both poses' variances + both
/// scans' noise variances.
[[nodiscard]] double matching_radius_mm(const RangeGrid& a, double noise_a_mm, double sigma_a_mm,
                                        const RangeGrid& b, double noise_b_mm, double sigma_b_mm,
                                        const ClearingOptions& options);

/// [size of the grid], 1 where a sample may clear others.
[[nodiscard]] std::vector<std::uint8_t> unflagged_samples(const RangeGrid& grid, const SampleFlags& flags);

/// A sparse sample that may be cleared; scanner frame of its own scan.
struct SparseSample {
  std::uint32_t index = 0;  ///< in its grid
  Eigen::Vector3f position_mm{0, 0, 0};
  /// Towards the camera. Its own normal would not do: at a gap differences say nothing, and where the scan
  /// grazes the surface their sign is a matter of luck; but a surface that was seen faces the camera.
  Eigen::Vector3f facing{0, 0, 0};
};

/// Sparse samples that lie together, and a ball around them: what another scan did not see at all is passed
/// over at once.
struct SparseTile {
  std::uint32_t first = 0;  ///< position of its first sample; it holds those up to the next tile's
  Eigen::Vector3f center_mm{0, 0, 0};
  float radius_mm = 0;
};

/// The sparse samples of a scan, tile of its grid by tile.
struct SparseSamples {
  std::vector<SparseSample> samples;
  std::vector<SparseTile> tiles;
  Eigen::AlignedBox3f box_mm;  ///< around all of them
};
[[nodiscard]] SparseSamples sparse_samples(const RangeGrid& grid, const SampleFlags& flags);

/// Which of the sparse samples (positions in the list, ascending) match a sample that `others` holds: it lies
/// within the radius, and its normal is compatible. other_from_own takes the samples' scanner frame to the
/// lookup's; `normals` are those of its grid. Uses both cores.
[[nodiscard]] std::vector<std::uint32_t> matched_samples(const SparseSamples& sparse,
                                                         const RigidTransform& other_from_own,
                                                         const GridLookup& others,
                                                         const SampleNormals& normals, double radius_mm,
                                                         const ClearingOptions& options);

/// The plain pairwise step: sets kCleared in `flags` (of `own`) where a non-flagged sample of `other` lies.
/// Returns how many samples it cleared that were not cleared before.
std::int64_t clear_against(const PlacedScan& own, const PlacedScan& other, SampleFlags& flags,
                           const ClearingOptions& options = {});

}  // namespace dubsar
