// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#include "registration/align_near.h"

#include <algorithm>
#include <cmath>

#include "core/parallel.h"
#include "core/random.h"
#include "registration/global_align.h"

namespace dubsar {

namespace {

constexpr double kFreeSpaceWeight = 2.0;
/// Draws of the neighbourhood: a constant, so that the same scans give the same poses.
constexpr std::uint64_t kSeed = 20031;

struct Candidate {
  RigidTransform pose;
  double score = 0;
};

double score_of(const ScanSurface& scan, std::span<const ModelScan> model, const RigidTransform& pose,
                const EvidenceOptions& options) {
  double score = 0;
  for (const ModelScan& m : model) {
    const RigidTransform m_from_scan = m.model_from_scanner.inverse() * pose;
    PoseEvidence e = pose_evidence(*scan.coarse, *m.surface->coarse, m_from_scan, options);
    e.add(pose_evidence(*m.surface->coarse, *scan.coarse, m_from_scan.inverse(), options));
    score += e.close - kFreeSpaceWeight * e.in_front;
  }
  return score;
}

/// `off` turns about the scan's centroid where `start` puts it.
RigidTransform moved_by(const RigidTransform& start, const Eigen::Vector3d& centroid_mm,
                        const Eigen::Vector3d& omega_rad, const Eigen::Vector3d& shift_mm) {
  const RigidTransform turn = RigidTransform::from_twist(omega_rad, Eigen::Vector3d::Zero());
  const Eigen::Vector3d center_mm = start * centroid_mm;
  return {turn.rotation * start.rotation,
          turn.rotation * (start.translation_mm - center_mm) + center_mm + shift_mm};
}

/// Poses around the start, denser near it.
std::vector<Candidate> neighbourhood(const ScanSurface& scan, const RigidTransform& start,
                                     const AlignNearOptions& options) {
  std::vector<Candidate> out;
  Random random(kSeed);
  const auto in_ball = [&](double radius) {
    const Eigen::Vector3d direction = random.normal3();
    return Eigen::Vector3d(direction.normalized() * radius * std::sqrt(random.uniform()));
  };
  for (int k = 0; k < options.tried; ++k) {
    const Eigen::Vector3d omega = in_ball(options.turn_rad);
    const Eigen::Vector3d shift = in_ball(options.shift * scan.scale_mm);
    out.push_back({moved_by(start, scan.centroid_mm, omega, shift)});
  }
  return out;
}

void keep_best(std::vector<Candidate>& candidates, std::size_t most, const ScanSurface& scan, double turn_rad,
               double shift_mm) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  std::vector<Candidate> kept;
  for (const Candidate& c : candidates) {
    if (kept.size() == most) {
      break;
    }
    if (std::none_of(kept.begin(), kept.end(), [&](const Candidate& k) {
          return same_pose(c.pose, k.pose, scan.centroid_mm, turn_rad, shift_mm);
        })) {
      kept.push_back(c);
    }
  }
  candidates = std::move(kept);
}

/// Point-to-point from far: the reach shrinks from the farthest that the start may be off.
RigidTransform brought_closer(const ScanSurface& scan, std::span<const ModelScan> model,
                              const RigidTransform& start, double reach_mm) {
  std::vector<IcpTarget> targets;
  for (const ModelScan& m : model) {
    targets.push_back({m.surface->coarse.get(), m.model_from_scanner});
  }
  IcpOptions far;
  far.metric = IcpMetric::kPointToPoint;
  far.two_way = true;
  far.normal_cosine = 0.5;
  far.converged_mm = 1e-3 * scan.scale_mm;
  RigidTransform pose = start;
  for (const double part : {1.0, 0.5}) {
    far.reach_mm = part * reach_mm;
    far.kernel_mm = 0.3 * far.reach_mm;
    far.iterations = 10;
    pose = icp(*scan.coarse, targets, pose, far).model_from_source;
  }
  return pose;
}

}  // namespace

std::vector<ModelFit> align_near(const ScanSurface& scan, std::span<const ModelScan> model,
                                 const RigidTransform& start, const AlignNearOptions& options) {
  if (scan.fine->samples.empty() || model.empty()) {
    return {};
  }
  const double reach_mm = 0.7 * options.shift * scan.scale_mm;
  const std::vector<RigidTransform> plain{start, brought_closer(scan, model, start, reach_mm)};
  std::vector<ModelFit> fits = fit_to_model(scan, model, plain, options.fit);
  if (!fits.empty() && doubt(fits.front(), options.verify) <= options.doubtful) {
    return fits;
  }
  EvidenceOptions quick;
  quick.tolerance_mm = 0.04 * scan.scale_mm;
  quick.band_mm = options.fit.band * scan.scale_mm;
  quick.most_samples = options.quick_samples;
  std::vector<Candidate> around = neighbourhood(scan, start, options);
  const auto score_all = [&](const EvidenceOptions& evidence) {
    parallel_for_each_index(
        around.size(),
        [&](std::size_t k) { around[k].score = score_of(scan, model, around[k].pose, evidence); }, 8);
  };
  score_all(quick);
  keep_best(around, static_cast<std::size_t>(options.refined), scan, 0.5 * options.fit.distinct_turn_rad,
            options.fit.distinct_shift * scan.scale_mm);
  parallel_for_each_index(
      around.size(),
      [&](std::size_t k) { around[k].pose = brought_closer(scan, model, around[k].pose, 0.5 * reach_mm); },
      1);
  std::vector<RigidTransform> starts;
  for (const Candidate& c : around) {
    starts.push_back(c.pose);
  }
  for (const ModelFit& fit : fits) {
    starts.push_back(fit.model_from_scanner);
  }
  return fit_to_model(scan, model, starts, options.fit);
}

}  // namespace dubsar
