// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/global_align.h"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/parallel.h"
#include "registration/absolute_orientation.h"
#include "registration/icp.h"
#include "registration/pose_evidence.h"

namespace dubsar {

namespace {

/// Free space weighs more than agreement: a right pose has next to none of it.
constexpr double kFreeSpaceWeight = 2.0;

double coarse_score(const ScanSurface& source, const ScanSurface& target,
                    const RigidTransform& target_from_source, const EvidenceOptions& options) {
  PoseEvidence e = pose_evidence(*source.coarse, *target.coarse, target_from_source, options);
  e.add(pose_evidence(*target.coarse, *source.coarse, target_from_source.inverse(), options));
  return e.sent == 0 ? 0.0 : (e.close - kFreeSpaceWeight * e.in_front) / static_cast<double>(e.sent);
}

/// A match of two keypoints with the pose that it gives.
struct Vote {
  RigidTransform pose;
  Eigen::Quaternionf turn;
  Eigen::Vector3f from, to;  ///< the keypoints, each in its scan's frame
  float weight = 0;
};

void collect_votes(const RingDescriptors& source, const RingDescriptors& target,
                   const RingDescriptorOptions& descriptors, int most, std::vector<Vote>& votes) {
  const std::vector<RingDescriptors::Match> matches = RingDescriptors::match(source, target, descriptors);
  const std::size_t first = votes.size();
  votes.resize(first + std::min(matches.size(), static_cast<std::size_t>(most)));
  parallel_for_each_index(
      votes.size() - first,
      [&](std::size_t k) {
        const RingDescriptors::Match& m = matches[k];
        Vote& vote = votes[first + k];
        vote.pose = RingDescriptors::pose_of(source, target, m);
        vote.turn = Eigen::Quaternionf(vote.pose.rotation.cast<float>());
        vote.from = source.keypoint(static_cast<std::size_t>(m.source)).position_mm;
        vote.to = target.keypoint(static_cast<std::size_t>(m.target)).position_mm;
        vote.weight = std::max(0.05F, 1.0F - m.distance);
      },
      64);
}

/// Decides which votes agree with a pose.
struct Agreement {
  Agreement(const RigidTransform& pose, double turn_rad, double shift_mm)
      : turn(pose.rotation.cast<float>()),
        rotation(pose.rotation.cast<float>()),
        shift(pose.translation_mm.cast<float>()),
        half_cosine(static_cast<float>(std::cos(0.5 * turn_rad))),
        reach2(static_cast<float>(shift_mm * shift_mm)) {}
  [[nodiscard]] bool holds(const Vote& v) const {
    return std::abs(turn.dot(v.turn)) >= half_cosine &&
           (rotation * v.from + shift - v.to).squaredNorm() <= reach2;
  }
  Eigen::Quaternionf turn;
  Eigen::Matrix3f rotation;
  Eigen::Vector3f shift;
  float half_cosine, reach2;
};

/// Horn's solution over the votes that agree with the pose; the pose itself when they are too few.
RigidTransform consensus(const std::vector<Vote>& votes, const RigidTransform& start, double turn_rad,
                         double shift_mm) {
  RigidTransform pose = start;
  for (int round = 0; round < 3; ++round) {
    const Agreement agreement(pose, turn_rad, shift_mm);
    std::vector<Eigen::Vector3d> from;
    std::vector<Eigen::Vector3d> to;
    for (const Vote& v : votes) {
      if (agreement.holds(v)) {
        from.emplace_back(v.from.cast<double>());
        to.emplace_back(v.to.cast<double>());
      }
    }
    const std::optional<RigidTransform> better =
        from.size() >= 4 ? absolute_orientation(from, to) : std::optional<RigidTransform>{};
    if (!better ||
        RigidTransform{better->rotation * pose.rotation.transpose(), {0, 0, 0}}.angle_rad() > turn_rad) {
      break;
    }
    pose = *better;
  }
  return pose;
}

double significance(const ScanSurface& source, const ScanSurface& target,
                    const RigidTransform& target_from_source, double tolerance_mm) {
  return relief_agreement(*source.medium, source.relief, *target.medium, target.relief, target_from_source,
                          tolerance_mm)
      .significance(source.relief.radius_mm);
}

/// The best `most` of the hypotheses by `value` that are no near-copies of a better one.
template <class Value>
std::vector<PoseHypothesis> distinct(std::vector<PoseHypothesis> all, std::size_t most,
                                     const Eigen::Vector3d& center_mm, double turn_rad, double shift_mm,
                                     const Value& value) {
  std::stable_sort(all.begin(), all.end(),
                   [&](const PoseHypothesis& a, const PoseHypothesis& b) { return value(a) > value(b); });
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

double by_shape(const PoseHypothesis& h) {
  return h.shape_score;
}
double by_relief(const PoseHypothesis& h) {
  return h.relief_significance;
}
double by_support(const PoseHypothesis& h) {
  return h.support();
}

struct Votes {
  std::vector<Vote> all;
  std::vector<std::size_t> seeds;  ///< the best of each kind: poses that the others may agree with
};

/// What relief, tone and shape say, each by its own matches.
Votes collect_votes(const ScanFeatures& source, const ScanFeatures& target,
                    const GlobalAlignOptions& options) {
  Votes votes;
  const auto collect = [&](const RingDescriptors& of_source, const RingDescriptors& of_target) {
    const std::size_t first = votes.all.size();
    collect_votes(of_source, of_target, options.rings, options.most_matches, votes.all);
    const std::size_t end = std::min(votes.all.size(), first + static_cast<std::size_t>(options.most_seeds));
    for (std::size_t k = first; k < end; ++k) {
      votes.seeds.push_back(k);
    }
  };
  collect(source.relief, target.relief);
  collect(source.tone, target.tone);
  collect(source.shape, target.shape);
  return votes;
}

/// The seeds' poses, each with the weight of the votes that agree with it as its shape score.
std::vector<PoseHypothesis> voted_poses(const Votes& votes, double turn_rad, double shift_mm) {
  std::vector<PoseHypothesis> poses(votes.seeds.size());
  parallel_for_each_index(
      poses.size(),
      [&](std::size_t k) {
        const RigidTransform& pose = votes.all[votes.seeds[k]].pose;
        const Agreement agreement(pose, turn_rad, shift_mm);
        double sum = 0;
        for (const Vote& v : votes.all) {
          sum += agreement.holds(v) ? static_cast<double>(v.weight) : 0.0;
        }
        poses[k] = {pose, sum, 0.0};
      },
      16);
  return poses;
}

PoseHypothesis weighed(const ScanSurface& source, const ScanSurface& target,
                       const RigidTransform& target_from_source, const EvidenceOptions& evidence) {
  return {target_from_source, coarse_score(source, target, target_from_source, evidence),
          significance(source, target, target_from_source, evidence.tolerance_mm)};
}

/// ICP between the coarse surfaces, from a wide reach to a narrow one.
RigidTransform fitted(const ScanSurface& source, const ScanSurface& target, RigidTransform pose) {
  IcpOptions options;
  options.normal_cosine = 0.6;
  options.iterations = 12;
  options.converged_mm = 1e-3 * target.scale_mm;
  options.two_way = true;
  const IcpTarget onto{target.coarse.get(), {}};
  for (const double reach : {0.08, 0.04}) {
    options.reach_mm = reach * target.scale_mm;
    options.kernel_mm = 0.2 * reach * target.scale_mm;
    pose = icp(*source.coarse, {&onto, 1}, pose, options).model_from_source;
  }
  return pose;
}

}  // namespace

double pose_support(double shape_score, double relief_significance) {
  // Among thousands of tried poses chance reaches three sigmas or so.
  return shape_score + 0.15 * std::clamp(relief_significance - 3.0, 0.0, 20.0);
}

ScanFeatures make_scan_features(std::shared_ptr<const ScanSurface> surface,
                                const GlobalAlignOptions& options) {
  ScanFeatures out;
  std::vector<RingContent> contents{RingContent::kShape, RingContent::kRelief};
  if (!surface->relief.tone.empty()) {
    contents.push_back(RingContent::kTone);
  }
  std::vector<RingDescriptors> made =
      RingDescriptors::make(*surface, surface->scale_mm, contents, options.rings);
  out.shape = std::move(made[0]);
  out.relief = std::move(made[1]);
  if (made.size() > 2) {
    out.tone = std::move(made[2]);
  }
  out.surface = std::move(surface);
  return out;
}

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
  const auto best_of = [&](std::vector<PoseHypothesis> all, std::size_t most, const auto& value) {
    return distinct(std::move(all), most, from.centroid_mm, options.distinct_turn_rad,
                    options.distinct_shift * scale_mm, value);
  };
  const Votes votes = collect_votes(source, target, options);
  if (votes.all.empty()) {
    return {};
  }
  const double vote_mm = options.vote_shift * scale_mm;
  std::vector<PoseHypothesis> found = best_of(voted_poses(votes, options.vote_turn_rad, vote_mm),
                                              static_cast<std::size_t>(options.most_consensus), by_shape);
  EvidenceOptions evidence;
  evidence.tolerance_mm = options.rough_tolerance * scale_mm;
  evidence.band_mm = options.band * scale_mm;
  parallel_for_each_index(
      found.size(),
      [&](std::size_t k) {
        const RigidTransform pose =
            consensus(votes.all, found[k].target_from_source, options.vote_turn_rad, vote_mm);
        found[k] = weighed(from, to, pose, evidence);
      },
      4);
  std::vector<PoseHypothesis> chosen =
      best_of(found, static_cast<std::size_t>(options.most_by_relief), by_relief);
  std::ranges::move(best_of(std::move(found), static_cast<std::size_t>(options.most_by_shape), by_shape),
                    std::back_inserter(chosen));
  const std::size_t all = chosen.size();
  chosen = best_of(std::move(chosen), all, by_support);
  drop_outdone(chosen, by_relief);

  evidence.tolerance_mm = std::max(options.tolerance * scale_mm, 0.5 * to.coarse->spacing_mm);
  parallel_for_each_index(
      chosen.size(),
      [&](std::size_t k) {
        chosen[k] = weighed(from, to, fitted(from, to, chosen[k].target_from_source), evidence);
      },
      1);
  return best_of(std::move(chosen), static_cast<std::size_t>(options.most_returned), by_support);
}

}  // namespace dubsar
