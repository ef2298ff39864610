// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/global_align.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "registration/absolute_orientation.h"
#include "registration/icp.h"
#include "registration/pose_evidence.h"

namespace dubsar {

namespace {

/// Free space weighs more than agreement: a right pose has next to none of it.
constexpr double kFreeSpaceWeight = 2.0;

double coarse_score(const ScanSurface& source, const ScanSurface& target,
                    const RigidTransform& target_from_source, const EvidenceOptions& options, bool two_way) {
  PoseEvidence e = pose_evidence(*source.coarse, *target.coarse, target_from_source, options);
  if (two_way) {
    e.add(pose_evidence(*target.coarse, *source.coarse, target_from_source.inverse(), options));
  }
  return e.sent == 0 ? 0.0 : (e.close - kFreeSpaceWeight * e.in_front) / static_cast<double>(e.sent);
}

/// Horn's solution over the matches that agree with the pose; the pose itself when they are too few.
RigidTransform consensus(const RingDescriptors& source, const RingDescriptors& target,
                         const std::vector<RingDescriptors::Match>& matches, const RigidTransform& start,
                         double reach_mm) {
  RigidTransform pose = start;
  for (int round = 0; round < 2; ++round) {
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    for (const RingDescriptors::Match& m : matches) {
      const SurfaceSample& a = source.keypoint(static_cast<std::size_t>(m.source));
      const SurfaceSample& b = target.keypoint(static_cast<std::size_t>(m.target));
      const Eigen::Vector3d p = a.position_mm.cast<double>();
      const Eigen::Vector3d q = b.position_mm.cast<double>();
      if ((pose * p - q).squaredNorm() <= reach_mm * reach_mm &&
          (pose.rotation * a.normal.cast<double>()).dot(b.normal.cast<double>()) > 0.8) {
        from.push_back(p);
        to.push_back(q);
      }
    }
    const std::optional<RigidTransform> better =
        from.size() >= 4 ? absolute_orientation(from, to) : std::optional<RigidTransform>{};
    if (!better ||
        RigidTransform{better->rotation * pose.rotation.transpose(), {0, 0, 0}}.angle_rad() > 0.5) {
      break;
    }
    pose = *better;
  }
  return pose;
}

/// The best `most` of the hypotheses that are no near-copies of a better one.
std::vector<PoseHypothesis> distinct(std::vector<PoseHypothesis> all, std::size_t most,
                                     const Eigen::Vector3d& center_mm, double turn_rad, double shift_mm) {
  std::stable_sort(all.begin(), all.end(),
                   [](const PoseHypothesis& a, const PoseHypothesis& b) { return a.score > b.score; });
  std::vector<PoseHypothesis> out;
  for (const PoseHypothesis& h : all) {
    if (out.size() >= most) {
      break;
    }
    const bool known = std::any_of(out.begin(), out.end(), [&](const PoseHypothesis& o) {
      return same_pose(h.target_from_source, o.target_from_source, center_mm, turn_rad, shift_mm);
    });
    if (!known) {
      out.push_back(h);
    }
  }
  return out;
}

}  // namespace

bool same_pose(const RigidTransform& a, const RigidTransform& b, const Eigen::Vector3d& center_mm,
               double turn_rad, double shift_mm) {
  const RigidTransform turn{a.rotation * b.rotation.transpose(), {0, 0, 0}};
  return turn.angle_rad() < turn_rad && (a * center_mm - b * center_mm).norm() < shift_mm;
}

std::vector<PoseHypothesis> align_pair(const ScanFeatures& source, const ScanFeatures& target,
                                       const GlobalAlignOptions& options) {
  const ScanSurface& from = *source.surface;
  const ScanSurface& to = *target.surface;
  const double scale_mm = to.scale_mm;
  std::vector<RingDescriptors::Match> matches =
      RingDescriptors::match(source.descriptors, target.descriptors, options.descriptors);
  if (matches.empty()) {
    return {};
  }
  const std::size_t tried = std::min(matches.size(), static_cast<std::size_t>(options.most_matches));
  EvidenceOptions rough;
  rough.tolerance_mm = options.rough_tolerance * scale_mm;
  rough.band_mm = options.band * scale_mm;
  rough.most_samples = options.quick_samples;
  std::vector<PoseHypothesis> found(tried);
  parallel_for_each_index(
      tried,
      [&](std::size_t k) {
        found[k].target_from_source =
            RingDescriptors::pose_of(source.descriptors, target.descriptors, matches[k]);
        found[k].score = coarse_score(from, to, found[k].target_from_source, rough, false);
      },
      64);

  const double turn = options.distinct_turn_rad;
  const double shift_mm = options.distinct_shift * scale_mm;
  found = distinct(std::move(found), static_cast<std::size_t>(options.most_consensus), from.centroid_mm,
                   0.5 * turn, 0.5 * shift_mm);
  rough.most_samples = 1 << 30;
  parallel_for_each_index(
      found.size(),
      [&](std::size_t k) {
        const RigidTransform better = consensus(source.descriptors, target.descriptors, matches,
                                                found[k].target_from_source, 2.0 * rough.tolerance_mm);
        const double as_found = coarse_score(from, to, found[k].target_from_source, rough, true);
        const double as_better = coarse_score(from, to, better, rough, true);
        found[k].score = std::max(as_found, as_better);
        if (as_better > as_found) {
          found[k].target_from_source = better;
        }
      },
      4);
  found = distinct(std::move(found), static_cast<std::size_t>(options.most_refined), from.centroid_mm, turn,
                   shift_mm);

  EvidenceOptions close = rough;
  close.tolerance_mm = std::max(options.tolerance * scale_mm, 0.5 * to.coarse->spacing_mm);
  parallel_for_each_index(
      found.size(),
      [&](std::size_t k) {
        IcpOptions icp_options;
        const IcpTarget onto{to.coarse.get(), {}};
        for (const double reach : {0.08, 0.04}) {
          icp_options.reach_mm = reach * scale_mm;
          icp_options.kernel_mm = 0.2 * reach * scale_mm;
          icp_options.normal_cosine = 0.6;
          icp_options.iterations = 12;
          icp_options.converged_mm = 1e-3 * scale_mm;
          icp_options.two_way = true;
          found[k].target_from_source =
              icp(*from.coarse, {&onto, 1}, found[k].target_from_source, icp_options).model_from_source;
        }
        found[k].score = coarse_score(from, to, found[k].target_from_source, close, true);
      },
      1);
  return distinct(std::move(found), static_cast<std::size_t>(options.most_returned), from.centroid_mm, turn,
                  shift_mm);
}

}  // namespace dubsar
