// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <algorithm>
#include <memory>
#include <vector>

#include "core/rigid_transform.h"
#include "registration/ring_descriptor.h"
#include "registration/scan_surface.h"

namespace dubsar {

/// What alignment from the surface alone needs of a scan; computed once.
struct ScanFeatures {
  std::shared_ptr<const ScanSurface> surface;
  RingDescriptors shape, relief, tone;  ///< tone: empty where the grid has no intensities
};

struct GlobalAlignOptions {
  RingDescriptorOptions rings;
  // Lengths are parts of the surfaces' common scale.
  int most_matches = 1600;     ///< of each content, the best ones
  int most_seeds = 700;        ///< of each content, whose poses are put to the vote
  double vote_turn_rad = 0.4;  ///< matches vote for a pose that theirs is this near to …
  double vote_shift = 0.045;   ///< … and that brings their points this near
  int most_consensus = 60;     ///< poses that are improved by the matches that agree with them
  int most_by_relief = 8;      ///< distinct poses that ICP refines
  int most_by_shape = 8;
  int most_returned = 6;
  double rough_tolerance = 0.035;  ///< of a sample under a pose from matches
  double tolerance = 0.015;        ///< of a sample after ICP on the coarse level
  double band = 0.08;
  double distinct_turn_rad = 0.2;  ///< poses nearer than both of these are one
  double distinct_shift = 0.06;
};

[[nodiscard]] ScanFeatures make_scan_features(std::shared_ptr<const ScanSurface> surface,
                                              const GlobalAlignOptions& options);

/// For sorting poses: relief beyond chance outweighs any shape, for tablets look alike from many sides.
[[nodiscard]] double pose_support(double shape_score, double relief_significance);

/// A pose of one scan against another and what speaks for it. Comparable within one pair only.
struct PoseHypothesis {
  RigidTransform target_from_source;
  /// The share of both scans' samples that lie on the other surface, less what free space contradicts.
  double shape_score = 0;
  double relief_significance = 0;  ///< ReliefAgreement::significance

  [[nodiscard]] double support() const { return pose_support(shape_score, relief_significance); }
};

/// Poses whose relief agrees like this, before they are refined, leave no room for others …
inline constexpr double kSettledSignificance = 8.0;
/// … that show less than this part of it.
inline constexpr double kOutdone = 0.5;

/// Takes out what a pose with settled relief outdoes. `significance` reads it from an entry.
template <class Entry, class Significance>
void drop_outdone(std::vector<Entry>& entries, const Significance& significance) {
  double most = 0;
  for (const Entry& entry : entries) {
    most = std::max(most, significance(entry));
  }
  if (most >= kSettledSignificance) {
    std::erase_if(entries, [&](const Entry& entry) { return significance(entry) < kOutdone * most; });
  }
}

/// True when two poses move the point at `center_mm` to within shift_mm of each other and differ by less than
/// turn_rad.
[[nodiscard]] bool same_pose(const RigidTransform& a, const RigidTransform& b,
                             const Eigen::Vector3d& center_mm, double turn_rad, double shift_mm);

/// Aligns two scans with nothing known of their poses: every descriptor match is a pose and votes for those
/// near its own; the poses with the most votes are improved by the matches that agree with them and by ICP.
/// Returns distinct hypotheses, best first; none of them is verified. Both surfaces must have been made for
/// the same scale.
[[nodiscard]] std::vector<PoseHypothesis> align_pair(const ScanFeatures& source, const ScanFeatures& target,
                                                     const GlobalAlignOptions& options);

}  // namespace dubsar
