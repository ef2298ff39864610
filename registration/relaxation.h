// SPDX-License-Identifier: Apache-2.0
// Copyright The Dubsar developers
#pragma once

#include <Eigen/Core>
#include <vector>

#include "core/job.h"
#include "core/result.h"
#include "core/rigid_transform.h"
#include "registration/icp.h"

namespace dubsar {

/// What one pair of scans says about their relative pose. The twist convention: left perturbation of a_from_b
/// (omega rad, v mm) about center_mm in the frame of scan a.
struct PairConstraint {
  std::size_t a = 0;  ///< position in the list of poses
  std::size_t b = 0;
  RigidTransform a_from_b;
  Eigen::Vector3d center_mm{0, 0, 0};
  Matrix6d information = Matrix6d::Zero();  ///< inverse covariance of the twist
  bool from_surfaces = true;                ///< the noise of its scans is in it, and in their other pairs …
  Footprint of_a, of_b;                     ///< … as far as these use the same parts of them
};

/// The same said of b and a.
[[nodiscard]] PairConstraint turned(const PairConstraint& pair);

struct RelaxationOptions {
  double huber_sigmas = 3.0;  ///< a pair that is off by more pulls with constant force
  int iterations = 50;
  /// How much of a scan's noise pairs on one part of it have in common, from 0 (each pair sees other samples)
  /// to 1 (all see the same). Calibrated with dubsar-registration.
  double shared_noise = 1.0;
};

struct RelaxedPose {
  RigidTransform model_from_scanner;
  Matrix6d covariance =
      Matrix6d::Zero();  ///< of the left twist about the given centre; zero for a fixed scan
};

/// Relaxes all poses together: a pose graph over the pairs (Ceres), robust, fixed scans untouched. `start`,
/// `fixed` and `centers_mm` (in each scan's frame: what its covariance is about) run over the same scans. Of
/// the largest piece that pairs connect a scan is fixed, or its first counts as fixed. Covariances are scaled
/// by how well the pairs agree with each other, never below what they claim; of a scan that no pairs connect
/// with a fixed one nothing is known: its covariance is huge. kCancelled when the job was stopped;
/// kInternal for poses or pairs that are not finite, and when no solution was found: the caller's poses then
/// stand. One thread; deterministic.
[[nodiscard]] Result<std::vector<RelaxedPose>> relax(const std::vector<RigidTransform>& start,
                                                     const std::vector<bool>& fixed,
                                                     const std::vector<Eigen::Vector3d>& centers_mm,
                                                     const std::vector<PairConstraint>& pairs,
                                                     const RelaxationOptions& options, const JobContext& job);

}  // namespace dubsar
