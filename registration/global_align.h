// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <memory>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/ring_descriptor.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What alignment from the surface alone needs of a scan; computed once.
struct ScanFeatures {
  std::shared_ptr<const ScanSurface> surface;
  RingDescriptors descriptors;
};

struct GlobalAlignOptions {
  RingDescriptorOptions descriptors;
  // Lengths are parts of the surfaces' common scale.
  int most_matches = 2400;  ///< whose poses are tried
  int quick_samples = 120;  ///< of the first trial of each
  int most_consensus = 80;  ///< poses that are improved by the matches that agree with them
  int most_refined = 14;    ///< distinct poses that ICP refines
  int most_returned = 5;
  double rough_tolerance = 0.035;  ///< of a sample under a pose from one match
  double tolerance = 0.015;        ///< of a sample after ICP on the coarse level
  double band = 0.08;
  double distinct_turn_rad = 0.2;  ///< poses nearer than both of these are one
  double distinct_shift = 0.06;
};

/// A pose of one scan against another, with its score: the share of both scans' samples that lie on the other
/// surface, less what free space contradicts. Comparable within one pair only.
struct PoseHypothesis {
  RigidTransform target_from_source;
  double score = 0;
};

/// True when two poses move the point at `center_mm` to within shift_mm of each other and differ by less than
/// turn_rad.
[[nodiscard]] bool same_pose(const RigidTransform& a, const RigidTransform& b,
                             const Eigen::Vector3d& center_mm, double turn_rad, double shift_mm);

/// Aligns two scans with nothing known of their poses: every descriptor match is a pose; the best by surface
/// agreement are improved by the matches that agree with them and by ICP. Returns distinct hypotheses, best
/// first; none of them is verified. Both surfaces must have been made for the same scale.
[[nodiscard]] std::vector<PoseHypothesis> align_pair(const ScanFeatures& source, const ScanFeatures& target,
                                                     const GlobalAlignOptions& options);

}  // namespace dubsar
