// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "core/job.h"
#include "triangulation/small_motion.h"
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

/// Where one scan overlaps one other (seed 001, 4: pairs by distance). Kept for the nodes of its lattice; the
/// pair of any sample is a few steps from that of its node.
struct Pairs {
  int other_id = 0;
  float reach_mm = 0;
  float min_normal_cos = 0;
  /// Samples over which the say of either scan fades out towards its rim: none where the poses agree to
  /// within the noise, more the farther the surfaces lie apart, so that no step shows where a scan ends.
  float feather = 0;
  /// From where the pose of this scan puts a place to where that of the other does, as far as they are known
  /// to be off: there its pair is looked for.
  SmallMotion onto;
  std::size_t nodes = 0;            ///< with a pair
  std::vector<std::int32_t> match;  ///< by node: the other scan's usable sample nearest to node_sample, or -1

  [[nodiscard]] Eigen::Vector3f on_other(const Eigen::Vector3f& p_mm) const {
    return onto.is_none() ? p_mm : Eigen::Vector3f(p_mm + onto.at(p_mm));
  }
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

/// Of a job that is cancelled some are missing.
[[nodiscard]] Pairs find_pairs(const StitchSurface& from, const StitchSurface& to, double reach_mm,
                               const PairingOptions& options, const JobContext& job = {});

/// The same with another Pairs::onto.
[[nodiscard]] Pairs find_pairs_anew(const StitchSurface& from, const StitchSurface& to, Pairs pairs,
                                    const SmallMotion& onto);

/// Where pair_of() sets out from for the samples of a node, and how the other grid goes on around there.
struct PairStart {
  std::int32_t sample = -1;  ///< of the other scan; -1 where the two do not overlap
  Eigen::Vector3f origin{0, 0, 0};
  float row = 0, col = 0;
  Eigen::Vector3f rows_per_mm{0, 0, 0}, cols_per_mm{0, 0, 0};

  /// Row and column that p would have if the grid went on evenly.
  [[nodiscard]] std::pair<float, float> place_of(const Eigen::Vector3f& p) const {
    const Eigen::Vector3f d = p - origin;
    return {row + rows_per_mm.dot(d), col + cols_per_mm.dot(d)};
  }
};
[[nodiscard]] PairStart pair_start(const StitchSurface& from, std::size_t node, const StitchSurface& to,
                                   const Pairs& pairs);

/// The sample of `to` that is likely to be nearest to p, or -1.
[[nodiscard]] std::int64_t likely_sample(const PairStart& start, const StitchSurface& to,
                                         const Eigen::Vector3f& p);

/// Whether two samples are near enough to each other, and look the same way.
[[nodiscard]] bool may_pair(const StitchSurface& from, std::size_t sample, const StitchSurface& to,
                            std::size_t other, const Pairs& pairs);

/// The pair of one sample: the usable sample of `to` nearest to it within reach whose normal agrees, or -1.
/// `start` is its node's, with a sample. Depends on nothing but its arguments.
[[nodiscard]] std::int64_t pair_of(const StitchSurface& from, std::size_t sample, const PairStart& start,
                                   const StitchSurface& to, const Pairs& pairs);

}  // namespace dubsar
